//! Curves of GGX: the fits, summed at the nodes, and the margins by which they err upwards.

use super::{ALBEDO, ALPHA_SMOOTH, AlbedoCurve, Grid, IN_ETA, NODES, Node, chebyshev, dot, fifth, interpolate};
use crate::fresnel;
use crate::real::Real;
use crate::rgb::Rgb;

/// The least index that differs from 1.
const ETA_LEAST: f64 = 1.02;

/// What 1 − E_white of width alpha in \[1e-8, 1\] is about in proportion to: 4µα²(1 + 12α²)/((µ + α)(µ + 4α)²).
#[inline(always)]
pub fn missing_factor<R: Real>(cos: R, alpha: R) -> R {
    let far = R::lit(4.0).mul_add(alpha, cos);
    let alpha2 = alpha * alpha;
    R::lit(4.0) * (cos / ((cos + alpha) * (far * far))) * (alpha2 * R::lit(12.0).mul_add(alpha2, R::ONE))
}

/// Of an index in \[1.02, 3\]: T_j of g = √((η − 1)/(η + 1)), stretched from where η is 1.1 and 3, and a ramp below 1.1.
#[inline(always)]
pub fn eta_basis<R: Real>(eta: R) -> [R; IN_ETA] {
    let least = 0.218_217_890_235_992_4; // of 1.1
    let g = ((eta - R::ONE) / (eta + R::ONE)).sqrt();
    let stretched = (g.max(R::lit(least)) - R::lit(least)) * R::lit(2.0 / (core::f64::consts::FRAC_1_SQRT_2 - least));
    let [t0, t1, t2, t3, t4] = chebyshev(stretched - R::ONE);
    [t0, t1, t2, t3, t4, (-g).mul_add(R::lit(1.0 / least), R::ONE).max(R::ZERO)]
}

/// What depends on α alone.
struct OfAlpha<R> {
    /// Not below [`ALPHA_SMOOTH`].
    alpha: R,
    /// 1, or (α/[`ALPHA_SMOOTH`])².
    rough: R,
    grid: Grid<R>,
    /// The margin everywhere.
    margin: R,
    /// The margin at grazing, and that in proportion to E there.
    at_grazing: [R; 2],
}

impl<R: Real> OfAlpha<R> {
    #[inline(always)]
    fn new(alpha: R) -> Self {
        let alpha_true = alpha.clamp(0.0, 1.0);
        let alpha = alpha_true.max(R::lit(ALPHA_SMOOTH));
        let part = alpha_true.min(R::lit(ALPHA_SMOOTH)) * R::lit(1.0 / ALPHA_SMOOTH);
        let wide = (alpha * R::lit(1.0 / 0.03)).sqr().sqr();
        let narrow = part * R::lit(ALPHA_SMOOTH) / alpha;
        Self {
            alpha,
            rough: part * part,
            grid: Grid::new(alpha),
            margin: R::lit(9e-4).mul_add((wide + R::ONE).recip(), R::lit(3e-4)),
            at_grazing: [R::lit(7.5e-3) * narrow.sqr(), R::lit(1.3e-3) * alpha_true],
        }
    }

    /// E_white at the node.
    #[inline(always)]
    fn white(&self, node: &Node, cos: R) -> R {
        (-self.rough * missing_factor(cos, self.alpha)).mul_add(dot(&node.missing, &self.grid.powers), R::ONE)
    }
    /// c̄ for q.
    #[inline(always)]
    fn mean_cosine(&self, cos: R, q: R) -> R {
        (self.rough * self.alpha.sqr()).mul_add(q, cos * cos).clamp(0.0, 1.0).sqrt()
    }
    /// E with its margin, of what is left after (1 − µ)⁵ `taken`.
    #[inline(always)]
    fn raised(&self, node: &Node, e: R, taken: R) -> R {
        let low = R::lit(0.5 - 0.5 * node.x);
        let low8 = low.sqr().sqr().sqr();
        let [constant, relative] = self.at_grazing;
        e - taken + low8.mul_add(relative.mul_add(e, constant), self.margin)
    }
}

