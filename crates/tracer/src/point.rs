//! Shading points: where eight paths met the world, and in which frame they are shaded.

use crate::effects::{Effect, EffectSet};
use crate::material::PreparedMaterial;
use crate::queue::Batch;
use crate::scene::NormalMapSpec;
use crate::surface_point::SurfacePoint;
use crate::world::World;
use gonio_kernel::frame::{facing, tangents};
use gonio_kernel::{F32x8, Frame, Mask, Mask8, Real, Vec3, each_lane};

/// Eight shading points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadingPoints<'w> {
    pub(crate) point: SurfacePoint,
    /// Geometric normal, unit, on wo's side.
    pub(crate) normal: Vec3<F32x8>,
    /// Shading frame: on wo's side, or, if light passes through, on the side that the winding faces.
    pub(crate) frame: Frame<F32x8>,
    /// Where the ray came from the side that the winding faces.
    pub(crate) front: Mask8,
    /// cos between wo and the geometric normal, ≥ 0.
    pub(crate) cos_geometric: F32x8,
    /// Distance travelled.
    pub(crate) t: F32x8,
    /// Texture coordinates, 0 without.
    pub(crate) uv: [F32x8; 2],
    pub(crate) materials: [&'w PreparedMaterial; F32x8::LANES],
}

impl<'w> ShadingPoints<'w> {
    /// Looks up the hits of a batch; wo points back along the rays.
    #[inline(always)]
    pub(crate) fn new(world: &'w World, effects: EffectSet, batch: &Batch, wo: Vec3<F32x8>) -> Self {
        let bary = [batch.hit(|h| &h.bary[0]), batch.hit(|h| &h.bary[1])];
        let t = batch.hit(|h| &h.t);
        let triangles = each_lane(|l| {
            let (instance, _, prim) = batch.hit_place(l);
            world.surfaces.triangle(instance, prim)
        });
        let corner = |c: usize| Vec3::from_lanes(|l| triangles[l].corners[c]);
        let corners = [corner(0), corner(1), corner(2)];
        let winding = Vec3::from_lanes(|l| triangles[l].normal);
        let cos = winding.dot(wo);
        let front = cos.ge(F32x8::ZERO);
        let side = F32x8::ONE.copysign(cos);
        let normal = winding * side;

        let mut shading = normal;
        let by_vertex = effects.has(Effect::SmoothNormals) || effects.has_uvs();
        let vertices = if by_vertex {
            each_lane(|l| {
                let (instance, mesh, prim) = batch.hit_place(l);
                world.surfaces.vertex_indices(instance, mesh, prim)
            })
        } else {
            [[0; 3]; F32x8::LANES]
        };
        if effects.has(Effect::SmoothNormals) {
            let at = |c: usize| Vec3::from_lanes(|l| world.surfaces.normal(batch.hit_place(l).0, vertices[l][c]));
            let b0 = F32x8::ONE - bary[0] - bary[1];
            let n = ((at(0) * b0).along(bary[0], at(1)).along(bary[1], at(2)) * side).normalize_or(normal);
            shading = facing(n, normal, wo);
        }

        let mut uv = [F32x8::ZERO; 2];
        let (x, y) = tangents(shading); // unit already: no need to normalise again
        let mut frame = Frame { x, y, z: shading };
        let materials = each_lane(|l| &world.materials[triangles[l].material as usize]);
        let which = |is| lanes_where(&materials, is);
        if effects.has_uvs() && !world.surfaces.uvs.is_empty() {
            let at = |c: usize, k: usize| F32x8::from_fn(|l| world.surfaces.uvs[vertices[l][c]][k]);
            let [u, v] = [[at(0, 0), at(1, 0), at(2, 0)], [at(0, 1), at(1, 1), at(2, 1)]];
            let b0 = F32x8::ONE - bary[0] - bary[1];
            let blend = |x: [F32x8; 3]| b0.mul_add(x[0], bary[0].mul_add(x[1], bary[1] * x[2]));
            uv = [blend(u), blend(v)];
            let (mut along_u, mut mapped) = (Mask8::splat(false), Mask8::splat(false));
            if effects.has(Effect::Tangents) {
                along_u = which(|m| m.anisotropic);
            }
            if effects.has(Effect::NormalMaps) {
                mapped = which(|m| m.normal_map.is_some());
                along_u = along_u | mapped;
            }
            if along_u.any() {
                // ∂p/∂u up to a positive factor: solve e₁ = Δu₁ ∂u + Δv₁ ∂v, e₂ likewise.
                let (dv1, dv2) = (v[1] - v[0], v[2] - v[0]);
                let det = (u[1] - u[0]) * dv2 - (u[2] - u[0]) * dv1;
                let (e1, e2) = (corners[1] - corners[0], corners[2] - corners[0]);
                let tangent = (e1 * dv2 - e2 * dv1) * F32x8::ONE.copysign(det);
                // Where an instanced mesh is mirrored, its corners go round the other way.
                let handed = F32x8::ONE.copysign(det) * F32x8::ONE.copysign(winding.dot(e1.cross(e2)));
                let along = Frame { z: shading, ..Frame::from_normal_tangent(shading, tangent) };
                frame = Frame::select(along_u, along, frame);
                if mapped.any() {
                    let n = sampled_normals(world, &materials, uv);
                    // ∂p/∂v lies to the other hand where the image is mirrored, and seen from behind, bumps are dents.
                    let n = Vec3::new(n.x * side, n.y * handed, n.z);
                    let tilted = frame.tilted(facing(n, frame.to_local(normal), frame.to_local(wo)));
                    frame = Frame::select(mapped, tilted, frame);
                }
            }
        }
        if effects.has(Effect::Transmission) {
            // An interface has an inside, behind its winding: seen from there, wo is below the surface.
            let turn = which(|m| m.transmits) & !front;
            frame = Frame::select(turn, Frame { x: frame.x, y: -frame.y, z: -frame.z }, frame);
        }
        Self {
            point: SurfacePoint::new(&corners, bary),
            normal,
            frame,
            front,
            cos_geometric: cos.abs(),
            t,
            uv,
            materials,
        }
    }
}

impl ShadingPoints<'_> {
    /// Where the material is such.
    #[inline(always)]
    pub(crate) fn which(&self, is: fn(&PreparedMaterial) -> bool) -> Mask8 {
        lanes_where(&self.materials, is)
    }

    /// Whether all eight are of the same material.
    #[inline(always)]
    pub(crate) fn of_one_material(&self) -> bool {
        self.materials.iter().all(|&m| std::ptr::eq(m, self.materials[0]))
    }
}

/// The lanes whose material is such.
#[inline(always)]
fn lanes_where(materials: &[&PreparedMaterial; F32x8::LANES], is: fn(&PreparedMaterial) -> bool) -> Mask8 {
    Mask8::from_bits((0..F32x8::LANES).fold(0, |bits, l| bits | u32::from(is(materials[l])) << l))
}

/// The normals of the lanes' maps at their texture coordinates, in tangent space; (0, 0, 1) without a map.
fn sampled_normals(world: &World, materials: &[&PreparedMaterial; F32x8::LANES], uv: [F32x8; 2]) -> Vec3<F32x8> {
    let [u, v] = uv.map(F32x8::to_array);
    Vec3::from_lanes(|l| match materials[l].normal_map {
        Some(NormalMapSpec { map, scale }) => world.normal_maps[map].sample(u[l], v[l], scale),
        None => Vec3::unit_z(),
    })
}
