//! The error function erf x = 2/√π ∫₀ˣ exp(−t²) dt and its inverse.
//!
//! Below 1, erf is x times a polynomial in x². Above, it is 1 − exp(−x²)·X(x)·2/√π with the scaled complement
//! X(x) = (√π/2) exp(x²) erfc(x), which is smooth and falls like 1/(2x): one exponential serves erf and its derivative.
//! Both are minimax polynomials by Remez' algorithm with 50 digits. The inverse is that of Giles 2010,
//! "Approximating the erfinv function" (GPU Computing Gems, Jade Edition), with his coefficients.

use super::{exp_negative, ln, ln_normal, long_polynomial, polynomial};
use crate::real::{Mask, Precision, Real};

/// erf x: at most 2 ulp; ±1 of ±∞, NaN of NaN.
#[inline]
pub fn erf<R: Real>(x: R) -> R {
    let [value] = R::named(
        "erf",
        [x],
        #[inline(always)]
        |[x]| [erf_text(x)],
    );
    value
}

#[inline(always)]
fn erf_text<R: Real>(x: R) -> R {
    let ax = x.abs();
    let small = ax.mul_add(polynomial(x * x, small_coefficients::<R>()), ax);
    let large = R::ONE - erfc_and_exp(ax).0;
    R::select(ax.ge(R::ONE), large, small).copysign(x)
}

/// erfc x for x ≥ 0, with an error below an ulp of 1 however small it is, and exp(−x²), which costs nothing more.
#[inline(always)]
pub(crate) fn erfc_and_exp<R: Real>(x: R) -> (R, R) {
    let [erfc, e] = R::named(
        "erfc_and_exp",
        [x],
        #[inline(always)]
        |[x]| erfc_and_exp_text(x).into(),
    );
    (erfc, e)
}

#[inline(always)]
fn erfc_and_exp_text<R: Real>(x: R) -> (R, R) {
    let e = exp_negative(-(x * x));
    (e * R::lit(core::f64::consts::FRAC_2_SQRT_PI) * scaled_erfc(x), e)
}

/// X(x) = (√π/2) exp(x²) erfc(x) for x ≥ 0, constant from 4.5 on in `f32`, from 6.5 in `f64`, where exp(−x²) ends what it
/// can add to 1. Its error times exp(−x²) is below a third of an ulp of 1, and that of X itself below 1e-3 of X (1e-6).
#[inline(always)]
fn scaled_erfc<R: Real>(x: R) -> R {
    let last = match R::PRECISION {
        Precision::Single => 4.5,
        Precision::Double => 6.5,
    };
    long_polynomial(x.min(R::lit(last)) - R::ONE, scaled_coefficients::<R>())
}

/// The y with erf y = x, for |x| < 1: at most 6 ulp in `f32`, 4 in `f64`.
#[inline]
pub fn erf_inv<R: Real>(x: R) -> R {
    let [value] = R::named(
        "erf_inv",
        [x],
        #[inline(always)]
        |[x]| [erf_inv_text(x)],
    );
    value
}

#[inline(always)]
fn erf_inv_text<R: Real>(x: R) -> R {
    x * erf_inv_over(-ln((R::ONE - x) * (R::ONE + x)))
}

/// [`erf_inv`] of x in \[−1, 1\], with 1 − x² not below ε/4, half of what it is at the last number below 1: always finite.
#[inline(always)]
pub(crate) fn erf_inv_within<R: Real>(x: R) -> R {
    x * erf_inv_over(-ln_normal(((R::ONE - x) * (R::ONE + x)).max(R::EPSILON * R::lit(0.25))))
}

/// erf⁻¹(x)/x from w = −ln(1 − x²). Beyond the first piece, which holds all but 0.4 % of \[−1, 1\], only if some lane is there.
#[inline(always)]
pub(crate) fn erf_inv_over<R: Real>(w: R) -> R {
    let [value] = R::named(
        "erf_inv_over",
        [w],
        #[inline(always)]
        |[w]| [erf_inv_over_text(w)],
    );
    value
}

