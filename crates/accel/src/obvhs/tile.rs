//! Rays that start together and point the same way: up to four packets visit the tree as one.
//!
//! A tile of up to 32 rays is tested against the boxes of a node's eight children at once, by intervals: if origins lie in a box and
//! inverse directions, all of one sign per axis, in another, then no ray enters a child before the least, nor leaves it after the
//! greatest of the products at their ends (compare Boulos, Wald & Shirley 2006, "Geometric and Arithmetic Culling Methods for
//! Entire Ray Packets"). A node so costs 32 rays hardly more than one. Only at a block of triangles each packet is tested
//! against the block's own box, after the tile was tested against the boxes of the triangles. Where many of a packet's eight rays
//! enter, they are tested against one triangle after the other; where few do, each ray against all eight triangles at once.
//!
//! Rays that do not share their octant, or come to a tree with entrances, go on alone ([`super::flight`]), and so do the rays of a tile that finds itself
//! at many blocks which few of them enter: far away, or in a small picture, neighbours have nothing in common. After such a
//! tile ever fewer are tried. Every test of a triangle is the same, so results are too.

use super::cell::{Cell, Child, Facing};
use super::flight::sound;
use super::stack::{Stack, for_each_lane};
use super::tree::{Tree, View};
use crate::geometry::{Order, TriangleId};
use crate::ray::{Hit8, Ray8};
use crate::triangle::{Beam, Crossing, Facet, barycentric, intersect};
use gonio_kernel::{F32x8, Mask, Mask8, Real, U32x8, Vec3};

/// Most packets of a tile.
const PACKETS: usize = 4;

/// The place of no triangle: larger than any other, and not negative where lanes are compared.
const NOWHERE: u32 = u32::MAX >> 1;

/// A tile does not pay if of so many blocks less than every second was entered by one of its rays.
const TRIAL: u32 = 32;

/// The most tiles that go as single rays after one that did not pay.
const LONGEST: usize = 64;

/// Most cells of a tree that a tile can walk: a cell's place and a slot share a word.
const MOST_CELLS: usize = 1 << 29;

/// Eight rays of a tile and the best hits of theirs so far.
#[derive(Clone, Copy)]
struct Packet {
    beam: Beam,
    live: Mask8,
    t_min: F32x8,
    t_best: F32x8,
    slack: F32x8,
    /// Boxes count that a ray is in between here,
    from: F32x8,
    /// and here; nowhere if it is not alive.
    until: F32x8,
    edges: [F32x8; 3],
    /// Places of the triangles, or [`NOWHERE`].
    index: U32x8,
}

impl Packet {
    fn new<const FAST: bool>(ray: &Ray8, tree: &Tree) -> Self {
        let beam = Beam::new(ray.origin, ray.dir, tree.lo, tree.hi);
        let (live, slack) = (sound(ray), beam.slack::<FAST>());
        Self {
            beam,
            live,
            t_min: ray.t_min,
            t_best: ray.t_max,
            from: ray.t_min - slack,
            slack,
            until: F32x8::select(live, ray.t_max + slack, F32x8::splat(f32::NEG_INFINITY)),
            edges: [F32x8::ZERO; 3],
            index: U32x8::splat(NOWHERE),
        }
    }

    fn hit(&self, order: &Order) -> Hit8 {
        let found = self.index.lt(U32x8::splat(NOWHERE));
        let mut hit = Hit8 {
            t: F32x8::select(found, self.t_best, F32x8::splat(f32::INFINITY)),
            bary: barycentric(&self.edges).map(|b| b.or_zero(found)),
            ..Hit8::miss()
        };
        for_each_lane(found, |lane| {
            let TriangleId { prim, mesh, instance } = order.id(self.index.lane(lane));
            hit.prim.set_lane(lane, prim);
            hit.mesh.set_lane(lane, mesh);
            hit.instance.set_lane(lane, instance);
        });
        hit
    }

    /// Takes those hits that are better.
    #[inline(always)]
    fn take(&mut self, crossing: &Crossing, live: Mask8, index: u32) -> bool {
        let index = U32x8::splat(index);
        // Not <: of two at one distance that with the smaller index counts.
        let nearer = crossing.t.lt(self.t_best) | (crossing.t.le(self.t_best) & index.lt(self.index));
        let better = crossing.mask & live & nearer;
        if better.any() {
            self.t_best = F32x8::select(better, crossing.t, self.t_best);
            self.until = F32x8::select(better, crossing.t + self.slack, self.until);
            for (best, edge) in self.edges.iter_mut().zip(crossing.edges()) {
                *best = F32x8::select(better, *edge, *best);
            }
            self.index = U32x8::select(better, index, self.index);
        }
        better.any()
    }
}

