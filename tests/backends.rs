//! Every backend finds the hit that brute finds, to the last bit or, Embree, up to rounding; nothing leaks through closed
//! surfaces.

mod edges;
mod filters;
mod instances;

use crate::support::{Random, crowd, geometry, grid, hills, side_by_side, soup, sphere};
use gonio_accel::{
    Accel, Brute, Geometry, GeometryError, Hit, Hit8, Intersect, Mesh, Obvhs, ObvhsOptions, Opacity, Ray8, RayKind,
};
use gonio_kernel::{F32x8, Mask8, Vec3};
use gonio_tracer::Backend;

/// The hits of some packets, misses as `None`.
fn hits(accel: &dyn Accel, rays: &[Ray8]) -> Vec<Option<Hit>> {
    hits_by(RayKind::Incoherent, accel, rays)
}

fn hits_by(kind: RayKind, accel: &dyn Accel, rays: &[Ray8]) -> Vec<Option<Hit>> {
    let mut hits = vec![Hit8::miss(); rays.len()];
    accel.closest(kind, rays, &mut hits);
    hits.iter().flat_map(|h| (0..8).map(|l| h.lane(l))).collect()
}

/// The tree, even over few triangles.
fn tree_of(geometry: &Geometry) -> Obvhs {
    let tree = Obvhs::always_tree(geometry, ObvhsOptions::default());
    assert_eq!(tree.validate(), Ok(()));
    tree
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

/// Rays of cameras: up to nine packets that start together and point the same way, more or less, many of them at vertices.
fn tiles_of_rays(geometry: &Geometry, random: &mut Random) -> Vec<Ray8> {
    let triangles: Vec<_> = geometry.world_triangles().map(|t| t.corners).collect();
    let (spread, apart) = (0.3 * random.unit().powi(4), 0.1 * random.unit().powi(4) * f32::from(random.pick(2) as u8));
    let aim = triangles[random.pick(triangles.len())][random.pick(3)];
    let far = [0.5, 3.0, 300.0][random.pick(3)];
    let eye = if random.pick(4) == 0 { aim } else { aim + random.point(far) };
    let axis = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.0, -0.0, 1.0)][random.pick(3)];
    let forth = if random.pick(4) == 0 { axis } else { (aim - eye).normalize_or(axis) };
    (0..1 + random.pick(9))
        .map(|i| {
            let lanes: [_; 8] = std::array::from_fn(|_| {
                let to = forth + random.point(spread);
                (eye + random.point(apart), if random.pick(8) == 0 { forth } else { to.normalize_or(axis) })
            });
            let mut ray = Ray8::new(side_by_side(lanes.map(|l| l.0)), side_by_side(lanes.map(|l| l.1)));
            if i % 4 == 1 {
                ray.t_min = F32x8::splat(0.1);
                ray.t_max = F32x8::splat(1.5);
                ray.mask = Mask8::from_bits(random.pick(256) as u32);
            }
            ray
        })
        .collect()
}

#[test]
fn rays_in_tiles_agree_with_brute_to_the_last_bit() {
    let mut random = Random(17);
    let (mut met, mut all) = (0, 0);
    for (name, geometry) in small_geometries() {
        let (brute, tree) = (Brute::new(&geometry), tree_of(&geometry));
        for _ in 0..if geometry.triangle_count() > 1000 { 60 } else { 300 } {
            let rays = tiles_of_rays(&geometry, &mut random);
            let expected = hits(&brute, &rays);
            for (i, (a, b)) in expected.iter().zip(hits_by(RayKind::Coherent, &tree, &rays)).enumerate() {
                assert_eq!(bits(a), bits(&b), "{name}: lane {} of {:?}", i % 8, rays[i / 8]);
            }
            assert_eq!(blocked(&brute, &rays, None), blocked(&tree, &rays, None), "{name}");
            met += expected.iter().flatten().count();
            all += expected.len();
        }
    }
    assert!(4 * met > all && 20 * (all - met) > all, "{met} of {all} rays meet something");
}

#[test]
fn a_million_coincident_triangles_are_one_to_every_ray() {
    let mesh =
        Mesh { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], triangles: vec![[0, 1, 2]; 1_000_000] };
    let geometry = geometry(mesh);
    let tree = tree_of(&geometry);
    let lanes: [_; 8] = std::array::from_fn(|l| Vec3::new(0.05 + 0.11 * l as f32, 0.1, -1.0));
    let rays = [Ray8::new(side_by_side(lanes), side_by_side([Vec3::new(0.0, 0.0, 1.0); 8])); 4];
    for kind in [RayKind::Coherent, RayKind::Incoherent] {
        for hit in hits_by(kind, &tree, &rays) {
            assert!(hit.is_some_and(|hit| hit.prim == 0 && hit.t == 1.0), "{kind:?}: {hit:?}"); // ties go to the first
        }
    }
    assert_eq!(blocked(&tree, &rays, None), [0xff; 4]);
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
        ("hills", geometry(hills(20))),
        ("a crowd", crowd(&mut random)),
    ]
}

