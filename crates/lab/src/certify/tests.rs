//! Certificates of lobes of every kind, of lawless ones, and of a user's own model.

use super::*;
use crate::effort::Effort;
use gonio_kernel::energy::Compensation;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{
    Conductor, Dielectric, Eon, EonAlbedo, Lambert, Mirror, Phong, PhongNormalization, RoughDielectric, SmoothConductor,
};
use gonio_kernel::metal::Metal;
use gonio_kernel::microfacet::{Beckmann, Ggx};
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use gonio_kernel::{Event, Real, Rgb, Sample, Surface, Transport, Value, Vec3};

fn quick<'t>(lobe: &impl TestBsdf<'t>) -> Certificate {
    certify("it", lobe, &Options::new(Effort::Quick))
}

#[test]
fn surfaces_of_every_kind_get_their_certificate() {
    let ggx = Ggx { alpha_x: 0.2_f32, alpha_y: 0.1 };
    let beckmann = Beckmann { alpha_x: 0.3_f32, alpha_y: 0.3 };
    let f0 = Rgb::new(0.9_f32, 0.6, 0.3);
    let gold = Fresnel::Conductor { eta: Rgb::new(0.143, 0.375, 1.442), k: Rgb::new(3.983, 2.386, 1.603) };
    let matte = Lambert::new(Rgb::new(0.8, 0.5, 0.2));
    let phong = Phong {
        diffuse: f0 * 0.5,
        glossy: f0 * 0.5,
        exponent: 50.0,
        normalization: PhongNormalization::LafortuneWillems,
    };
    let surfaces = [
        Surface::of(matte),
        Surface::of(Conductor::new(ggx, gold)),
        Surface::of(Conductor::new(beckmann, Fresnel::Schlick { f0 })),
        Surface::of(Conductor::new(ggx, Fresnel::Schlick { f0 }).with_compensation(Compensation::Turquin)),
        Surface::of(Conductor::new(ggx, Fresnel::Schlick { f0 }).with_compensation(Compensation::KullaConty)),
        Surface::of(SmoothConductor::new(Metal::Gold.into())),
        Surface::of(Dielectric::new(1.5)),
        Surface::of(RoughDielectric::new(ggx, 1.5)),
        Surface::of(phong),
        Surface::of(Eon { directional: EonAlbedo::Fitted, ..Eon::new(f0, 0.7) }),
        Surface::black().with(0.5, Conductor::new(ggx, gold)).unwrap().with(0.5, matte).unwrap(),
    ];
    for surface in surfaces {
        let certificate = quick(&surface);
        assert!(certificate.holds(), "{surface:?}\n{certificate}");
        for range in &certificate.ranges {
            let [from, to] = range.domain;
            assert!(range.safe.is_some_and(|[lo, hi]| lo <= from && to <= hi), "{range:?}");
        }
    }
}

/// A diffuse lobe that breaks a law, and says so or not.
struct Lawless {
    lopsided: bool,
    gain: f32,
    claims: Properties<f32>,
}

impl Lobe<f32> for Lawless {
    type Prepared = ();
    fn prepare(&self, _wo: Vec3<f32>, _transport: Transport) {}
    fn eval(&self, wo: Vec3<f32>, _: &(), wi: Vec3<f32>) -> Value<f32> {
        let matte = Lambert::new(Rgb::splat(self.gain));
        let value = Lobe::eval(&matte, wo, &(), wi);
        let factor = if self.lopsided { 1.0 - 0.5 * wo.z } else { 1.0 };
        Value { f_cos: value.f_cos * factor, ..value }
    }
    fn sample(&self, wo: Vec3<f32>, _: &(), u: [f32; 3]) -> Sample<f32> {
        let sample = Lobe::sample(&Lambert::new(Rgb::splat(1.0_f32)), wo, &(), u);
        Sample { event: Event::reflected(sample.event.failed), ..sample }
    }
    fn delta(&self, _: Vec3<f32>, _: &(), _: &Sample<f32>) -> Value<f32> {
        Value::zero()
    }
    fn albedo_estimate(&self, _wo: Vec3<f32>) -> Rgb<f32> {
        Rgb::splat(self.gain)
    }
    fn domain(&self) -> bool {
        true
    }
    fn properties(&self) -> Properties<f32> {
        self.claims
    }
}