/// The intervals of a tile: what the products with a plane's coordinate are taken from, for both ends.
struct Interval {
    facing: Facing,
    /// For each axis 1 if rays point down it.
    down: [usize; 3],
    /// Both ends of the inverse directions, along each axis.
    inverse: [[F32x8; 2]; 3],
    /// What is added for near planes at either end,
    enter: [[F32x8; 2]; 3],
    /// and for far planes.
    leave: [[F32x8; 2]; 3],
    from: F32x8,
}

/// The least, or the greatest, number of all live rays.
#[inline(always)]
fn extreme(packets: &[Packet], pick: impl Fn(&Packet) -> F32x8, start: f32, f: fn(F32x8, F32x8) -> F32x8) -> f32 {
    let start = F32x8::splat(start);
    let all = packets.iter().fold(start, |all, p| f(all, F32x8::select(p.live, pick(p), start)));
    // Eight lanes become one in three halvings.
    [[4, 5, 6, 7, 0, 1, 2, 3], [2, 3, 0, 1, 6, 7, 4, 5], [1, 0, 3, 2, 5, 4, 7, 6]]
        .into_iter()
        .fold(all, |all, from| f(all, all.to_bits().permute(U32x8::new(from)).as_real()))
        .lane(0)
}

/// For each axis 1 if all live rays point down it, 0 if all point up; `None` if some do and some do not.
fn down_of(packets: &[Packet]) -> Option<[usize; 3]> {
    let (mut some, mut every) = ([0; 3], [true; 3]);
    for packet in packets {
        let live = packet.live.to_bits();
        for (axis, down) in packet.beam.points_down().into_iter().enumerate() {
            some[axis] |= down & live;
            every[axis] &= down & live == live;
        }
    }
    let shared = (0..3).all(|axis| some[axis] == 0 || every[axis]);
    shared.then(|| some.map(|lanes| usize::from(lanes != 0)))
}

impl Interval {
    /// The intervals of packets whose rays share an octant.
    fn of(packets: &[Packet]) -> Option<Self> {
        let down = down_of(packets)?;
        let least = |pick: fn(&Packet) -> F32x8| extreme(packets, pick, f32::INFINITY, F32x8::min);
        let most = |pick: fn(&Packet) -> F32x8| extreme(packets, pick, f32::NEG_INFINITY, F32x8::max);
        let origins = [
            [least(|p| p.beam.origin().x), most(|p| p.beam.origin().x)],
            [least(|p| p.beam.origin().y), most(|p| p.beam.origin().y)],
            [least(|p| p.beam.origin().z), most(|p| p.beam.origin().z)],
        ];
        let inverses = [
            [least(|p| p.beam.inverse().x), most(|p| p.beam.inverse().x)],
            [least(|p| p.beam.inverse().y), most(|p| p.beam.inverse().y)],
            [least(|p| p.beam.inverse().z), most(|p| p.beam.inverse().z)],
        ];
        let pads = [most(|p| p.beam.pad().x), most(|p| p.beam.pad().y), most(|p| p.beam.pad().z)];
        // The origin that is farthest along for near planes, the other one for far planes; twice the padding of a ray, because
        // the offsets here are rounded like those of a ray, but are not the same.
        let offsets =
            |axis: usize, origin: f32, pad: f32| inverses[axis].map(|inverse| F32x8::splat(pad - origin * inverse));
        let enter = [0, 1, 2].map(|axis| offsets(axis, origins[axis][1 - down[axis]], -2.0 * pads[axis]));
        let leave = [0, 1, 2].map(|axis| offsets(axis, origins[axis][down[axis]], 2.0 * pads[axis]));
        Some(Self {
            facing: Facing::of(down),
            down,
            inverse: inverses.map(|ends| ends.map(F32x8::splat)),
            enter,
            leave,
            from: F32x8::splat(least(|p| p.from)),
        })
    }

