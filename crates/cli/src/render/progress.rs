//! The progress bar: samples per pixel, rate and remaining time, on a terminal; silence elsewhere.

use gonio_tracer::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// A progress bar on standard error, or nothing.
pub(super) struct Bar(Option<ProgressBar>);

impl Bar {
    /// A bar for so many samples per pixel.
    pub(super) fn new(spp: u32) -> Self {
        let terminal = std::io::stderr().is_terminal();
        Self(terminal.then(|| {
            let bar = ProgressBar::new(u64::from(spp));
            if let Ok(style) = ProgressStyle::with_template("[{bar:32}] {pos}/{len} spp  {msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        }))
    }

    /// Shows a finished pass.
    pub(super) fn update(&mut self, progress: &Progress) {
        let Some(bar) = &self.0 else { return };
        let rate = progress.samples as f64 / progress.seconds.max(1e-9) / 1e6;
        let left = f64::from(progress.spp.saturating_sub(progress.spp_done));
        let eta = progress.seconds * left / f64::from(progress.spp_done.max(1));
        bar.set_message(format!("{rate:.2} Msamples/s  ETA {}", duration(eta)));
        bar.set_position(u64::from(progress.spp_done));
    }

    /// Leaves the line as it is.
    pub(super) fn finish(self) {
        if let Some(bar) = self.0 {
            bar.abandon();
            eprintln!(); // what comes next begins a line of its own
        }
    }
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
