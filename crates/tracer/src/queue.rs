//! Queues of path states: the rays of one bounce, what each path carries, and the order in which they are shaded.
//!
//! A tile's paths advance together, one stage at a time. Rays and states lie in blocks of eight, as the casting stage wants
//! them; the shading stage reads them through a list sorted by material, so that its eights are full and alike, and writes
//! new blocks in that order. Dead lanes are left behind by the next sort.

use gonio_accel::{Hit8, NO_HIT, Ray8};
use gonio_kernel::{F32x8, Mask8, Rgb, U32x8, Vec3, each_lane};

/// What eight paths carry besides their rays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paths {
    /// The product of all weights so far.
    pub(crate) throughput: Rgb<F32x8>,
    /// Density with which scattering chose this ray; 0 after the camera or a delta event.
    pub(crate) pdf: F32x8,
    /// Density with which a light sample would have chosen this direction in a constant environment; a map is asked itself,
    /// when the path has left the world.
    pub(crate) pdf_environment: F32x8,
    /// Which path of the tile.
    pub(crate) path: U32x8,
    /// x + 65536·y of its pixel.
    pub(crate) pixel: U32x8,
    /// Its sample number.
    pub(crate) sample: U32x8,
}

/// The rays of one bounce.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    pub(crate) rays: Vec<Ray8>,
    pub(crate) paths: Vec<Paths>,
}

/// Shadow rays, and what arrives if nothing is in the way. Only about half of the lanes that are shaded have something to
/// ask for, so lanes are packed as they come.
#[derive(Debug, Default)]
pub(crate) struct ShadowQueue {
    pub(crate) rays: Vec<Ray8>,
    pub(crate) arriving: Vec<Rgb<F32x8>>,
    pub(crate) path: Vec<[u32; F32x8::LANES]>,
    /// The block that is being filled: origin, direction, t_max, light; eleven lanes of numbers with the path.
    open: [[f32; F32x8::LANES]; 10],
    open_path: [u32; F32x8::LANES],
    open_lanes: usize,
}

/// Live lanes in the order of their keys.
#[derive(Debug, Default)]
pub(crate) struct Order {
    /// Lane numbers: block · 8 + lane.
    pub(crate) lanes: Vec<u32>,
    /// Where each key's lanes start in `lanes`, and where the last one's end.
    pub(crate) starts: Vec<u32>,
    keys: Vec<u32>,
}

impl Queue {
    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
    }

    pub(crate) fn push(&mut self, ray: Ray8, paths: Paths) {
        self.rays.push(ray);
        self.paths.push(paths);
    }
}

impl ShadowQueue {
    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.arriving.clear();
        self.path.clear();
        self.open_lanes = 0;
    }

    /// Appends the lanes of `mask`.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        mask: Mask8,
        (origin, dir, t_max): (Vec3<F32x8>, Vec3<F32x8>, F32x8),
        light: Rgb<F32x8>,
        path: &[u32; F32x8::LANES],
    ) {
        let fields = [origin.x, origin.y, origin.z, dir.x, dir.y, dir.z, t_max, light.r, light.g, light.b];
        let fields = fields.map(F32x8::to_array);
        let mut bits = mask.to_bits();
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize % F32x8::LANES;
            bits &= bits - 1;
            let to = self.open_lanes % F32x8::LANES;
            for (open, field) in self.open.iter_mut().zip(&fields) {
                open[to] = field[lane];
            }
            self.open_path[to] = path[lane];
            self.open_lanes = to + 1;
            if self.open_lanes == F32x8::LANES {
                self.close();
            }
        }
    }

    /// Completes the block that is being filled; to be called before the rays are cast.
    pub(crate) fn close(&mut self) {
        if self.open_lanes > 0 {
            let [ox, oy, oz, dx, dy, dz, t_max, r, g, b] = self.open.map(F32x8::new);
            let mask = Mask8::first(self.open_lanes);
            self.rays.push(Ray8 { t_max, mask, ..Ray8::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz)) });
            self.arriving.push(Rgb::new(r, g, b));
            self.path.push(self.open_path);
            self.open_lanes = 0;
        }
    }
}

