//! The cost of a ray against the number of triangles, of a height field and of hair.
//!
//! Rays are random ones: how many of them do what does not depend on how finely a surface is divided. Over the sizes measured
//! costs grow about like a power of the number of triangles, and the exponent, fitted to the logarithms, is a curve's
//! steepness. It must not be more than Embree's by more than twice the standard error of their difference.

use super::contenders::{Builder, Side, warn_if_alone};
use super::measure::{best, median, take_turns};
use super::options::Options;
use super::plot::{Curve, log_log};
use crate::scenes::{Character, rays};
use serde::Serialize;
use std::fs;

/// Four to a decade would say nothing more.
const STEP: f64 = 3.162_277_660_168_379_5; // √10

#[derive(Serialize)]
struct Point {
    scene: &'static str,
    side: &'static str,
    triangles: usize,
    nanoseconds: f64,
}

pub(crate) fn run(options: &Options) -> Result<bool, String> {
    let test = options.tests[0];
    let mut points: Vec<Point> = Vec::new();
    println!("{test}: ns per random ray\n{:8} {:>10} {:>8} {:>8}", "scene", "triangles", "ours", "Embree");
    let characters = [Character::Terrain, Character::Hair].into_iter().filter(|c| options.scenes.contains(c));
    let characters: Vec<Character> = characters.collect();
    for &character in &characters {
        let mut size = 1000.0;
        while size < options.most as f64 * 1.01 {
            let scene = character.scene(size as usize);
            let built = Builder::compared().into_iter().map(|builder| builder.build(&scene.geometry, test));
            let built = built.collect::<Result<Vec<_>, _>>()?;
            let [_, _, random, ..] = rays::sets(&scene, built[0].as_a_renderer_does(), options.rays);
            let methods = built.iter().flat_map(|contender| contender.methods(random.kind)).collect();
            let timed = take_turns(methods, &random, options.rounds).map_err(|e| format!("{}: {e}", scene.name))?;
            let triangles = scene.geometry.triangle_count();
            print!("{:8} {triangles:10}", character.name());
            for (side, name) in [(Side::Ours, "ours"), (Side::Embree, "Embree")] {
                let Some(one) = best(&timed, side) else { continue };
                let nanoseconds = 1e9 * median(&one.seconds) / random.count as f64;
                print!(" {nanoseconds:8.1}");
                points.push(Point { scene: character.name(), side: name, triangles, nanoseconds });
            }
            println!();
            size *= STEP;
        }
    }
    let of = |scene: &str, side: &str| -> Vec<(f64, f64)> {
        let own = points.iter().filter(|point| point.scene == scene && point.side == side);
        own.map(|point| (point.triangles as f64, point.nanoseconds)).collect()
    };
    let mut passed = true;
    let mut curves = Vec::new();
    for character in characters {
        let name = character.name();
        let (ours, embree) = (of(name, "ours"), of(name, "Embree"));
        let (slope, error) = fit(&ours);
        print!("{name}: a ray's cost grows like n^{slope:.3} ± {error:.3}");
        if !embree.is_empty() {
            let (other, other_error) = fit(&embree);
            let met = slope <= other + 2.0 * error.hypot(other_error);
            passed &= met;
            print!(
                ", with Embree like n^{other:.3} ± {other_error:.3}: {}",
                if met { "not steeper" } else { "STEEPER" }
            );
        }
        println!();
        curves.push(Curve { name: format!("{name}, ours"), points: ours });
        curves.push(Curve { name: format!("{name}, Embree"), points: embree });
    }
    curves.retain(|curve| !curve.points.is_empty());
    if let Some(path) = &options.svg {
        let picture = log_log("triangles", "ns per ray", &curves);
        fs::write(path, picture).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    warn_if_alone();
    options.write_json(&points)?;
    Ok(passed)
}

/// Slope of the logarithms by least squares, and its standard error; no error with fewer than three points.
fn fit(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / n;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let xx: f64 = logs.iter().map(|(x, _)| (x - mx).powi(2)).sum();
    let xy: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    let slope = xy / xx;
    let rest: f64 = logs.iter().map(|(x, y)| (y - my - slope * (x - mx)).powi(2)).sum();
    (slope, if n > 2.0 { (rest / (n - 2.0) / xx).sqrt() } else { 0.0 })
}
