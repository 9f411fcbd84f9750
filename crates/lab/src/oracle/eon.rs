//! EON by the paper: Portsmouth, Kutz & Hill 2025, listings 1 to 3.

use crate::probe::{BsdfValue, Dir};
use gonio_kernel::lobe::{Eon, EonAlbedo};
use std::f64::consts::PI;

/// Its value and density; none for a directional albedo that this file does not know.
pub(super) fn value(l: &Eon<f64>, wo: Dir, wi: Dir) -> Option<BsdfValue> {
    match l.directional {
        EonAlbedo::Analytic => Some(eon(l, wo, wi, |mu| {
            let s = (1.0 - mu * mu).max(0.0).sqrt();
            (s * (mu.acos() - s * mu) + 2.0 / 3.0 * ((s / mu) * (1.0 - s * s * s) - s)) / PI
        })),
        EonAlbedo::Fitted => Some(eon(l, wo, wi, |mu| {
            let m = 1.0 - mu;
            0.0571085289 * m + 0.491881867 * m.powi(2) - 0.332181442 * m.powi(3) + 0.0714429953 * m.powi(4)
        })),
        _ => None,
    }
}

/// With r^⅛ instead of r^0.1; g is G/π.
fn eon(l: &Eon<f64>, wo: Dir, wi: Dir, g: impl Fn(f64) -> f64) -> BsdfValue {
    let r = l.roughness;
    let (c1, c2) = (0.5 - 2.0 / (3.0 * PI), 2.0 / 3.0 - 28.0 / (15.0 * PI));
    let a = 1.0 / (1.0 + c1 * r);
    let s = wo.dot(wi) - wo.z * wi.z;
    let s_over_t = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
    // The fitted albedo exceeds 1 at grazing, where the paper clamps as well.
    let lost = |mu: f64| (1.0 - a * (1.0 + r * g(mu))).max(0.0);
    let mean = a * (1.0 + c2 * r);
    let f_cos = <[f64; 3]>::from(l.albedo).map(|rho| {
        let multiple = rho * rho * mean / (1.0 - rho * (1.0 - mean));
        let compensation = if r > 0.0 { multiple / PI * lost(wo.z) * lost(wi.z) / (1.0 - mean) } else { 0.0 };
        (rho / PI * a * (1.0 + r * s_over_t) + compensation) * wi.z
    });
    let mu = wo.z;
    let share = r.powf(0.125) * (0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu));
    BsdfValue { f_cos, pdf: share / (2.0 * PI) + (1.0 - share) * cltc(wo, wi, r) }
}

/// Density of the clipped linearly transformed cosine: cosine over the kept part of the hemisphere, times the Jacobian
/// |M⁻¹| / |M⁻¹ω|³ of ω ∝ Mw.
fn cltc(wo: Dir, wi: Dir, r: f64) -> f64 {
    let mu = wo.z;
    let a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    let b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    let c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    let d = r * (0.540852 + (-1.01625 + 0.475392 * mu) * mu) / (-1.0743 + mu * (0.0725628 + mu));
    // wi in the frame whose x is wo's azimuth; any frame will do at the normal.
    let azimuth = if wo.x == 0.0 && wo.y == 0.0 { 0.0 } else { wo.y.atan2(wo.x) };
    let (x, y) = (wi.x * azimuth.cos() + wi.y * azimuth.sin(), wi.y * azimuth.cos() - wi.x * azimuth.sin());
    // M = [[a, 0, b], [0, c, 0], [d, 0, 1]]: y decouples, x and z by Cramer's rule.
    let det_xz = a - b * d;
    let w = [(x - b * wi.z) / det_xz, y / c, (a * wi.z - d * x) / det_xz];
    let length = (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]).sqrt();
    let kept = 0.5 * (1.0 + 1.0 / (1.0 + d * d).sqrt());
    (w[2] / length).max(0.0) / (PI * kept) / (c * det_xz) / (length * length * length)
}
