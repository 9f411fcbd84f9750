use super::*;
use crate::testing::{Random, close, special_values};

/// 2∫E µ dµ of what the curve returns, by Gauss's two points in 4000 intervals of √µ.
fn avg(curve: &AlbedoCurve<f64>) -> Rgb<f64> {
    let (count, mut sum) = (4000, Rgb::zero());
    for i in 0..count {
        for offset in [0.211_324_865_405_187, 0.788_675_134_594_813] {
            let root = (f64::from(i) + offset) / f64::from(count);
            sum += curve.at(root * root) * (2.0 * root * root * root / f64::from(count));
        }
    }
    sum
}

#[test]
fn the_average_is_that_of_the_curve() {
    for alpha in [0.0, 0.0025, 0.003, 0.01, 0.037, 0.11, 0.3, 0.77, 1.0] {
        for curve in [
            AlbedoCurve::dielectric(alpha, 1.5),
            AlbedoCurve::dielectric(alpha, 1.02),
            AlbedoCurve::schlick(alpha, Rgb::new(0.9, 0.04, 0.3)),
        ] {
            let (sum, avg) = (avg(&curve), curve.avg());
            for (sum, avg) in [(sum.r, avg.r), (sum.g, avg.g), (sum.b, avg.b)] {
                let raised = 1.2e-3 * 1.2e-3 / (1.2e-3 + 1.0 - sum);
                assert!(close(sum - raised, avg, 3e-6), "{alpha}: {sum} {avg}");
            }
        }
    }
}