#[test]
fn a_law_is_broken_exactly_where_a_model_says_so() {
    let lawful = Properties::LAWFUL;
    for (lopsided, gain) in [(false, 0.9_f32), (true, 0.9), (false, 1.1)] {
        for reciprocal in [true, false] {
            for conserving in [true, false] {
                let lobe = Lawless { lopsided, gain, claims: Properties { reciprocal, conserving, ..lawful } };
                let certificate = certify_single("it", &lobe, &Options::new(Effort::Quick));
                let failed: Vec<&str> =
                    certificate.checks.iter().filter(|c| c.failed()).map(|c| &*c.instrument).collect();
                assert_eq!(failed.contains(&"reciprocity"), reciprocal == lopsided, "{certificate}");
                assert_eq!(failed.contains(&"energy"), conserving == (gain > 1.0), "{certificate}");
            }
        }
    }
    // A bound of its own forgives exactly that much.
    for (excess, holds) in [(0.11, true), (0.09, false)] {
        let lobe = Lawless { lopsided: false, gain: 1.1, claims: Properties { excess, ..lawful } };
        assert_eq!(certify_single("it", &lobe, &Options::new(Effort::Quick)).holds(), holds);
    }
}

#[test]
fn a_range_ends_where_the_formulas_do() {
    let metal = Conductor::new(Ggx { alpha_x: 0.2_f32, alpha_y: 0.2 }, Fresnel::Schlick { f0: Rgb::splat(0.5) });
    let certificate = quick(&Surface::of(metal));
    let alpha_x = certificate.ranges.iter().find(|r| r.number == "alpha_x" && r.precision == "f32").unwrap();
    assert!(alpha_x.safe.unwrap()[0] > 0.0 && alpha_x.below.is_some(), "{alpha_x:?}");
    let f0 = certificate.ranges.iter().find(|r| r.number == "f0.r" && r.precision == "f32").unwrap();
    assert!(f0.safe.unwrap()[0] > -1.0, "a negative reflectance is negative light: {f0:?}");
}

gonio_kernel::model! {
    /// A user's own model: reflects more of the light the steeper it leaves.
    struct Dusty<R> = "dusty" {
        /// What is reflected along the normal.
        base_color: Rgb<R> = 0.8 in gonio_kernel::model::REFLECTANCE,
        /// How much less at grazing: 0 is Lambert's law.
        dust: R = 0.5 in gonio_kernel::model::WEIGHT,
    }
}

impl<R: Real> Lobe<R> for Dusty<R> {
    type Prepared = ();
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}
    fn eval(&self, wo: Vec3<R>, _: &(), wi: Vec3<R>) -> Value<R> {
        let pdf = pdf_cosine_hemisphere(wi);
        let fall = (R::ONE - self.dust) + self.dust * wo.z * wi.z;
        Value { f_cos: self.base_color * (pdf * fall), pdf }.or_zero(gonio_kernel::frame::both_above(wo, wi))
    }
    fn sample(&self, wo: Vec3<R>, _: &(), u: [R; 3]) -> Sample<R> {
        let wi = sample_cosine_hemisphere([u[1], u[2]]);
        Sample { wi, event: Event::reflected(!gonio_kernel::frame::both_above(wo, wi)) }
    }
    fn delta(&self, _: Vec3<R>, _: &(), _: &Sample<R>) -> Value<R> {
        Value::zero()
    }
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.base_color
    }
    fn domain(&self) -> R::Mask {
        gonio_kernel::Parameters::in_domain(self)
    }
}

#[test]
fn a_users_own_model_and_mixtures_of_it_are_measured_in_every_arithmetic() {
    let dusty = Dusty { base_color: Rgb::new(0.8_f32, 0.5, 0.2), dust: 0.5 };
    let half = Rgb::splat(0.5);
    let mixed = dusty.times(half).plus(Mirror::new(Rgb::splat(1.0_f32)).times(half));
    for certificate in [quick(&dusty), quick(&mixed)] {
        assert!(certificate.holds(), "{certificate}");
        assert!(certificate.ranges.iter().any(|range| range.number == "dust" && range.precision == "f64"));
        assert!(certificate.checks.iter().any(|check| check.instrument == "precision"));
        assert!(certificate.speeds.iter().any(|speed| speed.arithmetic == "lanes"));
    }
}
