//! Planted faults: models that are wrong on purpose, each with the instruments that must notice.
//!
//! A check that cannot fail proves nothing. A [`Plant`] is a row of the catalog whose `eval` or `sample` has been spoilt, in
//! `f32` and `f64` alike. The task `planted-faults` fails if one goes unnoticed. All run at the size of a quick run; the
//! density that is off by 1 % over 5 % of its mass gets the number of samples that the power calculation demands.

use crate::catalog::{Row, rows};
use crate::finding::{Finding, Run};
use crate::mutations;
use crate::probe::{BsdfValue, Dir, Draw, Kind, Probe, demote};
use crate::random::direction;
use crate::statistics::{FAULT_MASS, FAULT_SIZE, samples_for};
use crate::task::{Task, planted};
use crate::under_test::{UnderTest, View};
use crate::{chi2, consistency, delta, furnace, normalisation, precision, reciprocity, totality, weight};
use crate::{layering, walk};
use gonio_kernel::lobe::Layering;
use std::f64::consts::{PI, TAU};
use std::panic::resume_unwind;

type Eval = fn(&dyn Probe, Dir, Dir) -> BsdfValue;
type Sample = fn(&dyn Probe, Dir, [f64; 3]) -> Draw;
type Measure = fn(View, &Run) -> Finding;

/// A model that is wrong on purpose.
#[derive(Clone, Copy)]
struct Plant {
    /// What is wrong with it.
    name: &'static str,
    /// The row that was spoilt.
    row: &'static str,
    eval: Eval,
    sample: Option<Sample>,
    /// Who must notice.
    caught_by: &'static [(&'static str, Measure)],
}

const FURNACE: (&str, Measure) = ("furnace", furnace::measure);
const ENERGY: (&str, Measure) = ("energy", furnace::measure_bound);
const NORMALISATION: (&str, Measure) = ("normalisation", normalisation::measure);
const CHI2: (&str, Measure) = ("chi2", chi2::measure);
const JACOBIAN: (&str, Measure) = ("jacobian", consistency::measure_jacobian);
const CONSISTENCY: (&str, Measure) = ("consistency", consistency::measure);
const WEIGHT: (&str, Measure) = ("weight", weight::measure);
const RECIPROCITY: (&str, Measure) = ("reciprocity", reciprocity::measure);
const PRECISION: (&str, Measure) = ("precision", precision::measure);
const TOTALITY: (&str, Measure) = ("totality", totality::measure_probe);
const DELTA: (&str, Measure) = ("delta", delta::measure);

fn right(probe: &dyn Probe, wo: Dir, wi: Dir) -> BsdfValue {
    probe.eval(wo, wi)
}
/// The value times a factor.
fn scaled(value: BsdfValue, factor: f64) -> BsdfValue {
    BsdfValue { f_cos: value.f_cos.map(|f| f * factor), ..value }
}
/// The density times a factor.
fn denser(value: BsdfValue, factor: f64) -> BsdfValue {
    BsdfValue { pdf: value.pdf * factor, ..value }
}

