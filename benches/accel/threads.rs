//! Two threads that share a tree against two processes that do not.
//!
//! What two threads lose is what they do to each other: lines of the cache that both write, locks, an allocator in the way.
//! What they lose to the memory they would lose as two processes as well, so those are the measure: each casts the same rays,
//! at the same time, in turns with the two threads. The machine needs two free cores.

use super::contenders::{Builder, Method};
use super::measure::{cast, fails, median, slack};
use super::options::Options;
use crate::scenes::rays::Answers;
use crate::scenes::rays::{self, RaySet};
use serde::Serialize;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Barrier;

/// The least ratio of the rates.
const LEAST: f64 = 0.95;

#[derive(Serialize)]
struct Row {
    scene: String,
    intersect: String,
    set: &'static str,
    /// Millions of rays per second, both together.
    threads: f64,
    processes: f64,
    ratio: f64,
    slack: f64,
}

pub(crate) fn run(options: &Options) -> Result<bool, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if cores < 2 {
        return Err("two threads need two cores, and this process may use one".to_owned());
    }
    let mut rows: Vec<Row> = Vec::new();
    println!("Mrays/s of two threads and of two processes");
    for &character in &options.scenes {
        let scene = options.scene(character);
        let test = options.tests[0];
        let built = Builder::all()[0].build(&scene.geometry, test)?;
        let arguments = options.for_child(character, test);
        let mut partners = [Partner::start(&arguments)?, Partner::start(&arguments)?];
        for set in rays::sets(&scene, built.as_a_renderer_does(), options.rays) {
            let method = built.methods(set.kind).swap_remove(0);
            let (mut threads, mut processes) = (Vec::new(), Vec::new());
            for round in 0..=options.rounds {
                let pair = [in_threads(&method, &set), in_processes(&mut partners, set.name)?];
                if round > 0 {
                    threads.push(pair[0]);
                    processes.push(pair[1]);
                }
            }
            let rounds: Vec<f64> = processes.iter().zip(&threads).map(|(p, t)| p / t).collect();
            let slack = slack(&rounds);
            let rate = |seconds: &[f64]| set.count as f64 / 1e6 / median(seconds);
            let (threads, processes) = (rate(&threads), rate(&processes));
            let ratio = threads / processes;
            println!("{:18} {:10} {threads:8.2} {processes:8.2} {ratio:6.2}", scene.name, set.name);
            let (scene, intersect) = (scene.name.clone(), test.to_string());
            rows.push(Row { scene, intersect, set: set.name, threads, processes, ratio, slack });
        }
    }
    let mean = (rows.iter().map(|row| row.ratio.ln()).sum::<f64>() / rows.len() as f64).exp();
    let slack = rows.iter().map(|row| row.slack).sum::<f64>() / rows.len() as f64;
    let failed = fails(mean, LEAST, slack);
    let word = if failed { "FAILED" } else { ["not met", "met"][usize::from(mean >= LEAST)] };
    println!("mean {mean:.3}, asked {LEAST}, slack {slack:.2}: {word}");
    options.write_json(&rows)?;
    Ok(!failed)
}

/// Seconds that a pass takes with two at once: 1 over the sum of the rates.
fn together(seconds: [f64; 2]) -> f64 {
    1.0 / (1.0 / seconds[0] + 1.0 / seconds[1])
}

fn in_threads(method: &Method, set: &RaySet) -> f64 {
    let barrier = Barrier::new(2);
    let one = || {
        let mut answers = Answers::of(set);
        barrier.wait();
        cast(method, set, &mut answers)
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(one);
        let own = one();
        together([own, other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))])
    })
}

fn in_processes(partners: &mut [Partner; 2], set: &str) -> Result<f64, String> {
    partners.iter_mut().try_for_each(|partner| partner.cast(set))?;
    let [a, b] = partners;
    Ok(together([a.seconds()?, b.seconds()?]))
}

/// A child that casts the sets that it is told to; ended when its input is.
struct Partner {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
}

impl Partner {
    fn start(arguments: &[String]) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let mut command = Command::new(program);
        command.arg("--trace").args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|e| format!("a child cannot be started: {e}"))?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let output = BufReader::new(output.ok_or("a child has no output")?);
        let mut partner = Self { child, input, output };
        partner.seconds()?; // it is ready
        Ok(partner)
    }

    fn cast(&mut self, set: &str) -> Result<(), String> {
        let input = self.input.as_mut().ok_or("a child has no input")?;
        writeln!(input, "{set}").and_then(|()| input.flush()).map_err(|e| format!("a child does not listen: {e}"))
    }

    fn seconds(&mut self) -> Result<f64, String> {
        let mut line = String::new();
        self.output.read_line(&mut line).map_err(|e| format!("a child does not answer: {e}"))?;
        line.trim().parse().map_err(|_| format!("a child answered {line:?}"))
    }
}

impl Drop for Partner {
    fn drop(&mut self) {
        self.input = None;
        let _ = self.child.wait();
    }
}

/// The child's side: a number when it is ready, and for every name of a set the seconds of a pass.
pub(crate) fn trace_on_demand(options: &Options) -> Result<bool, String> {
    let scene = options.scene(options.scenes[0]);
    let built = Builder::all()[0].build(&scene.geometry, options.tests[0])?;
    let sets = rays::sets(&scene, built.as_a_renderer_does(), options.rays);
    let tell = |seconds: f64| {
        println!("{seconds}");
        std::io::stdout().flush().map_err(|e| e.to_string())
    };
    tell(0.0)?;
    for line in std::io::stdin().lock().lines() {
        let name = line.map_err(|e| e.to_string())?;
        let set = sets.iter().find(|set| set.name == name).ok_or_else(|| format!("no set {name}"))?;
        let method = built.methods(set.kind).swap_remove(0);
        let mut answers = Answers::of(set);
        tell(cast(&method, set, &mut answers))?;
    }
    Ok(true)
}
