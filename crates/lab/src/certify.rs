//! `certify`: the instruments pointed at one model, and everything that they find about it in one place.
//!
//! [`certify`] takes a lobe of the user's own, for which an `f32` implementation is enough; [`certify_surface`] a surface of
//! the kernel's lobes, whose other arithmetics and numbers it knows. Both measure: reciprocity and energy, each as the
//! model claims them ([`Properties`]); ∫pdf with failures; χ²; the largest weight; totality; the white furnace over roughness and
//! angle; times. What a model cannot be asked says so.

use crate::anatomy;
use crate::check::{Check, Outcome};
use crate::finding::Finding;
use crate::lanes;
use crate::run::{Options, Task, execute, tasks_of_subject};
use crate::speed::{self, Speed};
use crate::subject::Subject;
use crate::sweep::{self, SafeRange};
use crate::totality;
use crate::white::{self, FurnaceMap};
use gonio_kernel::{Lobe, Properties, Surface};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Mutex;

/// What the instruments found about one model.
#[derive(Clone, Debug, Serialize)]
pub struct Certificate {
    /// The model's name.
    pub name: String,
    /// It says that light takes the same way back.
    pub reciprocal: bool,
    /// It says that no albedo exceeds 1 + `excess`.
    pub conserving: bool,
    /// How far above 1 its albedo may lie by its own admission.
    pub excess: f32,
    /// One row per measurement. What could not run says why.
    pub checks: Vec<Check>,
    /// Where each number is safe; empty for a lobe of the user's own.
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

    /// What the model claims of itself, in words.
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
    let ends = |range: Option<[f64; 2]>| {
        range.map_or_else(|| "nowhere".to_owned(), |[lo, hi]| format!("{lo:.1e} to {hi:.1e}"))
    };
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

/// Measures a model of the user's own: everything that `f32` alone can answer. What needs more says that it did not run.
pub fn certify<L: Lobe<f32> + Sync>(name: &str, lobe: &L, options: &Options) -> Certificate {
    let subject = Subject::of_lobe(name, lobe);
    let mut tasks = general_tasks(&subject);
    for (instrument, needs) in MISSING {
        tasks.push(Task::new(instrument, name, 0, move |_| Finding::not_run(needs)));
    }
    let checks = run(tasks, options);
    let probe = subject.views().next().map(|view| white::of_probe(view.probe));
    let furnace = probe.unwrap_or_else(FurnaceMap::empty);
    certificate(name, lobe.properties(), checks, Vec::new(), furnace, speed::of_lobe(lobe))
}

/// Measures a surface of the kernel's lobes in `f32`, `f64` and eight lanes, and how far its numbers may move.
pub fn certify_surface(name: &str, surface: &Surface<f32>, options: &Options) -> Certificate {
    let subject = Subject::of_surface(name, surface);
    let claims = subject.claims;
    let (furnace, ranges) = (white::of_surface(surface), Mutex::new(BTreeMap::new()));
    let mut tasks = general_tasks(&subject);
    if subject.single.is_none() {
        let reason = "narrower than the lattice of f32 directions: a mirror there, and sound over the ranges below";
        tasks.push(Task::new("f32", name, 0, move |_| Finding::not_run(reason)));
    }
    tasks.push(Task::new("lanes", name, 0, |run| lanes::measure_surface(surface, run)));
    if !claims.empty {
        let furnace = &furnace;
        tasks.push(Task::new("white-furnace", name, 0, move |run| white::measure(surface, furnace, claims, run)));
    }
    let dials = anatomy::dials(surface);
    for (index, (dial, _)) in dials.iter().enumerate() {
        for single in [true, false] {
            let precision = if single { "f32" } else { "f64" };
            let place = if dial.lobe == 0 { String::new() } else { format!("lobe {} ", dial.lobe + 1) };
            let ranges = &ranges;
            tasks.push(Task::new("parameters", format!("{name} {place}{} {precision}", dial.name), 0, move |run| {
                let (finding, range) = sweep::measure(surface, index, single, run);
                ranges.lock().unwrap_or_else(|e| e.into_inner()).insert((index, !single), range);
                finding
            }));
        }
    }
    let checks = run(tasks, options);
    let ranges = ranges.into_inner().unwrap_or_else(|e| e.into_inner()).into_values().collect();
    let speeds = speed::of_surface(surface, &anatomy::converted(surface), &anatomy::converted(surface));
    certificate(name, claims.properties, checks, ranges, furnace, speeds)
}

fn certificate(
    name: &str,
    properties: Properties,
    checks: Vec<Check>,
    ranges: Vec<SafeRange>,
    furnace: FurnaceMap,
    speeds: Vec<Speed>,
) -> Certificate {
    let Properties { reciprocal, conserving, excess, .. } = properties;
    Certificate { name: name.to_owned(), reciprocal, conserving, excess, checks, ranges, furnace, speeds }
}

/// What is asked of any model.
fn general_tasks<'a>(subject: &'a Subject) -> Vec<Task<'a>> {
    let mut tasks = tasks_of_subject(subject);
    for view in subject.views() {
        let name = format!("{} {}", subject.name, view.precision());
        tasks.push(Task::new("totality", name, 0, move |run| totality::measure_probe(view, run)));
    }
    tasks
}

fn run(tasks: Vec<Task>, options: &Options) -> Vec<Check> {
    let mut checks = Vec::new();
    execute(tasks, options, &mut |check| checks.push(check));
    checks
}

