//! The random walk on Smith's surface: what a rough metal does with light, all orders of scattering included.
//!
//! Heitz, Hanika, d'Eon & Dachsbacher 2016, "Multiple-Scattering Microfacet BSDFs with the Smith Model": a ray moves through a
//! layer of facets of uniformly distributed heights as through a medium, is mirrored by visible normals, and leaves. An
//! estimator without a density: it says where light goes, not with which probability. It is the truth for
//! `gonio_kernel::energy`, which only knows how much is missing.
//!
//! **Three comparisons.** Order 1 must carry E (within the fit's 6e-5); a white surface must return all light but for the walks
//! that are cut; and Kulla & Conty's albedo of coloured surfaces must be the walk's to 2 % of the total. All are tests of means.

use crate::finding::{Finding, Run};
use crate::probe::Dir;
use crate::random::{Random, direction};
use crate::statistics::mean_p;
use gonio_kernel::Rgb;
use gonio_kernel::energy::{Missing, missing_avg, multiple_fresnel, scattered_again};
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::microfacet::{Ggx, Reach};

/// Where a walk ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walk {
    /// The direction in which light came in, above the surface.
    #[cfg_attr(not(test), allow(dead_code))] // albedos need none
    pub(crate) wi: Dir,
    /// Product of the reflectances met.
    pub(crate) weight: [f64; 3],
    /// How many facets.
    pub(crate) order: usize,
}

/// One walk from wo, above the surface; none if it was longer than `longest`. `fresnel` gets the cosine at the facet.
pub(crate) fn walk(
    ggx: &Ggx<f64>,
    fresnel: &dyn Fn(f64) -> [f64; 3],
    wo: Dir,
    longest: usize,
    random: &mut Random,
) -> Option<Walk> {
    // The ray comes in against wo. Heights are uniform in [−1, 1]; what counts is how much of the surface lies below.
    let (mut ray, mut below) = (-wo, 1.0);
    let mut weight = [1.0; 3];
    for order in 0..=longest {
        let u = 1.0 - random.uniform();
        // Freely passed with probability below^Λ upwards; downwards Λ < 0, and every ray meets a facet.
        let lambda = lambda(ggx, ray);
        let escape = if ray.z > 0.0 { f64::powf(below, lambda) } else { 0.0 };
        if u <= escape {
            return Some(Walk { wi: ray, weight, order });
        }
        below = (below / u.powf(1.0 / lambda)).clamp(0.0, 1.0);
        // Visible from below the surface as well: the spherical cap does not mind.
        let s = ggx.smith_length(ray);
        let m = ggx.sample_visible(-ray, s, Reach::whole(-ray, s), [random.uniform(), random.uniform()]);
        let m = m.normalize_or(Dir::unit_z());
        let cos = -ray.dot(m);
        ray = (ray + m * (2.0 * cos)).normalize();
        for (weight, f) in weight.iter_mut().zip(fresnel(cos.clamp(0.0, 1.0))) {
            *weight *= f;
        }
    }
    None
}

/// Smith's Λ = (s/cosθ − 1)/2 for either side; −1 straight down, 0 straight up.
fn lambda(ggx: &Ggx<f64>, w: Dir) -> f64 {
    let z = if w.z.abs() < 1e-12 { 1e-12_f64.copysign(w.z) } else { w.z };
    0.5 * (ggx.smith_length(w) / z - 1.0)
}

