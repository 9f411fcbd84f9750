//! Progress on standard error: a bar for people, lines for logs, JSON for front-ends, or silence.

use gonio_tracer::Progress;
use gonio_tracer::scene::{Loading, Stage};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// What comes before the render is only mentioned if it takes longer than this.
const PATIENCE: Duration = Duration::from_millis(500);
const RENDER: &str = "render";

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Mode {
    /// A bar on a terminal, silence elsewhere
    Auto,
    /// A line per percent: `render 25% 16/64 spp 1.02 Msamples/s ETA 42 s`
    Plain,
    /// A JSON object per line, as often
    Json,
    /// Silence
    None,
}

/// A stage of the work that is being shown.
pub(super) struct Report {
    mode: Mode,
    stage: &'static str,
    start: Instant,
    bar: Option<ProgressBar>,
    /// The last percent that was printed.
    percent: Option<u64>,
}

/// How far a stage has come, and how fast it goes.
struct Step {
    done: u64,
    of: u64,
    unit: &'static str,
    rate: Option<f64>,
    /// [s]
    left: f64,
}

impl Report {
    /// Shows nothing yet.
    pub(super) fn new(mode: Mode) -> Self {
        let silent = mode == Mode::Auto && !std::io::stderr().is_terminal();
        let mode = if silent { Mode::None } else { mode };
        Self { mode, stage: "", start: Instant::now(), bar: None, percent: None }
    }

    /// Shows how far loading has come, if that takes long.
    pub(super) fn loading(&mut self, loading: &Loading) {
        let (stage, unit) = match loading.stage {
            Stage::Reading => ("read", "bytes"),
            Stage::Placing => ("place", "triangles"),
            Stage::Building => ("build", "triangles"),
        };
        let Loading { done, of, .. } = *loading;
        self.begin(stage);
        let elapsed = self.start.elapsed();
        if elapsed > PATIENCE {
            let left = elapsed.as_secs_f64() * of.saturating_sub(done) as f64 / done.max(1) as f64;
            self.show(&Step { done, of, unit, rate: None, left });
        }
    }

    /// Shows a finished pass of the render.
    pub(super) fn pass(&mut self, progress: &Progress) {
        self.begin(RENDER);
        let left = f64::from(progress.spp.saturating_sub(progress.spp_done));
        let step = Step {
            done: u64::from(progress.spp_done),
            of: u64::from(progress.spp),
            unit: "spp",
            rate: Some(progress.samples as f64 / progress.seconds.max(1e-9) / 1e6),
            left: progress.seconds * left / f64::from(progress.spp_done.max(1)),
        };
        self.show(&step);
    }

    fn begin(&mut self, stage: &'static str) {
        if self.stage != stage {
            self.finish();
            (self.stage, self.start, self.percent) = (stage, Instant::now(), None);
        }
    }

    fn show(&mut self, step: &Step) {
        let stage = self.stage;
        let percent = step.done.saturating_mul(100).checked_div(step.of).unwrap_or(100);
        let news = self.percent != Some(percent);
        self.percent = Some(percent);
        let Step { done, of, unit, .. } = *step;
        let rate = step.rate.map_or_else(String::new, |rate| format!(" {rate:.2} Msamples/s"));
        // Nobody is left to tell if standard error is gone.
        match self.mode {
            Mode::Plain if news => {
                let _ = writeln!(
                    std::io::stderr(),
                    "{stage} {percent}% {done}/{of} {unit}{rate} ETA {}",
                    duration(step.left)
                );
            }
            Mode::Json if news => {
                let line = json!({
                    "stage": stage,
                    "percent": percent,
                    "done": done,
                    "of": of,
                    "unit": unit,
                    "msamples_per_second": step.rate,
                    "eta_seconds": step.left,
                });
                let _ = writeln!(std::io::stderr(), "{line}");
            }
            Mode::Auto => {
                let bar = self.bar.get_or_insert_with(|| bar(stage, of, unit));
                bar.set_message(format!("{rate}  ETA {}", duration(step.left)));
                bar.set_length(of);
                bar.set_position(done);
            }
            Mode::Plain | Mode::Json | Mode::None => {}
        }
    }

    /// Leaves the bar of a render as it is, so that what comes next begins a line of its own; others vanish.
    pub(super) fn finish(&mut self) {
        let Some(bar) = self.bar.take() else { return };
        if self.stage == RENDER {
            bar.abandon();
            let _ = writeln!(std::io::stderr());
        } else {
            bar.finish_and_clear();
        }
    }
}

fn bar(stage: &str, of: u64, unit: &str) -> ProgressBar {
    let bar = ProgressBar::new(of);
    if let Ok(style) = ProgressStyle::with_template(&format!("{stage:8}[{{bar:32}}] {{pos}}/{{len}} {unit} {{msg}}")) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// `42 s`, `3:05 min` or `2:03 h`.
fn duration(seconds: f64) -> String {
    let whole = seconds.ceil() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{}:{:02} min", whole / 60, whole % 60),
        _ => format!("{}:{:02} h", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn durations_read_well() {
        assert_eq!(duration(41.2), "42 s");
        assert_eq!(duration(185.0), "3:05 min");
        assert_eq!(duration(7380.0), "2:03 h");
    }
}
