//! The specimens: small meshes, generated here, each with something that ray casters get wrong.

use super::specimen::Specimen;
use gonio_accel::{Geometry, Instance, Mesh};
use gonio_lab::random::{seed_for, unit};

/// All of them.
pub(crate) fn specimens() -> Vec<Specimen> {
    let single = |mesh| (vec![mesh], vec![Instance { mesh: 0, transform: Instance::IDENTITY }]);
    let all = [
        ("box", single(cube())),
        ("sphere", single(sphere(3))),
        ("grid", single(grid())),
        ("soup", single(soup())),
        ("instances", instances()),
    ];
    all.into_iter()
        // A test below holds that none is refused.
        .filter_map(|(name, (meshes, instances))| {
            Some(Specimen::of_geometry(name, Geometry::new(meshes, instances).ok()?))
        })
        .collect()
}

/// Twelve triangles: every edge along an axis or a face's diagonal, boxes of no thickness.
fn cube() -> Mesh {
    let positions = (0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 })).collect();
    let quads = [[0, 2, 6, 4], [5, 7, 3, 1], [4, 5, 1, 0], [2, 3, 7, 6], [0, 1, 3, 2], [6, 7, 5, 4]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions, triangles }
}

/// A subdivided octahedron: 8·4ⁿ triangles, with vertices exactly on the axes.
fn sphere(subdivisions: u32) -> Mesh {
    let mut positions: Vec<[f32; 3]> =
        vec![[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..subdivisions {
        // Neighbours must share the middle of their edge, or the sphere is not closed.
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let (p, q) = (positions[a as usize], positions[b as usize]);
                let sum = [0, 1, 2].map(|axis| f64::from(p[axis]) + f64::from(q[axis]));
                let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                positions.push(sum.map(|x| (x / length) as f32));
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    Mesh { positions, triangles }
}

/// A height field of 2 · 24² triangles, flat to the last bit in one half.
fn grid() -> Mesh {
    const N: u32 = 24;
    let at = |i: u32| f64::from(i) / f64::from(N) * 4.0 - 2.0;
    let height = |x: f64, z: f64| if x < 0.0 { 0.0 } else { 0.3 * (3.0 * x).sin() * (2.0 * z).cos() };
    let positions =
        (0..=N).flat_map(|j| (0..=N).map(move |i| [at(i) as f32, height(at(i), at(j)) as f32, at(j) as f32])).collect();
    let triangles = (0..N).flat_map(|j| {
        (0..N).flat_map(move |i| {
            let a = j * (N + 1) + i;
            [[a, a + N + 1, a + 1], [a + 1, a + N + 1, a + N + 2]]
        })
    });
    Mesh { positions, triangles: triangles.collect() }
}

/// 500 triangles of every size and shape, needles among them; a tenth lies there twice, a tenth without any area.
fn soup() -> Mesh {
    let seed = seed_for(0, "soup");
    let mut mesh = Mesh::default();
    for i in 0..500_u64 {
        let u = |dimension| unit(seed, i, dimension);
        let first = mesh.positions.len() as u32;
        let size = 1e-3_f64.powf(u(0));
        let needle = if i % 5 == 0 { 1e-4 } else { 1.0 };
        let centre = [1, 2, 3].map(|d| 2.0 * u(d) - 1.0);
        let [e, f] = [[4, 5, 6], [7, 8, 9]].map(|d| d.map(|d| size * (2.0 * u(d) - 1.0)));
        let corner =
            |s: f64, t: f64| std::array::from_fn(|axis| (centre[axis] + s * e[axis] + t * needle * f[axis]) as f32);
        mesh.positions.extend([corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
        let triangle = [first, first + 1, first + 2];
        mesh.triangles.push(triangle);
        match i % 10 {
            3 => mesh.triangles.push(triangle),                      // a tie in everything
            7 => mesh.triangles.push([first, first + 1, first + 1]), // no area
            _ => {}
        }
    }
    mesh
}

/// Boxes and spheres, placed by rotations, uneven scales and a mirror image; some overlap, one is far away.
fn instances() -> (Vec<Mesh>, Vec<Instance>) {
    let seed = seed_for(0, "instances");
    let instances = (0..16_u64).map(|i| {
        let u = |dimension| unit(seed, i, dimension);
        let (sin, cos) = (std::f64::consts::TAU * u(0)).sin_cos();
        let [a, b, c] = [1, 2, 3].map(|d| 0.2 + u(d));
        let c = if i % 4 == 0 { -c } else { c };
        let far = if i == 15 { 100.0 } else { 1.0 };
        let [x, y, z] = [4, 5, 6].map(|d| far * (4.0 * u(d) - 2.0));
        let transform = [[a * cos, -b * sin, 0.0, x], [a * sin, b * cos, 0.1 * c, y], [0.0, 0.0, c, z]];
        Instance { mesh: (i % 2) as u32, transform }
    });
    (vec![cube(), sphere(1)], instances.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_specimen_is_refused_and_the_closed_ones_are_closed() {
        let all: Vec<_> = specimens()
            .iter()
            .map(|s| (s.name.clone(), s.count(), (0..s.count()).filter(|&i| s.is_closed(s.place(i))).count()))
            .collect();
        let expected =
            [("box", 12, 12), ("sphere", 512, 512), ("grid", 1152, 0), ("soup", 600, 0), ("instances", 352, 352)];
        assert_eq!(all, expected.map(|(name, count, closed)| (name.to_owned(), count, closed)));
    }
}
