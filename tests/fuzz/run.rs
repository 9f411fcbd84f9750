//! Running a target: seeds, mutations, and what is measured about each execution.

use super::bodies::{Target, plain};
use super::mutate::mutate;
use crate::support::{Random, repository};
use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// No input of 64 KiB may take longer, on the slowest machine that runs the tests.
const LONGEST: Duration = Duration::from_secs(10);
/// Memory that one execution may add to the process: a buffer per reader, and for images the most that is decoded.
const MOST_MEMORY: u64 = 1 << 30;
/// What loading may need for each byte of input beyond that.
const MEMORY_PER_BYTE: u64 = 1 << 10;

/// How a run went.
pub(super) struct Report {
    pub(super) executions: u64,
    pub(super) seconds: f64,
    pub(super) outcomes: BTreeSet<String>,
    pub(super) slowest: Duration,
    /// Most memory of an execution, where it is measured.
    pub(super) memory: u64,
}

/// The kept inputs of a target, in the order of their names.
pub(super) fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = repository("tests/corpus").join(target);
    let files = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = files.map(|file| file.expect("a corpus can be listed").path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("a corpus can be read")).collect()
}

/// Runs every seed and then mutations of them.
///
/// # Errors
/// The first broken promise, with the path of the input that broke it.
pub(super) fn run(target: &Target, executions: u64, measure_memory: bool) -> Result<Report, String> {
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    (target.prepare)(folder.path());
    let seeds = corpus(target.name);
    let mut random = Random(target.name.bytes().fold(1, |sum, byte| sum * 31 + u64::from(byte)));
    let start = Instant::now();
    let mut report =
        Report { executions: 0, seconds: 0.0, outcomes: BTreeSet::new(), slowest: Duration::ZERO, memory: 0 };
    for number in 0..executions {
        let data = match seeds.get(number as usize) {
            Some(seed) => seed.clone(),
            None => mutate(&seeds, &mut random),
        };
        let memory = measure_memory.then(Memory::begin).flatten();
        let began = Instant::now();
        let result = catch_unwind(AssertUnwindSafe(|| (target.body)(folder.path(), &data)));
        let took = began.elapsed();
        let used = memory.map_or(0, |memory| memory.end());
        let most = MOST_MEMORY + MEMORY_PER_BYTE * data.len() as u64;
        let broken = match &result {
            Err(panic) => Some(format!("a panic: {}", words(&**panic))),
            Ok(_) if took > LONGEST => Some(format!("{took:?}, more than {LONGEST:?}")),
            Ok(_) if used > most => Some(format!("{used} bytes of memory, more than {most}")),
            Ok(_) => None,
        };
        if let Some(broken) = broken {
            let kept = keep(target.name, &data);
            return Err(format!("{}: execution {number}: {broken}; the input is {}", target.name, kept.display()));
        }
        report.outcomes.extend(result.map(|outcome| plain(&outcome)));
        report.slowest = report.slowest.max(took);
        report.memory = report.memory.max(used);
        report.executions += 1;
    }
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

fn words(panic: &(dyn std::any::Any + Send)) -> &str {
    let string = panic.downcast_ref::<String>().map(String::as_str);
    string.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("without words")
}

/// Keeps an input under a name made of its bytes (FNV-1a).
fn keep(target: &str, data: &[u8]) -> PathBuf {
    let hash = data
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash: u64, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    let folder = repository("target/fuzz");
    let path = folder.join(format!("{target}-{hash:016x}"));
    let kept = fs::create_dir_all(&folder).and_then(|()| fs::write(&path, data));
    kept.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    path
}

/// The most memory of this process since a moment, by Linux' own count; other threads add to it.
pub(super) struct Memory {
    before: u64,
}

impl Memory {
    pub(super) fn begin() -> Option<Self> {
        fs::write("/proc/self/clear_refs", "5").ok()?; // sets the high-water mark to what is in use
        Some(Self { before: high_water(Path::new("/proc/self/status"))? })
    }

    pub(super) fn end(self) -> u64 {
        high_water(Path::new("/proc/self/status")).map_or(0, |after| after.saturating_sub(self.before))
    }
}

/// The largest resident size of a process so far, in bytes.
pub(crate) fn high_water(status: &Path) -> Option<u64> {
    let status = fs::read_to_string(status).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse::<u64>().ok().map(|kib| kib * 1024)
}
