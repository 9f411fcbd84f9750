//! `Certificate`: what was found about one lobe, in data and in words.

use crate::speed::Speed;
use crate::sweep::SafeRange;
use crate::white::FurnaceMap;
use gonio_report::number::range;
use gonio_report::{Check, Outcome};
use serde::Serialize;
use std::fmt;

/// What the instruments found about one lobe.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// The lobe's name.
    pub name: String,
    /// It says that it is reciprocal (Helmholtz).
    pub reciprocal: bool,
    /// It says that no albedo exceeds 1 + `excess`.
    pub conserving: bool,
    /// How far above 1 its albedo may lie by its own admission.
    pub excess: f32,
    /// One row per measurement. What could not run says why.
    pub checks: Vec<Check>,
    /// Where each number is safe; empty for a lobe that exists in `f32` only.
    pub ranges: Vec<SafeRange>,
    /// How much light it returns.
    pub furnace: FurnaceMap,
    /// How long calls take, on this machine and in this build.
    pub speeds: Vec<Speed>,
}

impl Certificate {
    /// Whether nothing failed. What did not run is not a failure: read the checks.
    pub fn holds(&self) -> bool {
        !self.checks.iter().any(Check::failed)
    }

    /// What it claims of itself, in words.
    pub fn claims(&self) -> String {
        let reciprocal = if self.reciprocal { "reciprocal" } else { "not reciprocal, by design" };
        match (self.conserving, self.excess) {
            (true, 0.0) => format!("{reciprocal}; conserves energy"),
            (true, excess) => format!("{reciprocal}; conserves energy within {excess:e}"),
            (false, _) => format!("{reciprocal}; gains energy, by design"),
        }
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        writeln!(out, "{}: {}", self.name, if self.holds() { "holds" } else { "FAILED" })?;
        writeln!(out, "claims: {}\n", self.claims())?;
        for check in &self.checks {
            let Check { instrument, subject, measured, meaning, limit, detail, .. } = check;
            let about = subject.strip_prefix(&self.name).unwrap_or(subject).trim_start();
            match &check.outcome {
                Outcome::NotRun(reason) => writeln!(out, "  not run  {instrument}: {reason}")?,
                outcome => {
                    let word = if *outcome == Outcome::Passed { "passed" } else { "FAILED" };
                    writeln!(out, "  {word}   {instrument} {about}: {meaning} {limit:.3e}, measured {measured:.3e}")?;
                    if !detail.is_empty() {
                        writeln!(out, "           {detail}")?;
                    }
                }
            }
        }
        write_ranges(out, &self.ranges)?;
        write_furnace(out, &self.furnace)?;
        writeln!(out, "\nns per call, one thread (lanes: per lane)")?;
        for Speed { call, arithmetic, ns } in &self.speeds {
            writeln!(out, "  {call:6} {arithmetic:5} {ns:8.2}")?;
        }
        Ok(())
    }
}

fn write_ranges(out: &mut fmt::Formatter, ranges: &[SafeRange]) -> fmt::Result {
    if ranges.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\nsafe without a guard, by a sweep: finite and not negative; precise: and f32 as near to f64 as inputs allow"
    )?;
    let ends = |ends| range(ends, "nowhere");
    for r in ranges {
        let [from, to] = r.domain;
        write!(out, "  {:14} {}  safe {:18}", r.number, r.precision, ends(r.safe))?;
        if r.precision == "f32" {
            write!(out, "  precise {:18}", ends(r.precise))?;
        }
        writeln!(out, "  (domain {from:.1e} to {to:.1e}, here {:.3e})", r.value)?;
        for (side, why) in [("below", &r.below), ("above", &r.above)] {
            if let Some(why) = why {
                writeln!(out, "      {side}, at {why}")?;
            }
        }
    }
    Ok(())
}

fn write_furnace(out: &mut fmt::Formatter, map: &FurnaceMap) -> fmt::Result {
    let what = if map.white { "white furnace: albedo with every reflectance 1" } else { "furnace: albedo" };
    write!(out, "\n{what}, over cosθ\n  {:>10}", map.varied.unwrap_or_default())?;
    for cos in &map.cosines {
        write!(out, " {cos:6.3}")?;
    }
    for (index, line) in map.albedo.iter().enumerate() {
        let value = map.rows.get(index).map_or_else(String::new, |x| format!("{x:.3e}"));
        write!(out, "\n  {value:>10}")?;
        for albedo in line {
            write!(out, " {albedo:6.4}")?;
        }
    }
    writeln!(out)
}
