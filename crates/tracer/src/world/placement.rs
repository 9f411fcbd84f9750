//! Placing: from the coordinates of a mesh to those of the world.

use crate::light::delta::Bounds;
use crate::scene::{Instance, Mesh};
use glam::{DMat3, DVec3};
use gonio_kernel::Vec3;

use super::triangle::{Triangle, unit_normal};

/// How an instanced mesh comes to the world.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    pub(super) instance: gonio_accel::Instance,
    pub(super) normal_matrix: DMat3,
    /// −1 if mirrored.
    pub(super) side: f32,
}

impl Placement {
    /// A triangle of the mesh, in the world: with the very corners that rays are cast at.
    pub(super) fn place(&self, triangle: &Triangle) -> Triangle {
        let corners = triangle.corners.map(|c| Vec3::from(self.instance.to_world(c.into())));
        Triangle { corners, normal: unit_normal(&corners) * self.side, ..*triangle }
    }
}

/// What normals are multiplied by.
pub(super) fn normal_matrix(instance: &Instance) -> DMat3 {
    instance.transform.matrix3.inverse().transpose()
}

/// A normal, turned and made unit; 0 stays 0.
pub(super) fn turn(normal_matrix: DMat3, n: [f32; 3]) -> Vec3<f32> {
    (normal_matrix * glam::Vec3::from(n).as_dvec3()).normalize_or_zero().as_vec3().to_array().into()
}

/// The middle of everything that is placed, and how far that reaches.
pub(super) fn bounds(instances: &[Instance], meshes: &[Mesh]) -> Bounds {
    let corners = |i: &Instance| meshes[i.mesh].positions.iter();
    let placed = instances.iter().flat_map(|i| corners(i).map(move |&p| i.transform.transform_point3(p.into())));
    let [lo, hi] = box_of(placed);
    Bounds {
        center: middle(lo, hi),
        radius: if lo.is_finite() && hi.is_finite() { (hi - lo).length() * 0.5 } else { 0.0 },
    }
}

/// The middle of the box of some points; the origin if there is none.
pub(super) fn middle_of(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let [lo, hi] = box_of(points);
    middle(lo, hi)
}

fn box_of(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)])
}

fn middle(lo: DVec3, hi: DVec3) -> DVec3 {
    if lo.is_finite() && hi.is_finite() { lo * 0.5 + hi * 0.5 } else { DVec3::ZERO }
}
