//! Plots: what the instruments see, for the eye. Nothing here passes or fails.
//!
//! Three for each species of the zoo: the directional albedo over angle and width (is energy where it should be?), the
//! residual of reciprocity over both angles in units of rounding (is it noise, or structure?), and the residuals of the χ²
//! test, over its cells and as a histogram beside the normal distribution (is it noise, or structure?).

use crate::anatomy::{Rough, converted};
use crate::chi2::observed_and_expected;
use crate::finding::Run;
use crate::probe::{Dir, Kind, Probe, SurfaceProbe};
use crate::random::{direction, seed_for};
use crate::run::Options;
use crate::subject::Subject;
use crate::white;
use crate::zoo::{Row, Species, Varied, species};
use gonio_kernel::{Rgb, Surface};

/// A plot with its words.
#[derive(Clone, Debug)]
pub struct Plot {
    /// The lobe that it shows.
    pub lobe: String,
    /// The instrument whose view it is.
    pub instrument: &'static str,
    /// What is drawn.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The numbers.
    pub figure: Figure,
}

/// The numbers of a plot.
#[derive(Clone, Debug)]
pub enum Figure {
    /// A value over two coordinates.
    Map(Map),
    /// How often a value occurs.
    Histogram(Histogram),
}

/// A value over two coordinates.
#[derive(Clone, Debug)]
pub struct Map {
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Values per row.
    pub columns: usize,
    /// Rows from the bottom. A value that is not a number has no colour.
    pub values: Vec<f64>,
    /// How a value becomes a colour.
    pub colours: Colours,
}

/// How often a value occurs, and how often it should.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// The value.
    pub x: Axis,
    /// Counts of equal intervals of the axis.
    pub bars: Vec<f64>,
    /// Expected counts of the same intervals.
    pub expected: Vec<f64>,
}

/// An axis: what it measures, and from where to where.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name with unit.
    pub name: &'static str,
    /// Its beginning.
    pub lo: f64,
    /// Its end.
    pub hi: f64,
    /// Whether equal steps are equal factors.
    pub log: bool,
}

/// How a value becomes a colour; what lies outside of the range has the colour of its end.
#[derive(Clone, Copy, Debug)]
pub enum Colours {
    /// From the least to the most.
    Linear(f64, f64),
    /// From minus to plus so much, with a neutral middle.
    Diverging(f64),
}

impl Axis {
    /// The middle of interval `i` of `n`.
    fn at(&self, i: usize, n: usize) -> f64 {
        let share = (i as f64 + 0.5) / n as f64;
        if self.log { self.lo * (self.hi / self.lo).powf(share) } else { self.lo + (self.hi - self.lo) * share }
    }
}

/// The same plots of one surface: its white twin's albedo, its own reciprocity and χ².
pub fn of_surface(name: &str, surface: &Surface<f32>, options: &Options) -> Vec<Plot> {
    let subject = Subject::of_surface(name, surface);
    let mut plots = vec![white_albedo(name, surface)];
    let Some(view) = subject.views().next() else { return plots };
    if !subject.claims.discrete {
        if !subject.claims.transmits {
            plots.push(reciprocity_of(name, "", view.probe));
        }
        plots.extend(residuals_of(&subject, "", options));
    }
    plots
}

/// All plots; a second or two.
pub fn plots(options: &Options) -> Vec<Plot> {
    let continuous = |s: &&Species| !s.is_discrete();
    let mut plots: Vec<Plot> = species().map(albedo).collect();
    plots.extend(species().filter(continuous).map(reciprocity));
    plots.extend(species().filter(continuous).flat_map(|s| residuals(s, options)));
    plots
}

const COSINE_OUT: Axis = Axis { name: "cosθ of wo", lo: 0.0, hi: 1.0, log: false };

const COLUMNS: usize = 36;
const ROWS: usize = 24;

