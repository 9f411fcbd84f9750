//! The benchmark on a terminal.

use super::{Measured, Report};
use std::fmt::Write;

/// The whole text.
pub(super) fn text(report: &Report) -> String {
    let e = &report.environment;
    let mut out = format!(
        "gonio {} accel bench: {}, {} triangles, {} rounds, {} thread{}\n{}; {}, {}\n\n",
        report.version,
        report.scene,
        report.triangles,
        report.rounds,
        report.threads,
        if report.threads == 1 { "" } else { "s" },
        e.processor,
        e.rustc.unwrap_or("compiler not known"),
        e.target_features.join(" "),
    );
    let _ = writeln!(out, "{:8}  {:7}  {:>9}  {:>10}", "backend", "test", "build s", "memory MiB");
    for build in &report.builds {
        let memory = build.resident_bytes.map_or("-".to_owned(), |b| format!("{:.1}", b as f64 / 1_048_576.0));
        let _ = writeln!(out, "{:8}  {:7}  {:9.3}  {memory:>10}", build.backend, build.intersect, build.seconds);
    }
    let _ = writeln!(
        out,
        "\n{:17}  {:8}  {:7}  {:10}  {:>9}  {:>5}  {:>8}  {:>15}  {:>6}",
        "rays", "backend", "test", "said to be", "cast", "hit %", "Mrays/s", "slowest–fastest", "ratio"
    );
    let mut last = None;
    for row in &report.results {
        if last.is_some_and(|set| set != row.set) {
            out.push('\n');
        }
        last = Some(row.set);
        let Measured { set, backend, intersect, rays, median, ratio, .. } = row;
        let kind = if row.coherent { "coherent" } else { "incoherent" };
        let hits = 100.0 * row.hits as f64 / (*rays).max(1) as f64;
        let spread = format!("{:.3}–{:.3}", row.min, row.max);
        let _ = writeln!(
            out,
            "{set:17}  {backend:8}  {intersect:7}  {kind:10}  {rays:9}  {hits:5.1}  {median:8.3}  {spread:>15}  {ratio:6.2}"
        );
    }
    for name in &report.not_run {
        let _ = writeln!(out, "\nnot run  {name}: this build does not have it (feature `{name}`)");
    }
    out
}
