//! Maps against formulas written a second time, in f64 and the plain way: texel by texel, cell by cell.

use super::*;
use crate::sampler::{Purpose, Sampler};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A chance of one in a hundred that a correct sampler fails one of the χ² tests of this file (Šidák).
const SIGNIFICANCE: f64 = 0.01;

/// A picture of a formula of column, row and channel.
fn picture(width: u32, height: u32, f: impl Fn(u32, u32, u32) -> f32) -> Arc<Picture> {
    let rgb = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let rgb = rgb.map(|(x, y)| [f(x, y, 0), f(x, y, 1), f(x, y, 2)]).collect();
    Arc::new(Picture { width, height, rgb, alpha: None })
}

/// Texels of all magnitudes, some of them black; the same for the same seed.
fn varied(width: u32, height: u32, seed: u32) -> Arc<Picture> {
    picture(width, height, |x, y, c| {
        let word = crate::sampler::hash2(crate::sampler::hash2(x + 1000 * y, c), seed);
        if crate::sampler::hash2(x + 1000 * y, seed).is_multiple_of(4) {
            0.0
        } else {
            10_f32.powf(word as f32 / 1e9 - 2.0)
        }
    })
}

/// The pictures of the tests: ordinary, odd, narrow, single, with one texel alone, and with the pole alone.
fn maps() -> Vec<Arc<Picture>> {
    let lone = |at: [u32; 2]| move |x: u32, y: u32, _: u32| if [x, y] == at { 50.0 } else { 0.0 };
    vec![
        varied(16, 8, 1),
        varied(7, 5, 2),
        varied(1, 4, 3),
        varied(5, 1, 4),
        picture(1, 1, |_, _, c| 0.5 + c as f32),
        picture(9, 6, lone([0, 2])),
        picture(6, 4, lone([5, 0])),
        picture(6, 3, lone([2, 2])),
    ]
}

fn prepared(picture: &Arc<Picture>, degrees: f64) -> EnvironmentMap {
    EnvironmentMap::new(picture, degrees, 1.0).expect("the picture is not black")
}

/// The direction at u and v, both from 0 to 1.
fn direction(u: f64, v: f64) -> [f64; 3] {
    let ((sin_phi, cos_phi), (sin, cos)) = ((u * TAU).sin_cos(), (v * PI).sin_cos());
    [sin * sin_phi, cos, -sin * cos_phi]
}

fn look(map: &EnvironmentMap, d: [f64; 3]) -> ([f64; 3], f64) {
    let seen = map.at(Vec3::broadcast(Vec3::from(d.map(|x| x as f32))));
    let channel = |x: F32x8| f64::from(x.lane(3));
    ([channel(seen.radiance.r), channel(seen.radiance.g), channel(seen.radiance.b)], channel(seen.pdf))
}

/// Bilinear radiance in f64, as the head of the module states it.
fn reference(picture: &Picture, degrees: f64, u: f64, v: f64) -> [f64; 3] {
    let (width, height) = (i64::from(picture.width), i64::from(picture.height));
    let x = (u + degrees / 360.0) * width as f64 - 0.5;
    let y = v * height as f64 - 0.5;
    let texel = |x: i64, y: i64, c: usize| {
        f64::from(picture.rgb[(y.clamp(0, height - 1) * width + x.rem_euclid(width)) as usize][c])
    };
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let (s, t) = (x - x.floor(), y - y.floor());
    std::array::from_fn(|c| {
        let row = |j| (1.0 - s) * texel(i, j, c) + s * texel(i + 1, j, c);
        (1.0 - t) * row(j) + t * row(j + 1)
    })
}

/// θ at the edges of the rows of cells.
fn edges(height: u32) -> Vec<f64> {
    let centres = (0..height).map(|row| (f64::from(row) + 0.5) / f64::from(height));
    std::iter::once(0.0).chain(centres).chain([1.0]).collect()
}

