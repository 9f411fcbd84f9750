//! The eight-wide tree.
//!
//! A leaf is a block of up to eight triangles side by side, because eight triangles cost as much to test as one; a node has
//! up to eight children, their boxes side by side. Which subtrees of the binary tree ([`super::sah`]) become nodes, children and
//! blocks is decided by [`super::collapse`]. Beyond [`PART`] triangles the tree is made of parts, each collapsed
//! before the next is built, and a small tree over the parts, so that the memory it takes to build does not grow with the scene.

use super::boxes::{Box3, Ref};
use super::collapse::Collapse;
use super::order::Odds;
use super::pages::{Pages, Rows};
use super::placed::{Entrance, Placed, Shared, local_triangle};
use super::stack::{packed, spread, together};
use super::{ObvhsOptions, ObvhsPreset, bridge, order, sah};
use crate::geometry::{Geometry, Order};
use glam::Vec4;
use gonio_kernel::{F32x8, Mask8, Real, U32x8, Vec3};
use std::ops::Range;
use wide::f32x8;

/// How many children a node has, and how many triangles a block.
pub(super) const WIDTH: usize = F32x8::LANES;

/// Most triangles of a part.
const PART: usize = 1 << 20;

/// A subtree: an inner node, or a leaf block if the top bit is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Child(pub(super) u32);

const LEAF: u32 = 1 << 31;

/// What is special has no cell: the end of a walk, the exit of a mesh's tree, and entrances to it ([`super::placed`]), numbered from
/// 1 on. A tree has fewer than 2³⁰ cells, so their bits are not those of a place.
const SPECIAL: u32 = LEAF | 1 << 30;

impl Child {
    /// There is no more to visit.
    pub(super) const DONE: Self = Self(SPECIAL);

    /// The way out of a mesh's tree.
    pub(super) const EXIT: Self = Self(u32::MAX);

    /// The entrance of that number, counted from 0.
    fn entrance(number: usize) -> Self {
        Self(SPECIAL | (number + 1) as u32)
    }

    #[inline(always)]
    pub(super) fn is_special(self) -> bool {
        self.0 >= SPECIAL
    }

    /// The number of an entrance, counted from 0.
    #[inline(always)]
    pub(super) fn number(self) -> usize {
        ((self.0 & !SPECIAL) as usize).wrapping_sub(1)
    }

    /// A mask instead of a branch.
    #[inline(always)]
    pub(super) fn all_ones_if_special(self) -> u32 {
        ((self.0 << 1) as i32 >> 31) as u32
    }

    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & LEAF != 0
    }

    /// Where its cell is; 0 for [`Child::DONE`], so that to look there is no mistake.
    #[inline(always)]
    pub(super) fn place(self) -> usize {
        (self.0 & !SPECIAL) as usize
    }

    /// A mask instead of a branch.
    #[inline(always)]
    pub(super) fn all_ones_if_leaf(self) -> u32 {
        (self.0 as i32 >> 31) as u32
    }
}

/// A node or a block, as ten times eight words, so that where the next one lies is known before which of both it is.
///
/// A **node** has up to eight children: rows 0 to 5 are the lower and upper planes across x, y, z of their boxes, row 6 the
/// children, that where a hit is likeliest last; row 7 has for each octant of directions the slots, the farthest first, three
/// bits each. Bit a of an octant is set if directions point down axis a. An unused slot has an inverted infinite box, which no ray
/// enters. A **block** has up to eight triangles: rows 0 to 8 are x, y, z of their three corners, row 9 their places in the
/// order of (instance, prim). Unused lanes repeat the first, which changes no result.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a>(&'a Rows);

impl<'a> Cell<'a> {
    /// A block that is not one of the tree's.
    #[inline(always)]
    pub(super) fn of(rows: &'a Rows) -> Self {
        Self(rows)
    }

    /// Has the memory fetch it.
    #[inline(always)]
    pub(super) fn prefetch(self) {
        for line in 0..5 {
            fetch(&self.0[2 * line]);
        }
    }

    /// A row of planes of the boxes, by where it starts among the words of the cell.
    #[inline(always)]
    pub(super) fn plane(self, start: usize) -> F32x8 {
        let [rows @ .., _, _] = self.0;
        let words: &[f32; 64] = bytemuck::cast_ref(rows);
        // All bits of 56 are a row's: the compiler sees that it lies within.
        words[start & 56..].first_chunk().map_or(F32x8::ZERO, |row| F32x8::new(*row))
    }

