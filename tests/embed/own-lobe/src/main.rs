//! A scattering model of one's own, over chalk, with a certificate: in f32, f64 and eight lanes from one source.

use gonio_kernel::energy::AlbedoCurve;
use gonio_kernel::frame::both_above;
use gonio_kernel::lobe::{Event, Lambert, Layer, Layering, NoCoat, Properties, Sample, Value};
use gonio_kernel::model::{Parameters, REFLECTANCE};
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use gonio_kernel::{Lobe, Real, Rgb, Transport, Vec3, model};
use gonio_lab::{Effort, Options, certify};

model! {
    /// Dust: f = 3c/π (1 − cos_o)(1 − cos_i), whose directional albedo is c (1 − cos_o).
    pub struct Dust<R> = "dust" {
        /// What it returns of grazing light.
        color: Rgb<R> = 0.6 in REFLECTANCE,
    }
    coat |dust| Some(AlbedoCurve::from_fn(|cos| R::ONE - cos).scaled(dust.color));
}

impl<R: Real> Lobe<R> for Dust<R> {
    type Prepared = ();
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}
    fn eval(&self, wo: Vec3<R>, _: &(), wi: Vec3<R>) -> Value<R> {
        let pdf = pdf_cosine_hemisphere(wi);
        let f_cos = self.color * (R::lit(3.0) * (R::ONE - wo.z) * (R::ONE - wi.z) * pdf);
        Value { f_cos: f_cos.map(|x| x.max(R::ZERO)), pdf }.or_zero(both_above(wo, wi))
    }
    fn sample(&self, wo: Vec3<R>, _: &(), u: [R; 3]) -> Sample<R> {
        let wi = sample_cosine_hemisphere([u[1], u[2]]);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }
    fn delta(&self, _: Vec3<R>, _: &(), _: &Sample<R>) -> Value<R> {
        Value::zero()
    }
    fn albedo_estimate(&self, wo: Vec3<R>) -> Rgb<R> {
        self.color * (R::ONE - wo.z).max(R::ZERO)
    }
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }
    fn properties(&self) -> Properties<R> {
        Properties::LAWFUL
    }
    fn largest_weight(&self, _wo: Vec3<R>) -> R {
        R::lit(3.0)
    }
}

fn main() -> Result<(), NoCoat> {
    let dust = Dust { color: Rgb::new(0.6_f32, 0.6, 0.5) };
    let chalk = Lambert::new(Rgb::new(0.2, 0.3, 0.7));
    let certificate = certify("dusty chalk", &Layer::new(dust, chalk, Layering::Reciprocal)?, &Options::new(Effort::Quick));
    println!("{certificate}");
    assert!(certificate.holds());
    Ok(())
}