/// Over roughness and angle, or over the angle alone.
fn white_albedo(name: &str, surface: &Surface<f32>) -> Plot {
    let varied = white::roughness(surface).map(Rough::axis);
    let (axis, lo, hi, log) = varied.unwrap_or(("nothing varied", 0.0, 1.0, false));
    let y = Axis { name: axis, lo, hi, log };
    let mut values = Vec::with_capacity(COLUMNS * ROWS);
    for line in 0..ROWS {
        let probe = SurfaceProbe::new(white::white(surface, varied.map(|_| y.at(line, ROWS))), None);
        values.extend((0..COLUMNS).map(|column| mean_weight(&probe, direction(COSINE_OUT.at(column, COLUMNS), 0.7))));
    }
    Plot {
        lobe: name.to_owned(),
        instrument: "furnace",
        title: "White furnace".to_owned(),
        caption: format!(
            "Luminance of the light that it returns from a white sky with every reflectance 1, over angle and {axis}."
        ),
        figure: Figure::Map(Map { x: COSINE_OUT, y, columns: COLUMNS, values, colours: Colours::Linear(0.0, 1.0) }),
    }
}

fn albedo(species: &'static Species) -> Plot {
    let Varied { name, range: (lo, hi), log, .. } = species.varied;
    let y = Axis { name, lo, hi, log };
    let mut values = Vec::with_capacity(COLUMNS * ROWS);
    for line in 0..ROWS {
        let probe = SurfaceProbe::<f64>::new(converted(&species.specimen(y.at(line, ROWS) as f32).surface()), None);
        values.extend((0..COLUMNS).map(|column| mean_weight(&probe, direction(COSINE_OUT.at(column, COLUMNS), 0.7))));
    }
    let parts = if species.has_width() { "; what is missing at large widths is light that scatters twice" } else { "" };
    Plot {
        lobe: species.name.to_owned(),
        instrument: "furnace",
        title: "Directional albedo".to_owned(),
        caption: format!(
            "Luminance of the reflected light under a uniform white sky, over angle and {}{parts}.",
            y.name
        ),
        figure: Figure::Map(Map { x: COSINE_OUT, y, columns: COLUMNS, values, colours: Colours::Linear(0.0, 1.0) }),
    }
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
        Kind::Discrete(worth, _) => worth.weight(),
    };
    let luminance = |[r, g, b]: [f64; 3]| Rgb::new(r, g, b).luminance();
    draws.iter().map(|draw| luminance(weight(draw.wi, draw.kind))).sum::<f64>() / u.len() as f64
}

fn reciprocity(species: &'static Species) -> Plot {
    let Varied { name, single, .. } = species.varied;
    let probe = SurfaceProbe::new(species.specimen(single).surface(), None);
    reciprocity_of(species.name, &format!(", {name} = {single}"), &probe)
}

fn reciprocity_of(lobe: &str, what: &str, probe: &dyn Probe) -> Plot {
    const N: usize = 36;
    const AZIMUTHS: usize = 16;
    let eps = probe.epsilon();
    let residual = |o: usize, i: usize| {
        let differences = (0..AZIMUTHS).map(|k| {
            let wo = probe.snap(direction(COSINE_OUT.at(o, N), 0.7));
            let wi =
                probe.snap(direction(COSINE_OUT.at(i, N), 0.7 + k as f64 * std::f64::consts::TAU / AZIMUTHS as f64));
            let (there, back) = (probe.eval(wo, wi).f_cos[1] / wi.z, probe.eval(wi, wo).f_cos[1] / wo.z);
            let most = there.max(back);
            if most > 0.0 { (there - back).abs() / (most * eps) } else { 0.0 }
        });
        differences.fold(0.0, f64::max)
    };
    Plot {
        lobe: lobe.to_owned(),
        instrument: "reciprocity",
        title: format!("Reciprocity, {}", if probe.single() { "f32" } else { "f64" }),
        caption: format!(
            "Largest |f(wo,wi) − f(wi,wo)| over f in units of epsilon, over {AZIMUTHS} azimuths{what}. The limit is 16."
        ),
        figure: Figure::Map(Map {
            x: COSINE_OUT,
            y: Axis { name: "cosθ of wi", ..COSINE_OUT },
            columns: N,
            values: (0..N * N).map(|at| residual(at % N, at / N)).collect(),
            colours: Colours::Linear(0.0, 16.0),
        }),
    }
}

/// The residuals (observed − expected)/√expected of the second view's cells: over the cells, and how often they occur.
fn residuals(species: &'static Species, options: &Options) -> [Plot; 2] {
    let Varied { name, single, .. } = species.varied;
    let row = Row { name: species.name.to_owned(), ..species.specimen(single) };
    residuals_of(&Subject::of_surface(&row.name, &row.surface()), &format!(", {name} = {single}"), options)
}

