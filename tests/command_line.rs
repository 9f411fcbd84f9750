//! The program from outside: every exit code, the words of each refusal, and files that appear whole or not at all.

mod accel;
mod bsdf;

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_gonio");

/// What a run of the program left behind.
struct Run {
    code: i32,
    out: String,
    err: String,
}

impl Run {
    #[track_caller]
    fn succeeds(self) -> String {
        assert_eq!(self.code, 0, "{}", self.err);
        self.out
    }
    #[track_caller]
    fn fails(self, code: i32, words: &str) {
        assert_eq!(self.code, code, "{}{}", self.out, self.err);
        assert!(self.err.contains(words), "\"{words}\" is not in: {}", self.err);
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}

/// Runs `gonio` with arguments separated by spaces, in a folder.
fn gonio(folder: &Path, arguments: &str) -> Run {
    let output = Command::new(PROGRAM).args(arguments.split_whitespace()).current_dir(folder).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Run { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

fn scene(name: &str) -> String {
    let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "scenes", name].iter().collect();
    path.display().to_string()
}

/// A folder with a diffuse, a mirror and a metal material, and a table of directions.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("white.toml", "base_color = [1, 1, 1]\n");
    write("metal.toml", "type = \"conductor\"\nf0 = [0.9, 0.6, 0.3]\nroughness = 0.5\n");
    write("mirror.toml", "type = \"mirror\"\nreflectance = [0.75, 0.5, 0.25]\n");
    write("in.csv", "wo_x,wo_y,wo_z,wi_x,wi_y,wi_z\n0.6,0,0.8,0,0,1\n\n0,0,1,0.6,0,-0.8\n");
    folder
}

/// The names in a folder.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Rows of a CSV without its header.
fn rows(csv: &str) -> Vec<Vec<&str>> {
    csv.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = folder();
    assert_eq!(gonio(folder.path(), "--version").succeeds(), format!("gonio {}\n", env!("CARGO_PKG_VERSION")));
    for command in [
        "",
        "render",
        "compare",
        "bsdf",
        "certify",
        "bsdf eval",
        "bsdf sample",
        "bsdf albedo",
        "accel",
        "accel census",
        "accel bench",
        "validate",
    ] {
        let help = gonio(folder.path(), &format!("{command} --help")).succeeds();
        assert!(help.contains("Usage: gonio"), "{help}");
    }
}

#[test]
fn wrong_usage_is_exit_code_2_and_says_what_would_be_right() {
    let folder = folder();
    let box_ = scene("cornell-box.toml");
    for (arguments, words) in [
        ("", "Usage"),
        ("paint", "unrecognized subcommand 'paint'"),
        ("render scene.toml", "--output"),
        ("render scene.toml -o a.exr --backend fast", "obvhs"),
        ("render scene.toml -o a.exr --backend brute --fast-intersect", "always robust"),
        ("render scene.toml -o a.jpg", "pictures are written as .exr or .png"),
        ("render scene.toml -o a.exr --spp 0", "0 is not in"),
        ("render scene.toml -o a.exr --crop 4,4,4,8", "X0 < X1"),
        ("render scene.toml -o a.exr --size 0x9", "WIDTHxHEIGHT"),
        ("render scene.toml -o - --json", "only one result can go to standard output"),
        (&format!("render {box_} -o a.exr --crop 0,0,8,513"), "does not fit the picture of 512 x 512 pixels"),
        ("bsdf sample white.toml --wo 0,1 -n 1", "a direction is three numbers"),
        ("bsdf sample white.toml --wo 0,0,1 -n 0", "at least 1"),
        ("bsdf eval white.toml --directions in.csv --precision f16", "f32"),
        ("bsdf albedo white.toml --cos 2", "a cosine is a number from -1 to 1"),
        ("accel census box.obj --scales 1,0", "a scale is a number above 0"),
        ("accel census box.obj --rays 0", "at least 1"),
        ("accel census box.obj --backends rtx", "there is no backend \"rtx\""),
        ("accel census box.obj --backends brute", "brute is what the others are compared with"),
        ("accel bench box.obj --backends obvhs,obvhs", "names obvhs twice"),
        ("accel bench box.obj --rounds 0", "0 is not in"),
        ("validate --quick --full", "cannot be used with"),
        ("validate --seed today", "random"),
        ("validate --quick --only no-such-check", "instruments are"),
    ] {
        gonio(folder.path(), arguments).fails(2, words);
    }
    if !cfg!(feature = "embree") {
        gonio(folder.path(), "render scene.toml -o a.exr --backend embree").fails(2, "cargo xtask embree");
    }
    assert!(!folder.path().join("a.exr").exists());
}

#[test]
fn errors_are_exit_code_1_and_point_to_file_and_line() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("bad.toml", "[film]\nwidth = 8\nheight = \"tall\"\n");
    write("typo.toml", "type = \"mirror\"\n\nreflectence = [1, 1, 1]\n");
    write("short.csv", "0.6,0,0.8,0,0,1\n0,0,1,0,0\n");
    write("word.csv", "0.6,0,0.8,0,0,1\n\n0,0,1,0,zero,1\n");
    write("header.csv", "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n0,0,1,0,0,1\n");
    for (arguments, words) in [
        ("render nothing.toml -o a.exr", "error: nothing.toml"),
        ("render bad.toml -o a.exr", "error: bad.toml:3: "),
        ("render in.csv -o a.exr", "neither a scene file (.toml) nor an OBJ file (.obj)"),
        ("accel census nothing.obj", "error: nothing.obj"),
        ("accel census bad.toml", "error: bad.toml:3: "),
        ("accel bench bad.toml", "error: bad.toml:3: "),
        ("bsdf albedo nothing.toml --cos 1", "error: nothing.toml: cannot be read"),
        ("bsdf albedo typo.toml --cos 1", "error: typo.toml:3: "),
        ("bsdf eval white.toml --directions nothing.csv", "error: nothing.csv: cannot be read"),
        (
            "bsdf eval white.toml --directions short.csv -o a.csv",
            "error: short.csv:2: a row has 6 numbers, this one has 5",
        ),
        ("bsdf eval white.toml --directions word.csv -o a.csv", "error: word.csv:3: \"zero\" is not a number"),
        ("bsdf eval white.toml --directions header.csv -o a.csv", "error: header.csv:1: "),
        ("validate --quick --only leaks --out white.toml", "error: white.toml: cannot be made"),
    ] {
        gonio(folder.path(), arguments).fails(1, words);
    }
    assert!(!names(folder.path()).iter().any(|name| name.starts_with("a.") || name.contains(".tmp")));
}

