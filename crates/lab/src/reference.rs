//! The kernel against the oracle: random parameters and directions, in `f64`, to five digits at the worst place and twelve elsewhere.

use crate::catalog::{RandomValues, Variant};
use crate::directions::{any_above, partner, show};
use crate::finding::{Finding, Run};
use crate::oracle;
use crate::probe::{BsdfValue, Dir, Kind, LobeProbe, Probe};
use crate::test_bsdf::TestBsdf;
use gonio_kernel::lobe::AnyLobe;
use gonio_kernel::units::{Flux, LUMINOUS_EFFICACY};
use gonio_kernel::{Alpha, Lobe, Rgb, Roughness, fresnel};

/// The oracle's normalised half vector loses eps/alpha, and its 1 − cos²θ eps over the smallest term. The worst is the
/// critical angle of a lossless index below 1, where Fresnel's curve is vertical: there eps becomes √eps, 1.5e-8, over the
/// index. Seen: 2e-7. A misread formula is wrong by per cents.
const LIMIT: f64 = 1e-5;

/// A lobe under test: it, wo, wi to f_cos and pdf.
pub(crate) type Model = fn(&AnyLobe<'static, f64>, Dir, Dir) -> BsdfValue;

/// The kernel's.
pub(crate) fn kernel(lobe: &AnyLobe<'static, f64>, wo: Dir, wi: Dir) -> BsdfValue {
    LobeProbe::<f64, _>::new(lobe).eval(wo, wi)
}

/// Whether there is a second opinion on a variant.
pub(crate) fn exists(variant: &Variant) -> bool {
    let w = Dir::new(0.6, 0.0, 0.8);
    oracle::value(&variant.lobe.double(), w, w).is_some()
}

/// One variant at random parameters.
pub(crate) fn measure(variant: &Variant, model: Model, run: &Run) -> Finding {
    let mut random = run.random();
    let mut random_values = RandomValues::new(&variant.lobe);
    let transmits = variant.lobe.properties().transmits;
    let mut finding = Finding::at_most(LIMIT, "max |kernel − oracle| / oracle ≤");
    for _ in 0..run.by_effort(20_000, 300_000, 3_000_000) {
        let values = random_values.draw(&mut random);
        let lobe = variant.lobe.at(&values).double();
        let mut wo = any_above(&mut random);
        let mut wi = partner(&mut random, wo);
        if transmits {
            // Any sides; and refraction is narrow, so that what was sampled is asked for as often as not.
            let side = |w: Dir, bits: u64| if bits.is_multiple_of(2) { Dir::new(w.x, w.y, -w.z) } else { w };
            (wo, wi) = (side(wo, random.bits()), side(wi, random.bits()));
            let draw = LobeProbe::<f64, _>::new(&lobe).sample(wo, random.sampler_input(false));
            if draw.kind == Kind::Continuous && random.bits().is_multiple_of(2) {
                wi = draw.wi;
            }
        }
        // The oracle needs room: tan θ of a grazing direction and 1 − cos² of it lose digits.
        if wo.z.abs() < 1e-4 || wi.z.abs() < 1e-4 {
            continue;
        }
        let Some(right) = oracle::value(&lobe, wo, wi) else {
            return Finding::not_run("the oracle does not know this model");
        };
        let got = model(&lobe, wo, wi);
        let density = right.pdf;
        for (got, right) in got.numbers().into_iter().zip(right.numbers()) {
            // Reflectances below 1e-6 count absolutely: (1 − cosθ)⁵ of the oracle has no digits near the normal.
            // And what is flushed on its way to the smallest numbers.
            let unit = right.max(1e-6 * density).max(1e-290);
            finding.raise((got - right).abs() / unit, || {
                format!("{got:.12e} instead of {right:.12e}, parameters {values:?}, wo {}, wi {}", show(wo), show(wi))
            });
        }
    }
    finding
}

/// Fresnel's equations at every angle, the roughness map, and the constants of photometry.
pub(crate) fn measure_conventions(run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::at_most(LIMIT, "max |kernel − textbook| ≤");
    for _ in 0..run.by_effort(20_000, 100_000, 1_000_000) {
        let cos = 1.0 - random.uniform();
        let (eta, k) = (random.log_between(0.05, 20.0), random.log_between(1e-3, 20.0));
        let (got, right) = (fresnel::conductor(cos, eta, k), oracle::conductor(cos, eta, k));
        finding.raise((got - right).abs(), || format!("conductor({cos}, {eta}, {k}) = {got}, not {right}"));
        let (got, right) = (fresnel::dielectric(cos, eta), oracle::dielectric(cos, eta));
        finding.raise((got - right).abs(), || format!("dielectric({cos}, {eta}) = {got}, not {right}"));
        let roughness = random.uniform();
        let alpha = Alpha::from(Roughness(roughness)).0;
        finding.raise((alpha - roughness * roughness).abs(), || format!("roughness {roughness} became alpha {alpha}"));
    }
    // CIE 1931 for Rec. 709 primaries and D65: the second row of the matrix of IEC 61966-2-1; 683 lm/W defines the candela.
    let luminance = Rgb::new(1.0, 0.1, 0.01).luminance();
    finding.raise((luminance - (0.2126 + 0.07152 + 0.000_722_f64)).abs(), || format!("luminance {luminance}"));
    finding.raise((Flux(2.0_f64).photometric().0 - 1366.0).abs(), || format!("luminous efficacy {LUMINOUS_EFFICACY}"));
    finding
}