#[inline(always)]
fn erf_inv_over_text<R: Real>(w: R) -> R {
    let Some((near, far)) = inverse_pieces::<R>().split_first() else { return R::ZERO };
    let mut ratio = long_polynomial(w - R::lit(near.middle), near.coefficients);
    for piece in far {
        let beyond = w.ge(R::lit(piece.from));
        if beyond.any() {
            let value = long_polynomial(w.max(R::ZERO).sqrt() - R::lit(piece.middle), piece.coefficients);
            ratio = R::select(beyond, value, ratio);
        }
    }
    ratio
}

/// A polynomial for w from `from` on, in w − middle for the first piece, in √w − middle for the others.
struct Piece {
    from: f64,
    middle: f64,
    coefficients: &'static [f64],
}

/// erf(x)/x − 1 as a polynomial in x², |x| ≤ 1.
#[inline(always)]
fn small_coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[
            7.853_844_045_9e-05,
            -8.010_189_247_27e-4,
            5.188_327_319_52e-3,
            -2.685_381_184_64e-2,
            0.112_835_851_507,
            -0.376_126_258_251,
            0.128_379_165_727,
        ],
        Precision::Double => &[
            5.945_257_693_941_542e-11,
            -1.136_566_313_662_849_3e-09,
            1.465_787_898_988_887_9e-08,
            -1.635_002_507_622_388_2e-07,
            1.646_097_280_119_071_7e-06,
            -1.492_559_350_576_636_4e-05,
            1.205_533_103_684_666_8e-4,
            -8.548_326_978_740_568e-4,
            5.223_977_624_780_835e-3,
            -2.686_617_064_507_289_3e-2,
            0.112_837_916_709_548_57,
            -0.376_126_389_031_837_5,
            0.128_379_167_095_512_6,
        ],
    }
}

/// (√π/2) exp(x²) erfc(x) as a polynomial in x − 1.
#[inline(always)]
fn scaled_coefficients<R: Real>() -> &'static [f64] {
    match R::PRECISION {
        Precision::Single => &[
            -5.565_145_790_36e-07,
            7.687_782_554_57e-06,
            -4.400_278_934_19e-05,
            1.437_637_296_57e-4,
            -3.532_228_520_61e-4,
            8.947_732_660_91e-4,
            -2.425_150_860_4e-3,
            6.203_561_834_12e-3,
            -1.478_316_242_12e-2,
            3.328_742_430_57e-2,
            -7.020_993_064_61e-2,
            0.136_809_685_515,
            -0.242_127_943_156,
            0.378_936_048_984,
        ],
        Precision::Double => &[
            -1.460_024_568_649_197_1e-18,
            7.387_489_786_025_983e-17,
            -1.720_576_364_282_687_7e-15,
            2.451_938_115_561_431_5e-14,
            -2.402_348_521_300_095_7e-13,
            1.731_199_860_601_357_8e-12,
            -9.665_840_610_882_262e-12,
            4.413_142_825_390_816_6e-11,
            -1.759_307_046_795_973_5e-10,
            6.573_185_539_093_417e-10,
            -2.417_642_750_788_796_5e-09,
            8.841_819_194_459_279e-09,
            -3.181_034_724_006_496_6e-08,
            1.117_117_068_331_820_7e-07,
            -3.824_218_677_410_241e-07,
            1.275_882_821_117_817_6e-06,
            -4.143_492_182_897_005e-06,
            1.307_463_194_957_361_2e-05,
            -4.000_779_028_013_89e-05,
            1.184_557_498_675_302e-4,
            -3.384_983_750_602_617e-4,
            9.307_770_119_421_36e-4,
            -2.454_019_765_444_381e-3,
            6.177_127_848_844_085e-3,
            -1.476_619_701_589_025_4e-2,
            3.329_758_055_688_581_5e-2,
            -7.021_307_309_784_36e-2,
            0.136_808_234_211_974_97,
            -0.242_127_843_858_687_2,
            0.378_936_078_070_656_05,
        ],
    }
}

