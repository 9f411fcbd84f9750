use super::*;
use crate::math::{erf, sin_cos_turns};
use crate::testing::{Random, close};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use std::vec::Vec;

/// ∫ f(m) over the upper hemisphere, by midpoints.
fn over_hemisphere(f: impl Fn(Vec3<f64>) -> f64) -> f64 {
    let (rows, columns) = (1000, 400);
    let mut sum = 0.0;
    for row in 0..rows {
        let (sin, cos) = ((f64::from(row) + 0.5) / f64::from(rows) * FRAC_PI_2).sin_cos();
        for column in 0..columns {
            let (sin_phi, cos_phi) = ((f64::from(column) + 0.5) / f64::from(columns) * TAU).sin_cos();
            sum += f(Vec3::new(sin * cos_phi, sin * sin_phi, cos)) * sin;
        }
    }
    sum * FRAC_PI_2 / f64::from(rows) * TAU / f64::from(columns)
}

const WIDTHS: [(f64, f64); 3] = [(1.0, 1.0), (0.5, 0.2), (0.3, 0.9)];

fn view(cos: f64, phi: f64) -> Vec3<f64> {
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

#[test]
fn along_the_normal_d_is_one_over_pi_alpha_x_alpha_y() {
    for (alpha_x, alpha_y) in [(1.0_f64, 1.0), (0.5, 0.1), (1e-8, 1e-8)] {
        let d = Beckmann { alpha_x, alpha_y }.d(Vec3::unit_z() * 1.7, 1.7 * 1.7);
        assert!(close(d * PI * alpha_x * alpha_y, 1.0, 1e-14));
    }
}

#[test]
fn the_facets_together_project_onto_the_whole_surface() {
    for (alpha_x, alpha_y) in WIDTHS {
        let beckmann = Beckmann { alpha_x, alpha_y };
        let integral = over_hemisphere(|m| beckmann.d(m, 1.0) * m.z);
        assert!(close(integral, 1.0, 1e-5), "{alpha_x}, {alpha_y}: {integral}");
    }
}

#[test]
fn the_visible_facets_together_fill_the_view() {
    // ∫ D max(0, wo·m) dω = cos_o/G₁ = (cos_o + s)/2.
    for (alpha_x, alpha_y) in WIDTHS {
        let beckmann = Beckmann { alpha_x, alpha_y };
        for (cos, phi) in [(1.0, 0.0), (0.7, 0.4), (0.2, 2.0), (0.01, 4.0), (1e-30, 5.0)] {
            let wo = view(cos, phi);
            let integral = over_hemisphere(|m| beckmann.d(m, 1.0) * m.dot(wo).max(0.0));
            let whole = 0.5 * (wo.z + beckmann.smith_length(wo));
            assert!(close(integral, whole, 2e-5 * whole), "{alpha_x}, {alpha_y}, {cos}: {integral} and {whole}");
        }
    }
}

/// ∫ (a − x) exp(−x²) up to x over that up to a, in `f64`, from erf.
fn share(a: f64, x: f64) -> f64 {
    let (c, s) = (a / (1.0 + a), 1.0 / (1.0 + a));
    let g = |x: f64| c * 0.5 * PI.sqrt() * (1.0 + erf(x)) + 0.5 * s * (-x * x).exp();
    g(x) / g(a)
}

#[test]
fn at_grazing_slopes_are_rayleighs_and_along_the_normal_they_are_gaussian() {
    for i in 0..1000 {
        let u = [f64::from(i) / 1000.0, f64::from(i * 7 % 1000) / 1000.0];
        let (along, across) = visible_slopes(0.0, u);
        assert!(close(along, -(-(1.0 - u[0]).ln()).sqrt(), 1e-14), "{u:?}: {along}");
        assert!(close(erf(across), 2.0 * u[1] - 1.0, 1e-14), "{u:?}: {across}");
        let (along, across) = visible_slopes(1e18, u);
        assert!(close(erf(along.abs()), u[0], 1e-14) && (along > 0.0) == (u[1] >= 0.5 && u[0] > 0.0), "{u:?}: {along}");
        assert!(close(erf(across), (4.0 * u[1]) % 2.0 - 1.0, 1e-14), "{u:?}: {across}");
    }
}

#[test]
fn slopes_are_finite_and_visible_in_every_corner() {
    let numbers = [0.0_f32, 1e-30, 1e-7, 0.25, 0.5, 0.75, 1.0 - 1e-6, 1.0 - f32::EPSILON / 2.0];
    for cot in [0.0, 1e-45, 1e-38, 1e-20, 1e-3, 0.5, 1.0, 3.0, 5.0, 9.0, 1e9, 1e18] {
        for u in numbers.into_iter().flat_map(|a| numbers.map(|b| [a, b])) {
            let (along, across) = visible_slopes(cot, u);
            assert!(along.is_finite() && across.is_finite() && along <= cot, "{cot}, {u:?}: {along}, {across}");
        }
    }
}

#[test]
fn the_density_of_a_visible_normal_is_the_inverse_of_the_stretching() {
    // D_visible = D wo·m/((cos_o + s)/2) times |∂m/∂u₀ × ∂m/∂u₁| is 1, by five-point differences. Where |x| > a, two parts
    // share the density as a to |x|.
    let mut random = Random(31);
    let mut skipped = 0;
    for i in 0..4000 {
        let mut unit = || f64::from(random.unit());
        let alpha = [(1.0, 1.0), (0.3, 0.7), (1e-8, 1e-8), (0.01, 0.9)][i % 4];
        let beckmann = Beckmann { alpha_x: alpha.0, alpha_y: alpha.1 };
        let cos = if i % 3 == 0 { 1e-6_f64.powf(unit()) } else { unit() };
        let wo = view(cos, TAU * unit());
        let u = [0.02 + 0.96 * unit(), 0.02 + 0.96 * unit()];
        // Where the map jumps from one part of the density to another, or is about to, differences say nothing.
        let mut jumps = false;
        let mut along = |axis: usize| {
            let at = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|steps| {
                let mut moved = u;
                moved[axis] += 1e-4 * steps;
                beckmann.sample_visible(wo, moved).normalize()
            });
            let steps = [0, 1, 2, 3].map(|i| (at[i + 1] - at[i]).length());
            let (least, most) = steps.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &s| (a.min(s), b.max(s)));
            jumps |= most > 1.05 * least;
            ((at[3] - at[1]) * (8.0 / 12.0) - (at[4] - at[0]) * (1.0 / 12.0)) * 1e4
        };
        let stretching = along(0).cross(along(1)).length();
        skipped += u32::from(jumps);
        if jumps {
            continue;
        }
        let m = beckmann.sample_visible(wo, u).normalize();
        let d = beckmann.d(m, 1.0) * wo.dot(m) * 2.0 / (wo.z + beckmann.smith_length(wo));
        let cot = beckmann.tilt(wo).cot;
        let (size, erf) = (visible_slopes(cot, u).0.abs(), erf(cot));
        let gaussian = 0.5 * PI.sqrt() * cot * (1.0 + erf);
        let is_gaussian = u[0] * (gaussian + 0.5 * (-cot * cot).exp()) < gaussian;
        let part = if size < cot { 1.0 } else { (if is_gaussian { cot } else { size }) / (cot + size) };
        let error = (part * d * stretching - 1.0).abs();
        assert!(error < 1e-5, "{error:e}: {beckmann:?}, {wo:?}, {u:?}");
    }
    assert!(skipped < 100, "{skipped} of 4000");
}

