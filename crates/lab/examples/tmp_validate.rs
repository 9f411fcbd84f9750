//! tmp
use gonio_lab::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let effort = match a.get(1).map(String::as_str) {
        Some("full") => Effort::Full,
        Some("standard") => Effort::Standard,
        _ => Effort::Quick,
    };
    let seed = a.get(2).and_then(|s| s.parse().ok()).unwrap_or(1);
    let only = a.get(3).filter(|s| !s.is_empty()).cloned();
    let verbose = a.get(4).is_some();
    let t = std::time::Instant::now();
    let mut by: std::collections::BTreeMap<String, (f64, usize, usize)> = Default::default();
    let mut failed = 0;
    validate_kernel(&Options { effort, seed, only }, &mut |c| {
        let e = by.entry(c.instrument.clone()).or_default();
        e.0 += c.seconds;
        e.1 += 1;
        if c.failed() || verbose || !matches!(c.outcome, Outcome::Passed) {
            if c.failed() {
                e.2 += 1;
                failed += 1;
            }
            println!(
                "{:?} {} | {} | {:.3e} {} {:.3e} | {} | {:.2}s",
                c.outcome,
                c.instrument,
                c.subject,
                c.measured,
                c.meaning,
                c.limit,
                &c.detail[..c.detail.len().min(600)],
                c.seconds
            );
        }
    });
    for (k, v) in by {
        println!("{k:16} {:.2}s {} checks {} failed", v.0, v.1, v.2);
    }
    println!("{failed} failed, wall {:.1}s", t.elapsed().as_secs_f64());
    std::process::exit(if failed > 0 { 3 } else { 0 });
}
