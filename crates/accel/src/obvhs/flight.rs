//! Rays that have nothing in common: each walks the tree alone, several at a time.
//!
//! A ray is tested against eight boxes or eight triangles at once. What then takes the time is waiting: for nodes that are not
//! in the cache, and for branches that nobody can predict. So [`FLIGHT`] rays are on their way at once and take turns.
//! Which node a ray visits next is known a whole round before it does, and is fetched meanwhile; and of all rays those at nodes
//! go first and those at blocks after, so that the kind of a visit is not a branch. When a ray is done the next of the slice takes
//! its place, so that all places stay taken to the end.
//!
//! A node is left without a branch ([`super::stack`]): the children that the ray enters are stored all at once, farthest first.
//! Their order is that of the ray's octant, computed when the tree was built (compare Ylitie, Karras & Laine 2017, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). For rays that look for any hit it is the order in which one is
//! likeliest to be found ([`super::order`]).
//!
//! Only a tree with entrances ([`super::placed`]) has rays that are inside of one: what they were outside is kept beside them, and the
//! way out lies on their stack. Other trees are walked by code that knows nothing of it.

use super::cell::{Cell, Child, Facing, Slots};
use super::placed::candidates;
use super::stack::Stack;
use super::tree::{Tree, View};
use crate::ray::{NO_HIT, Ray8};
use crate::triangle::{Beam, Crossing, intersect, intersect_fast};
use gonio_kernel::{F32x8, Mask, Mask8, Real, Vec3};

/// How many rays are on their way at once.
const FLIGHT: usize = 16;

/// What a flight is for.
pub(super) trait Quest {
    /// Whether any hit will do.
    const ANY: bool;
    /// Looks at eight rays before they go; returns those that need to.
    fn begin<const FAST: bool>(&mut self, packet: usize, ray: &Ray8, beam: &Beam, live: Mask8) -> Mask8;
    /// Looks at those triangles of a block that the ray meets; true if the ray need not go on.
    fn meet(&mut self, walk: &mut Walk<'_>, crossing: &Crossing, block: Cell<'_>) -> bool;
    /// A ray is done: `meet` returned true, or there was no more to visit.
    fn done(&mut self, walk: &Walk<'_>);
}

/// A ray on its way through the tree.
pub(super) struct Walk<'a> {
    /// Its number: packet · 8 + lane.
    pub(super) ray: usize,
    beam: Beam<f32>,
    facing: Facing,
    t_min: f32,
    slack: f32,
    /// Where it ends: the best hit so far, or t_max.
    t_best: f32,
    /// Boxes count that it is in between here,
    from: f32,
    /// and here.
    until: f32,
    /// Edge functions and place of the best hit.
    pub(super) edges: [f32; 3],
    pub(super) index: u32,
    /// Its part of the stacks starts here, with [`Child::DONE`],
    base: usize,
    /// and ends here.
    top: usize,
    next: Child,
    /// The cell of what is next, unless that has none.
    cell: Cell<'a>,
}

impl Walk<'_> {
    /// Takes a hit that is better than the best so far.
    #[inline(always)]
    pub(super) fn shorten(&mut self, t: f32, index: u32, edges: [f32; 3]) {
        (self.t_best, self.until) = (t, t + self.slack);
        (self.index, self.edges) = (index, edges);
    }

    /// The distance of the best hit.
    #[inline(always)]
    pub(super) fn t_best(&self) -> f32 {
        self.t_best
    }
}

/// What a ray is elsewhere than where it is: in the world while it is in the tree of a placed mesh, and in the mesh that it was in
/// last.
#[derive(Clone)]
struct Elsewhere {
    is_inside: bool,
    /// Which of the placed it is in, or was in last.
    placed: Option<u32>,
    world: Stance,
    /// In the mesh's coordinates.
    mesh: Stance,
    slack: f32,
}

/// How a ray meets boxes.
#[derive(Clone, Copy)]
struct Stance {
    beam: Beam<f32>,
    facing: Facing,
}

