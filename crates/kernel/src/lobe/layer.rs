//! `Layer`: one lobe over another. What lies above attenuates what lies below.
//!
//! With E the directional albedo of the top and T = 1 − E what enters through it, in one of two modes ([`Layering`]):
//!
//! - **Reciprocal**: $f = f_{top} + f_{base}\\,T(\omega_o)\\,T(\omega_i)/n$. Over a Lambertian base n is the cosine mean
//!   $T_{avg}$, and nothing is lost: the albedo is $E(\omega_o) + \rho\\,T(\omega_o)$. Over any other base n is the largest T, because
//!   $T_{avg}$ would return more than all light (a mirror below a coat 1.04 of it); what that loses is up to 4 % along the normal and
//!   more towards grazing. The base chooses, not the user.
//! - **Furnace-preserving**: $f = f_{top} + f_{base}\\,T(\omega_o)$. The albedo is $E(\omega_o) + \rho(\omega_o)\\,T(\omega_o)$ over any
//!   base. Not reciprocal: the adjoint albedo, ∫ over wo at fixed wi, is $E(\omega_i) + \rho\\,T_{avg}$ over Lambert and may exceed 1.
//!
//! Light that goes to and fro between base and top is not followed: its colour is that of one reflection below. This is the
//! albedo scaling of Kulla & Conty 2017 ("Revisiting Physically Based Shading at Imageworks") and of OpenPBR; the random walk on a slab
//! (`gonio_lab::slab`) says how far it is from the truth.
//!
//! **E errs upwards** ([`AlbedoCurve`]), so that no albedo exceeds 1 by more than 1e-4. Below the horizon T is 1: light that a base
//! transmits does not cross the top there.
//!
//! A part is chosen in proportion to E and to what the base returns through the top. Cost of a value beside those of both lobes: one
//! division and about ten fused operations for a colourless top.

use super::mix::{Prepared, either_scale, shares};
use super::{Lobe, Properties, Sample, Transport, Value};
use crate::energy::AlbedoCurve;
use crate::frame::both_above;
use crate::model::{Choice, Entry, Parameter, Parameters, Source};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;
use core::fmt;

crate::choice! {
    /// How what lies above attenuates what lies below.
    pub enum Layering {
        /// By both directions: reciprocal; loses light over bases that are not Lambertian.
        Reciprocal = "reciprocal",
        /// By wo alone: every view conserves; not reciprocal.
        FurnacePreserving = "furnace-preserving",
    }
}

/// The lobe cannot lie on top of others: it has no [`AlbedoCurve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoCoat;

impl fmt::Display for NoCoat {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("nothing shines through this lobe: it cannot lie on top of others")
    }
}
impl core::error::Error for NoCoat {}

/// What a top does to all that lies below it.
#[derive(Clone, Copy, Debug)]
pub struct Coat<R> {
    albedo: AlbedoCurve<R>,
    /// 1/T_avg and 1/max T.
    over: [Rgb<R>; 2],
    layering: Layering,
}

impl<R: Real> Coat<R> {
    /// A top of this albedo.
    #[inline(never)]
    pub fn new(albedo: AlbedoCurve<R>, layering: Layering) -> Self {
        let inverse = |t: R| t.recip().or_zero(t.gt(R::ZERO));
        let mean = albedo.avg().map(|e| inverse(R::ONE - e));
        Self { albedo, over: [mean, albedo.most_transmitted().map(inverse)], layering }
    }

    /// T(w), what enters or leaves through the top in the direction w, in \[0, 1\]; 1 below the horizon.
    #[inline(always)]
    pub fn transmitted(&self, w: Vec3<R>) -> Rgb<R> {
        let above = w.z.gt(R::ZERO);
        self.albedo.at(w.z.max(R::ZERO)).map(|e| R::select(above, R::ONE - e, R::ONE))
    }

