//! `Weighted`: a lobe times a colour.

use super::combined::Weighted;
use super::{Lobe, Properties, Sample, Transport, Value};
use crate::energy::AlbedoCurve;
use crate::model::{Entry, Parameter, Parameters, Source, WEIGHT};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

impl<R: Real, L: Lobe<R>> Lobe<R> for Weighted<R, L> {
    type Prepared = L::Prepared;
    const LOBES: u32 = L::LOBES;

    #[inline(always)]
    fn prepare(&self, wo: Vec3<R>, transport: Transport) -> Self::Prepared {
        self.lobe.prepare(wo, transport)
    }
    #[inline(always)]
    fn eval(&self, wo: Vec3<R>, prepared: &Self::Prepared, wi: Vec3<R>) -> Value<R> {
        self.lobe.eval(wo, prepared, wi).times(self.weight)
    }
    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, prepared: &Self::Prepared, u: [R; 3]) -> Sample<R> {
        self.lobe.sample(wo, prepared, u)
    }
    #[inline(always)]
    fn delta(&self, wo: Vec3<R>, prepared: &Self::Prepared, sample: &Sample<R>) -> Value<R> {
        self.lobe.delta(wo, prepared, sample).times(self.weight)
    }
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.lobe.albedo_estimate(wo) * self.weight
    }
    #[inline(always)]
    fn domain(&self) -> R::Mask {
        self.weight.within(0.0, 1.0) & self.lobe.domain()
    }
    #[inline(always)]
    fn properties(&self) -> Properties<R> {
        let properties = self.lobe.properties();
        Properties { albedo: properties.albedo.map(|albedo| albedo * self.weight), ..properties }
    }
    #[inline(always)]
    fn largest_weight(&self, wo: Vec3<R>) -> R {
        self.lobe.largest_weight(wo) * self.weight.largest()
    }
    #[inline(always)]
    fn radiance_scale(&self, wo: Vec3<R>) -> R {
        self.lobe.radiance_scale(wo)
    }
    #[inline(always)]
    fn is_lambertian(&self) -> bool {
        self.lobe.is_lambertian()
    }
}

impl<R: Real, L: Parameters<Real = R>> Parameters for Weighted<R, L> {
    type Real = R;
    type Of<S: Real> = Weighted<S, L::Of<S>>;
    const ENTRIES: &'static [Entry] = &[Entry::Parameter(WEIGHT_KEY)];

    #[inline(always)]
    fn map<S: Real>(&self, f: &mut impl FnMut(&'static Parameter, usize, R) -> S) -> Weighted<S, L::Of<S>> {
        let Rgb { r, g, b } = self.weight;
        let weight =
            Rgb::new(f(const { &WEIGHT_KEY }, 0, r), f(const { &WEIGHT_KEY }, 1, g), f(const { &WEIGHT_KEY }, 2, b));
        Weighted { weight, lobe: self.lobe.map(f) }
    }
    #[cfg(feature = "wide")]
    #[inline(always)]
    fn gather(lanes: [&Weighted<f32, L::Of<f32>>; 8]) -> Weighted<crate::F32x8, L::Of<crate::F32x8>> {
        let weight = Rgb::from_lanes(|i| lanes[i & 7].weight);
        Weighted { weight, lobe: L::gather(crate::each_lane(|i| &lanes[i & 7].lobe)) }
    }
    #[inline(always)]
    fn same_code(&self, other: &Self) -> bool {
        self.lobe.same_code(&other.lobe)
    }
    fn each_choice(&self, visit: &mut dyn FnMut(&'static str)) {
        self.lobe.each_choice(visit);
    }
    #[inline(always)]
    fn in_domain(&self) -> R::Mask {
        self.weight.within(0.0, 1.0) & self.lobe.in_domain()
    }
    #[inline(always)]
    fn albedo_curve(&self) -> Option<AlbedoCurve<R>> {
        self.lobe.albedo_curve().map(|curve| curve.scaled(self.weight))
    }
    fn read<S: Source<R>>(source: &mut S) -> Result<Self, S::Error> {
        let weight = crate::model::read_color(source, const { &WEIGHT_KEY })?;
        Ok(Self { weight, lobe: L::read(source)? })
    }
}

const WEIGHT_KEY: Parameter = Parameter::declared("weight", true, WEIGHT, Some(1.0), " Factor on the lobe's light.");
