//! All that the kernel computes of numbers, in one list: what must be the same in lanes, in every build, and whatever other lanes do.

use super::{Random, special_values};
use crate::energy::{Missing, albedo_avg, facet_cosines, missing_avg, pdf_multiple, sample_multiple};
use crate::frame::tangents;
use crate::fresnel::{Fresnel, conductor, dielectric, f82, interface, refracted_cosine, schlick};
use crate::math::{atan2_turns, erf, erf_inv, exp, exp_m1, flushed_square, ln, ln_1p, pow, sin_cos_turns};
use crate::microfacet::{Beckmann, Ggx, Masking, Microfacets, pdf_visible_reflected, reflect, vis_cos_i};
use crate::real::{Mask, Real};
use crate::rgb::Rgb;
use crate::table::Table;
use crate::vec3::Vec3;
use crate::warp::{sample_cosine_hemisphere, sample_uniform_sphere};
use std::vec::Vec;

/// Triples of special values in all combinations, random bits, and ordinary numbers; a multiple of eight.
pub(crate) fn triples() -> Vec<[f32; 3]> {
    let (values, mut random) = (special_values(), Random(10));
    let each = values.iter().flat_map(|&a| values.iter().map(move |&b| (a, b)));
    let mut triples: Vec<_> = each.flat_map(|(a, b)| values.iter().map(move |&c| [a, b, c])).collect();
    triples.extend((0..4096).map(|_| [(); 3].map(|()| f32::from_bits(random.bits() as u32))));
    triples.extend((0..4096).map(|_| [(); 3].map(|()| 8.0 * random.unit() - 4.0)));
    triples.truncate(triples.len() / 8 * 8);
    triples
}

/// Every operation on reals that has a real result, in order.
pub(crate) fn reals<R: Real>([a, b, c]: [R; 3]) -> Vec<R> {
    let mask = a.lt(b);
    let (mut sum, mut product) = (a, a);
    sum += b;
    product *= b;
    let (mut difference, mut quotient) = (a, a);
    difference -= b;
    quotient /= b;
    let assigned = [difference, quotient];
    let sums = [a + b, a - b, a * b, a / b, -a, sum, product, a.mul_add(b, c), a.sqr(), a.recip()];
    let others =
        [a.sqrt(), a.abs(), a.min(b), a.max(b), a.copysign(b), a.clamp(-1.5, 0.5), a.or_zero(mask), a.negated(mask)];
    let chosen = [R::select(mask, a, c), R::select(!mask, a, c), a.round_to_int().0, R::lit(0.1), R::ZERO, R::ONE];
    let (mantissa, exponent) = a.split_exponent();
    let bits = [mantissa, exponent, a.ldexp(b.round_to_int().1)];
    let (sin, cos) = sin_cos_turns(a);
    let angles = [sin, cos, atan2_turns(a, b)];
    let functions = [exp(a), exp_m1(a), ln(a), ln_1p(a), pow(a, b), erf(a), erf_inv(a)];
    let table = Table::new(&[0.5, -3.0, f32::INFINITY, 1e-40, 7.0], 0);
    let tables = [R::from_int(a.to_int()), R::from_int(b.round_to_int().1), R::lookup(table, a.to_int())];
    let tables = tables.into_iter().chain([R::lookup(table, R::int(u32::MAX)), table.linear(a)]);
    let tables = tables.chain([R::lookup(Table::new(&[], 1), a.to_int())]);
    sums.into_iter()
        .chain(assigned)
        .chain(others)
        .chain(chosen)
        .chain(bits)
        .chain(angles)
        .chain(functions)
        .chain(tables)
        .collect()
}

/// Every operation on reals that has a truth as result, in order.
pub(crate) fn truths<R: Real>([a, b, c]: [R; 3]) -> Vec<R::Mask> {
    let (x, y) = (a.round_to_int().1, b.round_to_int().1);
    let (lt, le) = (a.lt(b), b.le(c));
    let compared = [lt, le, a.gt(b), a.ge(b), a.same(b), a.is_finite(), !lt, lt & le, lt | le, lt ^ le];
    let sum = R::int_add(x, y);
    let bits = [R::int_bit(x, 0), R::int_bit(x, 1), R::int_bit(x, 21), R::int_bit(sum, 1), R::int_bit(sum, 22)];
    let whole = bits.into_iter().chain([R::int_same(x, y), R::int_lt(x, y), R::int_same(a.to_int(), b.to_int())]);
    let chosen = [R::int_same(R::int_select(lt, x, R::int(3)), y), R::Mask::splat(true), R::Mask::splat(false)];
    compared.into_iter().chain(whole).chain(chosen).collect()
}

/// Every function of physics, in order, for parameters in and outside their domain. Half vectors are short, indices critical and
/// probabilities close to 1 often enough to enter every rare branch.
pub(crate) fn physics<R: Real>([a, b, c]: [R; 3]) -> Vec<R> {
    let (cos, one) = (a.clamp(0.0, 1.0), R::ONE);
    let (eta, k) = (Rgb::new(b, b, c.clamp(1e-4, 100.0)), Rgb::new(R::ZERO, R::ZERO, a.abs()));
    let curves = [Fresnel::Conductor { eta, k }, Fresnel::Dielectric { eta: b }, Fresnel::F82 { f0: eta, tint: k }];
    let light = interface(cos, refracted_cosine(cos, b), b);
    let smooth =
        [light.reflected, light.transmitted, dielectric(cos, c), conductor(cos, b, c), schlick(a, b), f82(a, b, c)];
    let mut results = Vec::from(smooth);
    for curve in curves {
        results.extend(<[R; 3]>::from(curve.reflectance(cos)));
    }

    let (alpha_x, alpha_y) = (b.clamp(1e-8, 1.0), c.clamp(1e-8, 1.0));
    let (wo, wi) = (sample_cosine_hemisphere([cos, b]), Vec3::new(b, c, a.abs()).normalize_or(Vec3::unit_z()));
    let u = [cos.min(R::lit(1.0 - 1e-7)), c.clamp(0.0, 1.0 - 1e-7)];
    for microfacets in [Microfacets::from(Ggx { alpha_x, alpha_y }), Beckmann { alpha_x, alpha_y }.into()] {
        for h in [wo + wi, wi * R::lit(1e-7)] {
            results.push(microfacets.d(h, h.length2()));
        }
        let (s_o, s_i) = (microfacets.smith_length(wo), microfacets.smith_length(wi));
        let reach = microfacets.reach(wo, s_o);
        let m = microfacets.sample_visible(wo, s_o, reach, u);
        results.extend([s_o, s_i, pdf_visible_reflected(a, reach)]);
        results.extend([Masking::HeightCorrelated, Masking::Separable].map(|m| vis_cos_i(m, wo.z, s_o, wi.z, s_i)));
        results.extend(<[R; 3]>::from(reflect(wo, m)));
    }

    let (lost, steep) = (Missing::of(alpha_x), cos.max(R::lit(1e-30)));
    results.extend([lost.at(steep), missing_avg(alpha_x), albedo_avg(alpha_y), pdf_multiple(alpha_x, steep)]);
    results.extend(facet_cosines(alpha_x, steep, one));
    let (x, y) = tangents(wi);
    for v in [sample_multiple(alpha_x, u), sample_uniform_sphere(u), x, y, Vec3::new(a, b, c).normalize_or(wo)] {
        results.extend(<[R; 3]>::from(v));
    }
    results.push(flushed_square(a, b));
    results
}
