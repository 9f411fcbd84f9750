//! The white furnace as a map: how much light a lobe that absorbs nothing returns, over roughness and angle.
//!
//! The lobe is rebuilt with every number that says how much is absorbed as its declaration says of a white one (`Quantity::white`), and
//! those that say how rough it is as the row of the map says. Its directional albedo is measured by samples on a grid. Where the map is
//! largest the albedo is integrated, and that number is judged.

use crate::cells::Cells;
use crate::finding::{Finding, Run};
use crate::probe::{Dir, Kind, Probe};
use crate::random::{Random, direction, seed_for};
use crate::test_bsdf::{DynBsdf, Number};
use crate::under_test::Claims;
use gonio_kernel::model::Role;
use gonio_kernel::{Properties, Rgb};
use gonio_report::Axis;
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

/// What a map varies: all numbers of one role, from the values that plots show of it.
#[derive(Clone, Debug)]
pub(crate) struct Varied {
    /// The role of the numbers.
    role: Role,
    /// Their name and range.
    pub(crate) axis: Axis,
    /// A usual value.
    pub(crate) typical: f64,
}

impl Varied {
    /// The first number of any of these roles decides.
    fn first(numbers: &[Number], is_one: impl Fn(Role) -> bool) -> Option<Self> {
        let first = numbers.iter().map(|number| number.parameter).find(|p| is_one(p.quantity.role))?;
        let quantity = first.quantity;
        let role = quantity.role;
        let alike = numbers.iter().filter(|number| number.is(role)).map(|number| number.parameter.key);
        let word = if alike.clone().all(|key| key == first.key) { None } else { word(role) };
        let [lo, hi] = quantity.shown;
        let axis = Axis { name: word.unwrap_or(first.key), lo, hi, log: quantity.log_from.is_some() };
        Some(Self { role, axis, typical: quantity.typical })
    }
    /// How rough it is, if it says so.
    pub(crate) fn roughness(numbers: &[Number]) -> Option<Self> {
        Self::first(numbers, |role| matches!(role, Role::Alpha | Role::Roughness | Role::Exponent))
    }
    /// How rough it is, else what else it says.
    pub(crate) fn any(numbers: &[Number]) -> Option<Self> {
        let other = || Self::first(numbers, |role| role != Role::Weight);
        Self::roughness(numbers).or_else(other)
    }
    /// All numbers, those that are varied set to x.
    pub(crate) fn set(&self, numbers: &[Number], x: f64) -> Vec<f64> {
        numbers.iter().map(|n| if n.is(self.role) { x } else { f64::from(n.value) }).collect()
    }
}

/// What numbers of a role are called together.
fn word(role: Role) -> Option<&'static str> {
    match role {
        Role::Reflectance => Some("reflectance"),
        Role::Roughness => Some("roughness"),
        Role::Alpha => Some("alpha"),
        Role::Exponent => Some("exponent"),
        Role::Index => Some("index"),
        _ => None,
    }
}

/// The numbers of the white twin, as rough as given.
pub(crate) fn white(numbers: &[Number], varied: Option<(&Varied, f64)>) -> Vec<f64> {
    let varies = |number: &Number| varied.filter(|(varied, _)| number.is(varied.role)).map(|(_, x)| x);
    let value = |n: &Number| n.parameter.quantity.white.or_else(|| varies(n)).unwrap_or(f64::from(n.value));
    numbers.iter().map(value).collect()
}

/// Over roughness and angle.
pub(crate) fn map(bsdf: &dyn DynBsdf) -> FurnaceMap {
    let numbers = bsdf.numbers();
    let varied = Varied::roughness(&numbers);
    let rows: Vec<f64> = varied.as_ref().map_or_else(Vec::new, |Varied { axis: Axis { lo, hi, log, .. }, .. }| {
        let share = |i: usize| i as f64 / (ROWS - 1) as f64;
        (0..ROWS).map(|i| if *log { lo * (hi / lo).powf(share(i)) } else { lo + (hi - lo) * share(i) }).collect()
    });
    let cosines = cosines();
    let line = |value: Option<f64>| {
        let probe = bsdf.double_probe(&white(&numbers, varied.as_ref().zip(value)));
        cosines.iter().map(|&cos| mean_weight(probe.as_ref(), direction(cos, AZIMUTH))).collect()
    };
    let albedo = if rows.is_empty() { vec![line(None)] } else { rows.iter().map(|&x| line(Some(x))).collect() };
    FurnaceMap { varied: varied.map(|varied| varied.axis.name), rows, cosines, albedo, white: true }
}

