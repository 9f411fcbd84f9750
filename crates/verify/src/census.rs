//! The ray census: the same rays through every ray-casting backend, and every disagreement by name.
//!
//! Brute force tests every triangle and is the oracle. A [`Specimen`] is cast at by [`Family`] after family of rays, those that
//! renderers cast and those that break tracers, at several scales. Every backend is asked for the nearest hit, for
//! occlusion, and for occlusion through an opacity filter. Where brute cannot look at all rays (its cost is rays times
//! triangles) it looks at an even part of them, the others are compared among themselves, and brute is asked about each ray
//! that they do not agree on; without end where the answer counts against a backend, as long as its patience lasts elsewhere.
//!
//! What counts as agreement is the backend's [`Standard`]; what may be left over is in the [`Finding`]s. A census that sees
//! nothing proves nothing: backends that are wrong on purpose ([`FAULTS`]) must be noticed.
//!
//! `gonio accel census` runs it over a scene, `gonio validate` over generated specimens and a shipped scene.
//!
//! # Your own backend
//!
//! Whoever owns an [`Accel`] can have it checked. [`of_accel`] takes one that is built, at the scale at which it is built; [`of`]
//! takes [`Contender`]s, which say how a backend is built, and casts at every scale:
//!
//! ```
//! use gonio_accel::{Accel, Brute, Geometry, Hit8, Mesh, Opacity, Ray8, RayKind};
//! use gonio_kernel::{F32x8, Mask8};
//! use gonio_verify::census::{Contender, Settings, Specimen, Standard, of, of_accel};
//!
//! /// Right but for its distances: they are too long.
//! struct Mine(Brute);
//!
//! impl Accel for Mine {
//!     fn name(&self) -> &'static str {
//!         "mine"
//!     }
//!     fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
//!         self.0.closest(kind, rays, hits);
//!         hits.iter_mut().for_each(|hit| hit.t = hit.t * F32x8::splat(1.001));
//!     }
//!     fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
//!         self.0.occluded(kind, rays, filter, blocked);
//!     }
//! }
//!
//! let (a, b, c, d) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let tetrahedron = Geometry::of_mesh(Mesh { positions: vec![a, b, c, d], triangles: faces })?;
//!
//! let settings = Settings { rays: 256, ..Settings::default() };
//! let census = of_accel(&tetrahedron, &Mine(Brute::new(&tetrahedron)), Standard::Close, &settings)?;
//! assert!(!census.passed());
//! println!("{}", census.log.disagreements[0]); // the ray to the last bit, and what each backend says of it
//!
//! let right = Contender::new("right", Standard::Exact, |geometry| Ok(Box::new(Brute::new(geometry))));
//! let settings = Settings { scales: vec![1.0, 1e-4], ..settings };
//! let census = of(&Specimen::of_geometry("tetrahedron", tetrahedron), &[right], &settings, &mut |_, _| ())?;
//! assert!(census.passed() && census.log.rows.iter().any(|row| row.must_hit > 0 && row.leaks == 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod aim;
mod answer;
mod ball;
mod contender;
mod dice;
mod family;
mod faults;
mod inside;
mod judge;
mod meshes;
mod observe;
mod rays;
mod record;
mod specimen;
mod standard;
mod table;
mod topology;
mod wide;

pub use answer::Kind;
pub use contender::Contender;
pub use family::Family;
pub use faults::{FAULTS, Fault};
pub use judge::{Finding, What};
pub use record::{Disagreement, HitRecord, Log, Number, RayRecord, Row, Told};
pub use specimen::Specimen;
pub use standard::Standard;
pub use table::table;

pub(crate) use contender::Witness;
pub(crate) use faults::SCALES as FAULT_SCALES;
pub(crate) use judge::{allowed, forbids_leaks, is_judged, judge};
pub(crate) use meshes::specimens;
pub(crate) use rays::{Caster, bounces, shadows};

