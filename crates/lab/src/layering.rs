//! Layers: what a dielectric coat over a diffuse base returns, against all light and against the random walk.
//!
//! **Energy.** Over a white Lambertian base, for indices from 1.1 to 2.5, smooth and rough coats, cosines down to 0.02 and both modes of
//! [`Layering`]: the albedo of the whole is that of the top, by the quadrature that the kernel's tables are made with, and that of
//! the rest, by integrating what the layer adds to its top. It may exceed 1 by 1e-4, because the kernel's E errs upwards, and may
//! fall short by 1e-3 from roughness 0.3 on, by 3e-3 below.
//!
//! **Adjoint albedo.** ∫ over wo at fixed wi: what a lamp in the direction wi gets out of the surface on the whole. That of the
//! reciprocal mode is the albedo; that of the furnace-preserving one exceeds 1, and the most of it is printed.
//!
//! **The truth.** Over coloured bases the random walk on the slab ([`crate::slab`]) says what really returns. A layer follows one
//! reflection of the base, so it may only be brighter; by how much is printed.

use crate::finding::{Finding, Run};
use crate::probe::Dir;
use crate::random::direction;
use crate::slab::Slab;
use crate::statistics::mean_p;
use crate::tables::reflected;
use gonio_kernel::closure::Unguarded;
use gonio_kernel::energy::AlbedoCurve;
use gonio_kernel::lobe::{AnyLobe, Coat, Coating, Lambert, Layer, Layering};
use gonio_kernel::{Parameters, Rgb, Transport};
use std::f64::consts::PI;

/// What a diffuse base of that albedo returns from one direction to another through a coat of index eta and roughness \[1/sr\].
pub(crate) type Through = Box<dyn Fn(Dir, Dir) -> f64>;
/// How such a coat lies over such a base: the kernel's layer, or a planted fault.
pub(crate) type Model = fn(f64, f64, f64, Layering) -> Through;

/// The kernel's: what the layer adds to its top.
pub(crate) fn kernel(eta: f64, roughness: f64, base: f64, layering: Layering) -> Through {
    let layer = Layer::new(coat(eta, roughness), Lambert::new(Rgb::splat(base)), layering);
    let layer = layer.expect("a dielectric is a coat");
    Box::new(move |o, i| {
        let whole = Unguarded::new(&layer, o, Transport::Importance).eval(i).f_cos.g;
        let top = Unguarded::new(layer.top(), o, Transport::Importance).eval(i).f_cos.g;
        (whole - top) / i.z
    })
}

/// The coat's lobe, its parameters rounded to f32 as those of a material are.
pub(crate) fn coat(eta: f64, roughness: f64) -> AnyLobe<'static, f64> {
    let (eta, alpha) = as_built(eta, roughness);
    Coating::new(eta as f32, alpha as f32).lobe().to::<f64>()
}

const INDICES: [f64; 6] = [1.1, 1.25, 1.33, 1.5, 1.8, 2.5];
const ROUGHNESSES: [f64; 8] = [0.0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0];
const COSINES: [f64; 10] = [0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95, 1.0];

/// By how much the albedo may exceed 1.
const EXCESS: f64 = 1e-4;

/// By how much a white base may fall short.
fn shortfall(roughness: f64) -> f64 {
    if roughness >= 0.3 { 1e-3 } else { 3e-3 }
}

/// Index and alpha as the kernel has them in f32.
fn as_built(eta: f64, roughness: f64) -> (f64, f64) {
    (f64::from(eta as f32), f64::from((roughness * roughness) as f32))
}

/// What the base returns, f·cos integrated over wi at fixed wo, or over wo at fixed wi; the base is Lambertian and the coat
/// isotropic, so that no azimuth matters.
fn returned(through: &Through, cos: f64, adjoint: bool) -> f64 {
    // Midpoints in √cos, where the curves are smooth: right to 1e-6.
    const STEPS: u32 = 400;
    let fixed = direction(cos, 0.0);
    let midpoint = |step: u32| {
        let t = (f64::from(step) + 0.5) / f64::from(STEPS);
        let other = direction(t * t, 2.0);
        let f = if adjoint { through(other, fixed) } else { through(fixed, other) };
        f * t * t * 2.0 * t
    };
    (0..STEPS).map(midpoint).sum::<f64>() * std::f64::consts::TAU / f64::from(STEPS)
}

/// All light that returns of a direction of that cosine.
fn albedo(model: Model, eta: f64, roughness: f64, base: f64, layering: Layering, cos: f64) -> f64 {
    let (eta_built, alpha) = as_built(eta, roughness);
    reflected(cos, alpha, &[eta_built])[2] + returned(&model(eta, roughness, base, layering), cos, false)
}

