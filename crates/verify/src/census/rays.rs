//! Packets of rays, by family and number.
//!
//! A ray is addressed by (seed, family, number): asking for more never changes those before. The seed does not depend on the
//! scale, so every scale sees the same choices. All lengths are relative to the specimen.

use super::aim::Ray;
use super::ball::Ball;
use super::dice::Dice;
use super::family::Family;
use super::specimen::{Place, Specimen};
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::warp::sample_cosine_hemisphere;
use gonio_kernel::{F32x8, Frame, Mask8, Real, Vec3, each_lane};
use gonio_lab::random::{bits, seed_for, unit};
use gonio_tracer::{SHORT_OF_LIGHT, SurfacePoint};
use std::ops::Range;

/// Eight rays, and which of them a surface must stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet {
    pub(crate) ray: Ray8,
    /// A bit for each lane.
    pub(crate) covered: u32,
}

/// Makes the rays of every family.
pub(crate) struct Caster<'a> {
    pub(crate) specimen: &'a Specimen,
    /// Finds the camera hits from which bounces and shadow rays start.
    pub(crate) scout: &'a dyn Accel,
    /// For the families that start inside; see [`super::inside`].
    pub(crate) balls: &'a [Ball],
    pub(crate) seed: u64,
}

impl Caster<'_> {
    /// Whether the specimen has rays of this family at all.
    pub(crate) fn has(&self, family: Family) -> bool {
        self.specimen.count() > 0 && (!family.is_inside() || !self.balls.is_empty())
    }

    /// Packets of a family by their numbers. Every eighth has dead lanes, and rays that would start where a camera ray
    /// hit nothing are dead.
    pub(crate) fn packets(&self, family: Family, numbers: Range<u64>) -> Vec<Packet> {
        let seed = seed_for(self.seed, &family.to_string());
        let mut packets: Vec<Packet> = match family {
            Family::Camera => numbers.clone().map(|n| self.camera(seed, n).into()).collect(),
            Family::Bounce | Family::Shadow => {
                let rays: Vec<Ray8> = numbers.clone().map(|n| self.camera(seed, n)).collect();
                let mut hits = vec![Hit8::miss(); rays.len()];
                self.scout.closest(RayKind::Coherent, &rays, &mut hits);
                let made = if family == Family::Bounce {
                    bounces(self.specimen, &rays, &hits, seed, numbers.start)
                } else {
                    shadows(self.specimen, &rays, &hits, seed, numbers.start)
                };
                made.into_iter().map(Packet::from).collect()
            }
            _ => numbers.clone().map(|n| pack(&self.eight(family, seed, n), 0xff)).collect(),
        };
        for (number, packet) in numbers.zip(&mut packets) {
            if number % 8 == 7 {
                packet.ray.mask = packet.ray.mask & Mask8::from_bits(bits(seed, number, 100) as u32);
            }
            packet.covered &= packet.ray.mask.to_bits();
        }
        packets
    }

    /// A block of four by two pixels somewhere in the picture.
    fn camera(&self, seed: u64, number: u64) -> Ray8 {
        let [width, height] = self.specimen.picture();
        let at = |size: f32, dimension| (size * unit(seed, number, dimension) as f32).floor();
        camera_block(self.specimen, [at(width, 101), at(height, 102)], seed, number)
    }

    fn eight(&self, family: Family, seed: u64, number: u64) -> [Ray; 8] {
        std::array::from_fn(|lane| {
            let dice = Dice { specimen: self.specimen, seed, index: number * 8 + lane as u64 };
            if family.is_inside() {
                dice.inside_out(family, &self.balls[dice.pick(40, self.balls.len())])
            } else {
                dice.ray(family)
            }
        })
    }
}

/// Rays through a block of four by two pixels whose top left one is given, each somewhere in its pixel.
fn camera_block(specimen: &Specimen, [x, y]: [f32; 2], seed: u64, number: u64) -> Ray8 {
    let jitter = |dimension| F32x8::from_fn(|l| unit(seed, number * 8 + l as u64, dimension) as f32);
    let column = F32x8::from_fn(|l| x + (l % 4) as f32);
    let row = F32x8::from_fn(|l| y + (l / 4) as f32);
    specimen.camera(column + jitter(0), row + jitter(1))
}

/// Rays that leave the hits as diffuse light does. Misses become dead lanes.
pub(crate) fn bounces(specimen: &Specimen, rays: &[Ray8], hits: &[Hit8], seed: u64, first: u64) -> Vec<Ray8> {
    from_hits(specimen, rays, hits, first, |start, index| {
        let u = [2, 3].map(|dimension| F32x8::from_fn(|l| unit(seed, index + l as u64, dimension) as f32));
        let dir = Frame::from_normal(start.normal).to_world(sample_cosine_hemisphere(u));
        Ray8::new(start.origin, dir)
    })
}

/// Rays from the hits that end just short of a point of a light, or of the bounds if there is none. Misses, and points
/// below the surface, become dead lanes.
pub(crate) fn shadows(specimen: &Specimen, rays: &[Ray8], hits: &[Hit8], seed: u64, first: u64) -> Vec<Ray8> {
    from_hits(specimen, rays, hits, first, |start, index| {
        let to = Vec3::from_lanes(|l| {
            let dice = Dice { specimen, seed, index: index + l as u64 };
            match specimen.emitters.get(dice.pick(2, specimen.emitters.len())) {
                Some(corners) => dice.within(corners),
                // A lamp above everything, twice as wide.
                None => dice.in_bounds([2.0 * dice.u(3) - 0.5, 1.5 + 0.5 * dice.u(4), 2.0 * dice.u(5) - 0.5]),
            }
        }) - start.origin;
        let distance = to.length();
        // No renderer asks for light from below the surface.
        let above = to.dot(start.normal).gt(F32x8::ZERO);
        let dir = Vec3::select(above, to * distance.recip(), start.normal);
        Ray8 { t_max: distance * F32x8::splat(SHORT_OF_LIGHT), mask: above, ..Ray8::new(start.origin, dir) }
    })
}