    /// E(w), the albedo of the top itself; 0 below the horizon.
    #[inline(always)]
    pub fn albedo(&self, w: Vec3<R>) -> Rgb<R> {
        self.transmitted(w).map(|t| R::ONE - t)
    }

    /// What is left of a lobe below from wo to wi, with T(wo) given.
    ///
    /// Only where both directions are above does light cross the top twice, and only there is the mean divided by: what a base
    /// reflects or transmits below is left alone, and never made more.
    #[inline(always)]
    pub fn attenuation(&self, transmitted_o: Rgb<R>, wo: Vec3<R>, wi: Vec3<R>, lambertian: bool) -> Rgb<R> {
        match self.layering {
            Layering::Reciprocal => {
                let over = if lambertian { self.over[0] } else { self.over[1] };
                let over = Rgb::select(both_above(wo, wi), over, Rgb::splat(R::ONE));
                transmitted_o * self.transmitted(wi) * over
            }
            Layering::FurnacePreserving => transmitted_o,
        }
    }

    /// No [`Coat::attenuation`] from wo is greater.
    #[inline(always)]
    pub(crate) fn largest_attenuation(&self, transmitted_o: Rgb<R>, lambertian: bool) -> Rgb<R> {
        match self.layering {
            Layering::Reciprocal if lambertian => transmitted_o * self.over[0].map(|over| over.max(R::ONE)),
            _ => transmitted_o,
        }
    }

    /// What the layering leaves of a claim about both.
    #[inline(always)]
    pub(crate) fn properties(&self, both: Properties<R>) -> Properties<R> {
        let reciprocal = both.reciprocal && self.layering == Layering::Reciprocal;
        Properties { reciprocal, excess: both.excess + 1e-4, albedo: None, units: both.units.max(8.0), ..both }
    }

    /// How it attenuates.
    pub fn layering(&self) -> Layering {
        self.layering
    }
}

/// A top over a base.
///
/// ```
/// use gonio_kernel::{Closure, Rgb, Vec3};
/// use gonio_kernel::lobe::{Conductor, Lambert, Layer, Layering};
/// use gonio_kernel::{fresnel::Fresnel, microfacet::Ggx};
///
/// let coat = Conductor::new(Ggx::isotropic(0.1_f32), Fresnel::Dielectric { eta: 1.5 });
/// let red = Lambert::new(Rgb::new(0.8, 0.1, 0.1));
/// let plastic = Layer::new(coat, red, Layering::Reciprocal)?;
/// let value = Closure::new(&plastic, Vec3::unit_z()).eval(Vec3::new(0.6, 0.0, 0.8));
/// assert!(value.f_cos.r > value.f_cos.g);
/// # Ok::<(), gonio_kernel::lobe::NoCoat>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Layer<R, T, B> {
    top: T,
    base: B,
    coat: Coat<R>,
}

impl<R: Real, T: Parameters<Real = R>, B> Layer<R, T, B> {
    /// One lobe over another. Through a dielectric whose index is not in \[1, 3\] nothing is known to shine: its base is black.
    ///
    /// # Errors
    /// The top is a lobe that nothing shines through.
    #[inline(always)]
    pub fn new(top: T, base: B, layering: Layering) -> Result<Self, NoCoat> {
        let coat = Coat::new(top.albedo_curve().ok_or(NoCoat)?, layering);
        Ok(Self { top, base, coat })
    }

    /// With the layering of another, whose top was a coat.
    #[inline(always)]
    fn like(top: T, base: B, layering: Layering) -> Self {
        let albedo = top.albedo_curve().unwrap_or(AlbedoCurve::constant(Rgb::splat(R::ONE)));
        Self { top, base, coat: Coat::new(albedo, layering) }
    }
}

impl<R, T, B> Layer<R, T, B> {
    /// What light meets first.
    pub fn top(&self) -> &T {
        &self.top
    }
    /// What lies below.
    pub fn base(&self) -> &B {
        &self.base
    }
}

