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
            2.087_570_084_197_473_2e-9,
            -2.755_731_417_929_674e-7,
            2.480_158_728_885_170_5e-5,
            -1.388_888_888_887_305_6e-3,
            4.166_666_666_666_659e-2,
        ],
    }
}