/// The rays of a slice, one after the other.
struct Queue<'a> {
    rays: &'a [Ray8],
    /// How many packets have been begun.
    begun: usize,
    /// The lanes of the last one that have not.
    left: u32,
    /// What their tests need,
    beam: Beam,
    /// and the signs of their directions, as sets of lanes.
    down: [u32; 3],
}

impl<'a> View<'a> {
    /// Sends all live rays through the tree, which may have entrances if `PLACED`.
    pub(super) fn fly<const FAST: bool, const PLACED: bool, Q: Quest>(&self, rays: &[Ray8], quest: &mut Q) {
        let size = self.tree.stack_size();
        let mut stacks = Stack::with_room(FLIGHT * size);
        let Some(first) = rays.first() else { return };
        let beam = Beam::new(first.origin, first.dir, self.tree.lo, self.tree.hi);
        let mut queue = Queue { rays, begun: 0, left: 0, beam, down: [0; 3] };
        let cell = self.cell(Child::DONE);
        let mut walks: [Walk<'_>; FLIGHT] = std::array::from_fn(|i| {
            (stacks.children[i * size], stacks.nears[i * size]) = (Child::DONE.0, f32::NEG_INFINITY);
            Walk::nowhere(beam.lane(0), i * size, cell)
        });
        let mut others = if PLACED { vec![Elsewhere::of(&walks[0]); FLIGHT] } else { Vec::new() };
        let mut next = Next::default();
        for (i, walk) in walks.iter_mut().enumerate() {
            if self.take::<FAST, Q>(&mut queue, walk, quest) {
                self.turn::<PLACED>(1 << i, walk, &mut next);
            }
        }
        while next.any() {
            let now = std::mem::take(&mut next);
            for_each_bit(now.node, |i, bit| {
                let walk = &mut walks[i];
                walk.visit::<Q>(&mut stacks);
                self.pop::<PLACED, Q>(bit, walk, &stacks, &mut next);
            });
            for_each_bit(now.block, |i, bit| {
                let walk = &mut walks[i];
                let block = walk.cell;
                let is_done = match others.get(i) {
                    Some(Elsewhere { is_inside: true, placed: Some(number), world, .. }) if PLACED => {
                        walk.may_meet(block) && {
                            let rows = self.tree.placed[*number as usize].in_world(block);
                            let block = Cell::of(&rows);
                            let crossing = walk.test::<FAST>(&world.beam, block);
                            crossing.any() && quest.meet(walk, &crossing, block)
                        }
                    }
                    _ => {
                        let crossing = walk.test::<FAST>(&walk.beam, block);
                        crossing.any() && quest.meet(walk, &crossing, block)
                    }
                };
                if is_done {
                    next.done |= bit;
                } else {
                    self.pop::<PLACED, Q>(bit, walk, &stacks, &mut next);
                }
            });
            for_each_bit(now.nothing, |i, bit| self.pop::<PLACED, Q>(bit, &mut walks[i], &stacks, &mut next));
            if PLACED {
                for_each_bit(now.special, |i, bit| {
                    let (walk, other) = (&mut walks[i], &mut others[i]);
                    if walk.next == Child::EXIT {
                        walk.leave(other);
                        self.pop::<PLACED, Q>(bit, walk, &stacks, &mut next);
                    } else if walk.next == Child::DONE {
                        next.done |= bit;
                    } else {
                        walk.enter(other, self.tree, &mut stacks);
                        self.turn::<PLACED>(bit, walk, &mut next);
                    }
                });
            }
            for_each_bit(std::mem::take(&mut next.done), |i, bit| {
                let walk = &mut walks[i];
                quest.done(walk);
                if PLACED {
                    (others[i].is_inside, others[i].placed) = (false, None);
                }
                if self.take::<FAST, Q>(&mut queue, walk, quest) {
                    self.turn::<PLACED>(bit, walk, &mut next);
                }
            });
        }
    }

    /// Starts the next ray of the queue; false if there is none.
    #[inline(always)]
    fn take<const FAST: bool, Q: Quest>(&self, queue: &mut Queue<'_>, walk: &mut Walk<'_>, quest: &mut Q) -> bool {
        if queue.left == 0 && !self.begin::<FAST, Q>(queue, quest) {
            return false;
        }
        let lane = queue.left.trailing_zeros() as usize;
        queue.left &= queue.left - 1;
        let packet = queue.begun - 1;
        walk.facing = Facing::of(queue.down.map(|down| (down >> lane & 1) as usize));
        walk.ray = packet * F32x8::LANES + lane;
        walk.beam = queue.beam.lane(lane);
        (walk.t_min, walk.t_best) = (queue.rays[packet].t_min.lane(lane), queue.rays[packet].t_max.lane(lane));
        walk.see_as_far_as(queue.beam.slack::<FAST>().lane(lane));
        (walk.index, walk.top, walk.next) = (NO_HIT, walk.base + 1, self.tree.root);
        true
    }

    /// Begins the next packet that has live rays; false if there is none.
    #[inline(never)]
    fn begin<const FAST: bool, Q: Quest>(&self, queue: &mut Queue<'_>, quest: &mut Q) -> bool {
        loop {
            let Some(ray) = queue.rays.get(queue.begun) else { return false };
            let live = sound(ray);
            if live.any() {
                queue.beam = Beam::new(ray.origin, ray.dir, self.tree.lo, self.tree.hi);
                queue.down = queue.beam.points_down();
                queue.left = quest.begin::<FAST>(queue.begun, ray, &queue.beam, live).to_bits();
            }
            queue.begun += 1;
            if queue.left != 0 {
                return true;
            }
        }
    }

    /// Takes the next subtree from a ray's stack and has it fetched.
    #[inline(always)]
    fn pop<const PLACED: bool, Q: Quest>(&self, bit: u32, walk: &mut Walk<'a>, stacks: &Stack, next: &mut Next) {
        walk.top -= 1;
        walk.next = Child(stacks.children[walk.top]);
        // Not <: a tie may lie behind this box and have the smaller index.
        let counts = Q::ANY || stacks.nears[walk.top] <= walk.until;
        let visit = if counts { bit } else { 0 };
        next.nothing |= bit & !visit;
        self.turn::<PLACED>(visit, walk, next);
    }

    /// Has what is next fetched, and visited in the next round unless `bit` is 0.
    #[inline(always)]
    fn turn<const PLACED: bool>(&self, bit: u32, walk: &mut Walk<'a>, next: &mut Next) {
        if !(PLACED && walk.next.is_special()) {
            walk.cell = self.cell(walk.next);
            walk.cell.prefetch();
        }
        next.goes_to::<PLACED>(bit, walk.next);
    }
}

