//! The census: the same rays through every ray-casting backend, hit by hit.
//!
//! `brute` tests every triangle and is the oracle. Every other backend of this build must return the same bits: distance,
//! barycentrics, triangle, mesh, instance, and the same blocked rays, with and without an opacity filter. The rays are those
//! that break tracers: aimed at edges and vertices, parallel to the axes, grazing, starting on a surface, ending at one.
//! No ray may leave a closed mesh.
//!
//! A census that sees nothing proves nothing: backends that are wrong on purpose ([`faults`]) must be noticed.

mod compare;
mod faults;
mod meshes;
mod rays;

use super::wanted;
use crate::random::seed_for;
use anyhow::Result;
use compare::{compare, leaks};
use faults::FAULTS;
use gonio_accel::{Accel, Intersect};
use gonio_lab::{Check, Effort, Options, Outcome};
use gonio_tracer::Backend;
use meshes::{Specimen, specimens};
use rays::Family;
use std::time::Instant;

/// Name and meaning of the instruments in this file.
pub(super) const INSTRUMENTS: [(&str, &str); 2] = [
    (
        "census",
        "every ray-casting backend finds the hit that brute force finds, bit for bit, and the same blocked rays",
    ),
    ("leaks", "no ray leaves a closed mesh, wherever it is aimed"),
];

/// Runs the census of all backends and hands each check to `sink`.
pub(super) fn run(options: &Options, sink: &mut dyn FnMut(Check)) -> Result<()> {
    let count = match options.effort {
        Effort::Quick => 1 << 13,
        Effort::Standard => 1 << 15,
        Effort::Full => 1 << 20,
    };
    let mut send = |instrument: &str, subject: String, measure: &mut dyn FnMut(u64) -> Finding| {
        if !wanted(options, instrument, &subject) {
            return;
        }
        let start = Instant::now();
        let finding = measure(seed_for(options.seed, &format!("{instrument} {subject}")));
        let (count, limit) = (finding.count as f64, finding.limit as f64);
        let passed = if finding.at_least { count >= limit } else { count <= limit };
        sink(Check {
            instrument: instrument.to_owned(),
            subject,
            outcome: if passed { Outcome::Passed } else { Outcome::Failed },
            measured: count,
            limit,
            meaning: finding.meaning.to_owned(),
            detail: finding.detail,
            seconds: start.elapsed().as_secs_f64(),
        });
    };
    for specimen in specimens() {
        let oracle = Backend::Brute.build(&specimen.geometry, Intersect::Robust)?;
        for backend in Backend::ALL.into_iter().filter(|backend| *backend != Backend::Brute && backend.is_exact()) {
            let accel = backend.build(&specimen.geometry, Intersect::Robust)?;
            for family in Family::ALL {
                let subject = format!("{backend} on {}: {family} rays", specimen.name);
                send("census", subject, &mut |seed| agreement(&specimen, &*oracle, &*accel, family, count, seed));
            }
        }
        if specimen.closed {
            for backend in Backend::ALL.into_iter().filter(|backend| backend.is_exact()) {
                let accel = backend.build(&specimen.geometry, Intersect::Robust)?;
                send("leaks", format!("{backend} inside the {}", specimen.name), &mut |seed| {
                    let (count, detail) = leaks(&*accel, &specimen, count, seed);
                    Finding { count, limit: 0, at_least: false, meaning: "rays that leave ≤", detail }
                });
            }
            for (name, fault) in FAULTS {
                let wrong = fault(Backend::Obvhs.build(&specimen.geometry, Intersect::Robust)?);
                send("planted-faults", format!("census: {name} on {}", specimen.name), &mut |seed| {
                    let mut finding = agreement(&specimen, &*oracle, &*wrong, Family::Random, 1 << 13, seed);
                    (finding.limit, finding.at_least, finding.meaning) = (1, true, "disagreements noticed ≥");
                    finding
                });
            }
            let wrong = faults::drops_hits(Backend::Obvhs.build(&specimen.geometry, Intersect::Robust)?);
            send("planted-faults", format!("leaks: drops hits on {}", specimen.name), &mut |seed| {
                let (count, detail) = leaks(&*wrong, &specimen, 1 << 13, seed);
                Finding { count, limit: 1, at_least: true, meaning: "leaks noticed ≥", detail }
            });
        }
    }
    not_run(options, sink);
    Ok(())
}

/// Backends that this build does not have, by name: silence would read as success.
fn not_run(options: &Options, sink: &mut dyn FnMut(Check)) {
    let present = Backend::ALL.iter().any(|backend| backend.to_string() == "embree");
    let reason = if present {
        "its hits agree up to rounding, and this census compares bits; tests/backends.rs has its own"
    } else {
        "this build has no Embree backend (feature `embree`), its census did not run"
    };
    if wanted(options, "census", "embree") {
        sink(Check {
            instrument: "census".to_owned(),
            subject: "embree".to_owned(),
            outcome: Outcome::NotRun(reason.to_owned()),
            measured: 0.0,
            limit: 0.0,
            meaning: String::new(),
            detail: String::new(),
            seconds: 0.0,
        });
    }
}

/// A count and what it may be.
struct Finding {
    count: u64,
    limit: u64,
    /// The limit is the least that is allowed, not the most.
    at_least: bool,
    meaning: &'static str,
    detail: String,
}

fn agreement(
    specimen: &Specimen,
    oracle: &dyn Accel,
    accel: &dyn Accel,
    family: Family,
    count: u64,
    seed: u64,
) -> Finding {
    let found = compare(oracle, accel, family.kind(), |packet| rays::packet(specimen, family, seed, packet), count / 8);
    let detail = match found.first {
        Some(first) => first,
        None => {
            format!("{} rays, {:.0} % of them hit", found.rays, 100.0 * found.hits as f64 / found.rays.max(1) as f64)
        }
    };
    Finding { count: found.disagreements, limit: 0, at_least: false, meaning: "rays that disagree ≤", detail }
}
