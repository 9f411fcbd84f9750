//! Every backend finds the hit that brute finds, to the last bit, and nothing leaks through closed surfaces.

use crate::support::{Random, geometry, grid, side_by_side, soup, sphere};
use gonio_accel::{Accel, Brute, Geometry, GeometryError, Hit, Hit8, Intersect, Mesh, Obvhs, Opacity, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, Vec3};

/// The hits of one packet, misses as `None`.
fn hits(accel: &dyn Accel, rays: &[Ray8]) -> Vec<Option<Hit>> {
    let mut hits = vec![Hit8::miss(); rays.len()];
    accel.closest(RayKind::Incoherent, rays, &mut hits);
    hits.iter().flat_map(|h| (0..8).map(|l| h.lane(l))).collect()
}

fn blocked(accel: &dyn Accel, rays: &[Ray8], filter: Option<&dyn Opacity>) -> Vec<u32> {
    let mut blocked = vec![Mask8::first(0); rays.len()];
    accel.occluded(RayKind::Incoherent, rays, filter, &mut blocked);
    blocked.iter().map(|b| b.to_bits()).collect()
}

/// Bits of everything a hit says.
fn bits(hit: &Option<Hit>) -> Option<[u32; 6]> {
    hit.map(|h| [h.t.to_bits(), h.bary[0].to_bits(), h.bary[1].to_bits(), h.prim, h.mesh, h.instance])
}

/// The rays that find faults: anywhere, from surfaces, at edges and vertices, along axes, within planes, far away.
fn telling_rays(geometry: &Geometry, count: usize, random: &mut Random) -> Vec<Ray8> {
    let triangles: Vec<_> = geometry.world_triangles().map(|t| t.corners).collect();
    let mut one = |i: usize| -> (Vec3<f32>, Vec3<f32>) {
        let [a, b, c] = triangles[random.pick(triangles.len())];
        let along = random.unit();
        let aim = match i % 4 {
            0 => a,
            1 => a + (b - a) * along,
            2 => a + (b - a) * 0.5,
            _ => a + (b - a) * (0.9 * along) + (c - a) * (0.1 * along),
        };
        let axis = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.0, -0.0, 1.0)][random.pick(3)];
        let zero = Vec3::new(1.0, 0.0, 0.0);
        match i / 4 % 8 {
            0 => (random.point(2.0), random.direction()),
            1 => (aim, random.direction()),
            2 => {
                let from = random.point(3.0);
                (from, (aim - from).normalize_or(zero))
            }
            3 => {
                let from = random.point(3000.0);
                (from, (aim - from).normalize_or(zero))
            }
            4 => (aim - axis * 2.0, axis),
            5 => (random.point(2.0), axis),
            6 => (aim - (b - a), (b - a).normalize_or(zero)), // within the plane
            _ => {
                let from = a + (b - c) * 3.0 + random.point(1e-4);
                (from, (aim - from).normalize_or(zero)) // grazing
            }
        }
    };
    (0..count / 8)
        .map(|i| {
            let lanes: [_; 8] = std::array::from_fn(|l| one(8 * i + l));
            let mut ray = Ray8::new(side_by_side(lanes.map(|l| l.0)), side_by_side(lanes.map(|l| l.1)));
            if i % 5 == 0 {
                ray.t_min = F32x8::splat(0.3);
                ray.t_max = F32x8::splat(2.0);
                ray.mask = Mask8::from_bits((i as u32 / 5) & 0xff);
            }
            ray
        })
        .collect()
}

fn small_geometries() -> Vec<(&'static str, Geometry)> {
    let mut random = Random(11);
    let twice = {
        let mut mesh = sphere(6, [0.0; 3]);
        let again = mesh.triangles.clone();
        mesh.triangles.extend(again); // every hit is a tie
        mesh
    };
    let one = Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]] };
    vec![
        ("one triangle", geometry(one)),
        ("coincident triangles", geometry(twice)),
        ("a sphere in the list", geometry(sphere(5, [0.0; 3]))),
        ("a sphere", geometry(sphere(24, [0.0; 3]))),
        ("a grid", geometry(grid(16))),
        ("a soup", geometry(soup(600, &mut random))),
        ("a soup in the list", geometry(soup(60, &mut random))),
        ("a sphere far away", geometry(sphere(12, [1000.0, -2000.0, 500.0]))),
    ]
}

#[test]
fn lists_and_trees_agree_with_brute_to_the_last_bit() {
    for (name, geometry) in small_geometries() {
        let rays = telling_rays(&geometry, 60_000, &mut Random(5));
        let (brute, obvhs, tree) = (
            Brute::new(&geometry),
            Obvhs::new(&geometry, Intersect::Robust),
            Obvhs::always_tree(&geometry, Intersect::Robust),
        );
        let expected = hits(&brute, &rays);
        for accel in [&obvhs, &tree] {
            for (i, (a, b)) in expected.iter().zip(hits(accel, &rays)).enumerate() {
                assert_eq!(bits(a), bits(&b), "{name}: lane {} of {:?}", i % 8, rays[i / 8]);
            }
            assert_eq!(blocked(&brute, &rays, None), blocked(accel, &rays, None), "{name}");
        }
        // A shadow ray is blocked exactly if there is a closest hit.
        let live = expected.chunks(8).map(|h| (0..8).fold(0, |bits, l| bits | u32::from(h[l].is_some()) << l));
        assert!(live.eq(blocked(&brute, &rays, None)), "{name}");
    }
}