/// What each ray does next, as sets of rays.
#[derive(Default)]
struct Next {
    node: u32,
    block: u32,
    /// An entrance, or the exit, or the end, of a tree with entrances.
    special: u32,
    /// What it took from its stack lies behind its hit.
    nothing: u32,
    /// It need not go on, or has nowhere to go.
    done: u32,
}

impl Next {
    #[inline(always)]
    fn goes_to<const PLACED: bool>(&mut self, bit: u32, child: Child) {
        let (leaf, special) = (child.all_ones_if_leaf(), child.all_ones_if_special());
        self.node |= bit & !leaf;
        self.block |= bit & leaf & !special;
        if PLACED {
            self.special |= bit & special;
        } else {
            self.done |= bit & special;
        }
    }

    #[inline(always)]
    fn any(&self) -> bool {
        self.node | self.block | self.special | self.nothing != 0
    }
}

#[inline(always)]
fn for_each_bit(mut bits: u32, mut f: impl FnMut(usize, u32)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize % FLIGHT, bits & bits.wrapping_neg());
        bits &= bits - 1;
    }
}

/// Live rays of finite numbers: others meet nothing, and would not find their way among boxes.
pub(super) fn sound(ray: &Ray8) -> Mask8 {
    let finite = |v: Vec3<F32x8>| (v.x.abs() + v.y.abs() + v.z.abs()).lt(F32x8::splat(f32::INFINITY));
    ray.mask & finite(ray.origin) & finite(ray.dir)
}