    #[inline(always)]
    pub(super) fn children(self) -> U32x8 {
        F32x8::from_wide(self.0[6]).to_bits()
    }

    /// The order of an octant, packed.
    #[inline(always)]
    pub(super) fn order(self, octant: usize) -> u32 {
        F32x8::from_wide(self.0[7]).lane(octant).to_bits()
    }

    /// The slots of a set, the farthest first.
    #[inline(always)]
    pub(super) fn in_order(self, facing: &Facing, set: Mask8) -> Slots {
        let order = spread(self.order(facing.octant));
        let set = set.permute(order).to_bits();
        Slots { which: order.permute(together(set)), count: set.count_ones() as usize }
    }

    #[inline(always)]
    pub(super) fn corners(self) -> [Vec3<F32x8>; 3] {
        let r = self.0.map(F32x8::from_wide);
        [Vec3::new(r[0], r[1], r[2]), Vec3::new(r[3], r[4], r[5]), Vec3::new(r[6], r[7], r[8])]
    }

    /// The lanes of a block that are used.
    #[inline(always)]
    pub(super) fn used(self) -> u32 {
        (!F32x8::from_wide(self.0[9]).to_bits().same(U32x8::splat(self.index(0)))).to_bits() | 1
    }

    /// The same, one after the other.
    pub(super) fn lanes_used(self) -> impl Iterator<Item = usize> + Clone {
        let used = self.used();
        (0..WIDTH).filter(move |lane| used >> lane & 1 != 0)
    }

    /// The place of a triangle of the block.
    #[inline(always)]
    pub(super) fn index(self, lane: usize) -> u32 {
        F32x8::from_wide(self.0[9]).lane(lane).to_bits()
    }
}

/// Some slots of a node, one after the other.
#[derive(Clone, Copy)]
pub(super) struct Slots {
    /// In the lowest three bits of the first lanes.
    pub(super) which: U32x8,
    pub(super) count: usize,
}

impl Slots {
    /// The slots of a set, that where a hit is likeliest last.
    #[inline(always)]
    pub(super) fn as_they_are(set: Mask8) -> Self {
        let set = set.to_bits();
        Self { which: together(set), count: set.count_ones() as usize }
    }
}

/// Which sides of boxes rays meet first: where among a node's words the rows of near planes start, and those of far ones.
#[derive(Clone, Copy, Default)]
pub(super) struct Facing {
    near: [usize; 3],
    far: [usize; 3],
    octant: usize,
}

impl Facing {
    /// Of rays that point down those axes that have a 1, and up those that have a 0.
    #[inline(always)]
    pub(super) fn of([x, y, z]: [usize; 3]) -> Self {
        let rows = |x: usize, y: usize, z: usize| [x, 2 + y, 4 + z].map(|row| WIDTH * row);
        Self { near: rows(x, y, z), far: rows(x ^ 1, y ^ 1, z ^ 1), octant: x | y << 1 | z << 2 }
    }

    /// The near and the far planes of a node's children.
    #[inline(always)]
    pub(super) fn planes(&self, node: Cell<'_>) -> [Vec3<F32x8>; 2] {
        self.planes_of(|row| node.plane(row))
    }

    /// The near and the far planes of boxes whose rows start where those of a node do.
    #[inline(always)]
    pub(super) fn planes_of(&self, plane: impl Fn(usize) -> F32x8) -> [Vec3<F32x8>; 2] {
        [self.near, self.far].map(|[x, y, z]| Vec3::new(plane(x), plane(y), plane(z)))
    }
}

/// The whole tree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    cells: Pages,
    pub(super) root: Child,
    pub(super) order: Order,
    /// The trees of meshes that instances share,
    pub(super) shared: Vec<Child>,
    /// those instances,
    pub(super) placed: Vec<Placed>,
    /// and where rays enter them.
    pub(super) entrances: Vec<Entrance>,
    pub(super) lo: Vec3<f32>,
    pub(super) hi: Vec3<f32>,
    depth: usize,
}

