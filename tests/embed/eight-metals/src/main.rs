//! Eight hits, eight metals, one call: an engine that thinks in glam shades with the kernel.

use glam::Vec3;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::Conductor;
use gonio_kernel::metal::Metal;
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::{Closure, F32x8, Frame, Parameters, Roughness, Vec3 as Lanes};

/// What the engine knows of a hit.
struct Hit {
    normal: Vec3,
    to_viewer: Vec3,
    metal: Metal,
    roughness: f32,
}

fn main() {
    let metals = [Metal::Silver, Metal::Aluminium, Metal::Gold, Metal::Copper];
    let hits: [Hit; 8] = std::array::from_fn(|i| Hit {
        normal: Vec3::new(0.1 * i as f32, 1.0, 0.3).normalize(),
        to_viewer: Vec3::new(0.5, 0.7, -0.2).normalize(),
        metal: metals[i % 4],
        roughness: 0.1 + 0.1 * i as f32,
    });
    let to_lamp = Vec3::new(-0.3, 0.8, 0.5).normalize();

    // One metal after the other, then side by side.
    let each = hits.each_ref().map(|hit| Conductor::new(Ggx::isotropic(Roughness(hit.roughness)), Fresnel::from(hit.metal)));
    let all = Conductor::<f32>::gather(each.each_ref());
    let frame = Frame::from_normal(Lanes::from_lanes(|i| hits[i].normal.into()));
    let wo = frame.to_local(Lanes::from_lanes(|i| hits[i].to_viewer.into()));
    let wi = frame.to_local(Lanes::from_lanes(|_| to_lamp.into()));

    let closure = Closure::new(all, wo);
    let value = closure.eval(wi);
    let sample = closure.sample([0.5, 0.3, 0.7].map(F32x8::splat));
    let next = frame.to_world(sample.wi);
    for i in 0..8 {
        // Lane i is the scalar result, to the bit.
        let alone = Closure::new(each[i], wo.lane(i)).eval(wi.lane(i));
        assert_eq!(alone.f_cos.g.to_bits(), value.f_cos.g.lane(i).to_bits());
        let next: Vec3 = next.lane(i).into();
        println!("{:?}: {:.4} from the lamp; goes on along {next:.3}", hits[i].metal, value.f_cos.g.lane(i));
    }
}
