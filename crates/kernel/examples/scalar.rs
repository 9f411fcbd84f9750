//! One hit at a time, in plain `f32`: what an engine's shading loop asks of the kernel.
//!
//! ```text
//! cargo run --package gonio-kernel --example scalar
//! ```

use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{Conductor, Lambert};
use gonio_kernel::metal::Metal;
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::surface::SurfaceError;
use gonio_kernel::{Closure, Frame, Rgb, Roughness, Surface, Vec3};

fn main() -> Result<(), SurfaceError> {
    // Brushed gold over a brown ground: a quarter of it is metal.
    let gold = Conductor::new(Ggx::new(Roughness(0.2_f32), Roughness(0.5)), Fresnel::from(Metal::Gold));
    let brown = Lambert::new(Rgb::new(0.3_f32, 0.2, 0.1));
    let surface = Surface::black().with(0.25, gold)?.with(0.75, brown)?;

    // The hit: a normal, the direction in which the surface was brushed, and where the viewer is, in world space.
    let frame = Frame::from_normal_tangent(Vec3::new(0.0_f32, 1.0, 0.1), Vec3::new(1.0, 0.0, 0.0));
    let to_viewer = Vec3::new(0.6_f32, 0.8, 0.0);
    let closure = Closure::new(&surface, frame.to_local(to_viewer));

    // Light from a lamp: the value holds the cosine.
    let to_lamp = Vec3::new(-0.5_f32, 0.8, 0.2).normalize();
    let value = closure.eval(frame.to_local(to_lamp));
    println!("from the lamp: {:?} of its irradiance per sr, density {:.4}", value.f_cos, value.pdf);

    // The next direction of a path: your random numbers, each in [0, 1).
    let sample = closure.sample([0.3, 0.6, 0.1]);
    if sample.event.failed {
        println!("absorbed");
    } else {
        println!("the path goes on along {:?} with weight {:?}", frame.to_world(sample.wi), sample.weight);
    }
    Ok(())
}