fn plants() -> Vec<Plant> {
    vec![
        Plant {
            name: "value depends on wo as it does not on wi",
            row: "lambert colour",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), 1.0 + 1e-4 * wo.x),
            sample: None,
            caught_by: &[RECIPROCITY],
        },
        Plant {
            name: "gains 2 % energy",
            row: "lambert white",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), 1.02),
            sample: None,
            caught_by: &[ENERGY, WEIGHT],
        },
        Plant {
            name: "density off by 1 % over 5 % of its mass",
            row: "lambert white",
            eval: |p, wo, wi| denser(p.eval(wo, wi), one_percent(wi)),
            sample: None,
            caught_by: &[("chi2", find_one_percent), JACOBIAN],
        },
        Plant {
            name: "NaN at grazing",
            row: "lambert white",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), if wi.z.abs() < 1e-3 { f64::NAN } else { 1.0 }),
            sample: None,
            caught_by: &[TOTALITY],
        },
        Plant {
            name: "x and y swapped in sample only",
            row: "conductor 0.3x0.03 white",
            eval: right,
            sample: Some(|p, wo, u| {
                let draw = p.sample(wo, u);
                Draw { wi: Dir::new(draw.wi.y, draw.wi.x, draw.wi.z), ..draw }
            }),
            caught_by: &[CHI2, FURNACE, JACOBIAN],
        },
        Plant {
            name: "density of the half vector, its Jacobian forgotten",
            row: "conductor 0.2x0.2 white",
            eval: |p, wo, wi| denser(p.eval(wo, wi), 2.0 * (wo + wi).length()),
            sample: None,
            caught_by: &[NORMALISATION, CHI2, JACOBIAN],
        },
        Plant {
            name: "missing 1/π in the value",
            row: "lambert white",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), PI),
            sample: None,
            caught_by: &[ENERGY, WEIGHT],
        },
        Plant {
            name: "negative value",
            row: "lambert white",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), if wi.x > 0.9 { -1.0 } else { 1.0 }),
            sample: None,
            caught_by: &[TOTALITY, CONSISTENCY],
        },
        Plant {
            name: "samples uniformly what it says it samples by cosine",
            row: "lambert white",
            eval: right,
            sample: Some(|p, wo, u| Draw { wi: p.snap(direction(1.0 - u[1], TAU * u[2])), ..p.sample(wo, u) }),
            caught_by: &[CHI2, JACOBIAN], // not by the furnace: a white lobe weighs 1 wherever it is sampled
        },
        Plant {
            name: "weighs 0.1 % above its bound",
            row: "conductor 0.2x0.2 white",
            eval: |p, wo, wi| denser(p.eval(wo, wi), 0.999),
            sample: None,
            caught_by: &[WEIGHT],
        },
        Plant {
            name: "infinite where the cosine is denormal",
            row: "lambert white",
            eval: |p, wo, wi| scaled(p.eval(wo, wi), if wi.z > 0.0 && wi.z < 1e-38 { f64::INFINITY } else { 1.0 }),
            sample: None,
            caught_by: &[TOTALITY],
        },
        Plant {
            name: "panics at infinity",
            row: "lambert white",
            eval: |p, wo, wi| {
                if wi.x.is_infinite() {
                    resume_unwind(Box::new("planted")); // no message on the terminal
                }
                p.eval(wo, wi)
            },
            sample: None,
            caught_by: &[TOTALITY],
        },
        Plant {
            name: "wi too long by 1e-5",
            row: "conductor 0.2x0.2 white",
            eval: right,
            sample: Some(|p, wo, u| {
                let draw = p.sample(wo, u);
                Draw { wi: draw.wi * 1.00001, ..draw }
            }),
            caught_by: &[CONSISTENCY],
        },
        Plant {
            name: "failures passed off as samples",
            row: "ground glass 1x1 2.4",
            eval: right,
            sample: Some(|p, wo, u| {
                let draw = p.sample(wo, u);
                Draw { kind: if draw.kind == Kind::Failed { Kind::Continuous } else { draw.kind }, ..draw }
            }),
            caught_by: &[NORMALISATION, CONSISTENCY, CHI2],
        },
        Plant {
            name: "delta event of half its strength",
            row: "half lambert half mirror",
            eval: right,
            sample: Some(|p, wo, u| {
                let draw = p.sample(wo, u);
                let Kind::Delta(value, label) = draw.kind else { return draw };
                Draw { kind: Kind::Delta(scaled(value, 0.5), label), ..draw }
            }),
            caught_by: &[ENERGY],
        },
        Plant {
            name: "mirror that does not turn the tangential part",
            row: "mirror white",
            eval: right,
            sample: Some(|p, wo, u| Draw { wi: wo, ..p.sample(wo, u) }),
            caught_by: &[DELTA],
        },
        Plant {
            name: "mirror of probability one half",
            row: "mirror white",
            eval: right,
            sample: Some(|p, wo, u| {
                let draw = p.sample(wo, u);
                let Kind::Delta(value, label) = draw.kind else { return draw };
                Draw { kind: Kind::Delta(denser(value, 0.5), label), ..draw }
            }),
            caught_by: &[DELTA, NORMALISATION],
        },
        Plant {
            name: "sin² as 1 − cos² in f32",
            row: "conductor 0.01x0.01 white",
            eval: cancelling,
            sample: None,
            caught_by: &[PRECISION],
        },
    ]
}

/// 1.01 over a part of exactly 5 % of the mass of a cosine lobe, and what keeps the integral elsewhere. In the warp's
/// square, sin²θ and φ/2π, a cosine lobe is uniform.
fn one_percent(wi: Dir) -> f64 {
    let side = FAULT_MASS.sqrt();
    let (u, v) = (wi.x * wi.x + wi.y * wi.y, wi.y.atan2(wi.x).rem_euclid(TAU) / TAU);
    let inside = (0.31..0.31 + side).contains(&u) && (0.37..0.37 + side).contains(&v);
    if inside { 1.0 + FAULT_SIZE } else { 1.0 - FAULT_SIZE * FAULT_MASS / (1.0 - FAULT_MASS) }
}

/// χ² at one view with the number of samples that leaves one chance in a million to miss it.
fn find_one_percent(view: View, run: &Run) -> Finding {
    chi2::measure_with(view, run, samples_for(FAULT_SIZE, run.level, chi2::DEGREES, 1.0 - 1e-6), 1)
}

