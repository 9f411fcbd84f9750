//! Plots: what the instruments see, for the eye. Nothing here passes or fails.
//!
//! Three for each variant of the catalog: the directional albedo over angle and roughness (is energy where it should be?), the
//! residual of reciprocity over both angles in units of rounding (is it noise, or structure?), and the residuals of the χ²
//! test, over its cells and as a histogram beside the normal distribution (is it noise, or structure?).

use crate::catalog::variants;
use crate::chi2::observed_and_expected;
use crate::finding::Run;
use crate::probe::Probe;
use crate::random::{direction, seed_for};
use crate::task::Options;
use crate::test_bsdf::{DynBsdf, TestBsdf};
use crate::under_test::UnderTest;
use crate::white::{self, Varied, mean_weight};
use gonio_report::{Axis, Colours, Figure, Histogram, Map, Plot};

/// The plots of one lobe: its white twin's albedo, its own reciprocity and χ².
pub fn of<'t>(name: &str, lobe: &impl TestBsdf<'t>, options: &Options) -> Vec<Plot> {
    let under_test = UnderTest::of(name, lobe);
    let mut plots = vec![albedo(name, lobe, true)];
    plots.extend(reciprocity_and_residuals(&under_test, "", options));
    plots
}

/// All plots: those of every variant at usual values; some seconds.
pub fn plots(options: &Options) -> Vec<Plot> {
    let variants: Vec<_> = variants().into_iter().map(|variant| (variant.surface(), variant.name)).collect();
    let of_variant = |(surface, name): &(gonio_kernel::Surface<f32>, String)| {
        let mut plots = vec![albedo(name, surface, false)];
        let (numbers, varied) = (DynBsdf::numbers(surface), Varied::any(&DynBsdf::numbers(surface)));
        if let Some(varied) = varied {
            let values: Vec<f32> = varied.set(&numbers, varied.typical).into_iter().map(|x| x as f32).collect();
            let what = format!(", {} = {}", varied.axis.name, varied.typical);
            plots.extend(reciprocity_and_residuals(&UnderTest::at(name, surface, &numbers, &values), &what, options));
        }
        plots
    };
    // On all threads, in the order of the list.
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let parts = variants.chunks(variants.len().div_ceil(4 * threads).max(1));
    let mut plots: Vec<Plot> = std::thread::scope(|scope| {
        let running: Vec<_> =
            parts.map(|part| scope.spawn(move || part.iter().flat_map(of_variant).collect::<Vec<_>>())).collect();
        running.into_iter().flat_map(|part| part.join().unwrap_or_default()).collect()
    });
    let order = ["furnace", "reciprocity", "chi2"];
    plots.sort_by_key(|plot| order.iter().position(|instrument| *instrument == plot.instrument));
    plots
}

const COSINE_OUT: Axis = Axis { name: "cosθ of wo", lo: 0.0, hi: 1.0, log: false };

const COLUMNS: usize = 36;
const ROWS: usize = 24;

/// Over roughness and angle, or whatever else the lobe says; of the white twin, or of the lobe as it is.
fn albedo(name: &str, bsdf: &dyn DynBsdf, is_white: bool) -> Plot {
    let numbers = bsdf.numbers();
    let varied = if is_white { Varied::roughness(&numbers) } else { Varied::any(&numbers) };
    let nothing = Axis { name: "nothing varied", lo: 0.0, hi: 1.0, log: false };
    let y = varied.as_ref().map_or(nothing, |varied| varied.axis.clone());
    let mut values = Vec::with_capacity(COLUMNS * ROWS);
    for line in 0..ROWS {
        let x = y.at(line, ROWS);
        let numbers = match (&varied, is_white) {
            (varied, true) => white::white(&numbers, varied.as_ref().map(|varied| (varied, x))),
            (Some(varied), false) => varied.set(&numbers, x),
            (None, false) => numbers.iter().map(|number| f64::from(number.value)).collect(),
        };
        let probe = bsdf.double_probe(&numbers);
        let at = |column| mean_weight(probe.as_ref(), direction(COSINE_OUT.at(column, COLUMNS), 0.7));
        values.extend((0..COLUMNS).map(at));
    }
    let (title, light) = match is_white {
        true => ("White furnace", "Luminance of the light that it returns from a white sky with every reflectance 1"),
        false => ("Directional albedo", "Luminance of the reflected light under a uniform white sky"),
    };
    Plot {
        lobe: name.to_owned(),
        instrument: "furnace",
        title: title.to_owned(),
        caption: format!("{light}, over angle and {}.", y.name),
        figure: Figure::Map(Map { x: COSINE_OUT, y, columns: COLUMNS, values, colours: Colours::Linear(0.0, 1.0) }),
    }
}