/// What an `f32` implementation alone cannot answer.
const MISSING: [(&str, &str); 4] = [
    ("precision", "needs an f64 form of the lobe"),
    ("jacobian", "needs an f64 form of the lobe"),
    ("lanes", "not offered: the lobe has no eight-lane form"),
    ("parameters", "a lobe of one's own has no parameters that could be varied: it is certified as it is"),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::Effort;
    use gonio_kernel::energy::Compensation;
    use gonio_kernel::fresnel::Fresnel;
    use gonio_kernel::lobe::{
        Conductor, Dielectric, Eon, Lambert, Phong, PhongNorm, RoughDielectric, eon::Directional,
    };
    use gonio_kernel::microfacet::{Beckmann, Ggx};
    use gonio_kernel::{Event, Rgb, Sample, Value, Vec3};

    fn quick(surface: &Surface<f32>) -> Certificate {
        certify_surface("it", surface, &Options::new(Effort::Quick))
    }

    #[test]
    fn surfaces_of_every_kind_get_their_certificate() {
        let ggx = Ggx { alpha_x: 0.2_f32, alpha_y: 0.1 };
        let beckmann = Beckmann { alpha_x: 0.3_f32, alpha_y: 0.3 };
        let f0 = Rgb::new(0.9_f32, 0.6, 0.3);
        let gold = Fresnel::Conductor { eta: Rgb::new(0.143, 0.375, 1.442), k: Rgb::new(3.983, 2.386, 1.603) };
        let matte = Lambert::new(Rgb::new(0.8, 0.5, 0.2));
        let phong = Phong { diffuse: f0 * 0.5, glossy: f0 * 0.5, exponent: 50.0, norm: PhongNorm::Lafortune };
        let surfaces = [
            Surface::of(matte),
            Surface::of(Conductor::new(ggx, gold)),
            Surface::of(Conductor::new(beckmann, Fresnel::Schlick { f0 })),
            Surface::of(Conductor::new(ggx, Fresnel::Schlick { f0 }).with_compensation(Compensation::Turquin)),
            Surface::of(Conductor::new(ggx, Fresnel::Schlick { f0 }).with_compensation(Compensation::KullaConty)),
            Surface::of(Dielectric::new(1.5)),
            Surface::of(RoughDielectric::new(ggx, 1.5)),
            Surface::of(phong),
            Surface::of(Eon { directional: Directional::Fitted, ..Eon::new(f0, 0.7) }),
            Surface::black().with(0.5, Conductor::new(ggx, gold)).with(0.5, matte),
        ];
        for surface in surfaces {
            let certificate = quick(&surface);
            assert!(certificate.holds(), "{surface:?}\n{certificate}");
            for range in &certificate.ranges {
                let [from, to] = range.domain;
                assert!(range.safe.is_some_and(|[lo, hi]| lo <= from && to <= hi), "{range:?}");
            }
        }
    }

    /// A diffuse lobe that breaks a law, and says so or not.
    struct Lawless {
        lopsided: bool,
        gain: f32,
        claims: Properties,
    }

    impl Lobe<f32> for Lawless {
        fn eval(&self, wo: Vec3<f32>, wi: Vec3<f32>) -> Value<f32> {
            let matte = Lambert::new(Rgb::splat(self.gain));
            let value = Lobe::eval(&matte, wo, wi);
            let factor = if self.lopsided { 1.0 - 0.5 * wo.z } else { 1.0 };
            Value { f_cos: value.f_cos * factor, ..value }
        }
        fn sample(&self, wo: Vec3<f32>, u: [f32; 3]) -> Sample<f32> {
            let sample = Lobe::sample(&Lambert::new(Rgb::splat(1.0)), wo, u);
            Sample { event: Event::reflected(sample.event.failed), ..sample }
        }
        fn albedo_estimate(&self, _wo: Vec3<f32>) -> Rgb<f32> {
            Rgb::splat(self.gain)
        }
        fn domain(&self) -> bool {
            true
        }
        fn properties(&self) -> Properties {
            self.claims
        }
    }

    #[test]
    fn a_law_is_broken_exactly_where_a_model_says_so() {
        let lawful = Properties::LAWFUL;
        for (lopsided, gain) in [(false, 0.9_f32), (true, 0.9), (false, 1.1)] {
            for reciprocal in [true, false] {
                for conserving in [true, false] {
                    let lobe = Lawless { lopsided, gain, claims: Properties { reciprocal, conserving, ..lawful } };
                    let certificate = certify("it", &lobe, &Options::new(Effort::Quick));
                    let failed: Vec<&str> =
                        certificate.checks.iter().filter(|c| c.failed()).map(|c| &*c.instrument).collect();
                    assert_eq!(failed.contains(&"reciprocity"), reciprocal == lopsided, "{certificate}");
                    assert_eq!(failed.contains(&"energy"), conserving == (gain > 1.0), "{certificate}");
                }
            }
        }
        // A bound of its own forgives exactly that much.
        for (excess, holds) in [(0.11, true), (0.09, false)] {
            let lobe = Lawless { lopsided: false, gain: 1.1, claims: Properties { excess, ..lawful } };
            assert_eq!(certify("it", &lobe, &Options::new(Effort::Quick)).holds(), holds);
        }
    }

    #[test]
    fn a_range_ends_where_the_formulas_do() {
        let metal = Conductor::new(Ggx { alpha_x: 0.2_f32, alpha_y: 0.2 }, Fresnel::Schlick { f0: Rgb::splat(0.5) });
        let certificate = quick(&Surface::of(metal));
        let width = certificate.ranges.iter().find(|r| r.number == "alpha_x" && r.precision == "f32").unwrap();
        assert!(width.safe.unwrap()[0] > 0.0 && width.below.is_some(), "{width:?}");
        let f0 = certificate.ranges.iter().find(|r| r.number == "f0.r" && r.precision == "f32").unwrap();
        assert!(f0.safe.unwrap()[0] > -1.0, "a negative reflectance is negative light: {f0:?}");
    }
}