#[test]
fn radiance_is_bilinear_between_texel_centres_and_turns_with_the_picture() {
    let large = [varied(2048, 3, 5), varied(3, 2048, 6)];
    for picture in maps().iter().chain(&large) {
        for degrees in [0.0, 90.0, -123.4, 1000.0] {
            let map = prepared(picture, degrees);
            let brightest = picture.rgb.iter().flatten().fold(0.0, |a: f64, &b| a.max(b.into()));
            // An f32 direction is off by 2⁻²⁴ in each component, the angles by a few times that: so much of a texel.
            let edge = f64::from(picture.width.max(picture.height));
            let bound = brightest * (1e-6 * edge + 1e-6);
            for i in 0..400 {
                // A golden-section lattice, with the poles and the seam among its points.
                let u = (f64::from(i) * 0.618_033_988_75).fract();
                let v = f64::from(i) / 399.0;
                let near_pole = 1e-7 / (v * PI).sin().max(1e-7);
                let (got, _) = look(&map, direction(u, v));
                let right = reference(picture, degrees, u, v);
                for c in 0..3 {
                    let off = (got[c] - right[c]).abs();
                    let place = format!("{u} {v} of {} x {}", picture.width, picture.height);
                    assert!(off <= bound * (1.0 + near_pole * 1e7) || near_pole > 1e-2, "{place}: {got:?} {right:?}");
                }
            }
        }
    }
}

#[test]
fn the_centre_column_faces_plus_z_and_turns_to_plus_x() {
    let picture = picture(64, 32, |x, y, _| (x * 100 + y) as f32);
    let centre = |degrees: f64, d: [f64; 3]| look(&prepared(&picture, degrees), d).0[0];
    // Between columns 31 and 32, rows 15 and 16.
    let expected = 3150.0 + 15.5;
    for (degrees, d) in
        [(0.0, [0.0, 0.0, 1.0]), (90.0, [1.0, 0.0, 0.0]), (-90.0, [-1.0, 0.0, 0.0]), (540.0, [0.0, 0.0, -1.0])]
    {
        assert!((centre(degrees, d) - expected).abs() < 0.05, "{degrees}: {}", centre(degrees, d));
    }
    // Three quarters across is −x; the top row is +y.
    assert!((centre(0.0, [-1.0, 0.0, 0.0]) - (4750.0 + 15.5)).abs() < 0.05);
    let up = direction(0.25 + 0.5 / 64.0, 1e-3);
    assert!((centre(0.0, up) - 1600.0).abs() < 0.5, "{}", centre(0.0, up));
}

/// ∫ pdf dω over each quarter of each cell. The density is bilinear in u and cosθ there, so its value in the middle is its
/// mean.
fn expected(map: &EnvironmentMap, degrees: f64) -> Vec<f64> {
    let (width, edges) = (map.picture.width, edges(map.picture.height));
    let mut cells = Vec::new();
    for row in edges.windows(2) {
        let [above, below] = [row[0], row[1]].map(|v| (v * PI).cos());
        for half in [0.25, 0.75] {
            let cos: f64 = above + (below - above) * half;
            for column in 0..2 * width {
                // Cells lie between texel centres: the first begins half a texel before the left edge.
                let u = (f64::from(column) + 0.5) / f64::from(2 * width) - 0.5 / f64::from(width) - degrees / 360.0;
                let solid_angle = (above - below) / 2.0 * TAU / f64::from(2 * width);
                cells.push(look(map, direction(u, cos.acos() / PI)).1 * solid_angle);
            }
        }
    }
    cells
}

/// How many of `count` samples fall into each quarter of each cell.
fn counted(map: &EnvironmentMap, degrees: f64, count: u32) -> Vec<f64> {
    let (width, edges) = (map.picture.width, edges(map.picture.height));
    let mut cells = vec![0.0; (2 * width) as usize * 2 * (edges.len() - 1)];
    let sampler = Sampler::new(77);
    for i in 0..count / 8 {
        let pixel = U32x8::from_fn(|l| 8 * i + l as u32);
        let [toss, place] = [Purpose::Light, Purpose::Environment].map(|p| sampler.draw(pixel, pixel, 1, p));
        let w = map.sample(&place, [toss.0[1], toss.0[2]]);
        let seen = map.at(w);
        for l in 0..8 {
            let [x, y, z] = [w.x, w.y, w.z].map(|c| f64::from(c.lane(l)));
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6);
            assert!(seen.pdf.lane(l) > 0.0 && seen.radiance.largest().lane(l) > 0.0, "black was drawn");
            let theta = x.hypot(z).atan2(y);
            let row = edges[1..edges.len() - 1].partition_point(|&edge| edge * PI <= theta);
            let [above, below] = [edges[row], edges[row + 1]].map(|v| (v * PI).cos());
            let half = usize::from(theta.cos() < 0.5 * (above + below));
            let u = (x.atan2(-z) / TAU + degrees / 360.0 + 0.5 / f64::from(width)).rem_euclid(1.0);
            let column = ((u * f64::from(2 * width)) as usize).min(2 * width as usize - 1);
            cells[(2 * row + half) * 2 * width as usize + column] += 1.0;
        }
    }
    cells
}

