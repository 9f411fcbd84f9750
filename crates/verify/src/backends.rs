//! The census of the ray-casting backends over generated specimens and a shipped scene; see [`crate::census`].
//!
//! Brute looks at every ray. One check for each backend, specimen and family, all scales together; one for each backend and
//! specimen that no ray passes a surface which must stop it. Then the planted faults, each of which the same judgement must
//! fail.

use crate::census::{
    self, Contender, FAULT_SCALES, FAULTS, Family, Fault, Log, Plan, Row, Specimen, Standard, allowed, forbids_leaks,
    is_judged, judge, specimens,
};
use crate::error::Error;
use crate::outcome::outcome;
use crate::shipped::{CORNELL_BOX, unpack};
use gonio_accel::{Geometry, Intersect};
use gonio_lab::random::seed_for;
use gonio_lab::{Check, Effort, Options, Outcome};
use gonio_tracer::{Backend, World};
use std::path::Path;
use std::time::Instant;

/// Name and meaning of the instruments in this file.
pub(crate) const INSTRUMENTS: [(&str, &str); 2] = [
    (
        "census",
        "every ray-casting backend finds the hit that brute force finds, and the same blocked rays, at every scale",
    ),
    ("leaks", "no ray leaves a closed surface or passes between triangles that cover it, wherever it is aimed"),
];

/// Factors on all lengths.
const ALL_SCALES: [f64; 3] = [1e-4, 1.0, 1e4];
/// Rays of each family at each scale that look for a planted fault.
const FAULT_RAYS: u64 = 1 << 11;

/// Runs the census of all backends and hands each check to `sink`.
pub(crate) fn run(options: &Options, out: &Path, sink: &mut dyn FnMut(Check)) -> Result<Log, Error> {
    let mut log = Log::default();
    let mut all = specimens();
    let scene = unpack(CORNELL_BOX, &out.join("scenes"))?;
    all.push(Specimen::of_world("cornell-box", &World::new(&scene)?));
    for specimen in &all {
        measure(specimen, options, &mut log, sink)?;
    }
    for specimen in all.iter().filter(|s| ["sphere", "cornell-box"].contains(&s.name.as_str())) {
        planted_faults(specimen, options, sink)?;
    }
    not_run(options, sink);
    Ok(log)
}

/// All backends but brute.
fn backends() -> impl Iterator<Item = Backend> {
    Backend::ALL.into_iter().filter(|backend| *backend != Backend::Brute)
}

fn census_subject(backend: &str, specimen: &Specimen, family: Family) -> String {
    format!("{backend} on {}: {family} rays", specimen.name)
}

fn leak_subject(backend: &str, specimen: &Specimen) -> String {
    format!("{backend} on {}", specimen.name)
}

fn measure(specimen: &Specimen, options: &Options, log: &mut Log, sink: &mut dyn FnMut(Check)) -> Result<(), Error> {
    let rays: u64 = match options.effort {
        Effort::Quick => 1 << 11,
        Effort::Standard => 1 << 13,
        Effort::Full => 1 << 18,
    };
    let names: Vec<String> = Backend::ALL.iter().map(Backend::to_string).collect();
    let packets = |family: Family| {
        let census = names.iter().any(|name| options.want("census", &census_subject(name, specimen, family)));
        let leaks = names.iter().any(|name| options.want("leaks", &leak_subject(name, specimen)));
        if census || (leaks && family.is_aimed_between_triangles()) { rays / 8 } else { 0 }
    };
    let start = Instant::now();
    let before = log.rows.len();
    let contenders: Vec<Contender> = backends().map(|b| Contender::of_backend(b, Intersect::Robust)).collect();
    let witnesses = |scaled: &Specimen| contenders.iter().map(|contender| contender.witness(scaled)).collect();
    let plan = Plan {
        witnesses: &witnesses,
        scales: &ALL_SCALES,
        packets: &packets,
        seed: seed_for(options.seed, &specimen.name),
        brute_budget: u64::MAX,
    };
    census::run(specimen, &plan, log, &mut |_, _| ())?;
    let rows = &log.rows[before..];
    let seconds = start.elapsed().as_secs_f64() / rows.len().max(1) as f64;
    let first = |backend: &str, kind: &dyn Fn(&Row) -> bool| {
        let noted = log.disagreements.iter().filter(|d| d.specimen == specimen.name && d.backend == backend);
        let row = |family, scale| rows.iter().any(|r| r.family == family && r.scale == scale && kind(r));
        noted.into_iter().find(|d| row(d.family, d.scale)).map(|d| d.to_string().replace("\n  ", "; "))
    };
    for name in &names {
        for family in Family::ALL {
            let of = |row: &&Row| row.backend == *name && row.family == family && is_judged(row);
            let subject = census_subject(name, specimen, family);
            let Some(total) = sum(rows.iter().filter(of)) else { continue };
            if options.want("census", &subject) {
                let hits = 100.0 * total.hits as f64 / total.rays.max(1) as f64;
                let detail = first(name, &|row| row.family == family)
                    .unwrap_or_else(|| format!("{} rays, {hits:.0} % of them hit", total.rays));
                let limit = allowed(total.standard, total.rays);
                sink(check("census", subject, total.exceptions(), limit, "rays that disagree ≤", detail, seconds));
            }
        }
        let subject = leak_subject(name, specimen);
        let of = |row: &&Row| row.backend == *name && forbids_leaks(row);
        if let Some(total) = sum(rows.iter().filter(of)).filter(|_| options.want("leaks", &subject)) {
            let detail = first(name, &|row| row.leaks > 0).unwrap_or_else(|| format!("{} rays", total.must_hit));
            sink(check("leaks", subject, total.leaks, 0, "rays that get through ≤", detail, seconds));
        }
    }
    Ok(())
}

