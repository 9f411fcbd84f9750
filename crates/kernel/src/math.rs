//! Elementary functions: one algorithm each for `f32`, `f64` and lanes, with the coefficients of the precision at hand.
//!
//! Angles use Cephes' minimax polynomials (Moshier, `sinf.c`, `sin.c`, `atanf.c` and `atan.c`); the sources of the others
//! stand with them. Stated errors are those of a target with fused multiply-add.

mod erf;
mod exp;
mod log;
#[cfg(test)]
mod values;

pub use erf::{erf, erf_inv};
pub(crate) use erf::{erf_inv_over, erf_inv_within, erfc_and_exp};
pub(crate) use exp::exp_negative;
pub use exp::{exp, exp_m1, flushed_square};
pub(crate) use log::ln_normal;
pub use log::{ln, ln_1p, pow};

use crate::real::{Precision, Real};

/// sin(2πu) and cos(2πu) for |u| ≤ 2¹⁹. The reduction to an eighth of a turn is exact, so the error is that of the
/// polynomials: at most 2 ulp, or 2⁻²⁴ absolute in `f32` (2⁻⁵³ in `f64`) near a zero.
#[inline(always)]
pub fn sin_cos_turns<R: Real>(u: R) -> (R, R) {
    let [sin, cos] = R::named(
        "sin_cos_turns",
        [u],
        #[inline(always)]
        |[u]| sin_cos_turns_text(u).into(),
    );
    (sin, cos)
}

#[inline(always)]
fn sin_cos_turns_text<R: Real>(u: R) -> (R, R) {
    let (quarters, quadrant) = (u * R::lit(4.0)).round_to_int();
    let x = quarters.mul_add(R::lit(-0.25), u) * R::lit(core::f64::consts::TAU);
    let z = x * x;
    let sin = x.mul_add(z * polynomial(z, sin_coefficients::<R>()), x);
    let cos = (z * z).mul_add(polynomial(z, cos_coefficients::<R>()), z.mul_add(R::lit(-0.5), R::ONE));
    // Odd quadrants swap the two; the sine is negative in quadrants 2 and 3, the cosine in 1 and 2.
    let odd = R::int_bit(quadrant, 0);
    let half = R::int_bit(quadrant, 1);
    let (s, c) = (R::select(odd, cos, sin), R::select(odd, sin, cos));
    (s.negated(half), c.negated(half ^ odd))
}

/// The angle of the point (x, y) from the positive x axis in turns, in [−½, ½]; positive for positive y. 0 at the origin,
/// where sign bits decide as in IEEE 754's atan2. For finite x and y whose sum does not overflow; at most 4 ulp.
#[inline(always)]
pub fn atan2_turns<R: Real>(y: R, x: R) -> R {
    let [value] = R::named(
        "atan2_turns",
        [y, x],
        #[inline(always)]
        |[y, x]| [atan2_turns_text(y, x)],
    );
    value
}

#[inline(always)]
fn atan2_turns_text<R: Real>(y: R, x: R) -> R {
    let (ax, ay) = (x.abs(), y.abs());
    let (low, high) = (ax.min(ay), ax.max(ay));
    // Within an eighth of a turn; beyond half of that, tan(a − ⅛) = (tan a − 1)/(tan a + 1) brings it nearer to 0.
    let far = low.gt(high * R::lit(core::f64::consts::SQRT_2 - 1.0));
    let t = R::select(far, low - high, low) / R::select(far, low + high, high);
    let t = t.or_zero(high.gt(R::ZERO));
    let z = t * t;
    let tail = match R::PRECISION {
        Precision::Single => polynomial(z, &ATAN_SINGLE),
        Precision::Double => polynomial(z, &ATAN_DOUBLE[0]) / polynomial(z, &ATAN_DOUBLE[1]),
    };
    let first = t.mul_add(z * tail, t) * R::lit(0.5 * core::f64::consts::FRAC_1_PI);
    let first = R::select(far, first + R::lit(0.125), first);
    let quarter = R::select(ay.gt(ax), R::lit(0.25) - first, first);
    // The sign bit of x, so that −0 counts as left.
    let right = R::ONE.copysign(x).gt(R::ZERO);
    R::select(right, quarter, R::lit(0.5) - quarter).copysign(y)
}

