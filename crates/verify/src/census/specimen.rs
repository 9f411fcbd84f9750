//! What rays are cast at, with everything that is known of it: bounds, neighbourhoods, a camera, lights, and its scale.

use super::topology::Topology;
use super::wide::wide;
use crate::error::Error;
use gonio_accel::{Geometry, Hit, Instance, Ray8, WorldTriangle};
use gonio_kernel::{F32x8, Vec3};
use gonio_tracer::scene::{Camera, FilmSettings};
use gonio_tracer::{View, World};
use std::sync::Arc;

/// A geometry and what is known of it, at one scale.
#[derive(Clone)]
pub struct Specimen {
    /// Its name in reports.
    pub name: String,
    pub(crate) geometry: Geometry,
    /// The factor on all lengths.
    pub(crate) scale: f64,
    /// World bounds.
    pub(crate) lo: Vec3<f32>,
    pub(crate) hi: Vec3<f32>,
    /// The corners of every emitting triangle.
    pub(crate) emitters: Vec<[Vec3<f32>; 3]>,
    /// More than one triangle in a hundred is a needle, whose plane f32 hardly knows.
    pub(crate) needles: bool,
    /// At scale 1.
    view: View,
    /// Of each mesh.
    topology: Arc<Vec<Topology>>,
    /// The first triangle of each instance, and one past the last of all.
    starts: Vec<u32>,
}

/// A triangle of a specimen: its instance, and its place in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) instance: u32,
    pub(crate) prim: u32,
}

impl Specimen {
    /// A scene, seen by its own camera.
    pub fn of_world(name: &str, world: &World) -> Self {
        let emitters = world.emitters().collect();
        Self::new(name, world.geometry().clone(), world.view(), emitters)
    }

    /// A geometry, seen from beyond a corner of its bounds, with no lights.
    pub fn of_geometry(name: &str, geometry: Geometry) -> Self {
        let [lo, hi] = bounds(&geometry).map(wide);
        let [origin, target] = [hi + (hi - lo) * 0.7, (lo + hi) * 0.5].map(|v| [v.x, v.y, v.z].into());
        let film = FilmSettings { width: 256, height: 256, spp: 1, exposure: 0.0 };
        let camera = Camera::pinhole(origin, target, [0.0, 1.0, 0.0].into(), 50.0);
        let view = View::new(&camera, &film, [0.0; 3].into());
        Self::new(name, geometry, view, Vec::new())
    }

    fn new(name: &str, geometry: Geometry, view: View, emitters: Vec<[Vec3<f32>; 3]>) -> Self {
        let topology = Arc::new(geometry.meshes().iter().map(Topology::of).collect());
        let mut starts = vec![0];
        for instance in geometry.instances() {
            let count = geometry.meshes()[instance.mesh as usize].triangles.len() as u32;
            starts.push(starts.last().map_or(0, |start| start + count));
        }
        let [lo, hi] = bounds(&geometry);
        let needles = 100 * geometry.world_triangles().filter(is_needle).count() > geometry.triangle_count();
        Self { name: name.to_owned(), geometry, scale: 1.0, lo, hi, emitters, needles, view, topology, starts }
    }

    /// The same with all lengths multiplied.
    ///
    /// # Errors
    /// If it would reach beyond what rays can.
    pub(crate) fn scaled(&self, scale: f64) -> Result<Self, Error> {
        let instances = self.geometry.instances().iter();
        let instances = instances.map(|i| Instance { transform: i.transform.map(|row| row.map(|x| x * scale)), ..*i });
        let geometry = Geometry::new(self.geometry.meshes().to_vec(), instances.collect())
            .map_err(|source| Error::Scale { name: self.name.clone(), scale, source })?;
        let [lo, hi] = bounds(&geometry);
        let emitters = self.emitters.iter().map(|corners| corners.map(|v| v * scale as f32)).collect();
        Ok(Self { geometry, scale: self.scale * scale, lo, hi, emitters, ..self.clone() })
    }

    /// How many triangles there are.
    pub fn count(&self) -> u32 {
        self.starts.last().copied().unwrap_or(0)
    }

