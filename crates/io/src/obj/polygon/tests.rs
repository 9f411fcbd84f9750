//! Ear clipping keeps area and orientation on outlines that a fan gets wrong.

use glam::{DMat3, DVec3};

use super::triangulate;

/// Outlines in the plane, counter-clockwise, with their areas.
fn outlines() -> Vec<(&'static str, Vec<[f64; 2]>, f64)> {
    let star = (0..10).map(|i| {
        let angle = f64::from(i) * std::f64::consts::TAU / 10.0;
        let radius = if i % 2 == 0 { 2.0 } else { 0.7 };
        [radius * angle.cos(), radius * angle.sin()]
    });
    let comb = (0..8).flat_map(|i| {
        let x = f64::from(i);
        [[8.0 - x, 3.0], [7.5 - x, 0.5]]
    });
    vec![
        ("square", vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]], 1.0),
        ("arrow head", vec![[0., 0.], [4., 0.], [1., 1.], [0., 4.]], 4.0),
        ("arrow head from its notch", vec![[1., 1.], [0., 4.], [0., 0.], [4., 0.]], 4.0),
        ("L", vec![[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 2.], [0., 2.]], 4.0),
        ("U", vec![[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]], 7.0),
        ("star", star.collect(), 10.0 * 0.5 * 2.0 * 0.7 * (std::f64::consts::TAU / 10.0).sin()),
        ("comb", [[0., 0.], [8., 0.]].into_iter().chain(comb).collect(), 13.25),
        ("collinear", vec![[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]], 4.0),
        ("triangle in six", vec![[0., 0.], [1., 0.], [2., 0.], [1., 1.], [0., 2.], [0., 1.]], 2.0),
        ("repeated corners", vec![[0., 0.], [2., 0.], [2., 0.], [2., 2.], [0., 2.], [0., 2.], [0., 2.]], 4.0),
        ("closed by its first corner", vec![[0., 0.], [3., 0.], [1., 1.], [0., 3.], [0., 0.]], 3.0),
        (
            "square with a square hole, bridged",
            vec![[0., 0.], [3., 0.], [3., 3.], [0., 3.], [0., 0.], [1., 1.], [1., 2.], [2., 2.], [2., 1.], [1., 1.]],
            8.0,
        ),
    ]
}

fn vector_area(points: &[DVec3], triangles: &[[usize; 3]]) -> Vec<DVec3> {
    let area = |&[a, b, c]: &[usize; 3]| (points[b] - points[a]).cross(points[c] - points[a]) * 0.5;
    triangles.iter().map(area).collect()
}

#[test]
fn concave_outlines_keep_area_and_orientation_in_every_plane() {
    let planes = [
        DMat3::IDENTITY,
        DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2),
        DMat3::from_rotation_y(-std::f64::consts::FRAC_PI_2),
        DMat3::from_rotation_y(std::f64::consts::PI),
        DMat3::from_rotation_x(0.7) * DMat3::from_rotation_y(1.1) * DMat3::from_rotation_z(0.3),
        DMat3::from_axis_angle(DVec3::ONE.normalize(), 2.5),
    ];
    let offsets = [DVec3::ZERO, DVec3::new(680_000.0, 120.0, -5_400_000.0)];
    for (name, outline, area) in outlines() {
        for plane in planes {
            for offset in offsets {
                let points: Vec<DVec3> = outline.iter().map(|p| plane * DVec3::new(p[0], p[1], 0.0) + offset).collect();
                let mut triangles = Vec::new();
                assert!(triangulate(&points, &mut triangles), "{name}: not simple");
                assert!(triangles.len() <= points.len() - 2, "{name}");
                let front = plane * DVec3::Z;
                let areas = vector_area(&points, &triangles);
                let sum: f64 = areas.iter().map(|a| a.length()).sum();
                let tolerance = 1e-15 * (1.0 + offset.length()) * 100.0; // rounding of the coordinates times the outline
                assert!((sum - area).abs() <= tolerance, "{name}: area {sum}, not {area}");
                assert!(areas.iter().all(|a| a.dot(front) > -tolerance), "{name}: a triangle faces back");
            }
        }
    }
}

#[test]
fn a_convex_polygon_becomes_the_fan_of_its_first_corner() {
    let points: Vec<DVec3> =
        (0..6).map(|i| f64::from(i) * std::f64::consts::TAU / 6.0).map(|a| DVec3::new(a.cos(), a.sin(), 1.0)).collect();
    let mut triangles = Vec::new();
    assert!(triangulate(&points, &mut triangles));
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
}

