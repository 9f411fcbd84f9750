//! A check that cannot fail does not count: every instrument is tested on planted faults, and certificates on good and bad lobes.
//! What the instruments say of the kernel is `cargo xtask validate`'s to tell.

use gonio_kernel::warp::{pdf_cosine_hemisphere, pdf_uniform_sphere, sample_cosine_hemisphere, sample_uniform_sphere};
use gonio_kernel::{Event, Lobe, Rgb, Sample, Transport, Value, Vec3};
use gonio_lab::{Certificate, Check, Effort, Options, Outcome, certify_single, instruments, validate_kernel};

fn checks(only: &str, seed: u64) -> Vec<Check> {
    let mut checks = Vec::new();
    let options = Options { seed, only: Some(only.to_owned()), ..Options::new(Effort::Quick) };
    validate_kernel(&options, &mut |check| checks.push(check));
    checks
}

fn failures(checks: &[Check]) -> Vec<String> {
    checks.iter().filter(|c| c.failed()).map(|c| format!("{} {}: {}", c.instrument, c.subject, c.detail)).collect()
}

#[test]
fn every_planted_fault_is_caught() {
    let checks = checks("planted-faults", 1);
    assert_eq!(failures(&checks), Vec::<String>::new());
    assert!(checks.iter().all(|check| check.outcome == Outcome::Passed));
    for (name, _) in instruments().iter().filter(|(name, _)| *name != "planted-faults") {
        let caught = checks.iter().any(|check| check.subject.ends_with(&format!("→ {name}")));
        assert!(caught, "no fault is planted for {name}");
    }
}

#[test]
fn a_run_repeats_exactly_whatever_the_threads_do() {
    let measured =
        |seed| checks("conductor 0.2x0.2", seed).iter().map(|c| (c.subject.clone(), c.measured)).collect::<Vec<_>>();
    assert_eq!(measured(5), measured(5));
    assert_ne!(measured(5), measured(6));
}

/// A diffuse lobe of one's own, in `f32` alone, with a knob for each way of getting it wrong.
#[derive(Clone, Copy)]
struct Mine {
    scale: f32,
    density: fn(Vec3<f32>) -> f32,
    draw: fn([f32; 2]) -> Vec3<f32>,
}

const GOOD: Mine = Mine { scale: 0.8, density: pdf_cosine_hemisphere, draw: sample_cosine_hemisphere };
/// Uniform samples are noisier, weights reach 2, and all is as it should be.
const UNIFORM: Mine = Mine {
    scale: 0.8,
    density: |_| 2.0 * pdf_uniform_sphere::<f32>(),
    draw: |u| {
        let w = sample_uniform_sphere(u);
        Vec3::new(w.x, w.y, w.z.abs().max(1e-9))
    },
};

impl Lobe<f32> for Mine {
    type Prepared = ();
    fn prepare(&self, _wo: Vec3<f32>, _transport: Transport) {}
    fn eval(&self, wo: Vec3<f32>, _: &(), wi: Vec3<f32>) -> Value<f32> {
        let pdf = (self.density)(wi);
        let f_cos = Rgb::splat(self.scale) * pdf_cosine_hemisphere(wi);
        Value { f_cos, pdf }.or_zero(wo.z > 0.0 && wi.z > 0.0)
    }
    fn sample(&self, wo: Vec3<f32>, _: &(), u: [f32; 3]) -> Sample<f32> {
        Sample { wi: (self.draw)([u[1], u[2]]), event: Event::reflected(wo.z <= 0.0) }
    }
    fn delta(&self, _: Vec3<f32>, _: &(), _: &Sample<f32>) -> Value<f32> {
        Value::zero()
    }
    fn albedo_estimate(&self, _wo: Vec3<f32>) -> Rgb<f32> {
        Rgb::splat(self.scale)
    }
    fn domain(&self) -> bool {
        true
    }
}

fn certificate(lobe: &Mine) -> Certificate {
    certify_single("mine", lobe, &Options::new(Effort::Quick))
}

fn failed_instruments(lobe: &Mine) -> Vec<String> {
    certificate(lobe).checks.iter().filter(|c| c.failed()).map(|c| c.instrument.clone()).collect()
}

#[test]
fn a_sound_lobe_in_f32_alone_gets_its_certificate() {
    for lobe in [GOOD, UNIFORM] {
        let certificate = certificate(&lobe);
        assert!(certificate.holds(), "{certificate}");
        // What f32 alone cannot answer is said, and not counted as passed.
        let not_run = certificate.checks.iter().filter(|c| matches!(c.outcome, Outcome::NotRun(_))).count();
        assert_eq!(not_run, 4, "{certificate}");
    }
}

#[test]
fn a_lobe_that_gains_energy_gets_none() {
    assert!(failed_instruments(&Mine { scale: 1.02, ..GOOD }).contains(&"energy".to_owned()));
}

#[test]
fn a_lobe_whose_density_is_another_gets_none() {
    let failed = failed_instruments(&Mine { draw: UNIFORM.draw, ..GOOD });
    assert!(failed.contains(&"chi2".to_owned()), "{failed:?}");
    let failed = failed_instruments(&Mine { density: |w| w.z.max(0.0), ..GOOD });
    assert!(failed.contains(&"normalisation".to_owned()), "{failed:?}");
}
