//! Logarithms, and powers through a logarithm of two words.
//!
//! x = m·2ᵏ with m in [√½, √2), and with f = m − 1 and s = f/(2 + f): ln m = 2s + s³ P(s²), as in fdlibm's `e_log.c`
//! (Ng 1993). P is a minimax polynomial by Remez' algorithm with 50 digits, in `f64` one degree above fdlibm's, for `pow`. In
//! `f32` ln(1 + f) is a polynomial in f, without a division, and P serves `pow` alone.

use super::exp::{exp_of_sum, ln_2};
use super::{least_normal, long_polynomial, polynomial};
use crate::real::{Precision, Real};

/// ln x: at most 2 ulp, denormal numbers included. −∞ of 0, NaN below and of NaN, +∞ of +∞.
#[inline]
pub fn ln<R: Real>(x: R) -> R {
    let [value] = R::named(
        "ln",
        [x],
        #[inline(always)]
        |[x]| [ln_text(x)],
    );
    value
}

#[inline(always)]
fn ln_text<R: Real>(x: R) -> R {
    let (m, k) = split(x);
    let f = m - R::ONE;
    special(x, ln_of_parts(f, k))
}

/// [`ln`] of a positive, normal, finite x.
#[inline(always)]
pub(crate) fn ln_normal<R: Real>(x: R) -> R {
    let [value] = R::named(
        "ln_normal",
        [x],
        #[inline(always)]
        |[x]| [ln_normal_text(x)],
    );
    value
}

#[inline(always)]
fn ln_normal_text<R: Real>(x: R) -> R {
    let (m, k) = x.split_exponent();
    ln_of_parts(m - R::ONE, k)
}

/// ln(1 + x) without cancellation: at most 2 ulp. −∞ of −1, NaN below and of NaN, +∞ of +∞.
#[inline]
pub fn ln_1p<R: Real>(x: R) -> R {
    let [value] = R::named(
        "ln_1p",
        [x],
        #[inline(always)]
        |[x]| [ln_1p_text(x)],
    );
    value
}

#[inline(always)]
fn ln_1p_text<R: Real>(x: R) -> R {
    let u = R::ONE + x;
    let (m, k) = u.split_exponent();
    // What u was rounded by, scaled as m is; where nothing was scaled, f is x itself.
    let part = u - R::ONE;
    let lost = (R::ONE - (u - part)) + (x - part);
    // From 2⁶⁴ on there is nothing to correct, and 2⁻ᵏ might not be a normal number.
    let f = (m - R::ONE) + lost * R::ONE.ldexp((-k).max(R::lit(-64.0)).round_to_int().1);
    let f = R::select(k.same(R::ZERO), x, f);
    special(u, ln_of_parts(f, k))
}

/// xʸ for x ≥ 0 and finite y: at most 8 ulp. 0⁰ = 1, 0 to a negative power is +∞. Flushed to exactly 0 below the least
/// normal number, as [`exp`](super::exp) is. NaN below 0.
#[inline]
pub fn pow<R: Real>(x: R, y: R) -> R {
    let [value] = R::named(
        "pow",
        [x, y],
        #[inline(always)]
        |[x, y]| [pow_text(x, y)],
    );
    value
}

#[inline(always)]
fn pow_text<R: Real>(x: R, y: R) -> R {
    let (high, low) = ln_of_two_words(x);
    // y(high + low) again in two words.
    let p = y * high;
    let rest = y.mul_add(high, -p) + y * low;
    let power = exp_of_sum(p, rest);
    let of_zero = R::select(y.gt(R::ZERO), R::ZERO, R::select(y.lt(R::ZERO), R::lit(f64::INFINITY), R::ONE));
    R::select(x.gt(R::ZERO), power, R::select(x.same(R::ZERO), of_zero, R::lit(f64::NAN)))
}

