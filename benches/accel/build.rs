//! What a tree costs: time, memory, and after how many rays it has paid.
//!
//! Builders take turns on one thread; the median counts. Memory is Linux' own count of a child process that makes the scene,
//! forgets what the peak was so far, and builds one tree: what it then has more than before, and the most it had in between. A
//! tree pays when building and casting together take less time than with Embree of medium quality; rays are the diffuse ones,
//! because those are most of a picture.

use super::contenders::{Builder, Contender, Method, Side, warn_if_alone};
use super::measure::{fails, median, slack, take_turns};
use super::options::Options;
use crate::scenes::{Character, Scene, rays};
use gonio_accel::Intersect;
use serde::Serialize;
use std::fs;
use std::process::Command;
use std::time::Instant;

/// What is asked of the builder that speeds are compared with: its time over that of Embree's medium quality, and bytes per
/// triangle.
const TIMES: f64 = 4.0;
const RESIDENT: f64 = 80.0;
const PEAK: f64 = 250.0;

/// One builder on one scene.
#[derive(Serialize)]
struct Row {
    scene: String,
    triangles: usize,
    intersect: String,
    builder: String,
    seconds: f64,
    /// Over Embree's medium quality, and its slack.
    times: Option<f64>,
    slack: f64,
    /// Bytes per triangle: as the tree says, as the process grew, and at the peak.
    told: Option<f64>,
    resident: Option<f64>,
    peak: Option<f64>,
    /// Diffuse rays, millions per second.
    mrays: f64,
    /// Rays from which on it is ahead of Embree's medium quality: 0 from the start, none for never.
    pays_after: Option<f64>,
}

pub(crate) fn run(options: &Options) -> Result<bool, String> {
    // Only with the fast tests does Embree's high quality build another tree than its medium one.
    let test = if options.tests.len() == 1 { options.tests[0] } else { Intersect::Fast };
    let mut rows = Vec::new();
    for &character in &options.scenes {
        let scene = options.scene(character);
        eprintln!("{}: {} triangles", scene.name, scene.geometry.triangle_count());
        rows.extend(measure(options, character, &scene, test)?);
    }
    println!("{test}; bytes per triangle; ahead of embree-medium after so many million diffuse rays");
    println!(
        "{:18} {:16} {:>8} {:>6} {:>6} {:>8} {:>6} {:>8} {:>10}",
        "scene", "builder", "seconds", "times", "told", "resident", "peak", "Mrays/s", "ahead"
    );
    let dash = |value: Option<f64>, digits: usize| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
    for row in &rows {
        println!(
            "{:18} {:16} {:8.3} {:>6} {:>6} {:>8} {:>6} {:8.2} {:>10}",
            row.scene,
            row.builder,
            row.seconds,
            dash(row.times, 2),
            dash(row.told, 0),
            dash(row.resident, 0),
            dash(row.peak, 0),
            row.mrays,
            row.pays_after.map_or("never".to_owned(), |rays| format!("{:.2}", rays / 1e6)),
        );
    }
    let name = Builder::all()[0].name();
    let mut passed = true;
    for row in rows.iter().filter(|row| row.builder == name) {
        // Bytes do not depend on how busy the machine is.
        let asked = [
            ("times", row.times, TIMES, row.slack),
            ("resident", row.told.or(row.resident), RESIDENT, 0.0),
            ("peak", row.peak, PEAK, 0.0),
        ];
        for (what, found, most, slack) in asked {
            if let Some(found) = found.filter(|found| *found > most) {
                let failed = fails(1.0 / found, 1.0 / most, slack);
                let word = if failed { "FAILED" } else { "not met" };
                println!("{}, {name}: {what} {found:.1}, asked {most:.1} at most, slack {slack:.2}: {word}", row.scene);
                passed &= !failed;
            }
        }
    }
    warn_if_alone();
    options.write_json(&rows)?;
    Ok(passed)
}

