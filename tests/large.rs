//! Large scenes: memory per triangle from file to picture, and files that are only large.
//!
//! Peaks are Linux' own count of a child process, read while it runs. That misses at most the last moments, in which the
//! picture is written; the peak comes before, when the tree is built.

use crate::fuzz::high_water;
use gonio_tracer::scene::{Loading, Stage};
use gonio_tracer::{Backend, World};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A height field of n × n squares, each two triangles.
fn height_field(n: u32, folder: &Path) -> PathBuf {
    let mut text = String::new();
    for (x, y) in (0..=n).flat_map(|y| (0..=n).map(move |x| (x, y))) {
        let height = f64::from(x * 7 + y * 13).sin();
        writeln!(text, "v {x} {height:.4} {y}").expect("a string can be written to");
    }
    for (x, y) in (0..n).flat_map(|y| (0..n).map(move |x| (x, y))) {
        let (a, b) = (y * (n + 1) + x + 1, (y + 1) * (n + 1) + x + 1);
        writeln!(text, "f {a} {b} {}\nf {} {b} {}", a + 1, a + 1, b + 1).expect("a string can be written to");
    }
    let path = folder.join(format!("field-{n}.obj"));
    fs::write(&path, text).expect("there is room for temporary files");
    path
}

/// Renders a small picture in a process of its own: its exit code, what it said, and its peak of memory in bytes.
fn render(scene: &Path) -> (Option<i32>, String, Option<u64>) {
    let picture = scene.with_extension("exr");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin!("gonio"))
        .arg("render")
        .arg(scene)
        .args(["--size", "8x8", "--spp", "1", "--threads", "1", "-o"])
        .arg(&picture)
        .stderr(Stdio::piped())
        .spawn()
        .expect("gonio starts");
    let status = format!("/proc/{}/status", child.id());
    let mut peak = None;
    while child.try_wait().expect("a child can be waited for").is_none() {
        peak = high_water(Path::new(&status)).or(peak);
        std::thread::sleep(Duration::from_millis(1));
    }
    let output = child.wait_with_output().expect("a child can be waited for");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned(), peak)
}

#[test]
fn memory_grows_by_420_bytes_per_triangle_at_most() {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    let peaks = [160, 450].map(|n| {
        let (code, said, peak) = render(&height_field(n, folder.path()));
        assert_eq!(code, Some(0), "{said}");
        (f64::from(2 * n * n), peak)
    });
    let [(few, Some(least)), (many, Some(most))] = peaks else {
        return println!("memory: /proc is not there, not run");
    };
    // 250 of them are the builder's while it works, on at most 2²⁰ triangles at a time; beyond that they do not grow.
    let each = (most as f64 - least as f64) / (many - few);
    println!("{each:.0} bytes per triangle");
    assert!((100.0..420.0).contains(&each), "{each} bytes per triangle");
}

#[test]
fn a_forest_takes_the_memory_of_a_tree() {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    height_field(150, folder.path());
    let mut forest = "[film]\nwidth = 8\nheight = 8\n[camera]\norigin = [0.0, 500.0, -900.0]\n\
                      target = [800.0, 0.0, 800.0]\nvfov = 40.0\n[environment]\nradiance = 1.0\n"
        .to_owned();
    for i in 0..100 {
        let place = [i % 10 * 160, i % 3, i / 10 * 160];
        let one = format!("[[meshes]]\nfile = \"field-150.obj\"\ntransform = [{{ translate = {place:?} }}]\n");
        forest.push_str(&one);
    }
    let path = folder.path().join("forest.toml");
    fs::write(&path, forest).expect("there is room for temporary files");
    let (code, said, peak) = render(&path);
    assert_eq!(code, Some(0), "{said}");
    let each = peak.map(|peak| peak / (100 * 2 * 150 * 150));
    println!("{each:?} bytes per triangle, program included");
    assert!(each.is_none_or(|each| each < 30), "{each:?} bytes per triangle");
}

#[test]
fn files_that_are_only_large_are_refused_in_little_memory() {
    const SIZE: usize = 40 << 20;
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    let refused = |name: &str, block: &[u8], end: &str| {
        let path = folder.path().join(name);
        fs::write(&path, block.repeat(SIZE / block.len())).expect("there is room for temporary files");
        let (code, said, peak) = render(&path);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.trim_end().ends_with(end), "{said}");
        assert!(peak.is_none_or(|peak| peak < SIZE as u64), "{name}: {peak:?} bytes");
    };
    refused("line.obj", b"x", "line.obj:1: the line is longer than 16777216 bytes: this is not an OBJ file");
    refused(
        "continued.obj",
        b"f 1 2 3 \\\n",
        "continued.obj:1: the line is longer than 16777216 bytes: this is not an OBJ file",
    );
    refused("points.obj", b"v 0 0 0\n", "points.obj:5242880: the file ends here and has no faces");
    refused(
        "binary.obj",
        b"v\0\n",
        "binary.obj:1: here is a zero byte: an OBJ file is plain text, one byte per letter",
    );
    refused("far.obj", b"f 1 2 3\n", "far.obj:1: vertex index 1 in a face is out of range: the file defines 0");
}

#[test]
fn loading_tells_how_far_it_is() {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    let path = height_field(400, folder.path());
    let size = fs::metadata(&path).expect("it was just written").len();
    let mut told: Vec<Loading> = Vec::new();
    let mut scene = gonio_io::load_with(&path, &mut |loading| told.push(loading)).expect("a height field loads");
    let (meshes, materials) = (scene.meshes.clone(), scene.materials.clone());
    let world = World::take(&mut scene, &mut |loading| told.push(loading)).expect("and can be placed");
    let accel = Backend::Obvhs.build_with(world.geometry(), Default::default(), &mut |loading| told.push(loading));
    assert!(accel.is_ok() && scene.meshes.is_empty());
    assert!(told.iter().all(|loading| loading.done <= loading.of));
    let last = |stage| told.iter().rfind(|loading| loading.stage == stage).map(|loading| (loading.done, loading.of));
    assert_eq!(last(Stage::Reading), Some((size, size)));
    assert_eq!(last(Stage::Placing), Some((320_000, 320_000)));
    assert_eq!(last(Stage::Building), Some((320_000, 320_000)));
    let steps = told.iter().filter(|loading| loading.stage == Stage::Reading).count();
    assert!(steps > 2, "{steps} reports for {size} bytes");

    scene.meshes = meshes;
    assert_eq!(materials, scene.materials);
    let borrowed = World::new(&scene).expect("a scene can be placed without being taken");
    assert_eq!(format!("{:?}", borrowed.geometry()), format!("{:?}", world.geometry()));
}