#[test]
fn an_output_that_cannot_be_written_is_found_before_the_work() {
    let folder = folder();
    fs::create_dir(folder.path().join("taken.exr")).unwrap();
    let before = names(folder.path());
    // A scene that would render for hours: if it were rendered first, this test would not end.
    let render = format!("render {} --spp 1000000", scene("cornell-box.toml"));
    for outputs in
        ["-o no/folder/a.exr", "-o taken.exr", "-o white.toml/a.png", "-o a.exr --stats no/folder/stats.json"]
    {
        gonio(folder.path(), &format!("{render} {outputs}")).fails(1, "cannot be written");
    }
    gonio(folder.path(), "bsdf sample white.toml --wo 0,0,1 -n 4 -o no/folder/a.csv").fails(1, "cannot be written");
    assert_eq!(names(folder.path()), before);
}

#[test]
fn a_render_writes_pictures_and_statistics_in_silence() {
    let folder = folder();
    let render = format!("render {} --size 8x8 --spp 1", scene("cornell-box.toml"));
    let run = gonio(
        folder.path(),
        &format!("{render} -o a.exr -o a.png --stats stats.json --backend brute --threads 2 --seed 7"),
    );
    assert_eq!(run.err, "");
    assert_eq!(run.succeeds(), "");
    assert_eq!(&fs::read(folder.path().join("a.exr")).unwrap()[..4], [0x76, 0x2f, 0x31, 0x01]);
    assert_eq!(&fs::read(folder.path().join("a.png")).unwrap()[..4], *b"\x89PNG");
    let stats: Value = serde_json::from_slice(&fs::read(folder.path().join("stats.json")).unwrap()).unwrap();
    for name in ["load_seconds", "build_seconds", "render_seconds", "msamples_per_second", "lanes_full"] {
        assert!(stats[name].as_f64().unwrap() >= 0.0, "{name}");
    }
    for (name, value) in [
        ("samples", 64),
        ("spp", 1),
        ("width", 8),
        ("height", 8),
        ("max_depth", 8),
        ("seed", 7),
        ("dropped_samples", 0),
    ] {
        assert_eq!(stats[name].as_u64(), Some(value), "{name}");
    }
    for name in ["closest_rays", "shadow_rays", "threads"] {
        assert!(stats[name].as_u64().unwrap() > 0, "{name}");
    }
    for name in ["film_hash", "effects", "version"] {
        assert!(!stats[name].as_str().unwrap().is_empty(), "{name}");
    }
    assert_eq!(stats["backend"], "brute");
    assert_eq!(stats["intersect"], "robust");
    let largest = stats["largest_samples"].as_array().unwrap();
    assert!(!largest.is_empty() && largest.len() <= 10);
    assert!(largest[0]["value"].as_f64().unwrap() > 0.0 && largest[0]["x"].as_u64().unwrap() < 8);
}