impl Order {
    /// Counting sort of the live lanes: key 0 is a miss, key 1 + m a hit on material m < `materials`. Stable.
    pub(crate) fn sort(
        &mut self,
        rays: &[Ray8],
        hits: &[Hit8],
        materials: usize,
        material_of: impl Fn(u32, u32) -> u32,
    ) {
        const DEAD: u32 = u32::MAX;
        self.starts.clear();
        self.starts.resize(materials + 2, 0);
        self.keys.clear();
        for (ray, hit) in rays.iter().zip(hits) {
            let (live, prim, instance) = (ray.mask.to_bits(), hit.prim.to_array(), hit.instance.to_array());
            for lane in 0..F32x8::LANES {
                let key = match prim[lane] {
                    _ if live >> lane & 1 == 0 => DEAD,
                    NO_HIT => 0,
                    prim => 1 + material_of(instance[lane], prim),
                };
                if key != DEAD {
                    self.starts[key as usize + 1] += 1;
                }
                self.keys.push(key);
            }
        }
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        // starts[k] is now where key k begins; while placing, it runs to where k ends, which is where k + 1 begins.
        self.lanes.clear();
        self.lanes.resize(total as usize, 0);
        for (lane, &key) in self.keys.iter().enumerate().filter(|(_, key)| **key != DEAD) {
            let place = &mut self.starts[key as usize];
            self.lanes[*place as usize] = lane as u32;
            *place += 1;
        }
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }

    /// The lanes of keys `from..to`.
    pub(crate) fn range(&self, from: usize, to: usize) -> &[u32] {
        &self.lanes[self.starts[from] as usize..self.starts[to] as usize]
    }
}

/// Eight lanes scattered over a queue. In a batch that is not full, the rest repeats its last lane and is not live.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Batch<'a> {
    rays: [&'a Ray8; F32x8::LANES],
    paths: [&'a Paths; F32x8::LANES],
    hits: [&'a Hit8; F32x8::LANES],
    lane: [usize; F32x8::LANES],
    pub(crate) live: Mask8,
}

impl<'a> Batch<'a> {
    /// One to eight lanes of a queue and its hits.
    #[inline(always)]
    pub(crate) fn new(lanes: &[u32], queue: &'a Queue, hits: &'a [Hit8]) -> Self {
        let last = lanes.len().saturating_sub(1);
        let place = each_lane(|i| lanes[i.min(last)] as usize);
        Self {
            rays: each_lane(|i| &queue.rays[place[i] / F32x8::LANES]),
            paths: each_lane(|i| &queue.paths[place[i] / F32x8::LANES]),
            hits: each_lane(|i| &hits[place[i] / F32x8::LANES]),
            lane: each_lane(|i| place[i] % F32x8::LANES),
            live: Mask8::first(lanes.len()),
        }
    }

    /// A field of the rays, brought together.
    #[inline(always)]
    pub(crate) fn ray(&self, field: impl Fn(&Ray8) -> &F32x8) -> F32x8 {
        F32x8::from_fn(|i| field(self.rays[i]).lane(self.lane[i]))
    }

    /// A field of the path states, brought together.
    #[inline(always)]
    pub(crate) fn path(&self, field: impl Fn(&Paths) -> &F32x8) -> F32x8 {
        F32x8::from_fn(|i| field(self.paths[i]).lane(self.lane[i]))
    }

    /// An integer field of the path states, brought together.
    #[inline(always)]
    pub(crate) fn path_int(&self, field: impl Fn(&Paths) -> &U32x8) -> U32x8 {
        U32x8::from_fn(|i| field(self.paths[i]).lane(self.lane[i]))
    }

    /// A field of the hits, brought together.
    #[inline(always)]
    pub(crate) fn hit(&self, field: impl Fn(&Hit8) -> &F32x8) -> F32x8 {
        F32x8::from_fn(|i| field(self.hits[i]).lane(self.lane[i]))
    }

    /// Instance, mesh and prim of one hit.
    #[inline(always)]
    pub(crate) fn hit_place(&self, i: usize) -> (u32, u32, u32) {
        let (hit, lane) = (&self.hits[i], self.lane[i]);
        (hit.instance.lane(lane), hit.mesh.lane(lane), hit.prim.lane(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Real;

    #[test]
    fn the_order_is_by_key_then_lane_and_leaves_out_the_dead() {
        let zero = Vec3::new(F32x8::ZERO, F32x8::ZERO, F32x8::ONE);
        let mut rays = [Ray8::new(zero, zero); 2];
        rays[1].mask = Mask8::from_bits(0b0000_0101);
        let mut hits = [Hit8::miss(); 2];
        hits[0].prim = U32x8::new([4, 1, NO_HIT, 4, 1, 0, NO_HIT, 2]);
        hits[1].prim = U32x8::new([1, 9, NO_HIT, 9, 9, 9, 9, 9]);
        let mut order = Order::default();
        order.sort(&rays, &hits, 5, |_, prim| prim);
        assert_eq!(order.lanes, [2, 6, 10, 5, 1, 4, 8, 7, 0, 3]);
        assert_eq!(order.range(0, 1), [2, 6, 10]);
        assert_eq!(order.range(2, 3), [1, 4, 8]);
        assert_eq!(order.range(4, 5), [0; 0]);
        assert_eq!(order.range(1, 6).len(), 7);
    }
}