use crate::error::Error;
use contender::Borrowed;
use gonio_accel::{Accel, Geometry, Intersect};
use gonio_tracer::Backend;
use observe::{Observer, QUESTIONS, STREAM};
use serde::Serialize;

/// How a census is taken.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Rays of each family at each scale; the families that start inside of closed surfaces get four times as many.
    pub rays: u64,
    /// Factors on all lengths.
    pub scales: Vec<f64>,
    /// Where all random choices come from.
    pub seed: u64,
    /// How many pairs of ray and triangle brute may look at, eight rays at a time; disputes that could fail the census come on
    /// top.
    pub brute_pairs: f64,
}

impl Default for Settings {
    /// Ten thousand rays at the scale of the specimen, all of them seen by brute.
    fn default() -> Self {
        Self { rays: 10_000, scales: vec![1.0], seed: 1, brute_pairs: f64::INFINITY }
    }
}

/// What a census found.
#[derive(Clone, Debug, Serialize)]
pub struct Census {
    /// What was cast at.
    pub scene: String,
    /// How many triangles it has.
    pub triangles: u32,
    /// Those of them that belong to closed surfaces.
    pub closed_triangles: usize,
    /// Counts, and the most that they may be.
    pub findings: Vec<Finding>,
    /// The counts of every family, and every disagreement.
    #[serde(flatten)]
    pub log: Log,
}

impl Census {
    /// Whether every count keeps its limit.
    pub fn passed(&self) -> bool {
        self.findings.iter().all(Finding::passed)
    }
}

/// Casts at a specimen at every scale, with every contender. `progress` hears of every family before it begins.
///
/// # Errors
/// If a backend cannot be built, or a scale takes the specimen beyond what rays can reach.
pub fn of(
    specimen: &Specimen,
    contenders: &[Contender],
    settings: &Settings,
    progress: &mut dyn FnMut(f64, Family),
) -> Result<Census, Error> {
    taken(
        specimen,
        &|scaled| contenders.iter().map(|contender| contender.witness(scaled)).collect(),
        settings,
        progress,
    )
}

/// Casts at a geometry with a backend that was built over it, at the scale at which it is.
///
/// # Errors
/// If the geometry is beyond what rays can reach.
pub fn of_accel(
    geometry: &Geometry,
    accel: &dyn Accel,
    standard: Standard,
    settings: &Settings,
) -> Result<Census, Error> {
    let specimen = Specimen::of_geometry("geometry", geometry.clone());
    let witness = || Witness { name: accel.name().to_owned(), accel: Box::new(Borrowed(accel)), standard };
    taken(&specimen, &|_| Ok(vec![witness()]), &Settings { scales: vec![1.0], ..settings.clone() }, &mut |_, _| ())
}

fn taken(
    specimen: &Specimen,
    witnesses: &Witnesses<'_, '_>,
    settings: &Settings,
    progress: &mut dyn FnMut(f64, Family),
) -> Result<Census, Error> {
    let packets = |family: Family| settings.rays.saturating_mul(if family.is_inside() { 4 } else { 1 }).div_ceil(8);
    let plan = Plan {
        witnesses,
        scales: &settings.scales,
        packets: &packets,
        seed: settings.seed,
        brute_budget: (settings.brute_pairs / 8.0) as u64, // eight rays at a time
    };
    let mut log = Log::default();
    run(specimen, &plan, &mut log, progress)?;
    Ok(Census {
        scene: specimen.name.clone(),
        triangles: specimen.count(),
        closed_triangles: specimen.closed_count(),
        findings: judge(&log.rows),
        log,
    })
}

/// Builds those who are looked at, at one scale.
type Witnesses<'a, 'w> = dyn Fn(&Specimen) -> Result<Vec<Witness<'w>>, Error> + 'a;

