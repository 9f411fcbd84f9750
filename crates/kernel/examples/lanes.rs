//! Eight hits at a time: the same lines with [`F32x8`] in place of `f32`, and masks in place of `if`.
//!
//! ```text
//! cargo run --package gonio-kernel --example lanes
//! ```

use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::Conductor;
use gonio_kernel::microfacet::Beckmann;
use gonio_kernel::{Closure, F32x8, Rgb, Vec3};

fn main() {
    // Eight roughnesses side by side, from polished to sandblasted; the rest is the same in every lane.
    let alpha = F32x8::from_fn(|lane| 0.01 * 1.8_f32.powi(lane as i32));
    let f0 = Rgb::new(0.95_f32, 0.93, 0.88).map(F32x8::splat);
    let silver = Conductor::new(Beckmann::isotropic(alpha), Fresnel::Schlick { f0 });

    let wo = Vec3::broadcast(Vec3::new(0.6_f32, 0.0, 0.8));
    let closure = Closure::new(silver, wo);
    let sample = closure.sample([0.5, 0.25, 0.75].map(F32x8::splat));

    // A failed lane has weight 0 instead of a branch.
    for lane in 0..F32x8::LANES {
        let (alpha, weight) = (alpha.lane(lane), sample.weight.g.lane(lane));
        let wi = [sample.wi.x.lane(lane), sample.wi.y.lane(lane), sample.wi.z.lane(lane)];
        println!("alpha {alpha:.3}: wi {wi:.3?}, weight {weight:.4}");
    }

    // Lane i has the bits of the scalar.
    let one =
        Conductor::new(Beckmann::isotropic(alpha.lane(3)), Fresnel::Schlick { f0: Rgb::new(0.95_f32, 0.93, 0.88) });
    let alone = Closure::new(one, Vec3::new(0.6_f32, 0.0, 0.8)).sample([0.5, 0.25, 0.75]);
    assert_eq!(alone.wi.x.to_bits(), sample.wi.x.lane(3).to_bits());
}
