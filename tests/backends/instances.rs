//! A tree that instances share gives the hits of triangles that are laid out in the world, to the last bit.

use super::filters::Witness;
use super::{bits, blocked, hits, hits_by, ordinary_rays, telling_rays, tiles_of_rays};
use crate::support::{Random, grid, hills, soup, sphere};
use gonio_accel::{Brute, Geometry, Instance, Intersect, Mesh, Obvhs, ObvhsOptions, RayKind, Sharing};
use gonio_kernel::F32x8;

type Map = [[f64; 4]; 3];

/// Any map: a random matrix whose columns are scaled, which turns, shears and mirrors.
fn map(random: &mut Random, scale: f64, away: f32) -> Map {
    let columns = [0, 1, 2].map(|_| <[f32; 3]>::from(random.direction()).map(f64::from));
    let sizes = [0, 1, 2].map(|_| scale * f64::from(random.within(-1.5, 1.5)).exp2());
    let place = <[f32; 3]>::from(random.point(away)).map(f64::from);
    [0, 1, 2]
        .map(|row| [columns[0][row] * sizes[0], columns[1][row] * sizes[1], columns[2][row] * sizes[2], place[row]])
}

fn placed(meshes: Vec<Mesh>, maps: Vec<(u32, Map)>) -> Geometry {
    let instances = maps.into_iter().map(|(mesh, transform)| Instance { mesh, transform }).collect();
    Geometry::new(meshes, instances).expect("the geometry is sound")
}

/// Long triangles of all directions, thinner than a hundredth of their length.
fn needles(count: u32, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let a = random.point(0.5);
        let b = a + random.direction();
        let c = a + (b - a) * random.unit() + random.point(0.005);
        mesh.positions.extend([a, b, c].map(<[f32; 3]>::from));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    mesh
}

fn geometries() -> Vec<(&'static str, Geometry)> {
    let mut random = Random(23);
    let mut several = |mesh: u32, count: usize, scale: f64, away: f32| -> Vec<(u32, Map)> {
        (0..count).map(|_| (mesh, map(&mut random, scale, away))).collect()
    };
    let flat = [[1.0, 0.0, 0.0, 0.2], [0.0, 1.0, 0.0, 0.1], [0.0, 0.0, 0.0, 0.3]];
    let mut mixed = several(0, 6, 0.3, 1.0);
    mixed.extend(several(1, 3, 0.4, 1.0));
    mixed.extend([(0, Instance::IDENTITY), (1, flat), (2, Instance::IDENTITY)]);
    let same = several(0, 1, 1.0, 0.5)[0];
    let far = (
        0,
        [0, 1, 2].map(|row| {
            let mut far = Instance::IDENTITY[row];
            far[3] = f64::from(1 << 20);
            far
        }),
    );
    let mut other = Random(29);
    vec![
        ("one sphere, turned", placed(vec![sphere(12, [0.0; 3])], several(0, 1, 1.0, 0.5))),
        ("spheres", placed(vec![sphere(10, [0.0; 3])], several(0, 9, 0.4, 1.0))),
        ("spheres on one place", placed(vec![sphere(9, [0.0; 3])], vec![same; 3])),
        ("spheres of a thousandth", placed(vec![sphere(10, [0.0; 3])], several(0, 12, 1e-3, 1.0))),
        ("spheres from a small model", placed(vec![sphere(8, [0.0; 3])], several(0, 3, 1e3, 500.0))),
        ("spheres far from their origin", placed(vec![sphere(10, [500.0, -200.0, 300.0])], several(0, 3, 1.0, 0.0))),
        ("a sphere whose triangles are as small as the rounding", placed(vec![sphere(40, [0.0; 3])], vec![far])),
        ("soups", placed(vec![soup(200, &mut other)], several(0, 4, 1.0, 0.5))),
        ("needles", placed(vec![needles(200, &mut other)], several(0, 4, 1.0, 0.5))),
        (
            "hills and a grid",
            placed(vec![hills(12), grid(6)], [several(0, 2, 0.5, 1.0), several(1, 2, 1.0, 1.0)].concat()),
        ),
        ("meshes of all kinds", placed(vec![sphere(8, [0.0; 3]), soup(50, &mut other), grid(4)], mixed)),
        ("a mesh of one block", placed(vec![sphere(2, [0.0; 3])], several(0, 20, 0.2, 1.0))),
    ]
}