#[test]
fn lists_and_trees_agree_with_brute_to_the_last_bit() {
    for (name, geometry) in small_geometries() {
        let rays = telling_rays(&geometry, 60_000, &mut Random(5));
        let (brute, obvhs, tree) =
            (Brute::new(&geometry), Obvhs::new(&geometry, Intersect::Robust), tree_of(&geometry));
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

/// Every backend of this build, robust, the tree of obvhs where it would be a list, and Embree's other ways.
fn all(geometry: &Geometry) -> Vec<Box<dyn Accel>> {
    let tree: Box<dyn Accel> = Box::new(tree_of(geometry));
    let built = |backend: Backend| backend.build(geometry, Intersect::Robust).expect("the backend builds");
    let ways = ways_of_embree(geometry, Intersect::Robust).into_iter().map(|(_, accel)| accel);
    Backend::ALL.into_iter().map(built).chain([tree]).chain(ways).collect()
}

/// Embree by every width, fast with the better tree, which the robust test does not have; nothing if this build lacks it.
fn ways_of_embree(geometry: &Geometry, intersect: Intersect) -> Vec<(String, Box<dyn Accel>)> {
    #[cfg(feature = "embree")]
    {
        use gonio_accel::{Embree, EmbreeOptions, EmbreeQuality, EmbreeWidth};
        let widths = [EmbreeWidth::One, EmbreeWidth::Eight, EmbreeWidth::Sixteen];
        let quality = if intersect == Intersect::Fast { EmbreeQuality::High } else { EmbreeQuality::Medium };
        let build = |width| -> (String, Box<dyn Accel>) {
            let options = EmbreeOptions { intersect, quality, width: Some(width) };
            let accel = Embree::with(geometry, options).expect("the backend builds");
            (format!("embree {quality:?} {width:?}, {intersect}"), Box::new(accel))
        };
        widths.into_iter().map(build).collect()
    }
    #[cfg(not(feature = "embree"))]
    {
        let _ = (geometry, intersect);
        Vec::new()
    }
}

/// Rays from anywhere in any direction, some within limits, some with dead lanes.
fn ordinary_rays(count: usize, random: &mut Random) -> Vec<Ray8> {
    (0..count / 8)
        .map(|i| {
            let lanes: [_; 8] = std::array::from_fn(|_| (random.point(2.0), random.direction()));
            let mut ray = Ray8::new(side_by_side(lanes.map(|l| l.0)), side_by_side(lanes.map(|l| l.1)));
            if i % 5 == 0 {
                (ray.t_min, ray.t_max) = (F32x8::splat(0.3), F32x8::splat(2.0));
                ray.mask = Mask8::from_bits(random.pick(256) as u32);
            }
            ray
        })
        .collect()
}

/// How many hits are neither on the same triangle nor at the same distance, within 1e-5 of the distance and the scene's size.
fn disagreements(expected: &[Option<Hit>], found: &[Option<Hit>], size: f32) -> usize {
    let agree = |(a, b): &(&Option<Hit>, &Option<Hit>)| match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => {
            let same = (a.instance, a.mesh, a.prim) == (b.instance, b.mesh, b.prim);
            same || (a.t - b.t).abs() <= 1e-5 * (a.t.abs() + size)
        }
        _ => false,
    };
    expected.iter().zip(found).filter(|pair| !agree(pair)).count()
}

/// How many hits are not where their barycentrics say, within 1e-5 of the distance and the scene's size.
fn misplaced(geometry: &Geometry, rays: &[Ray8], found: &[Option<Hit>]) -> usize {
    let triangles: Vec<_> = geometry.world_triangles().collect();
    let size = size(geometry);
    let is_off = |(i, hit): (usize, &Option<Hit>)| {
        let Some(hit) = hit else { return false };
        // World triangles are in the order of (instance, prim).
        let at = triangles.partition_point(|t| (t.id.instance, t.id.prim) < (hit.instance, hit.prim));
        let ([a, b, c], id) = (triangles[at].corners, triangles[at].id);
        assert_eq!((id.instance, id.mesh, id.prim), (hit.instance, hit.mesh, hit.prim));
        let one = |v: Vec3<F32x8>| Vec3::new(v.x.lane(i % 8), v.y.lane(i % 8), v.z.lane(i % 8));
        let along_ray = one(rays[i / 8].origin) + one(rays[i / 8].dir) * hit.t;
        let on_triangle = a + (b - a) * hit.bary[0] + (c - a) * hit.bary[1];
        (along_ray - on_triangle).length() > 1e-5 * (hit.t + size)
    };
    found.iter().enumerate().filter(|pair| is_off(*pair)).count()
}

/// The diagonal of the world's bounds.
fn size(geometry: &Geometry) -> f32 {
    let corners = || geometry.world_triangles().flat_map(|t| t.corners.map(<[f32; 3]>::from));
    let extent = |axis: usize| {
        let at = || corners().map(|c| c[axis]);
        at().fold(f32::MIN, f32::max) - at().fold(f32::MAX, f32::min)
    };
    Vec3::new(extent(0), extent(1), extent(2)).length()
}

/// The backends that must agree with brute up to rounding alone, on ordinary rays.
fn nearly_exact(geometry: &Geometry) -> Vec<(String, Box<dyn Accel>)> {
    let inexact = Backend::ALL.into_iter().filter(|backend| !backend.is_exact());
    let builds = inexact.flat_map(|backend| [(backend, Intersect::Robust), (backend, Intersect::Fast)]);
    builds
        .chain([(Backend::Obvhs, Intersect::Fast)])
        .map(|(b, i)| (format!("{b}, {i}"), b.build(geometry, i).expect("the backend builds")))
        .chain([Intersect::Robust, Intersect::Fast].into_iter().flat_map(|i| ways_of_embree(geometry, i)))
        .collect()
}

#[test]
fn what_is_not_exact_agrees_with_brute_up_to_rounding() {
    for (name, geometry) in small_geometries() {
        let rays = ordinary_rays(400_008, &mut Random(17)); // an odd number of packets
        let exact = Obvhs::new(&geometry, Intersect::Robust);
        let (expected, expected_blocked) = (hits(&exact, &rays), blocked(&exact, &rays, None));
        for (backend, accel) in nearly_exact(&geometry) {
            let found = hits(&*accel, &rays);
            let exceptions = disagreements(&expected, &found, size(&geometry));
            assert!(exceptions <= 4, "{name}, {backend}: {exceptions} of {} rays", rays.len() * 8);
            let exceptions = misplaced(&geometry, &rays, &found);
            assert!(exceptions <= 4, "{name}, {backend}: {exceptions} of {} hits are misplaced", rays.len() * 8);
            let blocked = blocked(&*accel, &rays, None);
            let exceptions: u32 = expected_blocked.iter().zip(blocked).map(|(a, b)| (a ^ b).count_ones()).sum();
            assert!(exceptions <= 4, "{name}, {backend}: {exceptions} of {} shadow rays", rays.len() * 8);
        }
    }
}

#[test]
fn a_disagreement_would_be_counted() {
    let hit = Hit { t: 1.0, bary: [0.25, 0.5], prim: 3, mesh: 0, instance: 0 };
    let other = Hit { prim: 4, ..hit };
    let count = |a, b| disagreements(&[a], &[b], 1.0);
    assert_eq!(count(Some(hit), Some(Hit { t: 1.1, ..hit })), 0);
    assert_eq!(count(Some(hit), Some(Hit { t: 1.00001, ..other })), 0);
    assert_eq!(count(Some(hit), Some(Hit { t: 1.0001, ..other })), 1);
    assert_eq!(count(Some(hit), None) + count(None, Some(hit)), 2);
}

#[test]
fn rays_that_are_not_numbers_do_not_disturb_the_others() {
    let geometry = geometry(sphere(20, [0.0; 3]));
    let inside = Ray8::new(side_by_side([Vec3::new(0.1, 0.2, 0.3); 8]), side_by_side([Vec3::new(0.0, 0.0, 1.0); 8]));
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut ray = inside;
        ray.origin.x = F32x8::from_fn(|l| if l == 0 { wrong } else { ray.origin.x.lane(l) });
        ray.dir.y = F32x8::from_fn(|l| if l == 1 { wrong } else { ray.dir.y.lane(l) });
        for accel in all(&geometry) {
            assert!(hits(&*accel, &[ray])[2..].iter().all(Option::is_some), "{}", accel.name());
            assert_eq!(blocked(&*accel, &[ray], None)[0] >> 2, 0x3f, "{}", accel.name());
        }
    }
}