impl Elsewhere {
    fn of(walk: &Walk<'_>) -> Self {
        let stance = walk.stance();
        Self { is_inside: false, placed: None, world: stance, mesh: stance, slack: walk.slack }
    }
}

impl<'a> Walk<'a> {
    fn stance(&self) -> Stance {
        Stance { beam: self.beam, facing: self.facing }
    }

    fn take_stance(&mut self, stance: &Stance, slack: f32) {
        (self.beam, self.facing) = (stance.beam, stance.facing);
        self.see_as_far_as(slack);
    }

    /// Goes in by the entrance that is next, with the way out on the stack.
    fn enter(&mut self, other: &mut Elsewhere, tree: &Tree, stacks: &mut Stack) {
        let entrance = &tree.entrances[self.next.number()];
        (other.is_inside, other.world, other.slack) = (true, self.stance(), self.slack);
        if other.placed != Some(entrance.placed) {
            let beam = tree.placed[entrance.placed as usize].enter(&self.beam);
            let down = <[f32; 3]>::from(beam.inverse()).map(|i| usize::from(i < 0.0));
            (other.placed, other.mesh) = (Some(entrance.placed), Stance { beam, facing: Facing::of(down) });
        }
        self.take_stance(&other.mesh, entrance.slack(&other.world.beam, other.slack));
        (stacks.children[self.top], stacks.nears[self.top]) = (Child::EXIT.0, f32::NEG_INFINITY);
        self.top += 1;
        self.next = entrance.subtree;
    }

    /// Comes back to the world.
    fn leave(&mut self, other: &mut Elsewhere) {
        self.take_stance(&other.world, other.slack);
        other.is_inside = false;
    }

    /// Whether the ray enters the box of some triangle of a block, in the coordinates of where it is.
    #[inline(always)]
    fn may_meet(&self, block: Cell<'_>) -> bool {
        candidates(block, &self.beam, &self.facing, self.from, self.until) != 0
    }

    /// Tests the ray, as it is in the world, against the triangles of a block of the world.
    #[inline(always)]
    fn test<const FAST: bool>(&self, beam: &Beam<f32>, block: Cell<'_>) -> Crossing {
        let (t_min, t_max) = (F32x8::splat(self.t_min), F32x8::splat(self.t_best));
        crossing::<FAST>(&beam.splat(), &block.corners(), t_min, t_max)
    }

    fn see_as_far_as(&mut self, slack: f32) {
        self.slack = slack;
        (self.from, self.until) = (self.t_min - slack, self.t_best + slack);
    }

    fn nowhere(beam: Beam<f32>, base: usize, cell: Cell<'a>) -> Self {
        Self {
            ray: 0,
            beam,
            facing: Facing::default(),
            t_min: 0.0,
            t_best: 0.0,
            slack: 0.0,
            from: 0.0,
            until: 0.0,
            edges: [0.0; 3],
            index: NO_HIT,
            base,
            top: base,
            next: Child::DONE,
            cell,
        }
    }

    /// Pushes the children of a node whose boxes the ray enters.
    #[inline(always)]
    fn visit<Q: Quest>(&mut self, stacks: &mut Stack) {
        let node = self.cell;
        let [near, far] = self.facing.planes(node);
        let [enter, leave] = self.beam.splat().slab(near, far);
        let entered = enter.max(F32x8::splat(self.from)).le(leave.min(F32x8::splat(self.until)));
        let (slots, nears) = if Q::ANY {
            (Slots::as_they_are(entered), None)
        } else {
            let slots = node.in_order(&self.facing, entered);
            (slots, Some(enter.to_bits().permute(slots.which).as_real()))
        };
        stacks.store(self.top, node.children().permute(slots.which), nears);
        self.top += slots.count;
    }
}

/// The test that a traversal is compiled with.
#[inline(always)]
pub(super) fn crossing<const FAST: bool>(
    beam: &Beam,
    corners: &[Vec3<F32x8>; 3],
    t_min: F32x8,
    t_max: F32x8,
) -> Crossing {
    if FAST { intersect_fast(beam, corners, t_min, t_max) } else { intersect(beam, corners, t_min, t_max) }
}