impl Tree {
    /// The tree over all triangles; `progress` is told how many are done.
    pub(super) fn build(geometry: &Geometry, options: &ObvhsOptions, progress: &mut dyn FnMut(usize)) -> Self {
        Self::in_parts(geometry, options, PART, progress)
    }

    /// The tree in parts of at most so many triangles.
    fn in_parts(geometry: &Geometry, options: &ObvhsOptions, most: usize, progress: &mut dyn FnMut(usize)) -> Self {
        let none = Vec3::splat(0.0);
        let order = geometry.order().clone();
        let mut tree = Self {
            cells: Pages::default(),
            root: Child(0),
            order,
            shared: Vec::new(),
            placed: Vec::new(),
            entrances: Vec::new(),
            lo: none,
            hi: none,
            depth: 0,
        };
        let mut ways = options.sharing.ways(geometry);
        let mut growth = Growth { tree: &mut tree, preset: options.preset, most, odds: Vec::new(), done: 0, progress };

        let laid_out = (0..ways.len()).filter(|&instance| ways[instance].is_none());
        let laid_out: Vec<_> = laid_out.map(|instance| geometry.order().places(instance)).collect();
        let mut roots = growth.parts(&laid_out, |place| geometry.world_triangle(place).corners);
        let mut below = std::mem::replace(&mut growth.tree.depth, 0);
        let mut sharing: Vec<Vec<usize>> = vec![Vec::new(); geometry.meshes().len()];
        for (number, instance) in geometry.instances().iter().enumerate().filter(|&(number, _)| ways[number].is_some())
        {
            sharing[instance.mesh as usize].push(number);
        }
        for (mesh, places) in geometry.meshes().iter().zip(sharing).filter(|(_, places)| !places.is_empty()) {
            let all = 0..mesh.triangles.len() as u32;
            let parts = growth.parts(&[all], |prim| local_triangle(mesh, prim));
            let root = growth.join(&parts);
            below = below.max(std::mem::replace(&mut growth.tree.depth, 0));
            let shared = Shared::new(growth.tree, &growth.odds, mesh, (bounds_of(&parts), root));
            growth.tree.shared.push(root);
            for instance in places {
                let Some(way) = ways[instance].take() else { continue };
                let first = geometry.order().places(instance).start;
                let placed = Placed::new(&geometry.instances()[instance], way, &shared, first);
                for entrance in placed.entrances(growth.tree.placed.len(), &shared) {
                    roots.push((entrance.bounds, Child::entrance(growth.tree.entrances.len())));
                    growth.tree.entrances.push(entrance);
                }
                growth.tree.placed.push(placed);
            }
        }
        growth.tree.root = growth.join(&roots);
        (growth.progress)(geometry.triangle_count());
        if !roots.is_empty() {
            let bounds = bounds_of(&roots);
            [tree.lo, tree.hi] = [bounds.lo, bounds.hi].map(|v| Vec3::new(v.x, v.y, v.z));
        }
        tree.depth += below;
        tree.cells.settle();
        tree
    }

    /// How many entries a traversal can have waiting at once, the end and an exit among them, and room for eight more.
    pub(super) fn stack_size(&self) -> usize {
        (WIDTH - 1) * self.depth + 3 + WIDTH
    }