#[test]
fn backends_leave_the_arithmetic_of_their_caller_alone() {
    let half = std::hint::black_box(0.5_f32);
    let geometry = geometry(sphere(20, [0.0; 3]));
    for accel in all(&geometry) {
        hits(&*accel, &ordinary_rays(80, &mut Random(1)));
        assert!(std::hint::black_box(f32::MIN_POSITIVE) * half > 0.0, "{} flushes denormals", accel.name());
        assert!(f32::from_bits(std::hint::black_box(2)) * half > 0.0, "{} ignores denormals", accel.name());
    }
}

#[test]
fn an_empty_geometry_is_a_miss() {
    let geometry = Geometry::new(Vec::new(), Vec::new()).unwrap();
    let ray = Ray8::new(side_by_side([Vec3::new(0.0, 0.0, 0.0); 8]), side_by_side([Vec3::new(0.0, 0.0, 1.0); 8]));
    for accel in all(&geometry) {
        assert!(hits(&*accel, &[ray]).iter().all(Option::is_none), "{}", accel.name());
        assert_eq!(blocked(&*accel, &[ray], None), [0], "{}", accel.name());
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
    for (i, (a, b)) in expected.iter().zip(hits(&tree_of(&geometry), &rays)).enumerate() {
        assert_eq!(bits(a), bits(&b), "lane {} of {:?}", i % 8, rays[i / 8]);
    }
}
