//! What it costs that instances share a tree: the same scans, laid out in the world, or as instances of one mesh.

use super::contenders::{Builder, Method};
use super::measure::{median, mrays, take_turns};
use super::options::Options;
use crate::scenes::{self, rays};
use gonio_accel::ObvhsPreset;
use serde::Serialize;
use std::time::Instant;

/// One kind of rays by one test.
#[derive(Serialize)]
struct Row {
    rays: &'static str,
    intersect: String,
    /// Millions per second, laid out and shared.
    mrays: [f64; 2],
    /// The median of the ratios of rounds, shared over laid out.
    speed: f64,
}

pub(crate) fn run(options: &Options) -> Result<bool, String> {
    let scene = scenes::instances();
    println!("{}, {} triangles", scene.name, scene.geometry.triangle_count());
    let mut rows: Vec<Row> = Vec::new();
    for &test in &options.tests {
        let mut built = Vec::new();
        for builder in [Builder::Obvhs(ObvhsPreset::Medium), Builder::Shared] {
            let start = Instant::now();
            built.push(builder.build(&scene.geometry, test)?);
            let (name, seconds) = (builder.name(), start.elapsed().as_secs_f64());
            println!("{name}: {} bytes, built in {seconds:.3} s", built[built.len() - 1].bytes.unwrap_or(0));
        }
        for set in rays::sets(&scene, built[0].as_a_renderer_does(), options.rays) {
            let methods: Vec<Method> = built.iter().flat_map(|contender| contender.methods(set.kind)).collect();
            let timed = take_turns(methods, &set, options.rounds).map_err(|e| format!("{}: {e}", scene.name))?;
            let ratios: Vec<f64> = timed[0].seconds.iter().zip(&timed[1].seconds).map(|(out, own)| out / own).collect();
            rows.push(Row {
                rays: set.name,
                intersect: test.to_string(),
                mrays: [mrays(&timed[0], &set), mrays(&timed[1], &set)],
                speed: median(&ratios),
            });
        }
    }
    println!("{:10} {:8} {:>10} {:>8} {:>8}", "rays", "test", "laid out", "shared", "speed");
    for Row { rays, intersect, mrays: [out, own], speed } in &rows {
        println!("{rays:10} {intersect:8} {out:10.2} {own:8.2} {speed:8.2}");
    }
    options.write_json(&rows)?;
    Ok(true)
}
