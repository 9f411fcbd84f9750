//! Values of the elementary functions: single precision against std, double against 60 digits.

// The values that happen to be constants of mathematics are values like the others here.
#![allow(clippy::approx_constant)]

use super::{erf, erf_inv, exp, exp_m1, ln, ln_1p, pow};
use crate::testing::Random;

/// |got − exact| in units of the last place of `exact` in a format of `bits` significant bits and this least exponent.
fn ulps(got: f64, exact: f64, bits: i32, least: i32) -> f64 {
    if got == exact {
        return 0.0; // infinities too
    }
    let exponent = (exact.abs().log2().floor() as i32).max(least);
    ((got - exact) / 2.0_f64.powi(exponent) * 2.0_f64.powi(bits - 1)).abs()
}
fn single(got: f32, exact: f64) -> f64 {
    ulps(got.into(), exact, 24, -126)
}

/// The worst error in ulp over `count` arguments, and where.
fn worst(mut argument: impl FnMut(&mut Random) -> f32, f: fn(f32) -> f32, exact: fn(f64) -> f64) -> (f64, f32) {
    let mut random = Random(21);
    (0..1_000_000).fold((0.0, 0.0), |worst, _| {
        let x = argument(&mut random);
        let error = single(f(x), exact(x.into()));
        if error > worst.0 || error.is_nan() { (error, x) } else { worst }
    })
}
fn between(lo: f32, hi: f32) -> impl FnMut(&mut Random) -> f32 {
    move |random| lo + (hi - lo) * random.unit()
}
/// Any positive number, each exponent as likely as any other.
fn positive(random: &mut Random) -> f32 {
    f32::from_bits((random.bits() % u64::from(f32::INFINITY.to_bits())) as u32)
}

#[test]
fn in_single_precision_every_function_keeps_its_bound_against_std() {
    let small = |random: &mut Random| (2.0 * random.unit() - 1.0) * random.unit().powi(8);
    let table = [
        ("exp", 2.0, worst(between(-87.3365, 88.7228), exp, f64::exp)),
        ("exp", 2.0, worst(small, exp, f64::exp)),
        ("exp_m1", 2.0, worst(between(-20.0, 88.7228), exp_m1, f64::exp_m1)),
        ("exp_m1", 2.0, worst(between(-1.0, 1.0), exp_m1, f64::exp_m1)),
        ("exp_m1", 2.0, worst(small, exp_m1, f64::exp_m1)),
        ("ln", 2.0, worst(positive, ln, f64::ln)),
        ("ln", 2.0, worst(between(0.5, 2.0), ln, f64::ln)),
        ("ln_1p", 2.0, worst(positive, ln_1p, f64::ln_1p)),
        ("ln_1p", 2.0, worst(between(-1.0, 3.0), ln_1p, f64::ln_1p)),
        ("ln_1p", 2.0, worst(small, ln_1p, f64::ln_1p)),
        // std has no erf: the f64 form is tested against 60 digits below.
        ("erf", 2.0, worst(between(-5.0, 5.0), erf, erf)),
        ("erf", 2.0, worst(small, erf, erf)),
        ("erf_inv", 6.0, worst(between(-1.0 + 1e-7, 1.0), erf_inv, erf_inv)),
        ("erf_inv", 6.0, worst(|random| 1.0 - 2.0_f32.powf(-24.0 * random.unit()), erf_inv, erf_inv)),
        ("erf_inv", 6.0, worst(small, erf_inv, erf_inv)),
    ];
    for (name, bound, (error, at)) in table {
        assert!(error <= bound, "{name}: {error} ulp at {at:e}");
    }
}