/// Walks longer than this are cut, counted, and lost.
const LONGEST: usize = 200;
/// The first four serve every effort, the others the full one.
const WIDTHS: [f64; 8] = [0.1, 0.3, 0.6, 1.0, 0.03, 0.2, 0.45, 0.8];
/// Likewise.
const COSINES: [f64; 6] = [0.98, 0.7, 0.35, 0.1, 0.2, 0.05];
/// What reflects. Five are metals with their indices at red, green and blue: near gold, silver, copper, aluminium and chromium. The
/// next is a different metal in each channel, none of which the constants of [`gonio_kernel::energy`] were fitted to.
const REFLECTORS: [(&str, Fresnel<f64>); 8] = [
    ("gold", metal([0.143, 0.375, 1.442], [3.983, 2.386, 1.603])),
    ("silver", metal([0.155, 0.117, 0.138], [4.828, 3.122, 2.147])),
    ("copper", metal([0.200, 0.924, 1.102], [3.912, 2.452, 2.142])),
    ("aluminium", metal([1.657, 0.880, 0.521], [9.224, 6.270, 4.837])),
    ("chromium", metal([3.11, 3.18, 2.17], [3.31, 3.33, 3.24])),
    ("lead, vanadium, lithium", metal([2.0, 3.5, 0.2], [3.5, 3.1, 2.8])),
    ("schlick", Fresnel::Schlick { f0: Rgb { r: 0.9, g: 0.5, b: 0.2 } }),
    ("f82", Fresnel::F82 { f0: Rgb { r: 0.9, g: 0.6, b: 0.5 }, tint: Rgb { r: 0.8, g: 0.7, b: 0.9 } }),
];
/// By how much of the total Kulla & Conty's albedo may differ.
const AGREEMENT: f64 = 0.02;

const fn metal(eta: [f64; 3], k: [f64; 3]) -> Fresnel<f64> {
    Fresnel::Conductor { eta: Rgb { r: eta[0], g: eta[1], b: eta[2] }, k: Rgb { r: k[0], g: k[1], b: k[2] } }
}

/// What is under test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Model {
    /// 1 − E(cos, alpha).
    pub(crate) missing: fn(f64, f64) -> f64,
    /// 1 − E_avg(alpha).
    pub(crate) missing_avg: fn(f64) -> f64,
    /// The mean reflectance of the facets that are met, of what, at α and the cosines of wo and wi.
    pub(crate) facets: fn(&Fresnel<f64>, f64, [f64; 2]) -> Rgb<f64>,
    /// F_ms of that reflectance, α, 1 − E at wo and wi, and 1 − E_avg.
    pub(crate) multiple: fn(f64, f64, [f64; 2], f64) -> f64,
}

/// The kernel's.
pub(crate) const KERNEL: Model = Model {
    missing: |cos, alpha| Missing::of(alpha).at(cos),
    missing_avg,
    facets: |fresnel, alpha, [o, i]| fresnel.of_facets(alpha, o, i),
    multiple: |f, alpha, [o, i], mean| multiple_fresnel(f, scattered_again(alpha, o, i, mean)),
};

/// How many p-values [`measure`] judges at most.
pub(crate) const TESTS: usize = WIDTHS.len() * COSINES.len() * (2 + 3 * REFLECTORS.len()) + WIDTHS.len();

/// The smallest p-value.
pub(crate) fn measure(model: Model, run: &Run) -> Finding {
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let n = run.by_effort(20_000, 100_000, 1_000_000);
    let (mut cut, mut worst) = (0, (0.0_f64, String::new()));
    let (widths, cosines) = (run.by_effort(4, 4, WIDTHS.len()), run.by_effort(4, 4, COSINES.len()));
    for &alpha in &WIDTHS[..widths] {
        let mean = (model.missing_avg)(alpha);
        let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
        finding.lower(of_the_mean(alpha, mean, n, &mut random), || format!("α {alpha}: E_avg {}", 1.0 - mean));
        for &cos in &COSINES[..cosines] {
            let wo = direction(cos, 0.3);
            let missing = (model.missing)(cos, alpha);
            let (mut single, mut ended) = (0, 0);
            for _ in 0..n {
                if let Some(walk) = walk(&ggx, &|_| [1.0; 3], wo, LONGEST, &mut random) {
                    ended += 1;
                    single += usize::from(walk.order == 1);
                }
            }
            cut += n - ended;
            let at = || format!("α {alpha}, cos {cos}");
            let (count, e) = (n as f64, 1.0 - missing);
            let p = mean_p((single as f64 / count - e).abs() - 6e-5, (e * missing / count).sqrt());
            finding.lower(p, || format!("{}: order 1 carries {}, E is {e}", at(), single as f64 / count));
            // Nothing is absorbed: only cut walks are missing, and 1 in 1000 may be.
            let p = if n - ended > n / 1000 { 0.0 } else { 1.0 };
            finding.lower(p, || format!("{}: {} of {n} walks were cut", at(), n - ended));
            for (name, fresnel) in REFLECTORS {
                let reflectance = |cos| fresnel.reflectance(cos).into();
                // What Kulla & Conty replace: the weight beyond the first facet. The rest is common to both.
                let (mut all, mut more, mut square) = ([0.0; 3], [0.0; 3], [0.0; 3]);
                for _ in 0..n {
                    let Some(walk) = walk(&ggx, &reflectance, wo, LONGEST, &mut random) else { continue };
                    for c in 0..3 {
                        let beyond = if walk.order > 1 { walk.weight[c] } else { 0.0 };
                        all[c] += walk.weight[c];
                        more[c] += beyond;
                        square[c] += beyond * beyond;
                    }
                }
                let added: [f64; 3] = added(model, alpha, cos, mean, &fresnel).into();
                for c in 0..3 {
                    let (all, more, square) = (all[c] / count, more[c] / count, square[c] / count);
                    let difference = (added[c] - more) / all;
                    let error = ((square - more * more) / count).sqrt() / all;
                    let text = || format!("{}, {name}, channel {c}: {:+.2} % of {all:.3}", at(), 100.0 * difference);
                    if difference.abs() > worst.0 {
                        worst = (difference.abs(), text());
                    }
                    finding.lower(mean_p(difference.abs() - AGREEMENT, error), text);
                }
            }
        }
    }
    finding.note(format!("{n} walks each, {cut} longer than {LONGEST}; farthest from the walk: {}", worst.1));
    finding
}