/// What is not all delta has both; what light passes through only the latter.
fn reciprocity_and_residuals(under_test: &UnderTest, what: &str, options: &Options) -> Vec<Plot> {
    let Some(view) = under_test.views().next() else { return Vec::new() };
    let mut plots = Vec::new();
    if !under_test.claims.properties.all_delta {
        if !under_test.claims.properties.transmits {
            plots.push(reciprocity(&under_test.name, what, view.probe));
        }
        plots.extend(residuals(under_test, what, options));
    }
    plots
}

fn reciprocity(lobe: &str, what: &str, probe: &dyn Probe) -> Plot {
    const N: usize = 36;
    const AZIMUTHS: usize = 16;
    let (eps, least) = (probe.epsilon(), if probe.single() { 1e-30 } else { 1e-280 });
    let residual = |o: usize, i: usize| {
        let differences = (0..AZIMUTHS).map(|k| {
            let wo = probe.snap(direction(COSINE_OUT.at(o, N), 0.7));
            let wi =
                probe.snap(direction(COSINE_OUT.at(i, N), 0.7 + k as f64 * std::f64::consts::TAU / AZIMUTHS as f64));
            let (there, back) = (probe.eval(wo, wi).f_cos[1] / wi.z, probe.eval(wi, wo).f_cos[1] / wo.z);
            let most = there.max(back);
            // Denormal results carry few bits: nothing to compare below.
            if most > least { (there - back).abs() / (most * eps) } else { 0.0 }
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
fn residuals(under_test: &UnderTest, what: &str, options: &Options) -> [Plot; 2] {
    const SAMPLES: u64 = 500_000;
    const BINS: usize = 17;
    let view = under_test.views().next().expect("it has a form");
    let at = view.prepared().nth(1).expect("there are four views");
    let seed = seed_for(options.seed, &format!("plot {}", under_test.name));
    let run = Run { effort: options.effort, seed, level: 0.0 };
    let cells = observed_and_expected(view, at, SAMPLES, &mut run.random());
    // A cell that expects next to nothing, below the horizon, has no residual value a colour.
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
            lobe: under_test.name.clone(),
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
            lobe: under_test.name.clone(),
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
    use crate::effort::Effort;

    #[test]
    fn every_variant_has_its_plots_and_they_show_the_truth() {
        let plots = plots(&Options::new(Effort::Quick));
        for variant in variants() {
            let name = &variant.name;
            let of = |instrument| plots.iter().filter(move |p| p.lobe == *name && p.instrument == instrument);
            let Some(Figure::Map(albedo)) = of("furnace").next().map(|p| &p.figure) else { panic!("{}", variant.name) };
            // A coarse grid of random numbers, where a lobe of two parts is not smooth, is good to two per cent.
            assert!(albedo.values.iter().all(|a| (0.0..=1.02).contains(a)), "{}: {:?}", variant.name, albedo.values);
            let symmetric = UnderTest::of(&variant.name, &variant.surface()).claims.properties.symmetric;
            for plot in of("reciprocity") {
                let Figure::Map(map) = &plot.figure else { panic!("{plot:?}") };
                // Where the two ways take different roundings, the plot shows how much; only the symmetric are bounded by it.
                assert!(!symmetric || map.values.iter().all(|r| *r <= 16.0), "{}", variant.name);
            }
            for plot in of("chi2") {
                let Figure::Histogram(h) = &plot.figure else { continue };
                let (cells, expected): (f64, f64) = (h.bars.iter().sum(), h.expected.iter().sum());
                assert!(cells >= 100.0 && (expected / cells - 1.0).abs() < 1e-3, "{cells} and {expected}");
            }
        }
        // Lambert's albedo is its reflectance, whatever the angle.
        let lambert = plots.iter().find(|p| p.lobe == "lambert").map(|p| &p.figure);
        let Some(Figure::Map(lambert)) = lambert else { panic!() };
        let top = lambert.values.len() - 1;
        assert!((lambert.values[top] - lambert.y.at(23, 24)).abs() < 1e-6);
    }
}