#[test]
fn powers_keep_their_bound_up_to_the_ends_of_the_range() {
    let (mut random, mut most, mut at) = (Random(22), 0.0, (0.0, 0.0));
    for i in 0..1_000_000 {
        let x = if i % 2 == 0 { positive(&mut random) } else { 0.25 + 4.0 * random.unit() };
        // Exponents that use the whole range of results.
        let y = (176.0 * random.unit() - 87.3) / x.ln();
        let exact = f64::from(x).powf(y.into());
        if exact < f64::from(f32::MIN_POSITIVE) || exact > f64::from(f32::MAX) {
            continue;
        }
        let error = single(pow(x, y), exact);
        if error > most {
            (most, at) = (error, (x, y));
        }
    }
    assert!(most <= 8.0, "{most} ulp at {at:?}");
}

#[test]
fn in_double_precision_every_function_agrees_with_sixty_digits() {
    /// Name, bound in ulp, function, arguments with values.
    type Row = (&'static str, f64, fn(f64) -> f64, &'static [(f64, f64)]);
    let table: [Row; 6] = [
        ("exp", 2.0, exp, EXP),
        ("exp_m1", 2.0, exp_m1, EXP_M1),
        ("ln", 2.0, ln, LN),
        ("ln_1p", 2.0, ln_1p, LN_1P),
        ("erf", 2.0, erf, ERF),
        ("erf_inv", 4.0, erf_inv, ERF_INV),
    ];
    for (name, bound, f, values) in table {
        for &(x, exact) in values {
            let error = ulps(f(x), exact, 53, -1022);
            assert!(error <= bound, "{name}({x:e}): {:e} instead of {exact:e}, {error} ulp", f(x));
        }
    }
    for &(x, y, exact) in POW {
        let error = ulps(pow(x, y), exact, 53, -1022);
        assert!(error <= 8.0, "{x:e}^{y:e}: {:e} instead of {exact:e}, {error} ulp", pow(x, y));
    }
}

#[test]
fn limits_are_those_of_mathematics() {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    assert_eq!((exp(-inf), exp(0.0_f32), exp(inf)), (0.0, 1.0, inf));
    assert_eq!((exp_m1(-inf), exp_m1(0.0_f32), exp_m1(inf)), (-1.0, 0.0, inf));
    assert_eq!((ln(0.0_f32), ln(1.0_f32), ln(inf)), (-inf, 0.0, inf));
    assert_eq!((ln_1p(-1.0_f32), ln_1p(0.0_f32), ln_1p(inf)), (-inf, 0.0, inf));
    assert_eq!((erf(-inf), erf(0.0_f32), erf(inf)), (-1.0, 0.0, 1.0));
    assert_eq!((pow(0.0_f32, 0.0), pow(0.0_f32, 2.0), pow(0.0_f32, -2.0)), (1.0, 0.0, inf));
    assert_eq!((pow(1.0_f32, 1e30), pow(2.0_f32, 1e30), pow(0.5_f32, 1e30), pow(7.0_f32, 0.0)), (1.0, inf, 0.0, 1.0));
    for x in [exp(nan), exp_m1(nan), ln(nan), ln(-1.0), ln_1p(nan), ln_1p(-2.0), erf(nan), erf_inv(nan), pow(-1.0, 2.0)]
    {
        assert!(x.is_nan(), "{x}");
    }
    assert_eq!((exp(-1e300_f64), exp(1e300_f64), ln(0.0_f64)), (0.0, f64::INFINITY, -f64::INFINITY));
}

#[test]
fn exp_is_never_denormal_and_never_falls() {
    for least in [-87.336_54_f32, 0.0, 88.722_83] {
        let mut last = 0.0;
        // A thousand neighbours on either side.
        let mut x = (0..1000).fold(least, |x, _| x.next_down());
        for _ in 0..2000 {
            let y = exp(x);
            assert!(
                y >= last * (1.0 - 2.0 * f32::EPSILON) && !y.is_subnormal() && !y.is_nan(),
                "{x}: {y} after {last}"
            );
            (last, x) = (y, x.next_up());
        }
    }
    assert!(exp(88.722_83_f32).is_finite() && exp(709.782_712_893_384_f64).is_finite());
    assert!(exp(-708.396_418_532_264_f64) >= f64::MIN_POSITIVE);
}