#[test]
fn pictures_are_compared_by_what_chance_can_explain() {
    let folder = folder();
    let render = |name: &str, more: &str| {
        let box_ = scene("cornell-box.toml");
        gonio(folder.path(), &format!("render {box_} --size 32x32 --spp 64 -o {name} {more}")).succeeds();
    };
    render("a.exr", "--seed 1");
    render("b.exr", "--seed 2");
    render("dark.exr", "--seed 2 --max-depth 2");
    render("other.png", "");
    let compared = |arguments: &str| -> Value {
        serde_json::from_str(&gonio(folder.path(), &format!("compare --json {arguments}")).succeeds()).unwrap()
    };
    let same = compared("a.exr a.exr");
    assert_eq!((same["differing_pixels"].as_u64(), same["rmse"][0].as_f64()), (Some(0), Some(0.0)));
    let noise = compared("a.exr b.exr -o d.png");
    assert_eq!(noise["block_test"]["explained_by_chance"], true, "{noise}");
    assert!(noise["differing_pixels"].as_u64().unwrap() > 500 && noise["rel_mse"][1].as_f64().unwrap() > 0.0);
    assert_eq!(&fs::read(folder.path().join("d.png")).unwrap()[..4], *b"\x89PNG");
    gonio(folder.path(), "compare a.exr b.exr --test -o d.exr").succeeds();
    gonio(folder.path(), "compare a.exr dark.exr").succeeds();
    gonio(folder.path(), "compare a.exr dark.exr --test").fails(3, "");
    gonio(folder.path(), "compare a.exr other.png --significance 2").fails(2, "between 0 and 1");
    gonio(folder.path(), "compare a.exr other.png -o d.gif").fails(2, "written as .exr or .png");
    gonio(folder.path(), "compare a.exr in.csv").fails(1, "in.csv: cannot be");
    gonio(folder.path(), &format!("render {} --size 8x8 --spp 1 -o small.png", scene("cornell-box.toml"))).succeeds();
    gonio(folder.path(), "compare a.exr small.png").fails(2, "32 x 32 pixels, but small.png has 8 x 8");
}

#[test]
fn threads_and_backends_do_not_change_the_picture_but_seeds_do() {
    let folder = folder();
    let hash = |more: &str| {
        let render = format!("render {} --size 8x8 --spp 1 -o a.exr --json {more}", scene("cornell-box.toml"));
        let stats: Value = serde_json::from_str(&gonio(folder.path(), &render).succeeds()).unwrap();
        stats["film_hash"].as_str().unwrap().to_owned()
    };
    let one = hash("--threads 1");
    assert_eq!(hash("--threads 2"), one);
    assert_eq!(hash("--backend brute"), one);
    assert_ne!(hash("--seed 9"), one);
    assert_ne!(hash("--max-depth 0"), one);
}