/// (atan t − t)/t³ as a polynomial in t², |t| ≤ √2 − 1.
const ATAN_SINGLE: [f64; 4] = [8.053_744_495_38e-2, -1.387_768_560_32e-1, 1.997_771_064_78e-1, -3.333_294_915_39e-1];
/// The same as a quotient.
const ATAN_DOUBLE: [[f64; 6]; 2] = [
    [
        0.0,
        -8.750_608_600_031_904e-1,
        -1.615_753_718_733_365e1,
        -7.500_855_792_314_705e1,
        -1.228_866_684_490_136_1e2,
        -6.485_021_904_942_025e1,
    ],
    [
        1.0,
        2.485_846_490_142_306_3e1,
        1.650_270_098_316_988_5e2,
        4.328_810_604_912_902_7e2,
        4.853_903_996_359_137e2,
        1.945_506_571_482_614e2,
    ],
];

/// The least normal number.
#[inline(always)]
fn least_normal<R: Real>() -> R {
    R::lit(match R::PRECISION {
        Precision::Single => f64::from(f32::MIN_POSITIVE),
        Precision::Double => f64::MIN_POSITIVE,
    })
}

/// Horner's scheme, highest coefficient first.
#[inline(always)]
fn polynomial<R: Real>(x: R, coefficients: &[f64]) -> R {
    let Some((&first, rest)) = coefficients.split_first() else { return R::ZERO };
    rest.iter().fold(R::lit(first), |sum, &c| sum.mul_add(x, R::lit(c)))
}

/// The same for long polynomials, even and odd powers apart: half the latency.
#[inline(always)]
fn long_polynomial<R: Real>(x: R, coefficients: &[f64]) -> R {
    let z = x * x;
    // From the highest power down the two sums take turns, and the last one holds the constant.
    let (mut before, mut last) = (R::ZERO, R::ZERO);
    for (i, &c) in coefficients.iter().enumerate() {
        let sum = if i < 2 { R::lit(c) } else { before.mul_add(z, R::lit(c)) };
        (before, last) = (last, sum);
    }
    before.mul_add(x, last)
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
    fn angles_of_points_on_the_axes_and_diagonals_are_exact() {
        let points = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (1.0, -1.0), (0.0, -1.0)];
        for (eighths, (y, x)) in points.into_iter().enumerate() {
            let turns = eighths as f64 / 8.0;
            for scale in [1e-30, 1.0, 1e30] {
                assert_eq!(atan2_turns(y * scale, x * scale), turns, "{y} {x}");
                assert_eq!(atan2_turns(-y * scale, x * scale), -turns, "-{y} {x}");
                assert_eq!(atan2_turns((y * scale) as f32, (x * scale) as f32), turns as f32, "{y} {x}");
            }
        }
        assert_eq!((atan2_turns(0.0_f32, 0.0), atan2_turns(0.0_f32, -0.0)), (0.0, 0.5));
    }

    #[test]
    fn angles_are_within_four_units_of_the_last_place() {
        let mut random = Random(11);
        let (mut single, mut double) = (0.0_f64, 0.0_f64);
        for i in 0..400_000 {
            let mut number = || (2.0 * random.unit() - 1.0) * if i % 4 == 0 { random.unit().powi(8) } else { 1.0 };
            let (y, x) = (number(), number());
            let exact = f64::from(y).atan2(x.into()) / TAU;
            let error = |got: f64, bits: i32| {
                let exponent = exact.abs().log2().floor() as i32;
                (got - exact).abs() / 2.0_f64.powi(exponent - bits + 1)
            };
            single = single.max(error(atan2_turns(y, x).into(), 24));
            double = double.max(error(atan2_turns(f64::from(y), f64::from(x)), 53));
        }
        // The f64 of std has one unit of its own, and the division by 2π another half.
        assert!(single <= 4.0 && double <= 5.5, "{single} {double}");
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