/// Where eight new rays start: off the surface, on the side that the old ones came from.
struct Start {
    origin: Vec3<F32x8>,
    normal: Vec3<F32x8>,
}

fn from_hits(
    specimen: &Specimen,
    rays: &[Ray8],
    hits: &[Hit8],
    first: u64,
    make: impl Fn(&Start, u64) -> Ray8,
) -> Vec<Ray8> {
    let packets = rays.iter().zip(hits).enumerate();
    let made = packets.map(|(i, (ray, hit))| {
        // A scout that is wrong may name what is not there: no ray starts from it.
        let found = each_lane(|l| hit.lane(l).filter(|hit| specimen.has(hit)));
        let live = (0..8).fold(0, |bits, l| bits | u32::from(found[l].is_some()) << l);
        let corners = each_lane(|l| match found[l] {
            Some(hit) => specimen.corners(Place { instance: hit.instance, prim: hit.prim }),
            None => [Vec3::splat(0.0), Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)],
        });
        let corners = [0, 1, 2].map(|c| Vec3::from_lanes(|l| corners[l][c]));
        let up = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(-ray.dir);
        let normal = up * F32x8::ONE.copysign(-up.dot(ray.dir));
        let start = Start { origin: SurfacePoint::new(&corners, hit.bary).off_plane(normal), normal };
        let made = make(&start, (first + i as u64) * 8);
        Ray8 { mask: ray.mask & made.mask & Mask8::from_bits(live), ..made }
    });
    made.collect()
}

impl From<Ray8> for Packet {
    fn from(ray: Ray8) -> Self {
        Self { ray, covered: 0 }
    }
}

/// Eight rays side by side, alive where `alive` has a bit.
pub(super) fn pack(rays: &[Ray; 8], alive: u32) -> Packet {
    let ray = Ray8 {
        mask: Mask8::from_bits(alive),
        t_min: F32x8::from_fn(|l| rays[l].t_min),
        t_max: F32x8::from_fn(|l| rays[l].t_max),
        ..Ray8::new(Vec3::from_lanes(|l| rays[l].origin), Vec3::from_lanes(|l| rays[l].dir))
    };
    Packet { ray, covered: rays.iter().enumerate().fold(0, |bits, (l, ray)| bits | u32::from(ray.covered) << l) }
}

#[cfg(test)]
mod tests {
    use super::super::inside::balls;
    use super::super::meshes::specimens;
    use super::*;
    use gonio_kernel::Mask;

    #[test]
    fn every_family_makes_rays_in_the_domain_at_every_scale_and_some_hit() {
        for specimen in specimens() {
            for scale in [1e-4, 1.0, 1e6] {
                let specimen = specimen.scaled(scale).unwrap();
                let brute = gonio_accel::Brute::new(&specimen.geometry);
                let balls = balls(&specimen, &brute, 3);
                let caster = Caster { specimen: &specimen, scout: &brute, balls: &balls, seed: 3 };
                for family in Family::ALL.into_iter().filter(|family| caster.has(*family)) {
                    let packets = caster.packets(family, 0..128);
                    let rays: Vec<Ray8> = packets.iter().map(|packet| packet.ray).collect();
                    let mut hits = vec![Hit8::miss(); rays.len()];
                    brute.closest(family.kind(), &rays, &mut hits);
                    let lanes = |r: &Ray8| (0..8).filter(move |&l| r.mask.lane(l)).collect::<Vec<_>>();
                    for ray in &rays {
                        let good = ray.dir.is_direction() & ray.origin.is_finite();
                        assert!((good | !ray.mask).all(), "{} {family} at {scale}: {ray:?}", specimen.name);
                    }
                    let found: usize = rays
                        .iter()
                        .zip(&hits)
                        .map(|(r, h)| lanes(r).iter().filter(|&&l| h.lane(l).is_some()).count())
                        .sum();
                    // What leaves a convex body, or one of many far apart, need not come back.
                    let leaves = matches!(family, Family::Bounce | Family::Shadow);
                    assert!(found > 0 || leaves, "{} {family} at {scale}", specimen.name);
                    // What is covered is hit.
                    for (packet, hit) in packets.iter().zip(&hits) {
                        let missed = (0..8).find(|&l| packet.covered >> l & 1 != 0 && hit.lane(l).is_none());
                        assert_eq!(missed, None, "{} {family} at {scale}: {:?}", specimen.name, packet.ray);
                    }
                }
            }
        }
    }

    #[test]
    fn a_longer_census_begins_with_the_shorter_one() {
        let specimen = specimens().swap_remove(1);
        let brute = gonio_accel::Brute::new(&specimen.geometry);
        let caster = Caster { specimen: &specimen, scout: &brute, balls: &[], seed: 3 };
        for family in Family::ALL.into_iter().filter(|family| caster.has(*family)) {
            let (all, rest) = (caster.packets(family, 0..16), caster.packets(family, 9..16));
            for (a, b) in all[9..].iter().zip(&rest) {
                assert_eq!(format!("{a:?}"), format!("{b:?}"), "{family}");
            }
        }
    }
}