/// erf⁻¹(x)/x as polynomials in w or √w about the middle of their interval, near 0 first (Giles 2010).
#[inline(always)]
fn inverse_pieces<R: Real>() -> &'static [Piece] {
    match R::PRECISION {
        Precision::Single => &[
            Piece {
                from: 0.0,
                middle: 2.5,
                coefficients: &[
                    2.810_226_36e-08,
                    3.432_739_39e-07,
                    -3.523_387_7e-06,
                    -4.391_506_54e-06,
                    2.185_808_7e-4,
                    -1.253_725_03e-3,
                    -4.177_681_64e-3,
                    0.246_640_727,
                    1.501_409_41,
                ],
            },
            Piece {
                from: 5.0,
                middle: 3.0,
                coefficients: &[
                    -2.002_142_57e-4,
                    1.009_505_58e-4,
                    1.349_343_22e-3,
                    -3.673_428_44e-3,
                    5.739_507_73e-3,
                    -7.622_461_3e-3,
                    9.438_870_47e-3,
                    1.001_674_06,
                    2.832_976_82,
                ],
            },
        ],
        Precision::Double => &[
            Piece {
                from: 0.0,
                middle: 3.125,
                coefficients: &[
                    -3.644_412_064_017_82e-21,
                    -1.685_059_138_182_016_6e-19,
                    1.285_848_071_525_64e-18,
                    1.115_787_767_802_518_1e-17,
                    -1.333_171_662_854_621e-16,
                    2.097_276_787_596_856_2e-17,
                    6.637_638_134_358_324e-15,
                    -4.054_566_272_975_207e-14,
                    -8.151_934_197_605_472e-14,
                    2.633_509_315_308_232_3e-12,
                    -1.297_513_325_345_353_2e-11,
                    -5.415_412_054_294_628e-11,
                    1.051_212_273_321_532_3e-09,
                    -4.112_633_980_346_984e-09,
                    -2.907_036_995_788_200_5e-08,
                    4.234_787_782_793_240_4e-07,
                    -1.365_469_200_083_467_9e-06,
                    -1.388_252_336_278_646_9e-05,
                    1.867_342_080_340_571_4e-4,
                    -7.407_025_341_662_67e-4,
                    -6.033_670_871_430_149e-3,
                    0.240_158_182_425_589_62,
                    1.653_654_562_683_102_7,
                ],
            },
            Piece {
                from: 6.25,
                middle: 3.25,
                coefficients: &[
                    2.213_737_692_177_578_7e-09,
                    9.075_656_193_888_539e-08,
                    -2.751_740_629_706_454_5e-07,
                    1.823_962_921_438_922_8e-08,
                    1.502_740_396_890_982_8e-06,
                    -4.013_867_526_981_546e-06,
                    2.923_444_908_995_544_6e-06,
                    1.247_530_448_167_177_9e-05,
                    -4.731_822_900_905_573_4e-05,
                    6.828_485_145_957_318e-05,
                    2.403_111_038_709_789_4e-05,
                    -3.550_375_203_628_475e-4,
                    9.532_893_797_373_805e-4,
                    -1.688_275_556_023_504_7e-3,
                    2.491_442_096_107_851e-3,
                    -3.751_208_507_569_241e-3,
                    5.370_914_553_590_064e-3,
                    1.005_258_967_694_159_2,
                    3.083_885_610_492_220_8,
                ],
            },
            Piece {
                from: 16.0,
                middle: 5.0,
                coefficients: &[
                    -2.710_992_061_643_857_3e-11,
                    -2.555_641_816_996_525e-10,
                    1.507_657_269_350_054_8e-09,
                    -3.789_465_440_126_737e-09,
                    7.615_701_208_078_34e-09,
                    -1.496_002_662_714_924e-08,
                    2.914_795_345_090_108e-08,
                    -6.771_199_775_845_234e-08,
                    2.290_048_222_802_665_5e-07,
                    -9.929_827_294_231_7e-07,
                    4.526_062_597_223_154e-06,
                    -1.968_177_810_553_167e-05,
                    7.599_527_703_001_776e-05,
                    -2.150_301_193_004_447_7e-4,
                    -1.387_193_183_362_312_2e-4,
                    1.010_300_464_864_534_4,
                    4.849_906_401_408_584,
                ],
            },
        ],
    }
}