/// The sum of rows of one backend.
fn sum<'a>(rows: impl Iterator<Item = &'a Row>) -> Option<Row> {
    rows.cloned().reduce(|a, b| a.plus(&b))
}

fn planted_faults(specimen: &Specimen, options: &Options, sink: &mut dyn FnMut(Check)) -> Result<(), Error> {
    for fault in &FAULTS {
        for standard in [Standard::Exact, Standard::Close] {
            // A sphere seen from outside shows a lax judge too little.
            let lax = fault.noticed_by == Standard::Close && specimen.name != "sphere";
            let word = if standard == Standard::Exact { "bit for bit" } else { "within tolerance" };
            let subject = format!("census: {} on {}, {word}", fault.name, specimen.name);
            if (lax || standard == Standard::Exact) && options.want("planted-faults", &subject) {
                let start = Instant::now();
                let (failed, detail) = planted(specimen, fault, standard, options)?;
                let seconds = start.elapsed().as_secs_f64();
                let mut check = check("planted-faults", subject, failed, 1, "limits broken ≥", detail, seconds);
                check.outcome = outcome(failed >= 1);
                sink(check);
            }
        }
    }
    Ok(())
}

/// How many findings fail because of a fault, and the first disagreement.
fn planted(
    specimen: &Specimen,
    fault: &'static Fault,
    standard: Standard,
    options: &Options,
) -> Result<(u64, String), Error> {
    let right = |geometry: &Geometry| Ok(Backend::Obvhs.build(geometry, Intersect::Robust)?);
    let contender = Contender::new("planted fault", standard, right).with_fault(fault);
    let witnesses = |scaled: &Specimen| Ok(vec![contender.witness(scaled)?]);
    let plan = Plan {
        witnesses: &witnesses,
        scales: &FAULT_SCALES,
        packets: &|_| FAULT_RAYS / 8,
        seed: seed_for(options.seed, &specimen.name),
        brute_budget: u64::MAX,
    };
    let mut log = Log::default();
    census::run(specimen, &plan, &mut log, &mut |_, _| ())?;
    let failed = judge(&log.rows).iter().filter(|finding| !finding.passed()).count() as u64;
    Ok((failed, log.disagreements.first().map_or_else(String::new, |d| d.to_string().replace("\n  ", "; "))))
}

fn check(
    instrument: &str,
    subject: String,
    count: u64,
    limit: u64,
    meaning: &str,
    detail: String,
    seconds: f64,
) -> Check {
    Check {
        instrument: instrument.to_owned(),
        subject,
        outcome: outcome(count <= limit),
        measured: count as f64,
        limit: limit as f64,
        meaning: meaning.to_owned(),
        detail,
        seconds,
    }
}

/// Backends that this build does not have, by name: silence would read as success.
fn not_run(options: &Options, sink: &mut dyn FnMut(Check)) {
    let absent = !Backend::ALL.iter().any(|backend| backend.to_string() == "embree");
    if absent && options.want("census", "embree") {
        let why = "this build has no Embree backend (feature `embree`): its census did not run";
        let mut row = check("census", "embree".to_owned(), 0, 0, "", String::new(), 0.0);
        row.outcome = Outcome::NotRun(why.to_owned());
        sink(row);
    }
}