#[test]
fn the_slopes_of_visible_normals_follow_their_law() {
    // Kolmogorov–Smirnov against G(x)/G(a), x along the view, and against a Gaussian across it: eight tests at 1e-4
    // each, which √n·D exceeds 2.2253 with that probability.
    let mut random = Random(32);
    let count = 100_000;
    for cos in [1.0, 0.6, 0.05, 1e-38] {
        let beckmann = Beckmann { alpha_x: 0.5_f32, alpha_y: 0.5 };
        let wo = Vec3::new((1.0 - cos * cos).sqrt() as f32, 0.0, cos as f32);
        let a = if cos < 1.0 { f64::from(wo.z) / (0.5 * f64::from(wo.x)) } else { 1e9 };
        let law = |x: f64| if cos < 1.0 { share(a, x) } else { 0.5 * (1.0 + erf(x)) };
        let (mut along, mut across) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let m = beckmann.sample_visible(wo, [random.unit(), random.unit()]);
            along.push(law(f64::from(-m.x / m.z) / 0.5));
            across.push(0.5 * (1.0 + erf(f64::from(-m.y / m.z) / 0.5)));
        }
        for mut values in [along, across] {
            values.sort_by(f64::total_cmp);
            let n = f64::from(count);
            let distance = values
                .iter()
                .enumerate()
                .fold(0.0, |most: f64, (i, &v)| most.max((v - i as f64 / n).abs()).max((v - (i + 1) as f64 / n).abs()));
            assert!(distance * n.sqrt() < 2.2253, "cos {cos}: {}", distance * n.sqrt());
        }
    }
}