impl<R: Real> AlbedoCurve<R> {
    /// Of GGX with height-correlated masking and the reflectance of a dielectric, single scattering: alpha in \[0, 1\] (0 is a
    /// smooth interface), eta in \[1, 3\]. For other indices it is 1: nothing is known to shine through.
    ///
    /// E_fit − E_true lies in \[0, 7e-4\] for α ≥ 0.09, \[6e-4, 2.6e-3\] for α in \[0.0025, 0.02\], \[7e-4, 1.8e-3\] for α = 0, at
    /// cosines from 0.02 on and η from 1.1; below 0.02 it reaches 1.4e-2 (α = 0.0025; 4e-3 from 0.005 on), and 0.11 for α
    /// between 0 and 0.0025, whose boundary layer the curve does not show. For η in \[1.02, 1.1\] it reaches 5e-3. Nearer to 1 it
    /// is an upper bound that goes to 0, but slowly at grazing: 0.1 too much for 1.01, 0.26 for 1.003, 0.45 for 1.0005 (α = 0,
    /// µ = 0.02). 1 itself reflects nothing.
    #[inline(never)]
    pub fn dielectric(alpha: R, eta: R) -> Self {
        let of = OfAlpha::new(alpha);
        let matched = eta.same(R::ONE);
        let known = eta.ge(R::ONE) & eta.le(R::lit(3.0));
        let eta = eta.clamp(1.0, 3.0);
        let basis = eta_basis(eta.max(R::lit(ETA_LEAST)));
        // Nearer to 1 reflection concentrates at grazing, in a layer of width b = √(η² − 1): of many facets few lie within,
        // E is as b, and F as (b/c)⁴, so that c̄ falls no faster than b to the power of 3/4.
        let layer = (eta - R::ONE) * (eta + R::ONE) * R::lit(1.0 / ((ETA_LEAST - 1.0) * (ETA_LEAST + 1.0)));
        let layer = layer.min(R::ONE).sqrt().sqrt();
        let nearer = layer * layer.sqrt();
        let [.., ramp] = basis;
        let [t0, t1, t2, t3, t4, t5, t6, t7, ..] = of.grid.powers;
        let powers = [t0, t1, t2, t3, t4, t5, t6, t7];
        // Between 1 and 1.1 the curve is steep at grazing and flat beyond, and waves more.
        let near = (R::ONE - ramp) * ramp * R::lit(0.002);
        let values = ALBEDO.each_ref().map(|node| {
            let cos = of.grid.stretch.cos(R::lit(node.x));
            let mut q = R::ZERO;
            for (row, &b) in node.dielectric.iter().zip(&basis) {
                q = dot(row, &powers).mul_add(b, q);
            }
            let f = fresnel::dielectric(of.mean_cosine(cos, q) * nearer, eta);
            let e = (of.raised(node, of.white(node, cos) * f, R::ZERO) + near).or_zero(!matched);
            R::select(known, e, R::ONE)
        });
        Self {
            stretch: of.grid.stretch,
            base: interpolate(&values),
            extra: [R::ZERO; NODES],
            grazing: [R::ZERO; 2],
            avg: Rgb::splat(of.grid.avg(&values)).map(|e| e.clamp(0.0, 1.0)),
            tint: [R::ZERO; 2],
            scale: Rgb::splat(R::ONE),
        }
    }

    /// The same with [`fresnel::schlick`] through f0, which is linear in it: E = f0 E_white + (1 − f0) E_5, f0 in \[0, 1\].
    ///
    /// E_fit − E_true lies in \[0, 8.1e-4\] for α ≥ 0.09, \[0, 2.5e-3\] for α in {0} and \[0.0025, 0.09\] and cosines
    /// from 0.02 on; below, as with dielectrics. From f0 = 0.99 on the margin is a good part of 1 − E_avg, and what
    /// T(wo) T(wi)/T_avg leaves of a base is darker than that: all of T is lost for f0 = 1.
    #[inline(never)]
    pub fn schlick(alpha: R, f0: Rgb<R>) -> Self {
        let of = OfAlpha::new(alpha);
        let white = ALBEDO.each_ref().map(|node| of.white(node, of.grid.stretch.cos(R::lit(node.x))));
        let mut rest = white.iter();
        let five = ALBEDO.each_ref().map(|node| {
            let cos = of.grid.stretch.cos(R::lit(node.x));
            let e_white = rest.next().copied().unwrap_or(R::ZERO);
            let f = fifth(of.mean_cosine(cos, dot(&node.schlick, &of.grid.powers)));
            of.raised(node, e_white * f, fifth(cos))
        });
        let mut rest = white.iter();
        let white = ALBEDO.each_ref().map(|node| of.raised(node, rest.next().copied().unwrap_or(R::ZERO), R::ZERO));
        let f0 = f0.map(|x| x.clamp(0.0, 1.0));
        // Of a smooth surface E_5 is (1 − µ)⁵, and else near it.
        Self::affine(&of.grid, &five, &white, f0, [R::ONE, R::ZERO])
    }
}
