//! A scene in memory, with a lobe of one's own under a spot light: rendered with progress, stopped early, and read.

use glam::{DAffine3, DVec3};
use gonio_accel::Intersect;
use gonio_kernel::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};
use gonio_kernel::{Event, Lobe, Parameters, Real, Rgb, Sample, Transport, Value, Vec3, frame::both_above, model};
use gonio_tracer::light::SpotLight;
use gonio_tracer::scene::{FilmSettings, Material, Mesh, SceneBuilder};
use gonio_tracer::{Backend, CustomLobe, Prepared, RenderSettings, World, render};
use std::ops::ControlFlow;

model! {
    /// f = c/π, by hand.
    pub struct Chalk<R> = "my-chalk" {
        /// What it returns.
        color: Rgb<R> = 0.5 in model::REFLECTANCE,
    }
}

impl<R: Real> Lobe<R> for Chalk<R> {
    type Prepared = ();
    fn prepare(&self, _wo: Vec3<R>, _transport: Transport) {}
    fn eval(&self, wo: Vec3<R>, _: &(), wi: Vec3<R>) -> Value<R> {
        let pdf = pdf_cosine_hemisphere(wi);
        Value { f_cos: self.color * pdf, pdf }.or_zero(both_above(wo, wi))
    }
    fn sample(&self, wo: Vec3<R>, _: &(), u: [R; 3]) -> Sample<R> {
        let wi = sample_cosine_hemisphere([u[1], u[2]]);
        Sample { wi, event: Event::reflected(!both_above(wo, wi)) }
    }
    fn delta(&self, _: Vec3<R>, _: &(), _: &Sample<R>) -> Value<R> {
        Value::zero()
    }
    fn albedo_estimate(&self, _wo: Vec3<R>) -> Rgb<R> {
        self.color
    }
    fn domain(&self) -> R::Mask {
        self.in_domain()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = SceneBuilder::new();
    let chalk = scene.material(Material::of_lobe("chalk", CustomLobe::new(Chalk { color: Rgb::splat(0.5_f32) })));
    let corners = [[-0.05, 0.0, -0.05], [-0.05, 0.0, 0.05], [0.05, 0.0, 0.05], [0.05, 0.0, -0.05]];
    let floor = scene.mesh(Mesh::of("floor", corners, [[0, 1, 2], [0, 2, 3]], chalk));
    let (position, target, intensity) = (DVec3::Y * 2.0, DVec3::ZERO, Rgb::splat(40.0));
    scene.light(SpotLight { position, target, intensity, cutoff_angle: 30.0, beam_width: 20.0 });
    scene.film(FilmSettings { width: 16, height: 16, spp: 1 << 16, exposure: 0.0 }).place(floor, DAffine3::IDENTITY);
    let scene = scene.build()?;
    let prepared = Prepared::new(World::new(&scene)?, Backend::Obvhs, Intersect::Robust)?;
    let rendering = render(&prepared, &RenderSettings::of(&scene), &mut |pass| {
        println!("{} of {} samples per pixel", pass.progress.spp_done, pass.progress.spp);
        if pass.progress.spp_done >= 8 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let radiance = rendering.picture.rgb[8 * 16 + 8][0];
    assert!((radiance - 0.5 * 10.0 / std::f32::consts::PI).abs() < 1e-2, "{radiance}"); // L = c/π · I/h²
    Ok(())
}