fn measure(options: &Options, character: Character, scene: &Scene, test: Intersect) -> Result<Vec<Row>, String> {
    let builders = Builder::all();
    let mut seconds = vec![Vec::new(); builders.len()];
    let mut built: Vec<Option<Contender>> = builders.iter().map(|_| None).collect();
    for _ in 0..options.rounds {
        for (i, builder) in builders.iter().enumerate() {
            built[i] = None; // its memory first
            let start = Instant::now();
            built[i] = Some(builder.build(&scene.geometry, test)?);
            seconds[i].push(start.elapsed().as_secs_f64());
        }
    }
    let built: Vec<Contender> = built.into_iter().flatten().collect();
    let [_, diffuse, ..] = rays::sets(scene, built[0].as_a_renderer_does(), options.rays);
    let methods: Vec<Vec<Method>> = built.iter().map(|contender| contender.methods(diffuse.kind)).collect();
    let owners: Vec<usize> = methods.iter().enumerate().flat_map(|(i, m)| m.iter().map(move |_| i)).collect();
    let timed = take_turns(methods.into_iter().flatten().collect(), &diffuse, options.rounds)
        .map_err(|e| format!("{}: {e}", scene.name))?;
    // Seconds per ray of each builder's best way.
    let per_ray: Vec<f64> = (0..built.len())
        .map(|i| {
            let own = timed.iter().zip(&owners).filter(|(_, owner)| **owner == i);
            let fastest = own.map(|(one, _)| median(&one.seconds)).fold(f64::INFINITY, f64::min);
            fastest / diffuse.count.max(1) as f64
        })
        .collect();
    let medium = built.iter().position(|contender| contender.builder.side() == Side::Embree);
    let triangles = scene.geometry.triangle_count();
    let row = |i: usize| -> Result<Row, String> {
        let (resident, peak) = memory(options, character, test, builders[i])?;
        let each = |bytes: f64| bytes / triangles as f64;
        Ok(Row {
            scene: scene.name.clone(),
            triangles,
            intersect: test.to_string(),
            builder: builders[i].name(),
            seconds: median(&seconds[i]),
            times: medium.map(|m| median(&seconds[i]) / median(&seconds[m])),
            slack: medium.map_or(0.0, |m| {
                let rounds: Vec<f64> = seconds[m].iter().zip(&seconds[i]).map(|(m, i)| m / i).collect();
                slack(&rounds)
            }),
            told: built[i].bytes.map(|bytes| each(bytes as f64)),
            resident: resident.map(each),
            peak: peak.map(each),
            mrays: 1e-6 / per_ray[i],
            pays_after: medium.and_then(|m| pays(median(&seconds[i]), per_ray[i], median(&seconds[m]), per_ray[m])),
        })
    };
    (0..builders.len()).map(row).collect()
}

/// From how many rays on one tree is ahead of another; `None` if it never is, or never stays.
fn pays(build: f64, per_ray: f64, other_build: f64, other_per_ray: f64) -> Option<f64> {
    if per_ray < other_per_ray {
        return Some(((build - other_build) / (other_per_ray - per_ray)).max(0.0));
    }
    None
}

/// The bytes by which a child grew when it built, and at most grew in between; `None` where the system does not say.
fn memory(
    options: &Options,
    character: Character,
    test: Intersect,
    builder: Builder,
) -> Result<(Option<f64>, Option<f64>), String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut child = Command::new(program);
    child.args(["--memory", &builder.name()]).args(options.for_child(character, test));
    let output = child.output().map_err(|e| format!("a child cannot be started: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let mut numbers = text.split_whitespace().map(|word| word.parse().ok());
    Ok((numbers.next().flatten(), numbers.next().flatten()))
}

/// The child's side: two numbers on stdout, or dashes.
pub(crate) fn tell_memory(options: &Options, builder: Builder) -> Result<bool, String> {
    let scene = options.scene(options.scenes[0]);
    let _ = fs::write("/proc/self/clear_refs", "5"); // the peak starts anew; where it cannot, that of the scene counts
    let before = status("VmRSS:");
    let built = builder.build(&scene.geometry, options.tests[0])?;
    let grown = |field: &str| before.zip(status(field)).map(|(before, after)| after - before);
    let word = |bytes: Option<f64>| bytes.map_or("-".to_owned(), |bytes| bytes.to_string());
    println!("{} {}", word(grown("VmRSS:")), word(grown("VmHWM:")));
    drop(built);
    Ok(true)
}

/// A field of Linux' report on this process, in bytes.
fn status(field: &str) -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let kibibytes = text.lines().find_map(|line| line.strip_prefix(field))?.trim().strip_suffix("kB")?;
    Some(kibibytes.trim().parse::<f64>().ok()? * 1024.0)
}