#[test]
fn a_wrong_answer_would_be_noticed() {
    // The comparison itself must be able to fail: a hit one ulp nearer, or the other of two coincident triangles.
    let hit = Hit { t: 1.0, bary: [0.25, 0.5], prim: 3, mesh: 0, instance: 0 };
    assert_ne!(bits(&Some(hit)), bits(&Some(Hit { t: 1.0_f32.next_down(), ..hit })));
    assert_ne!(bits(&Some(hit)), bits(&Some(Hit { prim: 4, ..hit })));
    assert_ne!(bits(&Some(hit)), bits(&None));
}

#[test]
fn nothing_leaks_through_a_closed_sphere() {
    let geometry = geometry(sphere(32, [0.0; 3]));
    let triangles: Vec<_> = geometry.world_triangles().map(|t| t.corners).collect();
    let mut random = Random(3);
    let rays: Vec<Ray8> = (0..50_000)
        .map(|_| {
            let lanes: [_; 8] = std::array::from_fn(|_| {
                let [a, b, _] = triangles[random.pick(triangles.len())];
                let aim = if random.pick(3) == 0 { a } else { a + (b - a) * random.unit() };
                let from = random.point(0.4);
                (from, (aim - from).normalize())
            });
            Ray8::new(side_by_side(lanes.map(|l| l.0)), side_by_side(lanes.map(|l| l.1)))
        })
        .collect();
    let leaks = hits(&Obvhs::new(&geometry, Intersect::Robust), &rays).iter().filter(|h| h.is_none()).count();
    assert_eq!(leaks, 0, "of {} rays aimed at edges and vertices", rays.len() * 8);
}

#[test]
fn vertical_rays_on_the_edges_of_a_flat_grid_all_hit() {
    let geometry = geometry(grid(30));
    let rays: Vec<Ray8> = (0..=30)
        .flat_map(|y| (0..=30).map(move |x| (x, y)))
        .flat_map(|(x, y)| [1.0_f32, -1.0].map(|dz| (x, y, dz)))
        .map(|(x, y, dz)| {
            let half = |l: usize| if l & 1 == 0 { 0.0 } else { 0.5 };
            let origin = std::array::from_fn(|l| {
                Vec3::new((x as f32 + half(l)).min(30.0), (y as f32 + half(l >> 1)).min(30.0), -3.0 * dz)
            });
            Ray8::new(side_by_side(origin), side_by_side([Vec3::new(-0.0, 0.0, dz); 8]))
        })
        .collect();
    for accel in [&Brute::new(&geometry) as &dyn Accel, &Obvhs::new(&geometry, Intersect::Robust)] {
        assert_eq!(hits(accel, &rays).iter().filter(|h| h.is_none()).count(), 0);
    }
}

#[test]
fn an_opacity_filter_lets_light_through_chosen_triangles() {
    struct Only(u32);
    impl Opacity for Only {
        fn blocks(&self, ray: usize, hit: &Hit) -> bool {
            assert!(ray < 8 * 100);
            hit.prim % 2 == self.0
        }
    }
    for mesh in [sphere(5, [0.0; 3]), sphere(20, [0.0; 3])] {
        let geometry = geometry(mesh);
        let rays = telling_rays(&geometry, 800, &mut Random(9));
        let (brute, obvhs) = (Brute::new(&geometry), Obvhs::new(&geometry, Intersect::Robust));
        for parity in [0, 1] {
            let expected = blocked(&brute, &rays, Some(&Only(parity)));
            assert_eq!(expected, blocked(&obvhs, &rays, Some(&Only(parity))));
            assert_ne!(expected, blocked(&brute, &rays, None));
        }
    }
}

#[test]
fn an_empty_geometry_is_a_miss() {
    let geometry = Geometry::new(Vec::new(), Vec::new()).unwrap();
    let ray = Ray8::new(side_by_side([Vec3::new(0.0, 0.0, 0.0); 8]), side_by_side([Vec3::new(0.0, 0.0, 1.0); 8]));
    for accel in [
        &Brute::new(&geometry) as &dyn Accel,
        &Obvhs::new(&geometry, Intersect::Robust),
        &Obvhs::always_tree(&geometry, Intersect::Robust),
    ] {
        assert!(hits(accel, &[ray]).iter().all(Option::is_none));
    }
}

#[test]
fn geometries_that_cannot_be_cast_at_are_refused() {
    let mesh = |positions: Vec<[f32; 3]>| Mesh { positions, triangles: vec![[0, 1, 2]] };
    let refusal = |m: Mesh| Geometry::of_mesh(m).unwrap_err();
    assert!(matches!(refusal(mesh(vec![[0.0; 3]; 2])), GeometryError::NoSuchVertex { vertex: 2, .. }));
    assert!(matches!(refusal(mesh(vec![[f32::NAN; 3]; 3])), GeometryError::NotFinite { vertex: 0, .. }));
    assert!(matches!(refusal(mesh(vec![[1e30; 3]; 3])), GeometryError::NotFinite { .. }));
}

#[test]
fn a_long_tail_of_shrinking_triangles_does_not_overflow_the_stack() {
    // Each triangle half the size of the last: binary trees over it are as deep as it is long.
    let positions = (0..120).flat_map(|i| {
        let s = 0.5_f32.powi(i);
        [[s, 0.0, 0.0], [s, s, 0.0], [s, 0.0, s]]
    });
    let mesh =
        Mesh { positions: positions.collect(), triangles: (0..120).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() };
    let geometry = geometry(mesh);
    let rays = telling_rays(&geometry, 8_000, &mut Random(2));
    let expected = hits(&Brute::new(&geometry), &rays);
    for (i, (a, b)) in expected.iter().zip(hits(&Obvhs::always_tree(&geometry, Intersect::Robust), &rays)).enumerate() {
        assert_eq!(bits(a), bits(&b), "lane {} of {:?}", i % 8, rays[i / 8]);
    }
}