fn shared(geometry: &Geometry, intersect: Intersect) -> Obvhs {
    let tree = Obvhs::always_tree(geometry, ObvhsOptions { sharing: Sharing::Always, intersect, ..Default::default() });
    assert_eq!(tree.validate(), Ok(()));
    tree
}

#[test]
fn shared_trees_agree_with_brute_to_the_last_bit() {
    for (name, geometry) in geometries() {
        let (brute, tree) = (Brute::new(&geometry), shared(&geometry, Intersect::Robust));
        let mut random = Random(3);
        let mut rays = telling_rays(&geometry, 40_000, &mut random);
        rays.extend((0..100).flat_map(|_| tiles_of_rays(&geometry, &mut random)));
        let expected = hits(&brute, &rays);
        for kind in [RayKind::Coherent, RayKind::Incoherent] {
            for (i, (a, b)) in expected.iter().zip(hits_by(kind, &tree, &rays)).enumerate() {
                assert_eq!(bits(a), bits(&b), "{name}: lane {} of {:?}", i % 8, rays[i / 8]);
            }
        }
        assert_eq!(blocked(&brute, &rays, None), blocked(&tree, &rays, None), "{name}");
        // Once more, up to no farther than what they hit.
        let found: Vec<f32> = expected.iter().map(|hit| hit.map_or(1.0, |hit| hit.t)).collect();
        for (ray, t) in rays.iter_mut().zip(found.chunks(8)) {
            ray.t_max = F32x8::from_fn(|lane| t[lane]);
        }
        for (i, (a, b)) in hits(&brute, &rays).iter().zip(hits(&tree, &rays)).enumerate() {
            assert_eq!(bits(a), bits(&b), "{name}, just as far: lane {} of {:?}", i % 8, rays[i / 8]);
        }
        assert!(10 * expected.iter().flatten().count() > expected.len(), "{name}: hardly a ray meets something");
    }
}

#[test]
fn a_filter_sees_the_instances_of_a_shared_tree() {
    for (name, geometry) in geometries() {
        let rays = ordinary_rays(4_000, &mut Random(31));
        let expected = Witness::of(&Brute::new(&geometry), &rays);
        assert_eq!(Witness::of(&shared(&geometry, Intersect::Robust), &rays), expected, "{name}");
    }
}

#[test]
fn the_fast_test_finds_the_same_in_a_shared_tree_and_in_one_that_is_laid_out() {
    for (name, geometry) in geometries() {
        let rays = ordinary_rays(40_000, &mut Random(37));
        let options = ObvhsOptions { sharing: Sharing::Never, intersect: Intersect::Fast, ..Default::default() };
        let [a, b] = [Obvhs::always_tree(&geometry, options), shared(&geometry, Intersect::Fast)];
        let (a, b) = (hits(&a, &rays), hits(&b, &rays));
        let differ = a.iter().zip(&b).filter(|(a, b)| bits(a) != bits(b)).count();
        assert!(differ <= 4, "{name}: {differ} of 40,000 hits");
    }
}

#[test]
fn large_scenes_share_trees_without_being_asked() {
    let mesh = sphere(60, [0.0; 3]);
    let each = mesh.triangles.len();
    let mut random = Random(41);
    let forest = |count: usize, random: &mut Random| {
        placed(vec![mesh.clone()], (0..count).map(|_| (0, map(random, 1e-2, 1.0))).collect())
    };
    let bytes = |geometry: &Geometry| Obvhs::new(geometry, Intersect::Robust).bytes();
    let (few, many) = (100, (1 << 22) / each + 1);
    let (few, many) =
        (bytes(&forest(few, &mut random)) / (few * each), bytes(&forest(many, &mut random)) / (many * each));
    assert!(few > 50 && many < 2, "{few} and {many} bytes per triangle");
}
