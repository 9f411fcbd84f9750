//! Mitsuba's answers: the rough conductor and Fresnel's equations at single points, computed by another renderer.
//!
//! `tests/reference/roughconductor.json` was written by `roughconductor.py` beside it: Mitsuba 3.9.1, single precision.
//! Mitsuba masks and shadows with G₁(wo) G₁(wi), the kernel with the height-correlated G₂, so values are multiplied by
//! G₂/(G₁G₁) by the oracle's formula; densities compare as they are.
//!
//! **Limit.** Mitsuba computed in `f32`, the kernel here in `f64` on the same numbers. As for precision: 16 times the
//! greater of eps·f and the change of f when an input moves by one unit in the last place; twice what the kernel's own
//! `f32` may take, because Mitsuba normalises half vectors and so rounds the inputs of D again.

use crate::finding::{Finding, Run};
use crate::oracle::{ggx_g1, ggx_g2};
use crate::precision::sensitivity;
use crate::probe::{Dir, Probe, SurfaceProbe};
use crate::totality::Build;
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::{Surface, Vec3, fresnel};

const REFERENCE: &str = include_str!("../../../tests/reference/roughconductor.json");

/// The rough conductor, made of alpha_x, alpha_y, three η, three k.
pub(crate) fn measure(metal: Build<f64>, _run: &Run) -> Finding {
    let mut finding = Finding::at_most(1.0, "max |kernel − Mitsuba| in units of its rounding limit ≤");
    let eps = f64::from(f32::EPSILON);
    let (mut count, mut relative) = (0, 0.0_f64);
    for line in REFERENCE.lines().filter(|line| line.contains("\"alpha_x\"")) {
        let get = |name| numbers(line, name);
        let p = [get("alpha_x"), get("alpha_y"), get("eta"), get("k")].concat();
        let (wo, wi) = (vector(&get("wo")), vector(&get("wi")));
        let probe = SurfaceProbe::new(Surface::of(metal(&p)), None);
        let correlated = ggx_g2(p[0], p[1], wo, wi) / (ggx_g1(p[0], p[1], wo) * ggx_g1(p[0], p[1], wi));
        let right = [get("f_cos").iter().map(|f| f * correlated).collect(), get("pdf")].concat();
        let moves = sensitivity(&probe, &[], wo, wi);
        let mut numbers = probe.eval(wo, wi).numbers();
        numbers[3] *= unbounded(p[0], p[1], wo);
        for (i, (got, right)) in numbers.into_iter().zip(right).enumerate() {
            let limit = 16.0 * (eps * got).max(moves[i]);
            relative = relative.max((got - right).abs() / got);
            finding.raise((got - right).abs() / limit, || format!("configuration {count}: {got} instead of {right}"));
        }
        count += 1;
    }
    if count < 100 {
        finding.broken(|| format!("only {count} configurations were read"));
    }
    finding.note(format!("{count} configurations, largest relative difference {relative:.1e}"));
    finding
}

/// What turns the density within the bound of visible normals into that of all of them, which Mitsuba samples.
fn unbounded(alpha_x: f64, alpha_y: f64, wo: Dir) -> f64 {
    let ggx = Ggx { alpha_x, alpha_y };
    let s = ggx.smith_length(wo);
    (ggx.bound(wo) * wo.z + s) / (wo.z + s)
}

/// Fresnel's equations.
pub(crate) fn measure_fresnel(_run: &Run) -> Finding {
    // A reflectance is a quotient of sums of about ten f32 terms, each below 1: 16 roundings of half an eps, at most
    // amplified fourfold by the small eta² - k² - sin² of the conductors.
    let mut finding = Finding::at_most(32.0 * f64::from(f32::EPSILON), "max |kernel − Mitsuba| ≤");
    let mut count = 0;
    for line in REFERENCE.lines().filter(|line| line.contains("\"reflectance\"")) {
        let get = |name| numbers(line, name)[0];
        let cos = get("cos");
        let got = if line.contains("\"k\"") {
            fresnel::conductor(cos, get("eta"), get("k"))
        } else {
            fresnel::dielectric(cos.abs(), get("eta_it"))
        };
        let right = get("reflectance");
        finding.raise((got - right).abs(), || format!("{got} instead of {right} in {line}"));
        count += 1;
    }
    if count < 50 {
        finding.broken(|| format!("only {count} points were read"));
    }
    finding.note(format!("{count} points"));
    finding
}

/// The number or numbers of a field in one line of JSON; empty if there is none.
fn numbers(line: &str, name: &str) -> Vec<f64> {
    let Some((_, rest)) = line.split_once(&format!("\"{name}\": ")) else { return Vec::new() };
    let text = match rest.strip_prefix('[') {
        Some(list) => list.split(']').next(),
        None => rest.split([',', '}']).next(),
    };
    text.unwrap_or_default().split(',').filter_map(|x| x.trim().parse().ok()).collect()
}

fn vector(x: &[f64]) -> Dir {
    Vec3::new(x[0], x[1], x[2])
}
