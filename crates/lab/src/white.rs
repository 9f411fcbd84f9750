//! The white furnace as a map: how much light a surface that absorbs nothing returns, over roughness and angle.
//!
//! The surface is rebuilt with every reflectance 1 (and every width of microfacets, or the other number that says how rough
//! it is, as the row of the map says), and its directional albedo measured by samples on a grid. Where the map is
//! largest the albedo is integrated, and that number is judged.

use crate::anatomy::{self, Rough};
use crate::cells::Cells;
use crate::finding::{Finding, Run};
use crate::plots::mean_weight;
use crate::probe::{Dir, Kind, Probe, SurfaceProbe};
use crate::random::{Random, direction, seed_for};
use crate::subject::Claims;
use gonio_kernel::Surface;
use serde::Serialize;

/// Directional albedos over angle and roughness.
#[derive(Clone, Debug, Serialize)]
pub struct FurnaceMap {
    /// What the rows vary; none if the model has no roughness: then there is one row.
    pub varied: Option<&'static str>,
    /// Its value for each row.
    pub rows: Vec<f64>,
    /// cosθ of wo for each column.
    pub cosines: Vec<f64>,
    /// Luminance of the albedo, row by row.
    pub albedo: Vec<Vec<f64>>,
    /// Whether every reflectance was set to 1; else the model is as it is.
    pub white: bool,
}

impl FurnaceMap {
    /// Nothing measured.
    pub(crate) fn empty() -> Self {
        Self { varied: None, rows: Vec::new(), cosines: Vec::new(), albedo: Vec::new(), white: false }
    }
    /// The largest value with its row and column.
    pub fn largest(&self) -> (f64, usize, usize) {
        let cells =
            self.albedo.iter().enumerate().flat_map(|(r, row)| row.iter().enumerate().map(move |(c, &a)| (a, r, c)));
        cells.fold((0.0, 0, 0), |most, cell| if cell.0 > most.0 { cell } else { most })
    }
}

const ANGLES: usize = 12;
const ROWS: usize = 10;
const AZIMUTH: f64 = 0.7;

fn cosines() -> Vec<f64> {
    (0..ANGLES).map(|i| (i as f64 + 0.5) / ANGLES as f64).collect()
}

/// Over roughness and angle, of a surface.
pub(crate) fn of_surface(surface: &Surface<f32>) -> FurnaceMap {
    let rough = roughness(surface);
    let rows: Vec<f64> = rough.map_or_else(Vec::new, |rough| {
        let (_, lo, hi, log) = rough.axis();
        let share = |i: usize| i as f64 / (ROWS - 1) as f64;
        (0..ROWS).map(|i| if log { lo * (hi / lo).powf(share(i)) } else { lo + (hi - lo) * share(i) }).collect()
    });
    let cosines = cosines();
    let line = |value: Option<f64>| {
        let probe = SurfaceProbe::new(white(surface, value), None);
        cosines.iter().map(|&cos| mean_weight(&probe, direction(cos, AZIMUTH))).collect()
    };
    let albedo = if rows.is_empty() { vec![line(None)] } else { rows.iter().map(|&x| line(Some(x))).collect() };
    FurnaceMap { varied: rough.map(|rough| rough.axis().0), rows, cosines, albedo, white: true }
}

/// Over the angle alone, of a model as it is.
pub(crate) fn of_probe(probe: &dyn Probe) -> FurnaceMap {
    let cosines = cosines();
    let at = |&cos: &f64| mean_weight(probe, probe.snap(direction(cos, AZIMUTH)));
    let albedo = vec![cosines.iter().map(at).collect()];
    FurnaceMap { varied: None, rows: Vec::new(), cosines, albedo, white: false }
}

/// The first number of the surface that says how rough it is decides what the rows mean.
pub(crate) fn roughness(surface: &Surface<f32>) -> Option<Rough> {
    anatomy::dials(surface).iter().find_map(|(dial, _)| dial.rough)
}

/// The surface without absorption, as rough as given.
pub(crate) fn white(surface: &Surface<f32>, roughness: Option<f64>) -> Surface<f64> {
    let varied = self::roughness(surface);
    anatomy::rebuilt(surface, |dial, x| match (dial.white, dial.rough) {
        (Some(white), _) => f64::from(white),
        (None, Some(rough)) if Some(rough) == varied => roughness.unwrap_or(f64::from(x)),
        _ => f64::from(x),
    })
}

/// The largest albedo of the surface's map, integrated.
pub(crate) fn measure(surface: &Surface<f32>, map: &FurnaceMap, claims: Claims, run: &Run) -> Finding {
    let properties = claims.properties;
    let mut finding = match properties.conserving {
        true => Finding::at_most(1.0, "white: excess over 1 in units of quadrature error and what the model admits ≤"),
        false => Finding::at_least(1.0, "white, gains energy by design: excess over 1 in units of quadrature error ≥"),
    };
    let (sampled, row, column) = map.largest();
    let value = map.rows.get(row).copied();
    let cos = map.cosines[column];
    let probe = SurfaceProbe::new(white(surface, value), None);
    let wo = direction(cos, AZIMUTH);
    let (albedo, error) = integral(&probe, wo, run);
    // The white of a conductor's index reflects 4e-8 less than all; integration of what is all discrete has only rounding.
    let unit = error + f64::from(properties.excess) + 1e-7;
    let place = match (map.varied, value) {
        (Some(name), Some(value)) => format!("{name} {value:.3e}, cosθ {cos:.3}"),
        _ => format!("cosθ {cos:.3}"),
    };
    finding.raise((albedo - 1.0) / unit, || format!("{place}: albedo {albedo:.7}"));
    let least = map.albedo.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    finding.note(format!("white albedo from {least:.4} to {albedo:.6} (by samples {sampled:.4}) at {place}"));
    finding
}

/// The green albedo with its error: all of a white surface's channels are equal.
fn integral(probe: &SurfaceProbe<f64>, wo: Dir, run: &Run) -> (f64, f64) {
    let cells = Cells::following(probe, wo, &mut Random::new(seed_for(0, "white")));
    let total = Cells::total(&cells.integrate(probe, wo));
    let mut random = run.random();
    let mut discrete: Vec<((u32, bool), f64)> = Vec::new();
    for _ in 0..1000 {
        if let Kind::Discrete(worth, label) = probe.sample(wo, random.sampler_input(false)).kind
            && discrete.iter().all(|(seen, _)| *seen != label)
        {
            discrete.push((label, worth.f_cos[1]));
        }
    }
    (total.value[1] + discrete.iter().map(|d| d.1).sum::<f64>(), total.error)
}
