//! Instances that share the tree of their mesh.
//!
//! A mesh that is placed many times has one tree, in its own coordinates, and leaves above stand for each place: **entrances**.
//! There is one for each of some subtrees, because the box of a whole mesh is mostly empty, more so if it is turned
//! (Benthin, Woop, Wald & Áfra 2017, "Improved Two-Level BVHs using Partial Re-Braiding").
//! A ray that comes to one goes on below it with an origin and a direction in the mesh's coordinates; t stays what it is in the
//! world. There boxes are entered by that ray, but triangles are tested in the world, by the corners that
//! [`Instance::to_world`] gives. So a hit is the same, to the last bit, whether an instance shares a tree or is laid out.
//!
//! **No hit is lost.** A triangle that is hit lies within the padding of a point of the ray (see [`crate::triangle`]). Moved to the
//! mesh's coordinates, the distance grows along each axis by at most the sum of absolute values of a row of the inverse map, and
//! to it is added how far the corners, the origin and the direction were rounded. How far along the ray that point is from the hit is
//! known to the slack for triangles that the ray is not too nearly parallel to; for others, only that both lie within the
//! triangle's box, so the slack grows by the diagonal of the largest one below the entrance.

use super::boxes::Box3;
use super::cell::{Cell, Child, Facing};
use super::odds::Odds;
use super::pages::Rows;
use crate::geometry::Instance;
use crate::triangle::{Beam, PAD};
use gonio_kernel::{F32x8, Real, U32x8, Vec3};
use wide::{f32x8, f64x4};

/// Maps that stretch or shrink by more than this are laid out: the bounds of errors are made for others.
const MOST_STRETCH: f64 = (1 << 20) as f64;

/// So are those whose inverse, times themselves, is further than this from one.
const MOST_RESIDUAL: f64 = 1.0 / (1 << 30) as f64;

/// Rounding of a number to `f32`, at most.
pub(super) const U: f64 = 1.0 / (1 << 24) as f64;

/// An instance of a mesh that keeps a tree.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) instance: Instance,
    /// The place of its first triangle in the order of (instance, prim).
    pub(super) first: u32,
    pub(super) way: Way,
    /// How far points of the mesh may be off, along each axis, whatever the ray.
    pub(super) error: [f64; 3],
}

/// A subtree of a placed mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entrance {
    pub(super) subtree: Child,
    /// Number of the [`Placed`].
    pub(super) placed: u32,
    /// How likely a ray that enters is to hit it.
    pub(super) odds: Odds,
    /// All of it, in the world.
    pub(super) bounds: Box3,
    /// How far a hit may lie from where the ray passes its triangle, beyond the slack.
    pub(super) diagonal: f32,
}

/// From the world to a mesh's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// M⁻¹, by rows.
    inverse: [[f64; 3]; 3],
    /// The sums of their absolute values.
    pub(super) stretch: [f64; 3],
}

impl Way {
    /// The way to an instance's mesh; `None` if its map has no inverse, or hardly one.
    pub(super) fn to(instance: &Instance) -> Option<Self> {
        let m = instance.transform.map(|[a, b, c, _]| [a, b, c]);
        let next = |i: usize| [(i + 1) % 3, (i + 2) % 3]; // in a circle: then minors need no signs
        let minor = |r: usize, c: usize| {
            let ([r, s], [c, d]) = (next(r), next(c));
            m[r][c] * m[s][d] - m[r][d] * m[s][c]
        };
        let determinant: f64 = (0..3).map(|c| m[0][c] * minor(0, c)).sum();
        let inverse = [0, 1, 2].map(|r| [0, 1, 2].map(|c| minor(c, r) / determinant));
        let sum = |row: [f64; 3]| row.iter().map(|x| x.abs()).sum::<f64>();
        let stretch = inverse.map(sum);
        let residual = |r: usize, c: usize| {
            let one = if r == c { 1.0 } else { 0.0 };
            ((0..3).map(|k| inverse[r][k] * m[k][c]).sum::<f64>() - one).abs()
        };
        let is_inverse = (0..9).all(|i| residual(i / 3, i % 3) <= MOST_RESIDUAL); // not if it is not a number
        let is_tame = m.map(sum).into_iter().chain(stretch).all(|x| x <= MOST_STRETCH);
        (is_inverse && is_tame).then_some(Self { inverse, stretch })
    }