/// The albedo of f_ms: ∫ (1 − E(wo))(1 − E(wi))/(π(1 − E_avg)) F_ms cosθ dω, by midpoints in √μ.
fn added(model: Model, alpha: f64, cos: f64, mean: f64, fresnel: &Fresnel<f64>) -> Rgb<f64> {
    let missing = (model.missing)(cos, alpha);
    let (mut sum, mut whole) = (Rgb::splat(0.0), 0.0);
    for i in 0..64 {
        let t = (f64::from(i) + 0.5) / 64.0;
        let lost = (model.missing)(t * t, alpha);
        let weight = lost * t * t * t;
        let facets = (model.facets)(fresnel, alpha, [cos, t * t]);
        sum += facets.map(|f| weight * (model.multiple)(f, alpha, [missing, lost], mean));
        whole += weight;
    }
    sum * (missing / whole)
}

/// E_avg against the share of order 1 under uniform light.
fn of_the_mean(alpha: f64, missing_avg: f64, n: usize, random: &mut Random) -> f64 {
    let ggx = Ggx { alpha_x: alpha, alpha_y: alpha };
    let count = 10 * n;
    let mut single = 0;
    for _ in 0..count {
        // Cosine-distributed.
        let wo = direction((1.0 - random.uniform()).sqrt(), 0.0);
        single += usize::from(walk(&ggx, &|_| [1.0; 3], wo, 1, random).is_some());
    }
    let (share, error) = (single as f64 / count as f64, (missing_avg * (1.0 - missing_avg) / count as f64).sqrt());
    mean_p((share + missing_avg - 1.0).abs() - 6e-5, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Vec3;

    #[test]
    fn a_brushed_white_surface_loses_only_the_walks_that_are_cut_and_leaves_upwards() {
        let (ggx, mut random) = (Ggx { alpha_x: 0.9, alpha_y: 0.1 }, Random::new(5));
        let mut cut = 0;
        for i in 0..20_000 {
            let wo = random.above();
            match walk(&ggx, &|_| [1.0; 3], wo, LONGEST, &mut random) {
                Some(walk) => assert!(walk.wi.z > 0.0 && walk.weight == [1.0; 3] && walk.order >= 1, "{i}: {walk:?}"),
                None => cut += 1,
            }
        }
        assert!(cut < 20, "{cut}");
    }

    #[test]
    fn a_smooth_metal_is_a_mirror() {
        let (ggx, mut random) = (Ggx { alpha_x: 1e-6, alpha_y: 1e-6 }, Random::new(6));
        let wo = direction(0.6, 1.0);
        let walk = walk(&ggx, &|cos| [cos, 0.5, 1.0], wo, LONGEST, &mut random).unwrap();
        assert!(walk.order == 1 && (walk.wi - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-3);
        assert!((walk.weight[0] - 0.6).abs() < 1e-3 && walk.weight[1] == 0.5);
    }
}
