//! The ray sets of the benchmark.

use crate::census::{Caster, Family, Specimen, bounces, shadows};
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask, Mask8};
use gonio_lab::random::{seed_for, unit};
use serde::{Serialize, Serializer};
use std::fmt;

/// Rays of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySet {
    /// Camera rays, tile by tile.
    Primary,
    /// From the primary hits, distributed by cosine.
    Bounce,
    /// From anywhere in any direction.
    Random,
    /// From the primary hits to the lights.
    Shadow,
    /// The bounces, asked only whether anything is in their way.
    AmbientOcclusion,
}

impl RaySet {
    /// What may be said of the rays.
    pub(super) fn kinds(self) -> &'static [RayKind] {
        match self {
            Self::Primary => &[RayKind::Coherent, RayKind::Incoherent],
            _ => &[RayKind::Incoherent],
        }
    }

    /// Whether any hit will do.
    pub(super) fn is_any_hit(self) -> bool {
        matches!(self, Self::Shadow | Self::AmbientOcclusion)
    }
}

impl fmt::Display for RaySet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Random => "random",
            Self::Shadow => "shadow",
            Self::AmbientOcclusion => "ambient-occlusion",
        })
    }
}

impl Serialize for RaySet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// All sets, each of about `count` rays. Those that start at hits have dead lanes where there is none.
pub(super) fn cast(specimen: &Specimen, scout: &dyn Accel, count: u64, seed: u64) -> Vec<(RaySet, Vec<Ray8>)> {
    let primary = primary(specimen, count, seed_for(seed, "primary"));
    let mut hits = vec![Hit8::miss(); primary.len()];
    scout.closest(RayKind::Coherent, &primary, &mut hits);
    let bounce = bounces(specimen, &primary, &hits, seed_for(seed, "bounce"), 0);
    let shadow = shadows(specimen, &primary, &hits, seed_for(seed, "shadow"), 0);
    let caster = Caster { specimen, scout, balls: &[], seed };
    let random = caster.packets(Family::Random, 0..count.div_ceil(8));
    let random = random.into_iter().map(|packet| Ray8 { mask: Mask8::splat(true), ..packet.ray }).collect();
    vec![
        (RaySet::Primary, primary),
        (RaySet::Bounce, bounce.clone()),
        (RaySet::Random, random),
        (RaySet::Shadow, shadow),
        (RaySet::AmbientOcclusion, bounce),
    ]
}

/// The camera's picture with about `count` pixels, one ray each: tiles of eight by four pixels, each of four blocks of four
/// by two, so that four consecutive packets are one tile.
fn primary(specimen: &Specimen, count: u64, seed: u64) -> Vec<Ray8> {
    let [width, height] = specimen.picture();
    let pixels = count as f32;
    let columns = ((pixels * width / height).sqrt() / 8.0).ceil().max(1.0);
    let rows = (pixels / (columns * 32.0)).ceil().max(1.0);
    let step = [width / (columns * 8.0), height / (rows * 4.0)];
    let mut rays = Vec::new();
    for tile in 0..(columns * rows) as u64 {
        let [left, top] = [(tile % columns as u64) as f32 * 8.0, (tile / columns as u64) as f32 * 4.0];
        for block in 0..4_u64 {
            let number = (tile * 4 + block) * 8;
            let place = |first: f32, at: fn(usize) -> usize, dimension| {
                F32x8::from_fn(|l| first + at(l) as f32 + unit(seed, number + l as u64, dimension) as f32)
            };
            let x = place(left + (block % 2 * 4) as f32, |l| l % 4, 0);
            let y = place(top + (block / 2 * 2) as f32, |l| l / 4, 1);
            rays.push(specimen.camera(x * F32x8::splat(step[0]), y * F32x8::splat(step[1])));
        }
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::census::specimens;
    use gonio_kernel::Vec3;

    #[test]
    fn primary_rays_fill_the_picture_and_a_packet_is_a_block() {
        let specimen = specimens().swap_remove(0);
        let rays = primary(&specimen, 4096, 1);
        assert!((4096 / 8..4096 / 8 + 200).contains(&rays.len()), "{}", rays.len());
        let at = |v: Vec3<F32x8>, l: usize| Vec3::new(v.x.lane(l), v.y.lane(l), v.z.lane(l));
        let middle = specimen.camera(F32x8::splat(128.0), F32x8::splat(128.0));
        let cosines = rays.iter().flat_map(|ray| (0..8).map(|l| at(ray.dir, l).dot(at(middle.dir, 0))));
        let least = cosines.fold(1.0_f32, f32::min);
        // To the corner of a square picture of 50 degrees: tan = √2·tan 25°.
        let corner = 1.0 / (1.0 + 2.0 * 25.0_f32.to_radians().tan().powi(2)).sqrt();
        assert!((least - corner).abs() < 0.02, "{least} {corner}");
        for ray in &rays {
            assert!((1..8).all(|l| at(ray.dir, l).dot(at(ray.dir, 0)) > 0.995));
        }
    }

    #[test]
    fn every_set_has_rays_and_most_primary_hits_have_followers() {
        let specimen = specimens().swap_remove(1);
        let brute = gonio_accel::Brute::new(&specimen.geometry);
        for (set, rays) in cast(&specimen, &brute, 2000, 1) {
            let live: u32 = rays.iter().map(|ray| ray.mask.to_bits().count_ones()).sum();
            assert!(live > 200, "{set}: {live}");
        }
    }
}