#[test]
fn outlines_that_cross_themselves_are_reported_and_never_panic() {
    let bow_tie = [[0., 0.], [1., 1.], [1., 0.], [0., 1.]];
    let lopsided = [[0., 0.], [3., 3.], [3., 0.], [0., 1.]];
    let pentagram: Vec<[f64; 2]> =
        (0..5).map(|i| f64::from(i * 2) * std::f64::consts::TAU / 5.0).map(|a| [a.cos(), a.sin()]).collect();
    for outline in [&bow_tie[..], &lopsided, &pentagram] {
        for start in 0..outline.len() {
            let mut points: Vec<DVec3> = outline.iter().map(|p| DVec3::new(p[0], p[1], 0.0)).collect();
            points.rotate_left(start);
            let mut triangles = Vec::new();
            assert!(!triangulate(&points, &mut triangles), "{outline:?}");
            assert!(triangles.len() <= points.len() - 2);
        }
    }
}

#[test]
fn outlines_without_area_never_panic() {
    for n in 3..9 {
        let mut triangles = Vec::new();
        triangulate(&vec![DVec3::ONE; n], &mut triangles);
        let line: Vec<DVec3> = (0..n).map(|i| DVec3::new(i as f64, 2.0 * i as f64, -(i as f64))).collect();
        triangulate(&line, &mut triangles);
        let huge: Vec<DVec3> = line.iter().map(|p| *p * 1e12).collect();
        triangulate(&huge, &mut triangles);
    }
}

#[test]
fn random_outlines_never_panic_and_simple_ones_keep_their_area() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / 16_777_216.0
    };
    for round in 0..2000 {
        let n = 4 + round % 13;
        let on_grid = round % 3 == 0; // many repeated and collinear corners
        let points: Vec<DVec3> = (0..n)
            .map(|_| {
                let p = DVec3::new(random(), random(), 0.0);
                if on_grid { (p * 4.0).floor() } else { p }
            })
            .collect();
        let mut triangles = Vec::new();
        let simple = triangulate(&points, &mut triangles);
        let newell: f64 = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| a.cross(*b).z * 0.5).sum();
        if simple {
            let sum: f64 = vector_area(&points, &triangles).iter().map(|a| a.length()).sum();
            assert!((sum - newell.abs()).abs() < 1e-12 * (1.0 + sum), "{points:?}: {sum} is not {newell}");
        }
    }
}

#[test]
fn a_thousand_corners_take_no_time() {
    let spiky: Vec<DVec3> = (0..20_000)
        .map(|i| (f64::from(i) * std::f64::consts::TAU / 20_000.0, if i % 2 == 0 { 2.0 } else { 1.9 }))
        .map(|(angle, radius)| DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0))
        .collect();
    let mut triangles = Vec::new();
    let start = std::time::Instant::now();
    assert!(triangulate(&spiky, &mut triangles));
    assert_eq!(triangles.len(), spiky.len() - 2);
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

#[test]
fn a_face_of_very_many_corners_ends() {
    let n = 30_000;
    let repeated: Vec<DVec3> = (0..n).map(|i| DVec3::new(f64::from(i.min(2)), f64::from(i % 2), 0.0)).collect();
    // Two arms wound around each other: few ears, and every corner of the inner side is reflex.
    let turn = |i: i32| f64::from(i.min(n - 1 - i)) * 0.02;
    let radius = |i: i32| 1.0 + turn(i) + if i < n / 2 { 0.0 } else { 2.0 };
    let spiral: Vec<DVec3> =
        (0..n).map(|i| DVec3::new(radius(i) * turn(i).cos(), radius(i) * turn(i).sin(), 0.0)).collect();
    let star: Vec<DVec3> = (0..n)
        .map(|i| {
            let (angle, radius) = (f64::from(i) * std::f64::consts::TAU / f64::from(n), f64::from(1 + i % 2));
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        })
        .collect();
    for outline in [repeated, spiral, star] {
        let mut triangles = Vec::new();
        let start = std::time::Instant::now();
        triangulate(&outline, &mut triangles);
        let seconds = start.elapsed().as_secs_f64();
        println!("{} triangles in {seconds} s", triangles.len());
        assert!(triangles.len() <= outline.len() - 2 && seconds < 30.0, "{seconds} s");
    }
}
