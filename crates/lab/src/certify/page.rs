//! The certificate as a page: verdict, plots, safe ranges, costs, every check.

use super::Certificate;
use crate::speed::Count;
use crate::task::Options;
use gonio_report::number::range;
use gonio_report::{Cell, Check, Environment, Html, Page, Plot, Table, Tone, checks_table};

impl Certificate {
    /// The whole page. `instructions` are those of its calls, or why they were not counted; `plots` are those of
    /// [`crate::plots::of`], and `options` those of the measurement.
    ///
    /// ```
    /// use gonio_kernel::{Rgb, lobe::Lambert};
    /// use gonio_lab::{Effort, Options, certify, plots};
    /// use gonio_report::Environment;
    ///
    /// let (chalk, options) = (Lambert::new(Rgb::splat(0.5_f32)), Options::new(Effort::Quick));
    /// let environment = Environment {
    ///     target: std::env::consts::ARCH,
    ///     target_features: Vec::new(),
    ///     rustc: None,
    ///     debug_assertions: cfg!(debug_assertions),
    ///     processor: "not known".to_owned(),
    ///     threads: 1,
    /// };
    /// let instructions = Err("not asked for".to_owned());
    /// let plots = plots::of("chalk", &chalk, &options);
    /// let page = certify("chalk", &chalk, &options).page(&options, &instructions, &plots, &environment);
    /// assert!(page.contains("The certificate holds"));
    /// ```
    pub fn page(
        &self,
        options: &Options,
        instructions: &Result<Vec<Count>, String>,
        plots: &[Plot],
        environment: &Environment,
    ) -> String {
        let (tone, word) = if self.holds() { (Tone::Good, "holds") } else { (Tone::Bad, "failed") };
        let failed: Vec<&Check> = self.checks.iter().filter(|check| check.failed()).collect();
        let mut page = Page::new(&format!("{}: certificate {word}", self.name));
        page.headline(&format!("Certificate of {}", self.name));
        let of = format!("{} of {} checks failed", failed.len(), self.checks.len());
        page.verdict(tone, &format!("The certificate {word}: {of}"));
        page.note(format!("{}. {:?} effort, seed {}.", self.claims(), options.effort, options.seed));
        if !failed.is_empty() {
            page.toned_heading(Tone::Bad, "What failed");
            page.table(&checks_table(failed));
        }
        page.heading("What the instruments see");
        page.plots(plots);
        page.heading("Where each number is safe without a guard");
        page.note(
            "By a sweep of the domain and far beyond: finite and not negative; precise where f32 is as near to f64 as rounded \
             inputs allow. Eight lanes give the bits of f32.",
        );
        page.table(&self.safe_ranges());
        page.heading("What a call costs");
        page.table(&self.costs(instructions));
        let uncounted = instructions.as_ref().err().map(|why| format!(" Instructions: not counted ({why})."));
        page.note(format!("One thread; lanes per lane.{}", uncounted.unwrap_or_default()));
        page.heading("Every check");
        page.table(&checks_table(&self.checks));
        page.environment(environment);
        page.finish()
    }

    fn safe_ranges(&self) -> Table {
        let mut table = Table::new(["Number", "Arithmetic", "Safe", "Precise too", "Domain", "Here"]);
        for r in &self.ranges {
            let mut number = Html::from(&*r.number);
            for (side, why) in [("below", &r.below), ("above", &r.above)] {
                number = number.detail(&why.as_ref().map_or_else(String::new, |why| format!("{side}, at {why}")));
            }
            table.row([
                Cell::new(number),
                Cell::new(r.precision),
                Cell::number("safe", range(r.safe, "nowhere")),
                Cell::number("precise", range(r.precise, if r.precision == "f32" { "nowhere" } else { "" })),
                Cell::number("domain", format!("{:.3e} to {:.3e}", r.domain[0], r.domain[1])),
                Cell::number("here", format!("{:.3e}", r.value)),
            ]);
        }
        table
    }

    fn costs(&self, instructions: &Result<Vec<Count>, String>) -> Table {
        let mut table = Table::new(["Call", "Arithmetic", "ns", "Instructions"]);
        for speed in &self.speeds {
            let mut counted = instructions.iter().flatten();
            let count = counted.find(|c| (c.call, c.arithmetic) == (speed.call, speed.arithmetic));
            table.row([
                Cell::new(speed.call),
                Cell::new(speed.arithmetic),
                Cell::number("ns", format!("{:.2}", speed.ns)),
                Cell::number("instructions", count.map_or_else(String::new, |c| format!("{:.1}", c.instructions))),
            ]);
        }
        table
    }
}