    pub(super) fn cell(&self, child: Child) -> Cell<'_> {
        self.view().cell(child)
    }

    /// The tree as traversals see it.
    pub(super) fn view(&self) -> View<'_> {
        View { tree: self, rows: self.cells.rows() }
    }

    /// Bytes that the tree occupies.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.cells.rows()) + size_of_val(self.placed.as_slice()) + size_of_val(self.entrances.as_slice())
    }

    /// How many nodes and blocks there are.
    pub(super) fn cell_count(&self) -> usize {
        self.cells.rows().len()
    }

    /// The blocks below a node or block; not behind entrances.
    pub(super) fn blocks_below(&self, root: Child) -> Vec<Cell<'_>> {
        let (mut blocks, mut work) = (Vec::new(), vec![root]);
        while let Some(child) = work.pop() {
            if child.is_leaf() {
                blocks.push(self.cell(child));
            } else {
                work.extend(self.cell(child).slots().map(|slot| slot.1).filter(|child| !child.is_special()));
            }
        }
        blocks
    }

    /// Appends a node, to be filled in, and takes note of how deep it lies.
    pub(super) fn new_node(&mut self, depth: usize) -> Child {
        self.depth = self.depth.max(depth);
        self.cells.push(node_of(&[]));
        Child((self.cells.rows().len() - 1) as u32)
    }

    /// Fills in a node.
    pub(super) fn set_node(&mut self, node: Child, children: &[(Box3, Child)]) {
        self.cells.set(node.place(), node_of(children));
    }

    /// Fills in a node whose children are in the slots where they stay.
    pub(super) fn settle_node(&mut self, node: Child, children: &[(Box3, Child)]) {
        let mut rows = node_of(children);
        rows[7] = orders_of(children).to_wide();
        self.cells.set(node.place(), rows);
    }

    /// Appends a block of triangles.
    fn block(&mut self, triangles: &[u32], corners: impl Fn(u32) -> [Vec3<f32>; 3]) -> Child {
        let (mut rows, mut index) = ([[0.0; WIDTH]; 9], [triangles[0]; WIDTH]);
        for (lane, &triangle) in triangles.iter().enumerate() {
            let [a, b, c] = corners(triangle);
            for (row, x) in rows.iter_mut().zip([a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]) {
                row[lane] = x;
            }
            index[lane] = triangle;
        }
        for row in &mut rows {
            let first = row[0];
            row[triangles.len()..].fill(first);
        }
        let [ax, ay, az, bx, by, bz, cx, cy, cz] = rows.map(f32x8::new);
        self.cells.push([ax, ay, az, bx, by, bz, cx, cy, cz, U32x8::new(index).as_real().to_wide()]);
        Child((self.cells.rows().len() - 1) as u32 | LEAF)
    }
}

/// A tree while it grows.
struct Growth<'a> {
    tree: &'a mut Tree,
    preset: ObvhsPreset,
    /// Most triangles of a part.
    most: usize,
    odds: Vec<Odds>,
    /// How many triangles are done.
    done: usize,
    progress: &'a mut dyn FnMut(usize),
}

impl Growth<'_> {
    /// Trees over parts of some triangles.
    fn parts(&mut self, triangles: &[Range<u32>], corners: impl Fn(u32) -> [Vec3<f32>; 3]) -> Vec<(Box3, Child)> {
        let mut refs = Vec::with_capacity(triangles.iter().map(|range| range.len()).sum());
        let of = |triangle: u32| Ref::new(Box3::of_points(corners(triangle)), triangle);
        refs.extend(triangles.iter().cloned().flatten().map(of));
        let (mut roots, mut start) = (Vec::new(), 0);
        for end in sah::split(&mut refs, self.most) {
            let part = &mut refs[start..end];
            let binary = match self.preset {
                ObvhsPreset::Fast => bridge::ploc(part),
                ObvhsPreset::Medium => sah::build(part),
                ObvhsPreset::High => bridge::reinserted(sah::build(part)),
            };
            if let Some(root) = binary.first() {
                let leaf = |tree: &mut Tree, node: usize| tree.block(&triangles_below(&binary, node), &corners);
                roots.push((root.bounds(), self.settle(&binary, WIDTH, leaf)));
            }
            self.done += end - start;
            (self.progress)(self.done);
            start = end;
        }
        roots
    }

    /// One tree over some.
    fn join(&mut self, roots: &[(Box3, Child)]) -> Child {
        if let [(_, root)] = roots {
            return *root;
        }
        let below = std::mem::replace(&mut self.tree.depth, 0);
        let mut refs: Vec<Ref> = roots.iter().enumerate().map(|(i, root)| Ref::new(root.0, i as u32)).collect();
        let top = sah::build(&mut refs);
        let root = if top.is_empty() {
            let node = self.tree.new_node(1);
            self.tree.settle_node(node, &[]);
            node
        } else {
            self.settle(&top, 1, |_, node| roots[top[node].first as usize].1)
        };
        self.tree.depth += below;
        root
    }

    /// The wide tree of a binary one.
    fn settle(&mut self, binary: &[sah::Binary], most: usize, leaf: impl FnMut(&mut Tree, usize) -> Child) -> Child {
        let nodes = Collapse::new(binary, most).run(self.tree, leaf);
        order::settle(self.tree, &nodes, &mut self.odds);
        nodes[0]
    }
}