#[test]
fn the_average_of_a_smooth_dielectric_is_walshs() {
    // Walsh 1926, "The reflection factor of a polished glass surface for diffused light", as Duntley 1942 gives it.
    for n in [1.1_f64, 1.33, 1.5, 2.0, 2.5, 3.0] {
        let n2 = n * n;
        let (n4, sum) = (n2 * n2, n2 + 1.0);
        let walsh = 0.5
            + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
            + n2 * (n2 - 1.0) * (n2 - 1.0) / (sum * sum * sum) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / (sum * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / (sum * (n4 - 1.0) * (n4 - 1.0)) * n.ln();
        let fit = AlbedoCurve::dielectric(0.0, n).avg().r - walsh;
        assert!((1e-3..1.4e-3).contains(&fit), "{n}: {walsh} {fit}");
    }
}

#[test]
fn the_average_of_schlicks_smooth_surface_is_a_twenty_first_of_the_way_to_white() {
    let avg = AlbedoCurve::schlick(0.0, Rgb::new(0.0, 0.04, 0.5)).avg();
    for (f0, avg) in [(0.0, avg.r), (0.04, avg.g), (0.5, avg.b)] {
        let above: f64 = avg - (f0 + (1.0 - f0) / 21.0);
        assert!((1.1e-3..1.3e-3).contains(&above), "{f0}: {above}");
    }
}

#[test]
fn polynomials_in_x_are_interpolated_exactly_in_every_channel() {
    let tint = Rgb::new(0.2, 0.9, 0.0);
    let x = |mu: f64| mu / (mu + 0.295);
    let f = |mu: f64| [0.3 - 0.2 * x(mu), 0.5 * x(mu) * x(mu) * x(mu)];
    let (curve, grey) = (AlbedoCurve::from_fn_tinted(tint, f), AlbedoCurve::from_fn(|mu| f(mu)[0]));
    for mu in (0..=100).map(|i| f64::from(i) / 100.0) {
        let [base, extra] = f(mu);
        let (want, got) = (tint.map(|t| base + t * extra), curve.at(mu));
        for (want, got) in [(want.r, got.r), (want.g, got.g), (want.b, got.b), (base, grey.at(mu).g)] {
            assert!(close(want, got, 1e-13), "{mu}: {want} {got}");
        }
    }
}

#[test]
fn polynomials_in_the_cosine_are_interpolated_as_far_as_degree_11_in_x_goes() {
    // µᵏ has a pole of order k in x, at 1.59: the error falls as 2.83⁻¹², times a power of 12.
    for (degree, within) in [(0, 1e-12), (1, 6e-6), (2, 5e-5), (3, 2e-4)] {
        let curve = AlbedoCurve::from_fn(|mu: f64| 0.5 * mu.powi(degree));
        let error = (0..=1000).map(|i| f64::from(i) / 1000.0).map(|mu| (curve.at(mu).r - 0.5 * mu.powi(degree)).abs());
        let error = error.fold(0.0, f64::max);
        assert!(error < within, "{degree}: {error}");
        assert!(close(curve.avg().r, 1.0 / f64::from(degree + 2), 2e-5), "{degree}: {:?}", curve.avg());
    }
}

#[test]
fn nothing_more_is_transmitted_than_the_bound_and_little_less() {
    for alpha in [0.0, 0.0025, 0.02, 0.1, 0.3, 0.5, 1.0] {
        for curve in [
            AlbedoCurve::dielectric(alpha, 1.05),
            AlbedoCurve::dielectric(alpha, 1.5),
            AlbedoCurve::dielectric(alpha, 2.5),
            AlbedoCurve::schlick(alpha, Rgb::new(0.04, 0.5, 1.0)),
        ] {
            let bound = curve.most_transmitted();
            let mut most = Rgb::zero();
            for mu in (0..=3000).map(|i| (f64::from(i) / 3000.0).powi(2)) {
                let e = curve.at(mu);
                most = Rgb::new(f64::max(most.r, 1.0 - e.r), f64::max(most.g, 1.0 - e.g), f64::max(most.b, 1.0 - e.b));
            }
            for (most, bound) in [(most.r, bound.r), (most.g, bound.g), (most.b, bound.b)] {
                assert!(most <= bound + 1e-12 && bound <= most + 7e-3, "{alpha}: {most} {bound}");
            }
        }
    }
}

#[test]
fn an_index_of_one_reflects_nothing() {
    for alpha in [0.0_f32, 0.1, 1.0] {
        let curve = AlbedoCurve::dielectric(alpha, 1.0);
        assert_eq!((curve.at(0.0), curve.avg(), curve.most_transmitted()), (Rgb::zero(), Rgb::zero(), Rgb::splat(1.0)));
    }
}

#[test]
fn every_number_gives_an_albedo() {
    let special = special_values();
    for &a in &special {
        for &b in &special {
            let curves = [AlbedoCurve::dielectric(a, b), AlbedoCurve::schlick(a, Rgb::new(b, 0.5, a))];
            for curve in curves {
                for &cos in &special {
                    assert!(curve.at(cos).within(0.0, 1.0), "{a} {b} {cos}: {:?}", curve.at(cos));
                }
                assert!(curve.avg().within(0.0, 1.0) && curve.most_transmitted().within(0.0, 1.0), "{a} {b}");
            }
        }
    }
}

#[test]
#[cfg(feature = "wide")]
fn lanes_are_the_scalar_bit_for_bit() {
    use crate::{F32x8, testing::same_bits};
    let mut random = Random(83);
    for round in 0..200 {
        let mut four = || core::array::from_fn::<f32, 8, _>(|_| random.unit());
        let (alpha, eta, cos, red, green) = (four(), four().map(|u| 1.0 + 2.0 * u), four(), four(), four());
        // Some lanes are grey.
        let green = core::array::from_fn::<f32, 8, _>(|i| if (round + i) % 3 == 0 { red[i] } else { green[i] });
        let [a, e, c, r, g] = [alpha, eta, cos, red, green].map(|x| F32x8::from_fn(|i| x[i]));
        let wide = [AlbedoCurve::dielectric(a, e), AlbedoCurve::schlick(a, Rgb::new(r, g, r))];
        let all = wide.map(|curve| {
            [curve.at(c), curve.avg(), curve.most_transmitted()].map(|x| [x.r, x.g, x.b].map(|x| x.to_array()))
        });
        for i in 0..8 {
            let f0 = Rgb::new(red[i], green[i], red[i]);
            let narrow = [AlbedoCurve::dielectric(alpha[i], eta[i]), AlbedoCurve::schlick(alpha[i], f0)];
            for (curve, wide) in narrow.iter().zip(&all) {
                for (x, wide) in [curve.at(cos[i]), curve.avg(), curve.most_transmitted()].into_iter().zip(wide) {
                    for (x, wide) in [x.r, x.g, x.b].into_iter().zip(wide) {
                        assert!(same_bits(x, wide[i]), "{x} {}", wide[i]);
                    }
                }
            }
        }
    }
}

#[test]
fn single_precision_is_enough() {
    let mut random = Random(89);
    for _ in 0..3000 {
        let (alpha, eta, cos) =
            (random.unit() * random.unit(), 1.1 + 1.9 * random.unit(), random.unit() * random.unit());
        let single = f64::from(AlbedoCurve::dielectric(alpha, eta).at(cos).r);
        let double = AlbedoCurve::dielectric(f64::from(alpha), eta.into()).at(cos.into()).r;
        assert!(close(single, double, 5e-6), "{alpha} {eta} {cos}: {single} {double}");
    }
}
