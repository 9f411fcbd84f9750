use super::*;
use crate::testing::close;

#[test]
fn at_normal_incidence_glass_reflects_the_square_of_n_minus_1_over_n_plus_1() {
    assert!(close(dielectric(1.0, 1.5), 0.04, 1e-15));
    assert!(close(dielectric(1.0, 1.0 / 1.5), 0.04, 1e-15));
    assert_eq!(dielectric(0.7, 1.0), 0.0); // no interface, no reflection
}

#[test]
fn at_brewsters_angle_only_perpendicular_light_is_reflected() {
    let n = 1.5_f64; // tan θ = n, where r∥ = 0 and r⊥ = (1 − n²)/(1 + n²)
    let cos = 1.0 / (1.0 + n * n).sqrt();
    let perpendicular = ((1.0 - n * n) / (1.0 + n * n)).powi(2);
    assert!(close(dielectric(cos, n), 0.5 * perpendicular, 1e-15));
}

#[test]
fn beyond_the_critical_angle_everything_is_reflected() {
    let critical = (1.0 - 1.0 / (1.5_f64 * 1.5)).sqrt(); // sin θ = 1/1.5
    assert_eq!(dielectric(critical - 1e-6, 1.0 / 1.5), 1.0);
    assert_eq!(dielectric(0.0, 1.0 / 1.5), 1.0);
    let inside = dielectric(critical + 1e-6, 1.0 / 1.5);
    assert!(inside < 1.0 && inside > 0.95, "{inside}");
}

#[test]
fn a_conductor_without_extinction_is_a_dielectric() {
    for eta in [0.5_f64, 0.9, 1.1, 1.5, 4.0] {
        for step in 0..=100 {
            let cos = f64::from(step) / 100.0;
            let (c, d) = (conductor(cos, eta, 0.0), dielectric(cos, eta));
            assert!(close(c, d, 1e-7), "eta {eta}, cos {cos}: {c} and {d}");
        }
    }
}

#[test]
fn at_normal_incidence_silver_reflects_its_textbook_value() {
    let (eta, k) = (0.135_f64, 3.99);
    let textbook = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
    assert!(close(conductor(1.0, eta, k), textbook, 1e-14));
    assert!(close(conductor(1.0_f32, 0.135, 3.99).into(), textbook, 1e-6));
}

#[test]
fn at_grazing_incidence_every_interface_is_a_mirror() {
    assert!(close(dielectric(0.0, 1.5), 1.0, 1e-15));
    assert!(close(conductor(0.0, 0.2, 3.9), 1.0, 1e-15));
    assert_eq!(schlick(0.0, 0.04), 1.0);
    assert_eq!(schlick(1.0, 0.04), 0.04);
}

/// Reflection from a conductor, in the complex form of the textbook.
fn complex_conductor(cos: f64, eta: f64, k: f64) -> f64 {
    // u + iv = √((η + ik)² − sin²θ)
    let (re, im) = (eta * eta - k * k - (1.0 - cos * cos), 2.0 * eta * k);
    let (u, v) = {
        let u = ((re.hypot(im) + re.abs()) / 2.0).sqrt();
        if re >= 0.0 { (u, im / (2.0 * u)) } else { (im / (2.0 * u), u) }
    };
    let perpendicular = ((u - cos).powi(2) + v * v) / ((u + cos).powi(2) + v * v);
    // r∥ = r⊥ · (u + iv − sin θ tan θ)/(u + iv + sin θ tan θ)
    let st = (1.0 - cos * cos) / cos;
    let parallel = perpendicular * ((u - st).powi(2) + v * v) / ((u + st).powi(2) + v * v);
    0.5 * (perpendicular + parallel)
}