/// The box of all.
fn bounds_of(roots: &[(Box3, Child)]) -> Box3 {
    roots.iter().fold(Box3::EMPTY, |all, root| all.union(root.0))
}

/// A tree while rays are cast.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) tree: &'a Tree,
    rows: &'a [Rows],
}

impl<'a> View<'a> {
    #[inline(always)]
    pub(super) fn cell(self, child: Child) -> Cell<'a> {
        Cell(&self.rows[child.place()])
    }
}

/// Has the memory fetch the line that a value starts in.
#[inline(always)]
fn fetch<T>(value: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(value);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = value;
}

/// The triangles below a binary node, in order.
fn triangles_below(binary: &[sah::Binary], node: usize) -> Vec<u32> {
    let mut found = Vec::with_capacity(WIDTH);
    let mut stack = vec![node];
    while let Some(n) = stack.pop() {
        match binary[n].children() {
            Some(children) => stack.extend(children),
            None => found.push(binary[n].first),
        }
    }
    found.sort_unstable();
    found
}

/// A node of children and their boxes, whose orders are not known yet.
fn node_of(children: &[(Box3, Child)]) -> Rows {
    let plane = |pick: fn(&Box3) -> f32| {
        F32x8::new(std::array::from_fn(|slot| pick(children.get(slot).map_or(&Box3::EMPTY, |(bounds, _)| bounds))))
    };
    [
        plane(|b| b.lo.x),
        plane(|b| b.hi.x),
        plane(|b| b.lo.y),
        plane(|b| b.hi.y),
        plane(|b| b.lo.z),
        plane(|b| b.hi.z),
        U32x8::new(std::array::from_fn(|slot| children.get(slot).map_or(0, |child| child.1.0))).as_real(),
        F32x8::ZERO,
        F32x8::ZERO,
        F32x8::ZERO,
    ]
    .map(F32x8::to_wide)
}

/// The orders of children for each octant.
fn orders_of(children: &[(Box3, Child)]) -> F32x8 {
    let order = |octant: usize| {
        let sign = |axis: usize| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let depth = |slot: &usize| {
            let center = children[*slot].0.center2();
            center.x * sign(0) + center.y * sign(1) + center.z * sign(2)
        };
        let mut slots: Vec<usize> = (0..children.len()).collect();
        slots.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        // Unused slots too have a place in the order: slot 0 must not stand in for them.
        packed(slots.into_iter().chain(children.len()..WIDTH))
    };
    U32x8::new(std::array::from_fn(order)).as_real()
}

