//! Where rays are aimed, and whether the surface there must stop them.
//!
//! A ray aimed at an interior edge or a surrounded vertex passes between triangles. If all of them face the ray from the
//! same side, and the ray passes the outer border of their fan well inside, then the fan covers the ray: whatever rounding
//! makes of the place in the middle, one of the triangles must be hit, and a miss is a leak. The condition is sufficient, not
//! necessary (a ray over a ridge may go either way and says nothing), and it is computed in `f64` from the ray as it is.

use super::specimen::{Place, Specimen};
use super::wide::wide;
use gonio_kernel::Vec3;
use gonio_kernel::frame::tangents;

/// What a ray is aimed at.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// The edge from a corner of a triangle to the next.
    Edge(Place, usize),
    /// A corner of a triangle.
    Vertex(Place, usize),
}

/// One ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3<f32>,
    pub(crate) dir: Vec3<f32>,
    pub(crate) t_min: f32,
    pub(crate) t_max: f32,
    /// Whether the surface at its target must stop it.
    pub(crate) covered: bool,
}

/// Fans of more triangles than this are not looked at.
const MOST: usize = 64;

/// How far inside of the fan's border a covered ray passes, in units of the distance to its farthest corner: eight times the
/// error of a projected corner, which is 8·2⁻²⁴.
const MARGIN: f64 = 64.0 / 16_777_216.0;

/// The least cosine between a covered ray and the normals: beyond it the distance is ill-conditioned.
const STEEP: f64 = 1.0 / 1024.0;

/// Whether the triangles around the target cover the ray.
pub(crate) fn covers(specimen: &Specimen, target: Target, ray: &Ray) -> bool {
    let (place, corner) = match target {
        Target::Edge(place, corner) | Target::Vertex(place, corner) => (place, corner),
    };
    let topology = specimen.topology(place.instance);
    let edge;
    let fan: &[u32] = match target {
        Target::Edge(..) => match topology.along_edge(place.prim, corner) {
            Some(pair) => {
                edge = pair;
                &edge
            }
            None => return false,
        },
        Target::Vertex(..) => topology.around_vertex(place.prim, corner),
    };
    if fan.is_empty() || fan.len() > MOST {
        return false;
    }
    if matches!(target, Target::Vertex(..)) && !topology.is_surrounded(place.prim, corner) {
        return false;
    }
    let projection = Projection::of(ray);
    let mut side = 0.0;
    fan.iter().all(|&t| {
        let corners = specimen.corners(Place { prim: t, ..place }).map(|v| projection.project(v));
        // Edges that belong to the border of the fan.
        let border: Option<&[usize]> = match target {
            Target::Vertex(..) => topology.same_corner(place.prim, corner, t).map(|k| &[[1], [2], [0]][k][..]),
            Target::Edge(..) => {
                let is_shared = |k: &usize| topology.along_edge(t, *k).is_some_and(|pair| same(pair, fan));
                (0..3).find(is_shared).map(|k| &[[1, 2], [2, 0], [0, 1]][k][..])
            }
        };
        let sign = border.and_then(|border| projection.passes(ray, &corners, border)).unwrap_or(0.0);
        let ok = sign != 0.0 && side * sign >= 0.0;
        side = sign;
        ok
    })
}

fn same(pair: [u32; 2], fan: &[u32]) -> bool {
    fan == pair || fan == [pair[1], pair[0]]
}

/// Coordinates about a ray: two across it, and the distance along it.
struct Projection {
    origin: Vec3<f64>,
    across: [Vec3<f64>; 2],
    along: Vec3<f64>,
}

impl Projection {
    fn of(ray: &Ray) -> Self {
        let along = wide(ray.dir).normalize();
        let (x, y) = tangents(along);
        Self { origin: wide(ray.origin), across: [x, y], along }
    }

    fn project(&self, v: Vec3<f32>) -> Vec3<f64> {
        let a = wide(v) - self.origin;
        Vec3::new(a.dot(self.across[0]), a.dot(self.across[1]), a.dot(self.along))
    }

    /// Which way round the triangle lies about the ray, if it is steep enough, the ray meets its plane well within its
    /// interval and passes the `border` edges well on the inner side.
    fn passes(&self, ray: &Ray, c: &[Vec3<f64>; 3], border: &[usize]) -> Option<f64> {
        let normal = (c[1] - c[0]).cross(c[2] - c[0]);
        if normal.z.abs() < STEEP * normal.length() || normal.z == 0.0 {
            return None;
        }
        let side = normal.z.signum();
        let reach = c.iter().map(|v| v.length()).fold(0.0, f64::max);
        let (t, slack) = (normal.dot(c[0]) / normal.z, reach * MARGIN / STEEP);
        if !(t - slack > ray.t_min.into() && t + slack < ray.t_max.into()) {
            return None;
        }
        let well_inside = border.iter().all(|&k| {
            let (p, q) = (c[k], c[(k + 1) % 3]);
            let length = (q.x - p.x).hypot(q.y - p.y);
            side * (p.x * q.y - p.y * q.x) > MARGIN * reach * length
        });
        well_inside.then_some(side)
    }
}

#[cfg(test)]
mod tests {
    use super::super::meshes::specimens;
    use super::*;

    /// From the middle of the box, at a target.
    fn ray_at(to: Vec3<f32>) -> Ray {
        Ray { origin: Vec3::splat(0.0), dir: to.normalize(), t_min: 0.0, t_max: f32::INFINITY, covered: false }
    }

    #[test]
    fn the_inside_of_a_box_covers_its_edges_and_corners_and_a_silhouette_does_not() {
        let specimens = specimens();
        let cube = specimens.iter().find(|s| s.name == "box").unwrap();
        for i in 0..12 {
            let place = cube.place(i);
            let corners = cube.corners(place);
            for k in 0..3 {
                let middle = (corners[k] + corners[(k + 1) % 3]) * 0.5;
                assert!(covers(cube, Target::Edge(place, k), &ray_at(middle)), "edge {k} of {i}");
                assert!(covers(cube, Target::Vertex(place, k), &ray_at(corners[k])), "vertex {k} of {i}");
                // Too short to arrive, or past the corner, or elsewhere.
                let short = Ray { t_max: 0.5, ..ray_at(middle) };
                assert!(!covers(cube, Target::Edge(place, k), &short));
                assert!(!covers(cube, Target::Vertex(place, k), &ray_at(-corners[k])));
                // From beside: one face is seen from the front, the other from behind.
                let along = (corners[(k + 1) % 3] - corners[k]).normalize();
                let out = middle.normalize();
                let past = Ray { origin: middle + along.cross(out) * 3.0, dir: -along.cross(out), ..ray_at(middle) };
                let diagonal = middle.length() < 1.1;
                assert!(diagonal || !covers(cube, Target::Edge(place, k), &past), "edge {k} of {i}");
            }
        }
    }

    #[test]
    fn a_border_covers_nothing() {
        let specimens = specimens();
        let grid = specimens.iter().find(|s| s.name == "grid").unwrap();
        let place = grid.place(0); // the corner of the height field
        let corners = grid.corners(place);
        let covered = (0..3).map(|k| {
            let middle = (corners[k] + corners[(k + 1) % 3]) * 0.5;
            let up = Vec3::new(0.0, 1.0, 0.0);
            let ray = Ray { origin: middle - up, dir: up, ..ray_at(middle) };
            covers(grid, Target::Edge(place, k), &ray)
        });
        assert_eq!(covered.filter(|&covered| covered).count(), 1); // the diagonal alone has two sides
    }
}