/// GGX of alpha 0.01 whose D takes sin²θ of the half vector from 1 − cos²θ: exact in f64, three digits in f32.
fn cancelling(probe: &dyn Probe, wo: Dir, wi: Dir) -> BsdfValue {
    let value = probe.eval(wo, wi);
    if !probe.single() {
        return value;
    }
    let m = (demote(wo) + demote(wi)).normalize();
    let q = |sin2: f32| f64::from(m.z * m.z) + f64::from(sin2) * 1e4;
    let ratio = q(m.x * m.x + m.y * m.y) / q(1.0 - m.z * m.z);
    denser(scaled(value, ratio * ratio), ratio * ratio)
}

/// A spoilt probe.
struct Spoilt {
    base: Box<dyn Probe>,
    eval: Eval,
    sample: Option<Sample>,
}

impl Probe for Spoilt {
    fn eval(&self, wo: Dir, wi: Dir) -> BsdfValue {
        (self.eval)(self.base.as_ref(), wo, wi)
    }
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw {
        self.sample.map_or_else(|| self.base.sample(wo, u), |sample| sample(self.base.as_ref(), wo, u))
    }
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        match self.sample {
            None => self.base.sample_all(wo, u, out),
            Some(_) => out.extend(u.iter().map(|&u| self.sample(wo, u))),
        }
    }
    fn single(&self) -> bool {
        self.base.single()
    }
    fn radiance_scale(&self, wo: Dir) -> f64 {
        self.base.radiance_scale(wo)
    }
    fn largest_weight(&self, wo: Dir) -> f64 {
        self.base.largest_weight(wo)
    }
}

/// The row with the plant in both precisions.
fn spoil(plant: &Plant, rows: &[Row]) -> Option<UnderTest<'static>> {
    let row = rows.iter().find(|row| row.name == plant.row)?;
    let mut spoilt = UnderTest::of(&row.name, &row.surface);
    let spoil =
        |base: Box<dyn Probe>| -> Box<dyn Probe> { Box::new(Spoilt { base, eval: plant.eval, sample: plant.sample }) };
    spoilt.single = spoilt.single.take().map(spoil);
    spoilt.double = spoilt.double.take().map(spoil);
    Some(spoilt)
}

/// One task per fault and instrument.
pub(crate) fn tasks() -> Vec<Task<'static>> {
    let mut tasks = Vec::new();
    for plant in plants() {
        for &(instrument, measure) in plant.caught_by {
            tasks.push(planted(plant.name, instrument, move |run| {
                // A row that no longer exists is a fault that is not caught.
                let Some(spoilt) = spoil(&plant, &rows()) else { return Finding::at_most(0.0, "no such row") };
                let double = instrument == JACOBIAN.0;
                let view = spoilt.views().find(|view| view.probe.single() != double);
                view.map_or_else(|| Finding::at_most(0.0, "no such view"), |view| measure(view, run))
            }));
        }
    }
    for (name, model) in walk_faults() {
        tasks.push(planted(name, "walk", move |run| walk::measure(model, run)));
    }
    for (name, model) in layering::FAULTS {
        tasks.push(planted(name, "layering", move |run| {
            layering::measure_energy(model, Layering::FurnacePreserving, run)
        }));
    }
    tasks.push(planted("a base darker than the slab", "layering", |run| {
        layering::measure_slab(layering::too_dark, run)
    }));
    tasks.extend(mutations::tasks());
    tasks
}

/// Compensations that are wrong on purpose.
fn walk_faults() -> [(&'static str, walk::Model); 5] {
    use gonio_kernel::Rgb;
    use gonio_kernel::energy::multiple_fresnel;
    use walk::KERNEL;
    [
        (
            "E_avg off by 2 %",
            walk::Model { missing_avg: |alpha| 1.0 - 1.02 * (1.0 - (KERNEL.missing_avg)(alpha)), ..KERNEL },
        ),
        ("E off by 2 %", walk::Model { missing: |cos, alpha| 1.02 * (KERNEL.missing)(cos, alpha) - 0.02, ..KERNEL }),
        ("multiple scattering coloured once only", walk::Model { multiple: |f, _, _, _| f, ..KERNEL }),
        (
            "scattered again as often as at first",
            walk::Model { multiple: |f, _, _, mean| multiple_fresnel(f, mean), ..KERNEL },
        ),
        (
            "facets met as under uniform light",
            walk::Model {
                // 2∫F(μ)μ dμ, by midpoints.
                facets: |fresnel, _, _| {
                    let at = |i: i32| (f64::from(i) + 0.5) / 100.0;
                    let mean = |sum: Rgb<f64>, i: i32| sum + fresnel.reflectance(at(i)) * (0.02 * at(i));
                    (0..100).fold(Rgb::zero(), mean)
                },
                ..KERNEL
            },
        ),
    ]
}