impl Cell<'_> {
    /// The children of a node and their boxes.
    pub(super) fn slots(self) -> impl Iterator<Item = (Box3, Child)> {
        let corner = |side: usize, slot: usize| {
            let [x, y, z] = [0, 2, 4].map(|axis| F32x8::from_wide(self.0[axis + side]).lane(slot));
            Vec4::new(x, y, z, 1.0)
        };
        let children = self.children();
        let slot = move |slot| (Box3 { lo: corner(0, slot), hi: corner(1, slot) }, Child(children.lane(slot)));
        (0..WIDTH).map(slot).filter(|(bounds, _)| bounds.lo.x <= bounds.hi.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Accel, Brute, Hit8, Mesh, Obvhs, Ray8, RayKind, TreeError};

    /// Waves of n × n squares, of which a strip is one point, so that no plane can part it.
    fn waves(n: u32) -> Geometry {
        let at = |x: u32, y: u32| y * (n + 1) + x;
        let height = |x: u32, y: u32| ((x * 37 + y * 61) % 17) as f32 * 0.1;
        let position = |x: u32, y: u32| if y < 4 { [0.0; 3] } else { [x as f32, height(x, y), y as f32] };
        let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| position(x, y))).collect();
        let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
        let triangles = squares
            .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
            .collect();
        Geometry::of_mesh(Mesh { positions, triangles }).unwrap()
    }

    const PRESETS: [ObvhsPreset; 3] = [ObvhsPreset::Fast, ObvhsPreset::Medium, ObvhsPreset::High];

    fn by(preset: ObvhsPreset) -> ObvhsOptions {
        ObvhsOptions { preset, ..ObvhsOptions::default() }
    }

    fn bits(tree: &Tree) -> Vec<u32> {
        tree.cells.rows().iter().flatten().flat_map(|row| row.to_array().map(f32::to_bits)).collect()
    }

    #[test]
    fn a_tree_in_parts_is_sound_and_finds_what_brute_finds() {
        let geometry = waves(24);
        let brute = Brute::new(&geometry);
        for (most, preset) in [1, 7, 100, 1000, PART].into_iter().flat_map(|most| PRESETS.map(|preset| (most, preset)))
        {
            let mut told = Vec::new();
            let tree = Tree::in_parts(&geometry, &by(preset), most, &mut |done| told.push(done));
            assert_eq!(told.last(), Some(&geometry.triangle_count()));
            assert!(told.len() >= geometry.triangle_count() / most);
            assert_eq!(tree.check(), Ok(()), "{preset:?} in parts of {most}");
            let tree = Obvhs::of_tree(tree);
            let mut met = 0;
            for i in 0..400 {
                let lane = |l: usize| (i * 8 + l) as f32;
                let origin = Vec3::from_lanes(|l| Vec3::new(lane(l) * 0.618 % 24.0, 5.0, lane(l) * 0.414 % 24.0));
                let dir = Vec3::from_lanes(|l| {
                    Vec3::new(lane(l) * 0.732 % 2.0 - 1.0, -0.3, lane(l) * 0.236 % 2.0 - 1.0).normalize()
                });
                let rays = [Ray8::new(origin, dir)];
                let (mut a, mut b) = ([Hit8::miss()], [Hit8::miss()]);
                brute.closest(RayKind::Incoherent, &rays, &mut a);
                tree.closest(RayKind::Incoherent, &rays, &mut b);
                assert_eq!(format!("{a:?}"), format!("{b:?}"));
                met += a[0].t.to_array().iter().filter(|t| t.is_finite()).count();
            }
            assert!(met > 1000, "{met} of 3200 rays meet something");
        }
    }

    #[test]
    fn any_number_of_threads_builds_the_same_tree() {
        // Enough for several ranges that are worth a thread.
        let geometry = waves(160);
        for preset in PRESETS {
            let with = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| bits(&Tree::build(&geometry, &by(preset), &mut |_| ())))
            };
            let alone = with(1);
            for threads in [2, 3, 8] {
                assert!(alone == with(threads), "{preset:?} with {threads} threads");
            }
        }
    }

    #[test]
    fn a_broken_tree_is_noticed() {
        let geometry = waves(24);
        let sound = Tree::build(&geometry, &by(ObvhsPreset::Medium), &mut |_| ());
        assert_eq!(sound.check(), Ok(()));
        let broken = |change: &dyn Fn(&mut Rows)| {
            let mut tree = sound.clone();
            let root = tree.root.place();
            let mut rows = tree.cells.rows()[root];
            change(&mut rows);
            tree.cells.set(root, rows);
            tree.check().expect_err("the tree is broken")
        };
        let last = |rows: &Rows, row: usize| rows[row].to_array()[7].to_bits();
        let put = |rows: &mut Rows, row: usize, lane: usize, x: f32| rows[row].as_mut_array()[lane] = x;
        assert!(matches!(broken(&|rows| put(rows, 1, 7, rows[1].to_array()[7].next_down())), TreeError::Box { .. }));
        let first_again = |rows: &mut Rows| put(rows, 6, 7, f32::from_bits(rows[6].to_array()[6].to_bits()));
        assert!(matches!(broken(&first_again), TreeError::Box { .. } | TreeError::NotOnce { .. }));
        let nowhere = |rows: &mut Rows| put(rows, 6, 7, f32::from_bits(last(rows, 6) | 0x00ff_ffff));
        assert!(matches!(broken(&nowhere), TreeError::Box { .. }));
        assert!(matches!(broken(&|rows| put(rows, 7, 3, 0.0)), TreeError::Order { octant: 3, .. }));
        let unused = |rows: &mut Rows| put(rows, 0, 7, f32::INFINITY);
        assert!(matches!(broken(&unused), TreeError::NotOnce { times: 0, .. }));
        let mut shallow = sound.clone();
        shallow.depth = 1;
        assert!(matches!(shallow.check(), Err(TreeError::Stack { .. })));
        let mut other = sound.clone();
        other.order = waves(25).order().clone();
        assert!(matches!(other.check(), Err(TreeError::Triangle { times: 0, .. })));
    }
}
