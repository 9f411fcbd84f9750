//! The exponential function and its difference from 1.
//!
//! x = n ln 2 + r with |r| ≤ ½ ln 2, the product in two words (Cody & Waite 1980), and eˣ = 2ⁿ(1 + r + r² P(r)). P is the
//! minimax polynomial of the relative error of eʳ on that interval, by Remez' algorithm with 50 digits.

use super::{least_normal, polynomial};
use crate::real::{Precision, Real};

/// eˣ: at most 2 ulp. Exactly 0 where it is below the least normal number (2⁻¹²⁶ in `f32`), because one denormal lane
/// stalls all eight; +∞ beyond the largest; NaN of NaN.
#[inline(always)]
pub fn exp<R: Real>(x: R) -> R {
    let [value] = R::named(
        "exp",
        [x],
        #[inline(always)]
        |[x]| [exp_text(x)],
    );
    value
}

#[inline(always)]
fn exp_text<R: Real>(x: R) -> R {
    let (n, r) = reduce(x);
    let [least, largest] = range::<R>();
    // Only what lies between the ends has an exponent; beyond, x is positive, or NaN.
    let inside = reduced(n, r).or_zero(x.ge(R::lit(least)));
    R::select(x.le(R::lit(largest)), inside, x * R::lit(f64::INFINITY))
}

/// [`exp`] of x ≤ 0; 0 of NaN.
#[inline(always)]
pub(crate) fn exp_negative<R: Real>(x: R) -> R {
    let [value] = R::named(
        "exp_negative",
        [x],
        #[inline(always)]
        |[x]| [exp_negative_text(x)],
    );
    value
}

#[inline(always)]
fn exp_negative_text<R: Real>(x: R) -> R {
    let (n, r) = reduce(x);
    reduced(n, r).or_zero(x.ge(R::lit(range::<R>()[0])))
}

/// e^(x + y), where y is what x was rounded by: with the same ends as [`exp`], but those of the sum.
#[inline(always)]
pub(super) fn exp_of_sum<R: Real>(x: R, y: R) -> R {
    let (n, r) = reduce(x);
    let m = mantissa(r + y);
    let [least, largest] = range::<R>();
    // A unit of x is many of the result. So near the ends the exponent is added to half of m where it may be too large, and to
    // more than m where it may be too small, and the product says what lies beyond.
    let up = R::select(x.gt(R::ZERO), R::lit(0.5), R::lit(16_777_216.0)); // 2²⁴
    let power = (m * up).ldexp(n) * up.recip();
    let inside = power.or_zero(x.ge(R::lit(least - 0.01)) & power.ge(least_normal()));
    R::select(x.le(R::lit(largest + 0.01)), inside, x * R::lit(f64::INFINITY))
}

/// 2ⁿeʳ for |r| up to about ½ ln 2.
#[inline(always)]
fn reduced<R: Real>(n: R::Int, r: R) -> R {
    mantissa(r).ldexp(n)
}

/// eʳ for |r| up to about ½ ln 2.
#[inline(always)]
fn mantissa<R: Real>(r: R) -> R {
    R::ONE + r.mul_add(r * polynomial(r, coefficients::<R>()), r)
}

/// factor·root², flushed to 0 below 2⁻¹²⁶ in `f32` without a denormal number on the way (one stalls all eight lanes). With
/// root = exp(x/2) it is factor·exp(x) down to that bound, where factor·[`exp`] would be flushed at factor·2⁻¹²⁶. For factors
/// up to 10¹⁶ and roots of the order of 1 or below.
#[inline(always)]
pub fn flushed_square<R: Real>(root: R, factor: R) -> R {
    let grown = root * factor;
    match R::PRECISION {
        Precision::Single => {
            let lift = R::lit(18_446_744_073_709_551_616.0); // 2⁶⁴
            let least = R::lit(2.168_404_344_971_009e-19); // 2⁻⁶²
            grown.or_zero((grown * (root * lift)).ge(least)) * root
        }
        Precision::Double => grown * root,
    }
}

/// eˣ − 1 without cancellation: at most 2 ulp. −1 far below 0, +∞ beyond the largest number, NaN of NaN.
#[inline]
pub fn exp_m1<R: Real>(x: R) -> R {
    let [value] = R::named(
        "exp_m1",
        [x],
        #[inline(always)]
        |[x]| [exp_m1_text(x)],
    );
    value
}

#[inline(always)]
fn exp_m1_text<R: Real>(x: R) -> R {
    let [_, largest] = range::<R>();
    // At −40 even f64 cannot tell the result from −1.
    let (n, r) = reduce(x.max(R::lit(-40.0)));
    let q = r.mul_add(r * polynomial(r, coefficients::<R>()), r);
    // 2ⁿ(q + 1) − 1, by halves because 2ⁿ may overflow where the result does not.
    let half = R::lit(0.5).ldexp(n);
    let result = R::lit(2.0) * half.mul_add(q, half - R::lit(0.5));
    let tiny = x.abs().lt(R::lit(0.25 * core::f64::consts::LN_2));
    R::select(x.le(R::lit(largest)), R::select(tiny, q, result), x * R::lit(f64::INFINITY))
}

/// n and r of x = n ln 2 + r.
#[inline(always)]
fn reduce<R: Real>(x: R) -> (R::Int, R) {
    let (n, int) = (x * R::lit(core::f64::consts::LOG2_E)).round_to_int();
    let [high, low] = ln_2::<R>();
    (int, n.mul_add(-low, n.mul_add(-high, x)))
}

/// ln 2 as a number of so few bits that its product with an exponent is exact, and the rest (Cephes, fdlibm).
#[inline(always)]
pub(super) fn ln_2<R: Real>() -> [R; 2] {
    match R::PRECISION {
        Precision::Single => [0.693_359_375, -2.121_944_400_546_905_8e-4],
        Precision::Double => [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10],
    }
    .map(R::lit)
}

/// The arguments between which the result is a normal number: inside [ln 2⁻¹²⁶, ln(2¹²⁸ − 2¹⁰³)], and so for `f64`.
#[inline(always)]
fn range<R: Real>() -> [f64; 2] {
    match R::PRECISION {
        Precision::Single => [-87.336_54, 88.722_83],
        Precision::Double => [-708.396_418_532_264, 709.782_712_893_384],
    }
}

/// (eʳ − 1 − r)/r²
#[inline(always)]
fn coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[
            1.979_030_400_43e-4,
            1.394_467_034_48e-3,
            8.333_497_209_74e-3,
            4.166_629_481_1e-2,
            1.666_666_586_8e-1,
            5.000_000_067_71e-1,
        ],
        Precision::Double => &[
            2.500_007_380_284_746_4e-8,
            2.763_026_326_181_261_3e-7,
            2.755_758_639_809_504e-6,
            2.480_149_306_052_57e-5,
            1.984_126_950_648_811_4e-4,
            1.388_888_894_366_352_6e-3,
            8.333_333_333_494_528e-3,
            4.166_666_666_653_002e-2,
            1.666_666_666_666_641_2e-1,
            5.000_000_000_000_01e-1,
        ],
    }
}
