//! In an engine that thinks in `glam`: its vectors become the kernel's by their three numbers, whatever version of glam that is.
//!
//! ```text
//! cargo run --package gonio-kernel --example glam
//! ```

use glam::Vec3;
use gonio_kernel::lobe::{RoughDielectric, TwoSided};
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::{Closure, Frame, Transport, closure::Unguarded};

/// The engine's vector as the kernel's.
fn kernel(v: Vec3) -> gonio_kernel::Vec3<f32> {
    v.to_array().into()
}

/// The kernel's vector as the engine's.
fn engine(v: gonio_kernel::Vec3<f32>) -> Vec3 {
    <[f32; 3]>::from(v).into()
}

fn main() {
    // A pane of ground glass, seen from within.
    let glass = RoughDielectric::new(Ggx::isotropic(0.1_f32), 1.5);
    let (normal, to_viewer) = (Vec3::Y, Vec3::new(0.3, -0.9, 0.1).normalize());
    let frame = Frame::from_normal(kernel(normal));

    let closure = Closure::new(glass, frame.to_local(kernel(to_viewer)));
    let sample = closure.sample([0.9, 0.4, 0.2]);
    let wi = engine(frame.to_world(sample.wi));
    let what = if sample.event.transmitted { "refracted" } else { "reflected" };
    println!("light {what} towards the viewer comes from {wi}");

    // A lobe can be used without the guard, and on both sides.
    let paper = TwoSided(gonio_kernel::lobe::Lambert::new(gonio_kernel::Rgb::splat(0.8_f32)));
    let paper = Unguarded::new(paper, frame.to_local(kernel(to_viewer)), Transport::Radiance);
    let value = paper.eval(frame.to_local(kernel(-normal)));
    println!("paper from behind: {:.4}", value.f_cos.g);
}