#[test]
fn a_visible_normal_faces_the_viewer_in_every_corner() {
    let mut random = Random(33);
    let last = 1.0 - f32::EPSILON / 2.0;
    for alpha_x in [1e-8_f32, 1e-4, 0.1, 1.0] {
        for alpha_y in [1e-8_f32, 0.3, 1.0] {
            let beckmann = Beckmann { alpha_x, alpha_y };
            for i in 0..2000 {
                let mut wo = random.above();
                if i % 2 == 0 {
                    let cos = [1.0, 1e-3, 1e-7, 1e-18, 1e-30, 1e-38, 1.0 - 1e-7][i / 2 % 7];
                    let (s, c) = sin_cos_turns(random.unit());
                    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
                    wo = Vec3::new(sin * c, sin * s, cos);
                }
                let mut number = || match random.bits() % 8 {
                    0 => 0.0,
                    1 => last,
                    2 => 0.5,
                    _ => random.unit(),
                };
                let m = beckmann.sample_visible(wo, [number(), number()]).normalize();
                assert!(close(m.length().into(), 1.0, 1e-6) && m.z > 0.0, "{wo:?} {m:?}");
                assert!(m.dot(wo) >= -1e-6, "{wo:?} {m:?}");
                let (d, s) = (beckmann.d(m, 1.0), beckmann.smith_length(wo));
                assert!(d.is_finite() && d >= 0.0 && s.is_finite() && s >= wo.z * (1.0 - 1e-6) && s > 0.0, "{d} {s}");
            }
            for x in [1e-38_f32, 1e-20, 1e-8, 1e-3, 1.0] {
                for z in [1e-45_f32, 1e-38, 1e-30, 1e-16, 1e-6, 1.0] {
                    let h = Vec3::new(x, -0.5 * x, z);
                    let d = beckmann.d(h, h.length2());
                    assert!(d.is_finite() && d >= 0.0 && !d.is_subnormal(), "{h:?}: {d}");
                }
            }
        }
    }
}

#[test]
fn single_precision_is_as_good_as_its_input() {
    let mut random = Random(34);
    for _ in 0..100_000 {
        let alpha = 1e-8_f32.powf(random.unit());
        let single = Beckmann { alpha_x: alpha, alpha_y: 0.5 * alpha + 0.5e-8 };
        let double = Beckmann { alpha_x: f64::from(single.alpha_x), alpha_y: f64::from(single.alpha_y) };
        let m = single.sample_visible(random.above(), [random.unit(), random.unit()]).normalize();
        let wide = Vec3::new(f64::from(m.x), f64::from(m.y), f64::from(m.z));
        let (d, exact) = (f64::from(single.d(m, m.length2())), double.d(wide, wide.length2()));
        // D falls like exp(−e): an ulp of alpha changes it by 2e of themselves.
        let e = (wide.x / double.alpha_x).powi(2) + (wide.y / double.alpha_y).powi(2);
        let unit = f64::from(f32::EPSILON) * exact * (1.0 + 2.0 * e / wide.z / wide.z);
        assert!((d - exact).abs() <= 8.0 * unit, "{m:?}, {alpha}: {d:e} instead of {exact:e}");
        let (s, exact) = (f64::from(single.smith_length(m)), double.smith_length(wide));
        assert!((s - exact).abs() <= 8.0 * f64::from(f32::EPSILON) * exact, "{m:?}, {alpha}: {s} and {exact}");
    }
}