/// The level of each of the χ² tests that a correct sampler has to pass: every map at two rotations, and one more.
fn level() -> f64 {
    let tests = 2 * maps().len() + 1;
    -((-SIGNIFICANCE).ln_1p() / tests as f64).exp_m1()
}

/// Pearson's χ² of counts against probabilities, cells of few expected counts pooled.
fn p_value(counts: &[f64], probabilities: &[f64]) -> f64 {
    const FEWEST: f64 = 8.0;
    let n: f64 = counts.iter().sum();
    let (mut statistic, mut cells, mut pool) = (0.0, 0, [0.0; 2]);
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    for i in order {
        pool = [pool[0] + counts[i], pool[1] + n * probabilities[i]];
        if pool[1] >= FEWEST {
            statistic += (pool[0] - pool[1]).powi(2) / pool[1];
            cells += 1;
            pool = [0.0; 2];
        }
    }
    ChiSquared::new(f64::from(cells - 1).max(1.0)).expect("some cells").sf(statistic)
}

#[test]
fn the_sampler_draws_what_the_density_says() {
    let rotations = [0.0, 200.0];
    for picture in maps() {
        for degrees in rotations {
            let map = prepared(&picture, degrees);
            let (counts, expected) = (counted(&map, degrees, 1_000_000), expected(&map, degrees));
            let p = p_value(&counts, &expected);
            assert!(p >= level(), "{} x {} at {degrees}: p = {p:e}", picture.width, picture.height);
        }
    }
}

#[test]
fn a_density_off_by_a_hundredth_and_one_that_is_turned_are_found() {
    let map = prepared(&varied(16, 8, 1), 0.0);
    let counts = counted(&map, 0.0, 8_000_000);
    let right = expected(&map, 0.0);
    assert!(p_value(&counts, &right) >= level());
    // Every other quarter of a cell 1 % up, and the whole one again: for a share of one half, N·10⁻⁴/4 = 200 is added to χ².
    let mut scaled: Vec<f64> = right.iter().enumerate().map(|(i, p)| if i % 2 == 0 { 1.01 * p } else { *p }).collect();
    let sum: f64 = scaled.iter().sum();
    scaled.iter_mut().for_each(|p| *p /= sum);
    assert!(p_value(&counts, &scaled) < level(), "1 %");
    let turned = expected(&prepared(&varied(16, 8, 1), 1.0), 0.0);
    assert!(p_value(&counts, &turned) < level(), "one degree");
}

#[test]
fn densities_integrate_to_one() {
    let large = [varied(1024, 2, 5), varied(2, 1024, 6)];
    for picture in maps().iter().chain(&large) {
        for degrees in [0.0, 77.0] {
            let whole: f64 = expected(&prepared(picture, degrees), degrees).iter().sum();
            assert!((whole - 1.0).abs() < 2e-5, "{} x {}: {whole}", picture.width, picture.height);
        }
    }
}

#[test]
fn a_black_picture_is_no_light_and_no_direction_is_a_panic() {
    assert!(EnvironmentMap::new(&picture(4, 4, |_, _, _| 0.0), 0.0, 1.0).is_none());
    assert!(EnvironmentMap::new(&picture(4, 4, |_, _, _| 1.0), 0.0, 0.0).is_none());
    let awkward = [0.0, -0.0, 1.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE];
    for map in maps().iter().map(|picture| prepared(picture, 359.999_999)) {
        for x in awkward {
            for y in awkward {
                for z in awkward {
                    let _ = map.at(Vec3::broadcast(Vec3::new(x, y, z)));
                }
            }
        }
        let extremes = [0, u32::MAX].map(|word| Random4([U32x8::splat(word); 4]));
        for (u, toss) in extremes.iter().flat_map(|u| [(u, 0), (u, u32::MAX)]) {
            let w = map.sample(u, [U32x8::splat(toss); 2]);
            assert!(map.at(w).pdf.is_finite().to_bits() == 0xff);
        }
    }
}