    /// The diagonal of the bounds.
    pub(crate) fn size(&self) -> f32 {
        (self.hi - self.lo).length()
    }

    /// The place of the i-th triangle in the order (instance, prim).
    pub(crate) fn place(&self, i: u32) -> Place {
        let instance = self.starts.partition_point(|&start| start <= i).saturating_sub(1);
        Place { instance: instance as u32, prim: i - self.starts[instance] }
    }

    /// Whether a hit names a triangle that there is.
    pub(crate) fn has(&self, hit: &Hit) -> bool {
        let instance = self.geometry.instances().get(hit.instance as usize).filter(|i| i.mesh == hit.mesh);
        let mesh = instance.and_then(|i| self.geometry.meshes().get(i.mesh as usize));
        mesh.is_some_and(|mesh| (hit.prim as usize) < mesh.triangles.len())
    }

    /// The corners of a triangle in the world.
    pub(crate) fn corners(&self, place: Place) -> [Vec3<f32>; 3] {
        let instance = &self.geometry.instances()[place.instance as usize];
        let mesh = &self.geometry.meshes()[instance.mesh as usize];
        mesh.triangles[place.prim as usize].map(|v| instance.to_world(mesh.positions[v as usize]).into())
    }

    /// The neighbourhoods of an instance's mesh.
    pub(crate) fn topology(&self, instance: u32) -> &Topology {
        &self.topology[self.geometry.instances()[instance as usize].mesh as usize]
    }

    /// Whether the triangle belongs to a closed surface.
    pub(crate) fn is_closed(&self, place: Place) -> bool {
        self.topology(place.instance).is_closed(place.prim)
    }

    /// How many triangles belong to closed surfaces.
    pub fn closed_count(&self) -> usize {
        (0..self.count()).filter(|&i| self.is_closed(self.place(i))).count()
    }

    /// Columns and rows of the camera's picture.
    pub(crate) fn picture(&self) -> [f32; 2] {
        self.view.size()
    }

    /// Camera rays through places of the picture in pixels, y down.
    pub(crate) fn camera(&self, x: F32x8, y: F32x8) -> Ray8 {
        let ray = self.view.rays(x, y, [F32x8::splat(0.5); 2]);
        Ray8 { origin: ray.origin * F32x8::splat(self.scale as f32), ..ray }
    }
}

/// Whether two sides are parallel to a thousandth.
fn is_needle(t: &WorldTriangle) -> bool {
    let [a, b, c] = t.corners.map(wide);
    let (e1, e2) = (b - a, c - a);
    e1.cross(e2).length() <= 1e-3 * e1.length() * e2.length()
}

/// The bounds of everything that is placed; a point at the origin if there is nothing.
fn bounds(geometry: &Geometry) -> [Vec3<f32>; 2] {
    let corners = geometry.world_triangles().flat_map(|t: WorldTriangle| t.corners);
    let grow = |[lo, hi]: [Vec3<f32>; 2], v: Vec3<f32>| {
        [Vec3::new(lo.x.min(v.x), lo.y.min(v.y), lo.z.min(v.z)), Vec3::new(hi.x.max(v.x), hi.y.max(v.y), hi.z.max(v.z))]
    };
    corners.map(|v| [v, v]).reduce(|a, b| grow(grow(a, b[0]), b[1])).unwrap_or([Vec3::splat(0.0); 2])
}

#[cfg(test)]
mod tests {
    use super::super::meshes::specimens;
    #[test]
    fn places_and_corners_are_those_of_the_geometry_at_every_scale() {
        for specimen in specimens() {
            for scale in [1.0, 1e-4, 1e6] {
                let scaled = specimen.scaled(scale).unwrap();
                for (i, triangle) in scaled.geometry.world_triangles().enumerate() {
                    let place = scaled.place(i as u32);
                    assert_eq!((place.instance, place.prim), (triangle.id.instance, triangle.id.prim));
                    assert_eq!(scaled.corners(place), triangle.corners);
                }
                assert!((f64::from(scaled.size()) / f64::from(specimen.size()) / scale - 1.0).abs() < 1e-5);
            }
        }
    }
}