// mpmath 1.3 at 60 digits, rounded to f64: the value at exactly this f64.
const EXP: &[(f64, f64)] = &[
    (-708.25, 2.5759248692837695e-308),
    (-300.0, 5.148200222412013e-131),
    (-37.5, 5.175555005801869e-17),
    (-1.0, 0.36787944117144233),
    (-0.34, 0.7117703227626097),
    (-1e-09, 0.999999999),
    (1e-09, 1.000000001),
    (0.1, 1.1051709180756477),
    (0.35, 1.4190675485932571),
    (1.0, 2.718281828459045),
    (2.5, 12.182493960703473),
    (36.75, 9126877256863956.0),
    (345.0, 6.785725020057171e+149),
    (709.5, 1.3549863193146328e+308),
];
const EXP_M1: &[(f64, f64)] = &[
    (-36.0, -0.9999999999999998),
    (-5.0, -0.9932620530009145),
    (-1.0, -0.6321205588285577),
    (-0.5, -0.3934693402873666),
    (-0.34, -0.2882296772373903),
    (-0.17, -0.15633518340361632),
    (-0.001, -0.0009995001666250085),
    (-1e-12, -9.999999999995e-13),
    (1e-17, 1e-17),
    (1e-05, 1.0000050000166668e-05),
    (0.1, 0.10517091807564763),
    (0.3, 0.3498588075760031),
    (0.36, 0.43332941456034024),
    (0.69, 0.9937155332430823),
    (1.0, 1.7182818284590453),
    (3.0, 19.085536923187668),
    (50.0, 5.184705528587072e+21),
    (700.0, 1.0142320547350045e+304),
];
const LN: &[(f64, f64)] = &[
    (5e-324, -744.4400719213812),
    (1e-310, -713.8013788281542),
    (3e-200, -459.41840631014105),
    (1e-05, -11.512925464970229),
    (0.5, -0.6931471805599453),
    (0.7, -0.35667494393873245),
    (0.71, -0.342490308946776),
    (0.9, -0.10536051565782628),
    (0.999999, -1.000000500029089e-06),
    (1.000001, 9.999994999180668e-07),
    (1.1, 0.09531017980432493),
    (1.4, 0.3364722366212129),
    (1.42, 0.35065687161316933),
    (2.0, 0.6931471805599453),
    (10.0, 2.302585092994046),
    (1e+100, 230.25850929940458),
    (1.7e+308, 709.7268368932282),
];
const LN_1P: &[(f64, f64)] = &[
    (-0.9999999, -16.118095651484676),
    (-0.75, -1.3862943611198906),
    (-0.5, -0.6931471805599453),
    (-0.3, -0.35667494393873234),
    (-0.29, -0.3424903089467759),
    (-0.1, -0.10536051565782631),
    (-1e-05, -1.0000050000333337e-05),
    (-1e-15, -1.0000000000000007e-15),
    (1e-17, 1e-17),
    (1e-06, 9.999995000003334e-07),
    (0.01, 0.009950330853168083),
    (0.3, 0.26236426446749106),
    (0.41, 0.3435897043900769),
    (0.42, 0.35065687161316933),
    (1.0, 0.6931471805599453),
    (7.0, 2.0794415416798357),
    (1000000000000000.0, 34.538776394910684),
    (1e+20, 46.051701859880914),
    (1e+300, 690.7755278982137),
];
const ERF: &[(f64, f64)] = &[
    (1e-300, 1.1283791670955126e-300),
    (1e-09, 1.1283791670955127e-09),
    (0.01, 0.011283415555849618),
    (0.3, 0.3286267594591274),
    (0.5, 0.5204998778130465),
    (0.7, 0.6778011938374184),
    (0.9, 0.7969082124228322),
    (0.99, 0.8385080695553698),
    (1.01, 0.8468104962282768),
    (1.2, 0.9103139782296353),
    (1.5, 0.9661051464753108),
    (2.0, 0.9953222650189527),
    (2.7, 0.9998656672600594),
    (3.5, 0.9999992569016276),
    (4.5, 0.9999999998033839),
    (5.5, 0.9999999999999927),
    (5.9, 0.9999999999999999),
    (7.0, 1.0),
    (-0.6, -0.6038560908479259),
    (-1.6, -0.976348383344644),
];
const ERF_INV: &[(f64, f64)] = &[
    (1e-12, 8.86226925452758e-13),
    (0.001, 0.0008862271574665521),
    (0.1, 0.08885599049425769),
    (0.3, 0.2724627147267543),
    (0.5, 0.4769362762044699),
    (0.7, 0.7328690779592167),
    (0.9, 1.1630871536766743),
    (0.97, 1.5344856217777179),
    (0.99, 1.8213863677184494),
    (0.997, 2.0985076117936705),
    (0.999, 2.3267537655135246),
    (0.9999, 2.75106390571208),
    (0.99999999, 4.052237243268763),
    (0.9999999999999, 5.261483331372676),
    (-0.4, -0.37080715859355795),
    (-0.998, -2.1851242191330043),
    (0.9999999999999999, 5.8635847487551676),
];
const POW: &[(f64, f64, f64)] = &[
    (0.5, 0.5, 0.7071067811865476),
    (2.0, 1000.25, 1.2742456594525648e+301),
    (0.999, 100000.0, 3.5385276883431275e-44),
    (0.9999999, 3000000000.0, 5.148123812906238e-131),
    (1.0000001, 5000000000.0, 1.4035575382338372e+217),
    (1e-300, 0.9, 9.999999999999847e-271),
    (1e-310, -0.9, 1.0000000000000186e+279),
    (3.7, -500.0, 7.927531319896087e-285),
    (10.0, 307.5, 3.1622776601683796e+307),
    (0.3, 11.0, 1.7714699999999993e-06),
    (0.7072, 2000.0, 1.2147978371862094e-301),
    (1.4141, 2000.0, 9.1252451510273e+300),
    (1.4143, -2000.0, 8.258805756709239e-302),
    (0.01, 0.001, 0.995405417351527),
    (1e+300, 1e-10, 1.0000000690775552),
    // The hardest: m near √½ or √2, and the ends of the range.
    (1.4460051577731703, 1911.581, 1.5053130913733275e+306),
    (1.3635516641707979, 2273.513, 1.5053178788579054e+306),
    (1.4757595869653044, 1811.534, 1.5049769689932982e+306),
    (0.72022601412655, -2148.145, 1.5054853088871107e+306),
    (1.4197874942560536, -1997.106, 9.859192422421431e-305),
    (1.3616808369296605, 2283.624, 1.5053290057575006e+306),
    (1.4481483637228636, 1903.935, 1.5052525375765415e+306),
    (0.7388222750565949, 2312.537, 9.859191937573172e-305),
    (1.4718939336812427, 1823.826, 1.505059076326243e+306),
    (1.4634937484143153, 1851.236, 1.5049968292563975e+306),
    (0.7263634588094225, -2205.16, 1.505469049619924e+306),
    (1.3963830259852084, -2096.528, 9.860017670786637e-305),
    (1.4855687996244265, 1781.213, 1.505344463188195e+306),
    (1.3634395632812715, -2257.987, 9.860669395542236e-305),
    (0.718485830586102, -2132.426, 1.5050361884063426e+306),
    (1.4244912063642374, -1978.437, 9.85871841008556e-305),
    (1.3917815302799472, -2117.461, 9.859637483671368e-305),
    (1.4208963893932538, -1992.667, 9.86095082051285e-305),
    (1.4126514332705, -2026.235, 9.858310827237915e-305),
    (1.4131098362418533, -2024.333, 9.86121786194458e-305),
    (1.453757105534894, 1884.264, 1.5050262901448114e+306),
    (1.462228673014719, 1855.45, 1.5053259963011278e+306),
    (1.3990408698662122, 2099.546, 1.5053462615860312e+306),
    (0.7392717519795152, -2333.744, 1.505278198508607e+306),
];