fn residuals_of(subject: &Subject, what: &str, options: &Options) -> [Plot; 2] {
    const SAMPLES: u64 = 500_000;
    const BINS: usize = 17;
    let view = subject.views().next().expect("a subject has a form");
    let at = view.prepared().nth(1).expect("there are four views");
    let seed = seed_for(options.seed, &format!("plot {}", subject.name));
    let run = Run { effort: options.effort, seed, level: 0.0 };
    let cells = observed_and_expected(view, at, SAMPLES, &mut run.random());
    // A cell that expects next to nothing, below the horizon, has no residual worth a colour.
    let residual = |&(observed, expected): &(u64, f64)| {
        if expected >= 25.0 { (observed as f64 - expected) / expected.sqrt() } else { f64::NAN }
    };
    let values: Vec<f64> = cells.iter().map(residual).collect();
    let x = Axis { name: "(observed − expected)/√expected", lo: -4.25, hi: 4.25, log: false };
    let step = (x.hi - x.lo) / BINS as f64;
    let mut bars = vec![0.0; BINS];
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    for v in &finite {
        bars[(((v - x.lo) / step).max(0.0) as usize).min(BINS - 1)] += 1.0;
    }
    let normal = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    let expected = (0..BINS).map(|i| finite.len() as f64 * step * normal(x.at(i, BINS))).collect();
    let words = format!("{}, {SAMPLES} samples{what}", at.name);
    [
        Plot {
            lobe: subject.name.clone(),
            instrument: "chi2",
            title: "χ² by cell".to_owned(),
            caption: format!("{words}. Cells of about equal probability; noise without structure is right."),
            figure: Figure::Map(Map {
                x: Axis { name: "sector of azimuth about the mirror direction", lo: 0.0, hi: 8.0, log: false },
                y: Axis { name: "slab from the normal", lo: 0.0, hi: (values.len() / 8) as f64, log: false },
                columns: 8,
                values,
                colours: Colours::Diverging(4.0),
            }),
        },
        Plot {
            lobe: subject.name.clone(),
            instrument: "chi2",
            title: "χ² residuals".to_owned(),
            caption: format!("{words}. Bars: cells; line: the normal distribution that they should have."),
            figure: Figure::Histogram(Histogram { x, bars, expected }),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::Effort;

    #[test]
    fn every_species_has_its_plots_and_they_show_the_truth() {
        let plots = plots(&Options::new(Effort::Quick));
        for species in species() {
            let of = |instrument| plots.iter().filter(move |p| p.lobe == species.name && p.instrument == instrument);
            let Some(Figure::Map(albedo)) = of("furnace").next().map(|p| &p.figure) else { panic!("{}", species.name) };
            // A coarse grid of random numbers, where a lobe of two parts is not smooth, is good to two per cent.
            assert!(albedo.values.iter().all(|a| (0.0..=1.02).contains(a)), "{}: {:?}", species.name, albedo.values);
            let specimen = species.specimen(species.varied.single);
            let symmetric = Subject::of_surface(species.name, &specimen.surface()).claims.symmetric;
            for plot in of("reciprocity") {
                let Figure::Map(map) = &plot.figure else { panic!("{plot:?}") };
                // Where the two ways take different roundings, the plot shows how much; only the symmetric are bounded by it.
                assert!(!symmetric || map.values.iter().all(|r| *r <= 16.0), "{}", species.name);
            }
            for plot in of("chi2") {
                let Figure::Histogram(h) = &plot.figure else { continue };
                let (cells, expected): (f64, f64) = (h.bars.iter().sum(), h.expected.iter().sum());
                assert!(cells >= 100.0 && (expected / cells - 1.0).abs() < 1e-3, "{cells} and {expected}");
            }
        }
        // Lambert's albedo is its reflectance, whatever the angle.
        let Figure::Map(lambert) = &plots[0].figure else { panic!() };
        let top = lambert.values.len() - 1;
        assert!((lambert.values[top] - lambert.y.at(23, 24)).abs() < 1e-6);
    }
}