#[test]
fn the_real_form_of_a_conductor_is_its_complex_form() {
    for (eta, k) in [(0.22, 3.68), (0.96, 2.59), (1.17, 2.46), (3.1, 0.01), (0.05, 0.3), (4.0, 20.0)] {
        for step in 1..=50 {
            let cos = step as f32 / 50.0;
            let exact = complex_conductor(cos.into(), eta, k);
            assert!(close(conductor(f64::from(cos), eta, k), exact, 1e-12), "eta {eta}, k {k}, cos {cos}");
            let (eta32, k32) = (eta as f32, k as f32);
            let exact = complex_conductor(cos.into(), eta32.into(), k32.into());
            assert!(close(conductor(cos, eta32, k32).into(), exact, 2e-6), "eta {eta}, k {k}, cos {cos} in f32");
        }
    }
}

#[test]
fn three_channels_at_once_are_three_channels_one_by_one() {
    let (eta, k) = (Rgb::new(0.2_f32, 1e-4, 100.0), Rgb::new(3.9, 0.0, 100.0));
    for cos in [0.0_f32, 1e-30, 1e-8, 1e-4, 0.1, 0.5, 0.999, 1.0] {
        let (all, each) = (conductor_rgb(cos, cos * cos, eta, k), |eta, k| f64::from(conductor(cos, eta, k)));
        let one_by_one = [each(eta.r, k.r), each(eta.g, k.g), each(eta.b, k.b)];
        for (a, b) in [all.r, all.g, all.b].into_iter().zip(one_by_one) {
            assert!(close(a.into(), b, 1e-6), "cos {cos}: {all:?} and {one_by_one:?}");
        }
    }
}

#[test]
fn an_index_near_vacuum_reflects_the_little_that_it_does() {
    // R = ((η − 1)² + k²)/((η + 1)² + k²) straight on, in f64 of the same f32 numbers.
    for (eta, k) in [(1.001_f32, 0.0_f32), (1.0, 1e-3), (0.9999, 1e-4), (1.01, 0.001)] {
        let (n, x) = (f64::from(eta), f64::from(k));
        let right = ((n - 1.0).powi(2) + x * x) / ((n + 1.0).powi(2) + x * x);
        let got = f64::from(conductor(1.0_f32, eta, k));
        // One ulp of η moves it by 2·1.2e-7/(η − 1).
        let ulp = 2.0 * 1.2e-7 / ((n - 1.0).abs() + x);
        assert!((got / right - 1.0).abs() < 8.0 * ulp + 1e-6, "eta {eta}, k {k}: {got} instead of {right}");
    }
}

#[test]
fn what_is_not_reflected_is_transmitted_at_every_angle() {
    for eta in [0.5_f64, 0.99, 1.0, 1.33, 2.4] {
        for step in 0..=1000 {
            let cos = f64::from(step) / 1000.0;
            let i = interface(cos, refracted_cosine(cos, eta), eta);
            assert!(close(i.reflected + i.transmitted, 1.0, 1e-14), "eta {eta}, step {step}: {i:?}");
        }
    }
    // At grazing, where 1 − R has no digit left in f32: T = 4c(η + 1/η)/√(1 − 1/η²)/2 to first order.
    let (c, eta) = (1e-9_f32, 1.5_f64);
    let cos_t = (1.0 - 1.0 / (eta * eta)).sqrt();
    let first = 2.0 * f64::from(c) * (eta * cos_t / (eta * cos_t).powi(2) + eta / cos_t);
    assert!(close(f64::from(interface(c, refracted_cosine(c, 1.5), 1.5_f32).transmitted) / first, 1.0, 1e-6));
}

#[test]
fn f82_passes_through_its_tint_at_82_degrees_and_is_schlick_without() {
    let (f0, tint) = (0.7_f64, 0.4);
    assert!(close(f82(1.0 / 7.0, f0, tint), tint * schlick(1.0 / 7.0, f0), 1e-15));
    for step in 0..=100 {
        let cos = f64::from(step) / 100.0;
        assert!(close(f82(cos, f0, 1.0), schlick(cos, f0), 1e-15));
        assert!((0.0..=1.0).contains(&f82(cos, 0.04, 0.0)));
    }
}