/// What a census does.
pub(crate) struct Plan<'a, 'w> {
    /// Who is looked at besides brute.
    pub(crate) witnesses: &'a Witnesses<'a, 'w>,
    pub(crate) scales: &'a [f64],
    /// Packets of eight rays of each family, at each scale.
    pub(crate) packets: &'a dyn Fn(Family) -> u64,
    pub(crate) seed: u64,
    /// How many pairs of packet and triangle brute may look at in all, judged disputes not counted; and as many
    /// again for disputes that are only listed.
    pub(crate) brute_budget: u64,
}

/// Casts at a specimen at every scale. `progress` hears of every family before it begins.
///
/// # Errors
/// If a backend cannot be built, or a scale takes the specimen beyond what rays can reach.
pub(crate) fn run(
    specimen: &Specimen,
    plan: &Plan<'_, '_>,
    log: &mut Log,
    progress: &mut dyn FnMut(f64, Family),
) -> Result<(), Error> {
    for &scale in plan.scales {
        let scaled = specimen.scaled(scale)?;
        let oracle = Backend::Brute.build(&scaled.geometry, Intersect::Robust)?;
        let mut witnesses = (plan.witnesses)(&scaled)?;
        // The first is the reference: one that is right to the last bit, if there is one.
        witnesses.sort_by_key(|witness| witness.standard != Standard::Exact);
        let scout = witnesses.first().map_or(&*oracle, |witness| &*witness.accel);
        let wanted = |family: &Family| (plan.packets)(*family) > 0;
        let inside = Family::ALL.iter().any(|family| family.is_inside() && wanted(family));
        let balls = if inside { inside::balls(&scaled, scout, plan.seed) } else { Vec::new() };
        let caster = Caster { specimen: &scaled, scout, balls: &balls, seed: plan.seed };
        let families: Vec<Family> = Family::ALL.into_iter().filter(|f| wanted(f) && caster.has(*f)).collect();
        let share = plan.brute_budget / (families.len() * plan.scales.len()).max(1) as u64;
        for family in families {
            progress(scale, family);
            let mut packets = (plan.packets)(family);
            if family == Family::Far {
                // Boxes are padded in proportion to the distance, so that from far enough away a tree tests every triangle.
                packets = packets.min((plan.brute_budget / u64::from(scaled.count().max(1))).max(STREAM / 8));
            }
            let pairs = packets * QUESTIONS * u64::from(scaled.count());
            let stride = pairs.div_ceil(share.max(1)).max(1);
            let patience = (share / (QUESTIONS * u64::from(scaled.count())).max(1)).max(1);
            let observer = Observer { specimen: &scaled, oracle: &*oracle, witnesses: &witnesses, stride, patience };
            observer.observe(&caster, family, packets, log);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_accel::{Brute, Hit8, Opacity, Ray8, RayKind};
    use gonio_kernel::{F32x8, Mask, Mask8, U32x8};

    /// Hits wherever it is asked, and names a triangle that is not there.
    struct Liar;

    impl Accel for Liar {
        fn name(&self) -> &'static str {
            "liar"
        }
        fn closest(&self, _: RayKind, _: &[Ray8], hits: &mut [Hit8]) {
            for hit in hits {
                *hit = Hit8 { t: F32x8::splat(f32::NAN), prim: U32x8::splat(1 << 30), ..Hit8::miss() };
            }
        }
        fn occluded(&self, _: RayKind, _: &[Ray8], _: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
            blocked.fill(Mask8::splat(true));
        }
    }

    #[test]
    fn a_backend_that_names_what_is_not_there_fails_by_every_standard_and_right_ones_do_not() {
        let settings = Settings { rays: 64, ..Settings::default() };
        for specimen in specimens() {
            for standard in [Standard::Exact, Standard::Close] {
                let wrong = of_accel(&specimen.geometry, &Liar, standard, &settings).unwrap();
                assert!(!wrong.passed() && !wrong.log.disagreements.is_empty(), "{}", specimen.name);
            }
            let brute = Brute::new(&specimen.geometry);
            let right = of_accel(&specimen.geometry, &brute, Standard::Exact, &settings).unwrap();
            assert!(right.passed(), "{}: {}", specimen.name, right.log.disagreements[0]);
        }
    }
}