/// Over the angle alone, of a lobe as it is.
pub(crate) fn of_probe(probe: &dyn Probe) -> FurnaceMap {
    let cosines = cosines();
    let at = |&cos: &f64| mean_weight(probe, probe.snap(direction(cos, AZIMUTH)));
    let albedo = vec![cosines.iter().map(at).collect()];
    FurnaceMap { varied: None, rows: Vec::new(), cosines, albedo, white: false }
}

/// The largest albedo of the lobe's map, integrated.
pub(crate) fn measure(bsdf: &dyn DynBsdf, map: &FurnaceMap, claims: Claims, run: &Run) -> Finding {
    let Properties { conserving, excess, .. } = claims.properties;
    let mut finding = match conserving {
        true => Finding::at_most(1.0, "white: excess over 1 in units of quadrature error and what the model admits ≤"),
        false => Finding::at_least(1.0, "white, gains energy by design: excess over 1 in units of quadrature error ≥"),
    };
    let (sampled, row, column) = map.largest();
    let value = map.rows.get(row).copied();
    let cos = map.cosines[column];
    let numbers = bsdf.numbers();
    let varied = Varied::roughness(&numbers);
    let probe = bsdf.double_probe(&white(&numbers, varied.as_ref().zip(value)));
    let wo = direction(cos, AZIMUTH);
    if bsdf.is_combination() && probe.albedo_estimate(wo) > 1.001 {
        // Lobes side by side conserve energy as long as their reflectances add up to 1 at most: these would not.
        return Finding::not_run("its lobes side by side, each white, return more than all light by their own account");
    }
    let (albedo, error) = integral(probe.as_ref(), wo, run);
    // The white of a conductor's index reflects 4e-8 less than all; integration of what is all delta has only rounding.
    let unit = error + f64::from(excess) + 1e-7;
    let place = match (map.varied, value) {
        (Some(name), Some(value)) => format!("{name} {value:.3e}, cosθ {cos:.3}"),
        _ => format!("cosθ {cos:.3}"),
    };
    finding.raise((albedo - 1.0) / unit, || format!("{place}: albedo {albedo:.7}"));
    let least = map.albedo.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    finding.note(format!("white albedo from {least:.4} to {albedo:.6} (by samples {sampled:.4}) at {place}"));
    finding
}

/// The green albedo with its error: all of a white lobe's channels are equal.
fn integral(probe: &dyn Probe, wo: Dir, run: &Run) -> (f64, f64) {
    let cells = Cells::following(probe, wo, &mut Random::new(seed_for(0, "white")));
    let total = Cells::total(&cells.integrate(probe, wo));
    let mut random = run.random();
    let mut delta: Vec<((u32, bool), f64)> = Vec::new();
    for _ in 0..1000 {
        if let Kind::Delta(value, label) = probe.sample(wo, random.sampler_input(false)).kind
            && delta.iter().all(|(seen, _)| *seen != label)
        {
            delta.push((label, value.f_cos[1]));
        }
    }
    (total.value[1] + delta.iter().map(|d| d.1).sum::<f64>(), total.error)
}

/// The mean weight of samples on a grid of 32² random numbers, as a luminance.
pub(crate) fn mean_weight(probe: &dyn Probe, wo: Dir) -> f64 {
    const GRID: usize = 32;
    const GOLDEN: f64 = 0.618_033_988_749_894_9; // its multiples fill [0, 1) evenly
    let at = |i: usize| (i as f64 + 0.5) / GRID as f64;
    let u: Vec<[f64; 3]> =
        (0..GRID * GRID).map(|i| [(i as f64 * GOLDEN).fract(), at(i % GRID), at(i / GRID)]).collect();
    let mut draws = Vec::with_capacity(u.len());
    probe.sample_all(wo, &u, &mut draws);
    let weight = |wi, kind| match kind {
        Kind::Failed => [0.0; 3],
        Kind::Continuous => probe.eval(wo, wi).weight(),
        Kind::Delta(value, _) => value.weight(),
    };
    let luminance = |[r, g, b]: [f64; 3]| Rgb::new(r, g, b).luminance();
    draws.iter().map(|draw| luminance(weight(draw.wi, draw.kind))).sum::<f64>() / u.len() as f64
}