    /// A vector of the world in the mesh's coordinates.
    fn follow(&self, v: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|[a, b, c]| a * v[0] + b * v[1] + c * v[2])
    }
}

impl Placed {
    /// A ray in the mesh's coordinates.
    pub(super) fn enter(&self, beam: &Beam<f32>) -> Beam<f32> {
        let [origin, dir] = [beam.origin(), beam.dir()].map(|v| <[f32; 3]>::from(v).map(f64::from));
        let transform = &self.instance.transform;
        let origin = self.way.follow([0, 1, 2].map(|axis| origin[axis] - transform[axis][3]));
        let padding = 2.0 * f64::from(PAD * beam.reach());
        let error =
            [0, 1, 2].map(|axis| self.error[axis] + self.way.stretch[axis] * padding + 8.0 * U * origin[axis].abs());
        let [origin, dir, error] = [origin, self.way.follow(dir), error].map(|v| Vec3::from(v.map(|x| x as f32)));
        beam.moved(origin, dir, error)
    }

    /// A block of the mesh's tree as one of the world's.
    #[inline(always)]
    pub(super) fn in_world(&self, block: Cell<'_>) -> Rows {
        let map = self.instance.transform.map(|row| row.map(f64x4::splat));
        let mut rows = [f32x8::ZERO; 10];
        for (corner, rows) in block.corners().into_iter().zip(rows.chunks_exact_mut(3)) {
            // Lower and upper lanes apart, because four numbers of `f64` fill a register.
            let halves = <[F32x8; 3]>::from(corner).map(in_halves);
            for (row, &[a, b, c, t]) in rows.iter_mut().zip(&map) {
                // As `Instance::to_world` has it.
                let half = |h: usize| a * halves[0][h] + b * halves[1][h] + c * halves[2][h] + t;
                *row = joined([half(0), half(1)]);
            }
        }
        let index = std::array::from_fn(|lane| self.first + block.index(lane));
        rows[9] = U32x8::new(index).as_real().to_wide();
        rows
    }
}

/// The lower and the upper four lanes.
#[inline(always)]
fn in_halves(lanes: F32x8) -> [f64x4; 2] {
    let [a, b, c, d, e, f, g, h] = lanes.to_array().map(f64::from);
    [f64x4::new([a, b, c, d]), f64x4::new([e, f, g, h])]
}

/// Eight lanes of four each, rounded.
#[inline(always)]
fn joined(halves: [f64x4; 2]) -> f32x8 {
    let [[a, b, c, d], [e, f, g, h]] = halves.map(f64x4::to_array);
    f32x8::new([a, b, c, d, e, f, g, h].map(|x| x as f32))
}

impl Entrance {
    /// How far behind a hit of a ray of the world boxes still count, if in the world it is `slack`. A shallow hit is only known to
    /// lie in the padded box of its triangle, and far from the origin of the world the padding is that of its coordinates.
    pub(super) fn slack(&self, beam: &Beam<f32>, slack: f32) -> f32 {
        let coordinate = beam.origin().x.abs().max(beam.origin().y.abs()).max(beam.origin().z.abs());
        2.0 * slack + self.diagonal + 32.0 * U as f32 * coordinate
    }
}

/// The triangles of a block, as a set, whose own boxes a ray enters.
#[inline(always)]
pub(super) fn candidates(block: Cell<'_>, beam: &Beam<f32>, facing: &Facing, from: f32, until: f32) -> u32 {
    let [a, b, c] = block.corners().map(<[F32x8; 3]>::from);
    let ends = [0, 1, 2].map(|axis| [a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis])]);
    let [near, far] = facing.planes_of(|start| ends[start / 16 % 3][start / 8 % 2]);
    let [enter, leave] = beam.splat().slab(near, far);
    enter.max(F32x8::splat(from)).le(leave.min(F32x8::splat(until))).to_bits()
}