/// By how much the albedo over a white base exceeds 1, or falls short, in units of what is allowed.
pub(crate) fn measure_energy(model: Model, layering: Layering, _run: &Run) -> Finding {
    let mut finding =
        Finding::at_most(1.0, "albedo over a white base: excess over 1 in 1e-4, or shortfall in what is allowed ≤");
    let (mut least, mut most, mut adjoint) = (f64::INFINITY, 0.0_f64, (0.0_f64, String::new()));
    for eta in INDICES {
        for roughness in ROUGHNESSES {
            for cos in COSINES {
                let at = || format!("index {eta}, roughness {roughness}, cosθ {cos}");
                let albedo = albedo(model, eta, roughness, 1.0, layering, cos);
                (least, most) = (least.min(albedo), most.max(albedo));
                finding.raise((albedo - 1.0) / EXCESS, || format!("{}: albedo {albedo:.6}", at()));
                finding.raise((1.0 - albedo) / shortfall(roughness), || format!("{}: albedo {albedo:.6}", at()));
                let (eta_built, alpha) = as_built(eta, roughness);
                let back =
                    reflected(cos, alpha, &[eta_built])[2] + returned(&model(eta, roughness, 1.0, layering), cos, true);
                if back > adjoint.0 {
                    adjoint = (back, at());
                }
            }
        }
    }
    finding.note(format!(
        "white base returns {least:.5} to {most:.6}; largest adjoint albedo {:.4} at {}",
        adjoint.0, adjoint.1
    ));
    finding
}

/// How many p-values [`measure_slab`] judges.
pub(crate) const TESTS: usize = SLABS.len() * BASES.len() * VIEWS.len();
const SLABS: [(f64, f64); 4] = [(1.5, 0.0), (1.33, 0.0), (2.0, 0.0), (1.5, 0.3)];
const BASES: [f64; 3] = [0.2, 0.5, 0.8];
const VIEWS: [f64; 3] = [0.95, 0.5, 0.1];

/// Whether the layer is as bright as the walk on the slab or brighter, and by how much.
pub(crate) fn measure_slab(model: Model, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let walks = run.by_effort(20_000, 100_000, 1_000_000);
    let mut differences = Vec::new();
    for (eta, roughness) in SLABS {
        let (mut worst, mut lost) = (0.0_f64, 0.0_f64);
        for base in BASES {
            for cos in VIEWS {
                let (eta_built, alpha) = as_built(eta, roughness);
                let slab = Slab { eta: eta_built, alpha, base: Rgb::splat(base) };
                let truth = slab.walk(cos, walks, &mut random);
                let layer = albedo(model, eta, roughness, base, Layering::Reciprocal, cos);
                let difference = layer - truth.albedo.g;
                let at = || format!("index {eta}, roughness {roughness}, base {base}, cosθ {cos}");
                // E errs upwards: up to what a white base may fall short.
                let p = mean_p(-difference - shortfall(roughness), truth.error);
                finding.lower(p, || format!("{}: {layer:.4}, the walk finds {:.4}", at(), truth.albedo.g));
                worst = worst.max(difference);
                lost = lost.max(truth.lost);
            }
        }
        differences.push(format!(
            "index {eta}, roughness {roughness}: up to {worst:+.3} of all light ({lost:.3} lost between facets)"
        ));
    }
    finding.note(format!("{walks} walks each; a layer is brighter than the slab, {}", differences.join("; ")));
    finding
}

/// Layers that are wrong on purpose: name, and how the base is attenuated.
pub(crate) const FAULTS: [(&str, Model); 5] = [
    ("a base that its coat does not attenuate", |_, _, base, _| Box::new(move |_, _| base / PI)),
    ("a base attenuated by wo twice", |eta, roughness, base, _| {
        let coat = Coat::new(curve(eta, roughness), Layering::FurnacePreserving);
        Box::new(move |o, _| base / PI * coat.transmitted(o).g.powi(2))
    }),
    ("both directions without the mean", |eta, roughness, base, _| {
        let coat = Coat::new(curve(eta, roughness), Layering::FurnacePreserving);
        Box::new(move |o, i| base / PI * coat.transmitted(o).g * coat.transmitted(i).g)
    }),
    ("E off by a hundredth of itself", |eta, roughness, base, _| {
        let coat = Coat::new(curve(eta, roughness).scaled(Rgb::splat(0.99)), Layering::FurnacePreserving);
        Box::new(move |o, _| base / PI * coat.transmitted(o).g)
    }),
    ("a coat seen as smooth", |eta, _, base, _| {
        let coat = Coat::new(curve(eta, 0.0), Layering::FurnacePreserving);
        Box::new(move |o, _| base / PI * coat.transmitted(o).g)
    }),
];

fn curve(eta: f64, roughness: f64) -> AlbedoCurve<f64> {
    coat(eta, roughness).albedo_curve().expect("a dielectric is a coat")
}

/// A layer that is darker than the slab.
pub(crate) fn too_dark(eta: f64, roughness: f64, base: f64, layering: Layering) -> Through {
    kernel(eta, roughness, 0.3 * base, layering)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effort::Effort;

    const RUN: Run = Run { effort: Effort::Quick, seed: 7, level: 1e-4 };

    #[test]
    fn a_coat_loses_nothing_and_is_brighter_than_the_slab() {
        for layering in [Layering::Reciprocal, Layering::FurnacePreserving] {
            let finding = measure_energy(kernel, layering, &RUN);
            assert!(!finding.failed(), "{finding:?}");
        }
        let finding = measure_slab(kernel, &RUN);
        assert!(!finding.failed(), "{finding:?}");
    }

    #[test]
    fn both_modes_have_the_same_albedo_over_a_diffuse_base() {
        for cos in COSINES {
            let of = |layering| albedo(kernel, 1.5, 0.4, 0.7, layering, cos);
            assert!((of(Layering::Reciprocal) - of(Layering::FurnacePreserving)).abs() < 1e-5);
        }
    }
}
