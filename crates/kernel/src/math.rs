//! Elementary functions: one algorithm each for `f32`, `f64` and lanes, with the coefficients of the precision at hand.
//!
//! Coefficients are Cephes' minimax polynomials (Moshier, `sinf.c` and `sin.c`).

use crate::real::{Precision, Real};

/// sin(2πu) and cos(2πu) for |u| ≤ 2¹⁹. The reduction to an eighth of a turn is exact, so the error is that of the
/// polynomials: at most 2 ulp, or 2⁻²⁴ absolute in `f32` (2⁻⁵³ in `f64`) near a zero.
#[inline(always)]
pub fn sin_cos_turns<R: Real>(u: R) -> (R, R) {
    let (quarters, quadrant) = (u * R::lit(4.0)).round_to_int();
    let x = quarters.mul_add(R::lit(-0.25), u) * R::lit(core::f64::consts::TAU);
    let z = x * x;
    let sin = x.mul_add(z * polynomial(z, sin_coefficients::<R>()), x);
    let cos = (z * z).mul_add(polynomial(z, cos_coefficients::<R>()), z.mul_add(R::lit(-0.5), R::ONE));
    // Odd quadrants swap the two; the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
    let odd = R::int_bit(quadrant, 0);
    let half = R::int_bit(quadrant, 1);
    let (s, c) = (R::select(odd, cos, sin), R::select(odd, sin, cos));
    (R::select(half, -s, s), R::select((half | odd) & !(half & odd), -c, c))
}

/// Horner's scheme, highest coefficient first.
#[inline(always)]
fn polynomial<R: Real>(x: R, coefficients: &[f64]) -> R {
    let mut sum = R::ZERO;
    for &c in coefficients {
        sum = sum.mul_add(x, R::lit(c));
    }
    sum
}

#[inline(always)]
fn sin_coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[-1.951_529_589_1e-4, 8.332_160_873_6e-3, -1.666_665_461_1e-1],
        Precision::Double => &[
            1.589_623_015_765_465_7e-10,
            -2.505_074_776_285_780_7e-8,
            2.755_731_362_138_572_5e-6,
            -1.984_126_982_958_954e-4,
            8.333_333_333_322_119e-3,
            -1.666_666_666_666_663e-1,
        ],
    }
}

#[inline(always)]
fn cos_coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[2.443_315_711_809_948e-5, -1.388_731_625_493_765e-3, 4.166_664_568_298_827e-2],
        Precision::Double => &[
            -1.135_853_653_638_768_2e-11,
            2.087_570_084_197_473e-9,
            -2.755_731_417_929_674e-7,
            2.480_158_728_885_170_5e-5,
            -1.388_888_888_887_305_6e-3,
            4.166_666_666_666_659e-2,
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use core::f64::consts::TAU;

    /// sin and cos of u turns by std. The reduction is exact, so the errors are the rounding of 2πx and of std.
    fn std_sin_cos(u: f64) -> (f64, f64) {
        let quarters = (u * 4.0).round();
        let (s, c) = ((u - quarters * 0.25) * TAU).sin_cos();
        match quarters.rem_euclid(4.0) as u8 {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }

    /// Distance in units of the last place of `exact` in a format of `bits` significant bits; below `floor` absolute.
    fn ulps(x: f64, exact: f64, bits: i32) -> f64 {
        let exponent = exact.abs().log2().floor().max(-2.0) as i32;
        (x - exact).abs() / 2.0_f64.powi(exponent - bits + 1)
    }

    #[test]
    fn quarter_turns_are_exact() {
        let quarters = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for turn in -8..=8 {
            let (sin, cos) = quarters[(turn as usize) % 4];
            assert_eq!(sin_cos_turns(turn as f32 * 0.25), (sin as f32, cos as f32), "{turn} quarters");
            assert_eq!(sin_cos_turns(f64::from(turn) * 0.25), (sin, cos), "{turn} quarters");
        }
    }

    #[test]
    fn single_precision_is_within_two_units_of_the_last_place() {
        let mut random = Random(8);
        for range in [1.0_f32, 16.0, 500_000.0] {
            for _ in 0..100_000 {
                let u = (2.0 * random.unit() - 1.0) * range;
                let ((s, c), (sin, cos)) = (sin_cos_turns(u), std_sin_cos(u.into()));
                assert!(ulps(s.into(), sin, 24) <= 2.0 && ulps(c.into(), cos, 24) <= 2.0, "{u}: {s} {sin}, {c} {cos}");
            }
        }
    }

    #[test]
    fn double_precision_is_within_two_units_of_std_which_has_one_of_its_own() {
        let mut random = Random(9);
        for _ in 0..100_000 {
            let u = (random.bits() as f64 / 2.0_f64.powi(63)) - 1.0;
            let ((s, c), (sin, cos)) = (sin_cos_turns(u), std_sin_cos(u));
            assert!(ulps(s, sin, 53) <= 3.0 && ulps(c, cos, 53) <= 3.0, "{u}: {s} {sin}, {c} {cos}");
        }
    }
}
