//! A renderer that takes a beating: signals, full disks and folders that cannot be written to. Whatever happens, there is
//! no half file, and the exit code is the promised one.
#![cfg(unix)]

use crate::support::repository;
use gonio_io::exr;
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_gonio");

/// A render that is under way, in a folder of its own.
struct Render {
    child: Child,
    err: BufReader<ChildStderr>,
}

impl Render {
    /// Starts a render of the Cornell box that would take days.
    fn start(folder: &Path, size: &str, more: &[&str]) -> Self {
        let scene = repository("scenes/cornell-box.toml");
        let mut command = Command::new(PROGRAM);
        command.arg("render").arg(scene).args(["--size", size, "--spp", "1048576", "--progress", "json"]);
        command.args(more).current_dir(folder).stderr(Stdio::piped()).stdout(Stdio::null());
        let mut child = command.spawn().unwrap();
        let err = BufReader::new(child.stderr.take().unwrap());
        Self { child, err }
    }

    /// Waits for the first report of progress: from then on there is something to save.
    fn first_pass(&mut self) {
        let mut line = String::new();
        while !line.contains("\"render\"") {
            line.clear();
            assert!(self.err.read_line(&mut line).unwrap() > 0, "the render ended early");
        }
    }

    fn send(&self, signal: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
    }

    /// The exit code, and what else was said.
    fn end(mut self) -> (Option<i32>, String) {
        let mut rest = String::new();
        self.err.read_to_string(&mut rest).unwrap();
        (self.child.wait().unwrap().code(), rest)
    }
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_render_that_is_stopped_writes_the_picture_it_has() {
    for signal in ["-TERM", "-INT"] {
        let folder = tempfile::tempdir().unwrap();
        let mut render =
            Render::start(folder.path(), "32x32", &["-o", "a.exr", "-o", "a.png", "--stats", "stats.json"]);
        render.first_pass();
        render.send(signal);
        let (code, said) = render.end();
        assert_eq!(code, Some(75), "{signal}: {said}");
        assert!(said.contains("stopped with "), "{said}");
        assert_eq!(names(folder.path()), ["a.exr", "a.png", "stats.json"]);
        let stats: Value = serde_json::from_slice(&fs::read(folder.path().join("stats.json")).unwrap()).unwrap();
        let spp = stats["spp"].as_u64().unwrap();
        assert!((8..1_048_576).contains(&spp) && stats["spp_wanted"] == 1_048_576);

        // It is the picture of so many samples, to the last bit.
        let scene = repository("scenes/cornell-box.toml");
        let mut whole = Command::new(PROGRAM);
        whole.arg("render").arg(scene).args(["--size", "32x32", "-o", "b.exr", "--spp", &spp.to_string()]);
        assert!(whole.current_dir(folder.path()).status().unwrap().success());
        let read = |name: &str| exr::read(&folder.path().join(name)).unwrap();
        assert_eq!(read("a.exr"), read("b.exr"));
    }
}

#[test]
fn the_second_signal_quits_at_once_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    // Every ray against every triangle: a pass takes long enough to be interrupted twice.
    let mut render = Render::start(folder.path(), "256x256", &["--backend", "brute", "-o", "a.exr"]);
    render.first_pass();
    render.send("-INT");
    sleep(Duration::from_millis(50)); // one at a time: two signals at once are one
    render.send("-INT");
    let (code, said) = render.end();
    assert_eq!(code, Some(130), "{said}");
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_run_that_has_nothing_to_save_quits_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("slow.toml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for signal in ["-INT", "-TERM", "-HUP"] {
        let child = Command::new(PROGRAM)
            .args(["render", "slow.toml", "-o", "a.exr"])
            .current_dir(folder.path())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = child.unwrap();
        // It reads from a pipe into which nobody writes.
        sleep(Duration::from_millis(300));
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
    }
    assert_eq!(names(folder.path()), ["slow.toml"]);
}

#[test]
fn sighup_shows_the_picture_so_far_and_the_render_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut render = Render::start(folder.path(), "32x32", &["-o", "a.exr"]);
    render.first_pass();
    render.send("-HUP");
    let picture = folder.path().join("a.exr");
    let start = Instant::now();
    while !picture.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no picture came");
        sleep(Duration::from_millis(20));
    }
    let early = exr::read(&picture).unwrap();
    assert!(render.child.try_wait().unwrap().is_none(), "the render goes on");
    render.send("-TERM");
    assert_eq!(render.end().0, Some(75));
    assert_eq!((early.width, early.height), (32, 32));
    assert_eq!(names(folder.path()), ["a.exr"]);
}

#[test]
fn a_full_disk_says_so_and_the_picture_is_saved_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let (disk, refuge) = (folder.path().join("disk"), folder.path().join("refuge"));
    fs::create_dir(&disk).unwrap();
    fs::create_dir(&refuge).unwrap();
    let script = format!(
        "mount -t tmpfs -o size=64k none {disk} || exit 99
         TMPDIR={refuge} {PROGRAM} render {scene} --size 256x256 --spp 1 -o {disk}/a.exr; code=$?
         ls -A {disk}; exit $code",
        disk = disk.display(),
        refuge = refuge.display(),
        scene = repository("scenes/cornell-box.toml").display(),
    );
    let run = Command::new("unshare").args(["--mount", "--map-root-user", "sh", "-c", &script]).output();
    let Some(run) = run.ok().filter(|run| !matches!(run.status.code(), Some(99) | None)) else {
        println!("full disk: did not run, a file system of a few pages cannot be made here");
        return;
    };
    let said = String::from_utf8(run.stderr).unwrap();
    if said.starts_with("unshare:") {
        println!("full disk: did not run: {said}");
        return;
    }
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("disk/a.exr: cannot be written: No space left on device"), "{said}");
    assert_eq!(String::from_utf8(run.stdout).unwrap(), "", "something is left on the full disk");
    let saved = names(&refuge);
    assert!(saved.len() == 1 && said.contains(&saved[0]), "{saved:?}: {said}");
    assert_eq!(exr::read(&refuge.join(&saved[0])).unwrap().width, 256);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_pipe_and_a_folder_of_the_system_are_errors() {
    let render = |output: &str, stdout: Stdio| {
        let mut command = Command::new(PROGRAM);
        command.arg("render").arg(repository("scenes/cornell-box.toml")).args(["--size", "8x8", "--spp", "1"]);
        let run = command.args(["-o", output]).stdout(stdout).output().unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    };
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let (code, said) = render("-", full.into());
    assert_eq!(code, Some(1));
    assert!(said.contains("standard output: cannot be written: No space left on device"), "{said}");
    // Not even root can make files there.
    let (code, said) = render("/proc/a.exr", Stdio::null());
    assert_eq!(code, Some(1));
    assert!(said.contains("/proc/a.exr: cannot be written"), "{said}");
}