/// What a [`Layer`] prepares.
#[derive(Clone, Copy, Debug)]
pub struct Layered<R, T, B> {
    parts: Prepared<R, T, B>,
    transmitted: Rgb<R>,
}

impl<R: Real, T: Lobe<R>, B: Lobe<R>> Lobe<R> for Layer<R, T, B> {
    type Prepared = Layered<R, T::Prepared, B::Prepared>;
    const LOBES: u32 = T::LOBES + B::LOBES;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        let transmitted = self.coat.transmitted(wo);
        let p = shares(self.coat.albedo(wo), self.base.albedo_estimate(wo) * transmitted);
        let parts = Prepared { p, a: self.top.prepare(wo, transport), b: self.base.prepare(wo, transport) };
        Layered { parts, transmitted }
    }
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        let Layered { parts, transmitted } = prepared;
        let (top, base) = (self.top.eval(wo, &parts.a, wi), self.base.eval(wo, &parts.b, wi));
        let base = base.times(self.coat.attenuation(*transmitted, wo, wi, self.base.is_lambertian()));
        Value { f_cos: top.f_cos + base.f_cos, pdf: parts.pdf(top.pdf, base.pdf) }
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        prepared.parts.sample((&self.top, &self.base), wo, u)
    }
    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        let [top, base] = prepared.parts.delta((&self.top, &self.base), wo, sample);
        let base = base.times(self.coat.attenuation(prepared.transmitted, wo, sample.wi, self.base.is_lambertian()));
        Value { f_cos: top.f_cos + base.f_cos, pdf: prepared.parts.pdf(top.pdf, base.pdf) }
    }
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.coat.albedo(wo) + self.base.albedo_estimate(wo) * self.coat.transmitted(wo)
    }
    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.top.domain() & self.base.domain()
    }
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        self.coat.properties(self.top.properties().and(self.base.properties()))
    }
    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        let transmitted = self.coat.transmitted(wo);
        let p = shares(self.coat.albedo(wo), self.base.albedo_estimate(wo) * transmitted);
        let attenuation = self.coat.largest_attenuation(transmitted, self.base.is_lambertian()).largest();
        Prepared { p, a: (), b: () }
            .largest_weight(self.top.largest_weight(wo), self.base.largest_weight(wo) * attenuation)
    }
    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        either_scale(self.top.radiance_scale(wo), self.base.radiance_scale(wo))
    }
}

impl<R: Real, T: Parameters<Real = R>, B: Parameters<Real = R>> Parameters for Layer<R, T, B> {
    type Real = R;
    type Of<S: Real> = Layer<S, T::Of<S>, B::Of<S>>;
    const ENTRIES: &'static [Entry] = &[Entry::Group(T::ENTRIES), Entry::Group(B::ENTRIES)];

    #[inline(always)]
    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, R) -> S) -> Self::Of<S> {
        let top = self.top.map(f);
        Layer::like(top, self.base.map(f), self.coat.layering)
    }
    #[cfg(feature = "wide")]
    #[inline(always)]
    fn gather(lanes: [&Self::Of<f32>; 8]) -> Self::Of<crate::F32x8> {
        use crate::each_lane;
        let top = T::gather(each_lane(|i| &lanes[i & 7].top));
        Layer::like(top, B::gather(each_lane(|i| &lanes[i & 7].base)), lanes[0].coat.layering)
    }
    #[inline(always)]
    fn same_code(&self, other: &Self) -> bool {
        self.coat.layering == other.coat.layering && self.top.same_code(&other.top) && self.base.same_code(&other.base)
    }
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
        visit(self.coat.layering.word());
        self.top.each_choice(visit);
        self.base.each_choice(visit);
    }
    #[inline(always)]
    fn in_domain(&self) -> R::Mask {
        self.top.in_domain() & self.base.in_domain()
    }
    fn read<S: Source<R>>(source: &mut S) -> Result<Self, S::Error> {
        let (top, base) = (T::read(source)?, B::read(source)?);
        Ok(Self::like(top, base, Layering::Reciprocal))
    }
}