    /// Where the first ray may enter each of eight boxes, and where the last may leave it, given their near and far planes.
    #[inline(always)]
    fn slab(&self, near: Vec3<F32x8>, far: Vec3<F32x8>) -> [F32x8; 2] {
        let at = |planes: Vec3<F32x8>, offsets: &[[F32x8; 2]; 3], pick: fn(F32x8, F32x8) -> F32x8| {
            let planes = [planes.x, planes.y, planes.z];
            [0, 1, 2].map(|axis| {
                let (plane, [a, b]) = (planes[axis], self.inverse[axis]);
                pick(plane.mul_add(a, offsets[axis][0]), plane.mul_add(b, offsets[axis][1]))
            })
        };
        let enter = at(near, &self.enter, F32x8::min);
        let leave = at(far, &self.leave, F32x8::max);
        [enter[0].max(enter[1]).max(enter[2]), leave[0].min(leave[1]).min(leave[2])]
    }

    /// The triangles of a block, as a set, whose own boxes some ray may enter.
    #[inline(always)]
    fn candidates(&self, corners: &[Vec3<F32x8>; 3], until: f32) -> u32 {
        let [a, b, c] = *corners;
        let ends = |a: F32x8, b: F32x8, c: F32x8| [a.min(b).min(c), a.max(b).max(c)];
        let ends = [ends(a.x, b.x, c.x), ends(a.y, b.y, c.y), ends(a.z, b.z, c.z)];
        let [x, y, z] = self.down;
        let side = |far: usize| Vec3::new(ends[0][x ^ far], ends[1][y ^ far], ends[2][z ^ far]);
        let [enter, leave] = self.slab(side(0), side(1));
        enter.max(self.from).le(leave.min(F32x8::splat(until))).to_bits()
    }
}

impl View<'_> {
    /// Finds the nearest hits of rays, in tiles as far as they have enough in common; hands on those that have not.
    pub(super) fn closest_in_tiles<const FAST: bool>(
        &self,
        rays: &[Ray8],
        hits: &mut [Hit8],
        mut alone: impl FnMut(&[Ray8], &mut [Hit8]),
    ) {
        let fits = !self.tree.root.is_leaf() && self.tree.cell_count() <= MOST_CELLS && self.tree.placed.is_empty();
        let Some(first) = rays.first().filter(|_| fits) else { return alone(rays, hits) };
        let mut stack = Stack::with_room(self.tree.stack_size());
        let mut packets = [Packet::new::<FAST>(first, self.tree); PACKETS];
        // How many tiles to spare after the next that does not pay, and how many packets are done.
        let (mut pause, mut done) = (1, 0);
        while done < rays.len() {
            let end = (done + PACKETS).min(rays.len());
            let packets = &mut packets[..end - done];
            for (packet, ray) in packets.iter_mut().zip(&rays[done..end]) {
                *packet = Packet::new::<FAST>(ray, self.tree);
            }
            // As one tile; if they have not enough in common, each packet for itself; if even that has not, each ray.
            match Interval::of(packets) {
                Some(interval) if self.visit_tile::<FAST>(packets, &interval, &mut stack) => {
                    pause = 1;
                    for (packet, hit) in packets.iter().zip(&mut hits[done..end]) {
                        *hit = packet.hit(&self.tree.order);
                    }
                    done = end;
                }
                Some(_) => {
                    let end = (end + pause * PACKETS).min(rays.len());
                    alone(&rays[done..end], &mut hits[done..end]);
                    pause = (2 * pause + 1).min(LONGEST);
                    done = end;
                }
                None => {
                    for (packet, at) in packets.iter_mut().zip(done..end) {
                        let packet = std::slice::from_mut(packet);
                        match Interval::of(packet) {
                            Some(interval) if self.visit_tile::<FAST>(packet, &interval, &mut stack) => {
                                hits[at] = packet[0].hit(&self.tree.order);
                            }
                            _ => alone(&rays[at..=at], &mut hits[at..=at]),
                        }
                    }
                    done = end;
                }
            }
        }
    }

    /// Finds the nearest hits of a tile; false if it gave up, because ray by ray is cheaper.
    fn visit_tile<const FAST: bool>(&self, packets: &mut [Packet], interval: &Interval, stack: &mut Stack) -> bool {
        let (mut blocks, mut rays) = (0, 0);
        let last = |packets: &[Packet]| extreme(packets, |p| p.until, f32::NEG_INFINITY, F32x8::max);
        let mut until = last(packets);
        let mut top = self.enter_tile(interval, self.tree.root, until, stack, 0);
        while top > 0 {
            top -= 1;
            if stack.nears[top] > until {
                continue;
            }
            let key = stack.children[top];
            let (parent, slot) = (self.cell(Child(key >> 3)), key as usize & 7);
            let child = Child(parent.children().lane(slot));
            if !child.is_leaf() {
                top = self.enter_tile(interval, child, until, stack, top);
                continue;
            }
            let block = self.cell(child);
            let corners = block.corners();
            let candidates = interval.candidates(&corners, until) & block.used();
            if candidates == 0 {
                continue;
            }
            let [near, far] = interval.facing.planes(parent).map(|planes| planes.splat_lane(slot));
            let (mut met, mut faces) = (false, None);
            blocks += 1;
            if blocks >= TRIAL && 2 * rays < blocks {
                return false;
            }
            for packet in &mut *packets {
                let [enter, leave] = packet.beam.slab(near, far);
                let entered = enter.max(packet.from).le(leave.min(packet.until));
                if entered.any() {
                    rays += entered.to_bits().count_ones();
                    let faces = faces.get_or_insert_with(|| Faces::<FAST>::of(corners));
                    met |= packet.meet(entered, block, faces, candidates);
                }
            }
            if met {
                until = last(packets);
            }
        }
        true
    }

    /// Pushes the children of a node that some ray may enter, as the node's place · 8 + slot; returns the new top of the stack.
    #[inline(always)]
    fn enter_tile(&self, interval: &Interval, node: Child, until: f32, stack: &mut Stack, top: usize) -> usize {
        let cell = self.cell(node);
        let [near, far] = interval.facing.planes(cell);
        let [enter, leave] = interval.slab(near, far);
        let entered = enter.max(interval.from).le(leave.min(F32x8::splat(until)));
        let slots = cell.in_order(&interval.facing, entered);
        let keys = (slots.which & U32x8::splat(7)) | U32x8::splat(node.0 << 3);
        stack.store(top, keys, Some(enter.to_bits().permute(slots.which).as_real()));
        let end = top + slots.count;
        for key in &stack.children[top..end] {
            self.cell(Child(cell.children().lane(*key as usize))).prefetch();
        }
        end
    }
}