/// m and k of x = m·2ᵏ, for positive x, denormal numbers included.
#[inline(always)]
fn split<R: Real>(x: R) -> (R, R) {
    let (bits, lift) = match R::PRECISION {
        Precision::Single => (24.0, 16_777_216.0),
        Precision::Double => (53.0, 9_007_199_254_740_992.0),
    };
    let denormal = x.lt(least_normal());
    let (m, k) = R::select(denormal, x * R::lit(lift), x).split_exponent();
    (m, R::select(denormal, k - R::lit(bits), k))
}

/// ln((1 + f)·2ᵏ).
#[inline(always)]
fn ln_of_parts<R: Real>(f: R, k: R) -> R {
    let square = f * f;
    let half_square = R::lit(0.5) * square;
    let [high, low] = ln_2::<R>();
    let cubic = match R::PRECISION {
        Precision::Single => square * (f * long_polynomial(f, &DIRECT)),
        Precision::Double => {
            let s = f / (R::lit(2.0) + f);
            let z = s * s;
            s * z.mul_add(polynomial(z, coefficients::<R>()), half_square)
        }
    };
    // f − f²/2 + cubic: the large term last.
    k.mul_add(high, f - (half_square - k.mul_add(low, cubic)))
}

/// (ln(1 + f) − f + f²/2)/f³ for `f32`, where a division would cost more than the longer polynomial.
const DIRECT: [f64; 8] = [
    -7.634_544_569_117e-2,
    0.127_616_544_219_6,
    -0.131_602_012_627_1,
    0.142_017_490_768_6,
    -0.166_233_546_470_3,
    0.200_012_271_523,
    -0.250_008_211_102_5,
    0.333_333_317_056_8,
];

/// ln x of a positive x as the sum of two numbers, right to about 2⁻³⁰ of itself in `f32` (2⁻⁵⁹ in `f64`).
#[inline(always)]
fn ln_of_two_words<R: Real>(x: R) -> (R, R) {
    let (m, k) = split(x);
    let f = m - R::ONE;
    let sum = m + R::ONE;
    let sum_low = m - (sum - R::ONE);
    let inverse = sum.recip();
    let s = f * inverse;
    let s_low = (-s).mul_add(sum_low, (-s).mul_add(sum, f)) * inverse;
    let z = s * s;
    // Of the tail, 2s³/3 and on, the first term wants s² in two words as well.
    let z_low = s.mul_add(s, -z) * R::lit(2.0 / 3.0);
    let tail = s * z.mul_add(polynomial(z, coefficients::<R>()), z_low);
    let [ln_2_high, ln_2_low] = ln_2::<R>();
    let (whole, part) = (k * ln_2_high, s + s);
    let high = whole + part; // |whole| ≥ |part|, or whole is 0
    // 2s + 2s³/3 grows by 2(1 + s²) with s.
    let low = (part - (high - whole)) + k.mul_add(ln_2_low, s_low.mul_add(R::lit(2.0) * (R::ONE + z), tail));
    let total = high + low;
    (total, low - (total - high))
}

/// `result` where it is the logarithm of x, else the limit.
#[inline(always)]
fn special<R: Real>(x: R, result: R) -> R {
    let infinite = R::lit(f64::INFINITY);
    let limit = R::select(x.same(R::ZERO), -infinite, R::select(x.same(infinite), x, R::lit(f64::NAN)));
    R::select(x.gt(R::ZERO) & x.lt(infinite), result, limit)
}

/// (ln((1 + s)/(1 − s)) − 2s)/s³ as a polynomial in s².
#[inline(always)]
fn coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[0.235_835_168_725, 0.285_372_413_211, 0.400_003_361_67, 0.666_666_656_416],
        Precision::Double => &[
            0.132_527_200_231_807_33,
            0.132_499_664_270_643_44,
            0.153_870_974_233_491_36,
            0.181_817_755_146_979_4,
            0.222_222_226_486_567_92,
            0.285_714_285_690_737_5,
            0.400_000_000_000_062_86,
            0.666_666_666_666_666_6,
        ],
    }
}