#[test]
fn an_obj_file_alone_renders_with_warnings_and_to_standard_output() {
    let folder = folder();
    let arguments =
        format!("render {} --size 8x8 --spp 1 --no-russian-roulette --crop 2,2,6,4", scene("furnace-object.obj"));
    let run = gonio(folder.path(), &format!("{arguments} -o a.exr --stats -"));
    assert!(run.err.starts_with("warning: ") && run.err.contains("material \"object\" is not defined"), "{}", run.err);
    let stats: Value = serde_json::from_str(&run.succeeds()).unwrap();
    assert_eq!((stats["width"].as_u64(), stats["height"].as_u64()), (Some(4), Some(2)));
    let output = Command::new(PROGRAM).args(arguments.split_whitespace()).args(["-o", "-"]).output().unwrap();
    assert_eq!(output.stdout[..4], [0x76, 0x2f, 0x31, 0x01]);
}

#[test]
fn a_validation_writes_its_report_and_a_failure_is_exit_code_3() {
    let folder = folder();
    let run = gonio(folder.path(), "validate --quick --only leaks --out report");
    assert!(run.out.contains("PASS") && run.out.contains("passed, 0 failed, 0 not run"), "{}", run.out);
    run.succeeds();
    let page = fs::read_to_string(folder.path().join("report/report.html")).unwrap();
    assert!(page.contains("prefers-color-scheme: dark") && !page.contains("http") && !page.contains("<script"));

    let run = gonio(folder.path(), "validate --quick --only leaks --out report --plant-failure --json");
    assert_eq!(run.code, 3, "{}", run.err);
    let report: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(report["failed"].as_u64(), Some(1));
    assert_eq!(
        report,
        serde_json::from_slice::<Value>(&fs::read(folder.path().join("report/report.json")).unwrap()).unwrap()
    );
    assert!(report["census"]["rows"].as_array().unwrap().iter().any(|row| row["leaks"] == 0 && row["scale"] == 1e-4));
    if !cfg!(feature = "embree") {
        let run = gonio(folder.path(), "validate --quick --only embree --out report");
        assert!(run.out.contains("0 passed, 0 failed, 1 not run (embree)"), "{}", run.out);
    }
    let run = gonio(folder.path(), "validate --quick --only leaks --out report --plant-failure");
    assert!(run.out.contains("FAIL  planted-failure"), "{}", run.out);
    assert_eq!(run.code, 3);
}

#[test]
fn an_old_processor_gets_a_sentence_instead_of_an_illegal_instruction() {
    if !cfg!(target_feature = "avx2") {
        return;
    }
    let Ok(output) = std::process::Command::new("qemu-x86_64").args(["-cpu", "Nehalem", PROGRAM, "--version"]).output()
    else {
        println!("not run: qemu-x86_64 (package qemu-user) is not installed");
        return;
    };
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(err.contains("needs a processor with AVX2") && err.contains("lacks AVX2 FMA"), "{err}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn a_certificate_is_printed_written_and_drawn() {
    let folder = folder();
    let text = gonio(folder.path(), "certify metal.toml --quick --json c.json --report c.html").succeeds();
    for words in [
        "metal: holds",
        "claims: reciprocal; conserves energy",
        "alpha_x",
        "white furnace",
        "not counted (not asked for)",
    ] {
        assert!(text.contains(words), "\"{words}\" is not in: {text}");
    }
    let json: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("c.json")).unwrap()).unwrap();
    assert_eq!((&json["holds"], &json["reciprocal"]), (&Value::Bool(true), &Value::Bool(true)));
    assert!(json["ranges"].as_array().unwrap().iter().all(|range| range["safe"].is_array()), "{json}");
    let page = fs::read_to_string(folder.path().join("c.html")).unwrap();
    assert!(page.contains("Certificate of metal") && page.contains("<svg") && !page.contains("<script"), "{page}");
    let printed = gonio(folder.path(), "certify mirror.toml --quick --json -").succeeds();
    assert!(serde_json::from_str::<Value>(&printed).is_ok_and(|json| json["holds"] == Value::Bool(true)), "{printed}");
    // What is wrong with a file is said with its line; what is wrong with the command, with exit code 2.
    fs::write(folder.path().join("bad.toml"), "type = \"conductor\"\nf0 = 2\n").unwrap();
    gonio(folder.path(), "certify bad.toml").fails(1, "bad.toml:2");
    gonio(folder.path(), "certify metal.toml --quick --full").fails(2, "--full");
}