/// The triangles of a block.
struct Faces<const FAST: bool> {
    corners: [Vec3<F32x8>; 3],
    /// What the fast test needs of them, computed once for all packets.
    facet: Option<Facet>,
}

impl<const FAST: bool> Faces<FAST> {
    #[inline(always)]
    fn of(corners: [Vec3<F32x8>; 3]) -> Self {
        Self { corners, facet: FAST.then(|| Facet::of(&corners)) }
    }

    /// Tests eight rays against one triangle.
    #[inline(always)]
    fn one(&self, lane: usize, beam: &Beam, t_min: F32x8, t_max: F32x8) -> Crossing {
        match &self.facet {
            Some(facet) => facet.splat_lane(lane).cross(beam, t_min, t_max),
            None => intersect(beam, &self.corners.map(|c| c.splat_lane(lane)), t_min, t_max),
        }
    }

    /// Tests one ray, in all lanes, against eight triangles.
    #[inline(always)]
    fn all(&self, beam: &Beam, t_min: F32x8, t_max: F32x8) -> Crossing {
        match &self.facet {
            Some(facet) => facet.cross(beam, t_min, t_max),
            None => intersect(beam, &self.corners, t_min, t_max),
        }
    }
}

impl Packet {
    /// Tests the rays that enter a block's box against those of its triangles that are candidates; whether some came to a
    /// better hit.
    #[inline(always)]
    fn meet<const FAST: bool>(
        &mut self,
        entered: Mask8,
        block: Cell<'_>,
        faces: &Faces<FAST>,
        candidates: u32,
    ) -> bool {
        let mut met = false;
        if 2 * entered.to_bits().count_ones() <= candidates.count_ones() {
            for_each_lane(entered, |ray| {
                let (beam, t_min) = (self.beam.lane(ray).splat(), self.t_min.splat_lane(ray));
                let crossing = faces.all(&beam, t_min, self.t_best.splat_lane(ray));
                for_each_lane(crossing.mask, |lane| {
                    let crossing = crossing.splat_lane(lane);
                    met |= self.take(&crossing, Mask8::from_bits(1 << ray), block.index(lane));
                });
            });
        } else {
            for_each_lane(Mask8::from_bits(candidates), |lane| {
                let crossing = faces.one(lane, &self.beam, self.t_min, self.t_best);
                if crossing.mask.any() {
                    met |= self.take(&crossing, entered, block.index(lane));
                }
            });
        }
        met
    }
}
