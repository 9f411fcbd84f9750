//! Mitsuba's answers: BSDFs and Fresnel's equations at single points, computed by another renderer.
//!
//! `reference/bsdfs.json` was written by `bsdfs.py` beside it: Mitsuba 3.9.1, single precision, a few hundred
//! configurations of each model. Where the environment variable `GONIO_MITSUBA` names another file of that script, that one is
//! read, and must hold 10⁵ of each.
//!
//! Where the two differ on purpose, closed forms convert the kernel's answer into Mitsuba's:
//!
//! - Mitsuba masks and shadows with G₁(wo) G₁(wi): so does the kernel with [`Masking::Separable`].
//! - Mitsuba samples all visible normals, the kernel's conductor those above a bound: densities are as s + c to s + k c.
//! - Mitsuba's Beckmann masking is Walter's rational G₁ of 2007, the kernel's is exact: times the ratio of the two.
//! - Mitsuba finds the angle behind a rough interface by Snell's law, the kernel from the directions, and mirrors with
//!   wo·m and wi·m where the kernel takes |h|/2 for both. All that is the same for unit directions; those of `f32` are off by
//!   1e-7, which near the critical angle or at grazing is much: times the ratios of Fresnel's F and of the cosines.
//! - Mitsuba's D is 0 where D cosθ_m ≤ 1e-20.
//!
//! **Limit.** 10⁻⁴ of the value, and its largest change when one input (a component of a direction, or a parameter) moves by
//! one unit in the last place of the `f32` with which Mitsuba computed; the kernel computes in `f64` on the same numbers.
//! Two numbers between are inputs too, because Mitsuba rounds them before what follows subtracts: F, of which a unit is
//! 2⁻²⁴, where 1 − F is transmitted; and the cosine at the microfacet from which F is computed, by 4·2⁻²⁴: half a unit each for
//! the half vector, its length, its division by that, and their dot product.

use crate::finding::{Finding, Run};
use crate::oracle::beckmann_lambda;
use crate::precision::largest_change;
use crate::probe::{BsdfValue, Dir};
use gonio_kernel::fresnel::{self, Fresnel, interface, refracted_cosine};
use gonio_kernel::lobe::{AnyLobe, Conductor, Dielectric, Lambert, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Distribution, Ggx, Masking, Microfacets};
use gonio_kernel::{Lobe, Parameters, Rgb, Transport, Vec3};
use std::sync::OnceLock;

const REFERENCE: &str = include_str!("../reference/bsdfs.json");
/// Names a larger file.
const VARIABLE: &str = "GONIO_MITSUBA";

/// Three f_cos, the density and, where an event chooses it, the direction; as radiance.
type Numbers = [f64; 7];
/// A lobe, wo and wi to their numbers.
pub(crate) type Kernel = fn(&AnyLobe<'static, f64>, Dir, Dir) -> Numbers;

/// A model that both have.
#[derive(Debug)]
pub(crate) struct Model {
    /// Its name in the file.
    pub(crate) name: &'static str,
    /// The lobe of the parameters that the file lists.
    lobe: fn(&[f64]) -> AnyLobe<'static, f64>,
}

/// How Mitsuba's answer follows from the kernel's.
struct Known {
    /// What the value is multiplied by.
    value: f64,
    /// What the density is multiplied by.
    density: f64,
    /// The relative error of value and density by the roundings of what Mitsuba subtracts.
    rounding: f64,
    /// D cosθ_m, below 1e-20 of which Mitsuba returns 0.
    facets: f64,
}

impl Known {
    const SAME: Self = Self { value: 1.0, density: 1.0, rounding: 0.0, facets: 1.0 };
}

/// The models.
pub(crate) static MODELS: [Model; 6] = [
    Model { name: "diffuse", lobe: |p| Lambert::new(rgb(p)).into() },
    Model { name: "roughconductor-ggx", lobe: |p| conductor(ggx(p), p) },
    Model { name: "roughconductor-beckmann", lobe: |p| conductor(beckmann(p), p) },
    Model { name: "roughdielectric-ggx", lobe: |p| dielectric(ggx(p), p) },
    Model { name: "roughdielectric-beckmann", lobe: |p| dielectric(beckmann(p), p) },
    Model { name: "dielectric", lobe: |p| Dielectric::new(p[0]).into() },
];

fn rgb(p: &[f64]) -> Rgb<f64> {
    Rgb::new(p[0], p[1], p[2])
}
fn ggx(p: &[f64]) -> Microfacets<f64> {
    Ggx { alpha_x: p[0], alpha_y: p[1] }.into()
}
fn beckmann(p: &[f64]) -> Microfacets<f64> {
    Beckmann { alpha_x: p[0], alpha_y: p[1] }.into()
}
fn conductor(microfacets: Microfacets<f64>, p: &[f64]) -> AnyLobe<'static, f64> {
    let fresnel = Fresnel::Conductor { eta: rgb(&p[2..]), k: rgb(&p[5..]) };
    Conductor::new(microfacets, fresnel).with_masking(Masking::Separable).into()
}
fn dielectric(microfacets: Microfacets<f64>, p: &[f64]) -> AnyLobe<'static, f64> {
    RoughDielectric::new(microfacets, p[2]).with_masking(Masking::Separable).into()
}

/// The kernel's answer: of what is all delta, the event that crosses the surface, or does not, as wi does.
pub(crate) fn kernel(lobe: &AnyLobe<'static, f64>, wo: Dir, wi: Dir) -> Numbers {
    let prepared = lobe.prepare(wo, Transport::Radiance);
    let (value, wi) = if lobe.properties().all_delta {
        let last = 1.0_f64.next_down();
        let sample = lobe.sample(wo, &prepared, [if wo.z * wi.z < 0.0 { last } else { 0.0 }, 0.5, 0.5]);
        (lobe.delta(wo, &prepared, &sample), sample.wi)
    } else {
        (lobe.eval(wo, &prepared, wi), wi)
    };
    let [r, g, b, pdf] = BsdfValue::of(value).numbers();
    [r, g, b, pdf, wi.x, wi.y, wi.z]
}

/// What is known about the difference.
fn difference(lobe: &AnyLobe<'static, f64>, wo: Dir, wi: Dir) -> Known {
    match lobe {
        AnyLobe::Conductor(l) => {
            let masking = masking(&l.microfacets, wo, wi);
            let density = masking.density * unbounded(&l.microfacets, wo);
            Known { density, facets: facets(&l.microfacets, 1.0, wo, wi), ..masking }
        }
        AnyLobe::RoughDielectric(l) => through(l, wo, wi, masking(&l.microfacets, wo, wi)),
        AnyLobe::Dielectric(l) => {
            Known { rounding: rounding(seen_from(l.eta, wo), wo.z.abs(), 0.0, wo, wi), ..Known::SAME }
        }
        _ => Known::SAME,
    }
}

/// What turns the density within the bound of visible normals into that of all of them.
fn unbounded(microfacets: &Microfacets<f64>, wo: Dir) -> f64 {
    let s = microfacets.smith_length(wo);
    microfacets.reach(wo, s).depth / (wo.z + s)
}

/// What turns exact Beckmann masking into Walter's (2007, equation 27).
fn masking(microfacets: &Microfacets<f64>, wo: Dir, wi: Dir) -> Known {
    if microfacets.distribution != Distribution::Beckmann {
        return Known::SAME;
    }
    let [alpha_x, alpha_y] = microfacets.alphas();
    let ratio = |w: Dir| {
        let a = w.z.abs() / (alpha_x * w.x).hypot(alpha_y * w.y);
        let walter = if a < 1.6 { (3.535 + 2.181 * a) * a / (1.0 + (2.276 + 2.577 * a) * a) } else { 1.0 };
        walter * (1.0 + beckmann_lambda(alpha_x, alpha_y, Dir::new(w.x, w.y, w.z.abs())))
    };
    Known { value: ratio(wo) * ratio(wi), density: ratio(wo), ..Known::SAME }
}

/// η_t/η_i seen from wo.
fn seen_from(eta: f64, wo: Dir) -> f64 {
    if wo.z < 0.0 { eta.recip() } else { eta }
}

/// wo + wi, or the normal of refraction, with its side turned upwards.
fn half(eta: f64, wo: Dir, wi: Dir) -> Dir {
    let h = wo + wi * if wo.z * wi.z < 0.0 { eta } else { 1.0 };
    if h.z < 0.0 { -h } else { h }
}
fn facets(microfacets: &Microfacets<f64>, eta: f64, wo: Dir, wi: Dir) -> f64 {
    let h = half(eta, wo, wi);
    microfacets.d(h, h.length2()) * h.z / h.length()
}
/// Which part of the light goes from wo to wi's side, by Snell's law.
fn part(eta: f64, cos_m: f64, wo: Dir, wi: Dir) -> f64 {
    let at = interface(cos_m, refracted_cosine(cos_m, eta), eta);
    if wo.z * wi.z < 0.0 { at.transmitted } else { at.reflected }
}
/// The relative error of that part where the cosine was rounded by `units` of 2⁻²⁴, and F, if it is subtracted from 1, by one.
fn rounding(eta: f64, cos_m: f64, units: f64, wo: Dir, wi: Dir) -> f64 {
    let unit = 0.5 * f64::from(f32::EPSILON);
    let here = part(eta, cos_m, wo, wi);
    let moved = [-units, units].map(|by| (part(eta, (cos_m + by * unit).clamp(0.0, 1.0), wo, wi) - here).abs());
    let subtracted = if wo.z * wi.z < 0.0 { unit } else { 0.0 };
    // Where nothing passes, nothing is known.
    ((moved[0].max(moved[1]) + subtracted) / here).min(1.0)
}
fn through(l: &RoughDielectric<f64>, wo: Dir, wi: Dir, masking: Known) -> Known {
    let eta = seen_from(l.eta, wo);
    let h = half(eta, wo, wi);
    let cos = |w: Dir| (w.dot(h).abs() / h.length()).min(1.0);
    let (cos_o, cos_i) = (cos(wo), cos(wi));
    let (of_kernel, cosines) = if wo.z * wi.z < 0.0 {
        (interface(cos_o, cos_i, eta).transmitted, 1.0)
    } else {
        (fresnel::dielectric((0.5 * h.length()).min(1.0), eta), cos_o / cos_i)
    };
    let ratio = part(eta, cos_o, wo, wi) / of_kernel;
    let ratio = if ratio.is_finite() { ratio } else { 1.0 }; // 0/0 where nothing passes
    Known {
        value: masking.value * ratio,
        density: masking.density * ratio * cosines,
        rounding: rounding(eta, cos_o, 4.0, wo, wi),
        facets: facets(&l.microfacets, eta, wo, wi),
    }
}

/// One model, or something that is meant to be it.
pub(crate) fn measure(model: &Model, kernel: Kernel, _run: &Run) -> Finding {
    let mut finding = Finding::at_most(1.0, "max |kernel − Mitsuba| in units of 1e-4 f and one ulp of an input ≤");
    let file = match file() {
        Ok(file) => file,
        Err(error) => {
            finding.broken(|| error.clone());
            return finding;
        }
    };
    let (mut count, mut lit, mut relative) = (0_usize, 0_usize, 0.0_f64);
    for Material { parameters, rows } in file.materials(model.name) {
        let lobe = (model.lobe)(parameters);
        let nudged = nudged(&lobe);
        for row in rows.chunks_exact(10) {
            let (wo, wi) = (vector(&row[..3]), vector(&row[3..6]));
            count += 1;
            let known = difference(&lobe, wo, wi);
            if known.facets < 1.001e-20 && row[6..].iter().all(|x| *x == 0.0) {
                continue;
            }
            lit += usize::from(row[9] > 0.0);
            let converted = |lobe: &AnyLobe<'static, f64>, wo: Dir, wi: Dir| {
                let [r, g, b, pdf, x, y, z] = kernel(lobe, wo, wi);
                let Known { value, density, .. } = difference(lobe, wo, wi);
                [r * value, g * value, b * value, pdf * density, x, y, z]
            };
            let moves = nudged.iter().map(|lobe| converted(lobe, wo, wi));
            let moves = largest_change(|wo, wi| converted(&lobe, wo, wi), moves, wo, wi);
            let right = [&row[6..], &row[3..6]].concat();
            for (i, (got, right)) in converted(&lobe, wo, wi).into_iter().zip(right).enumerate() {
                let rounding = if i < 4 { known.rounding * got } else { 0.0 };
                let limit = got.abs() * 1e-4 + moves[i].max(rounding) + f64::from(f32::MIN_POSITIVE);
                let error = (got - right).abs();
                relative = relative.max(if got != 0.0 { error / got.abs() } else { 0.0 });
                finding.raise(error / limit, || {
                    let what = ["f_cos red", "f_cos green", "f_cos blue", "pdf", "wi.x", "wi.y", "wi.z"][i];
                    format!(
                        "configuration {count}: {what} {got:.9e} instead of {right:.9e}, limit {limit:.1e}, \
                         {lobe:?}, wo {wo:?}, wi {wi:?}"
                    )
                });
            }
        }
    }
    if count < file.least {
        finding.broken(|| {
            format!("{count} configurations of {} are in the file, {} were asked for", model.name, file.least)
        });
    }
    finding.note(format!("{count} configurations, {lit} of them lit; largest relative difference {relative:.1e}"));
    finding
}

/// The lobe with each of its numbers in turn moved to the next `f32`, up and down.
fn nudged(lobe: &AnyLobe<'static, f64>) -> Vec<AnyLobe<'static, f64>> {
    let mut count = 0;
    let _: AnyLobe<'static, f64> = lobe.map(&mut |_, _, x| {
        count += 1;
        x
    });
    let moved = |index: usize, next: fn(f32) -> f32| {
        let mut at = 0..;
        lobe.map(&mut |_, _, x| if at.next() == Some(index) { f64::from(next(x as f32)) } else { x })
    };
    (0..count).flat_map(|index| [moved(index, f32::next_up), moved(index, f32::next_down)]).collect()
}

/// Fresnel's equations.
pub(crate) fn measure_fresnel(_run: &Run) -> Finding {
    // A reflectance is a quotient of sums of about ten f32 terms, each below 1: 16 roundings of half an eps, at most
    // amplified fourfold by the small eta² - k² - sin² of the conductors. And near the critical angle it is vertical.
    let mut finding = Finding::at_most(1.0, "max |kernel − Mitsuba| in units of 32 eps and one ulp of an input ≤");
    type Reflectance = fn(&[f64]) -> f64;
    let models: [(&str, Reflectance); 2] = [
        ("fresnel_conductor", |x| fresnel::conductor(x[0], x[1], x[2])),
        ("fresnel_dielectric", |x| fresnel::dielectric(x[0].abs(), if x[0] < 0.0 { x[1].recip() } else { x[1] })),
    ];
    let file = match file() {
        Ok(file) => file,
        Err(error) => {
            finding.broken(|| error.clone());
            return finding;
        }
    };
    let mut total = 0;
    for (name, kernel) in models {
        let mut count = 0;
        for Material { parameters, rows } in file.materials(name) {
            for row in rows.chunks_exact(2) {
                let x = [&row[..1], parameters].concat();
                let (got, right) = (kernel(&x), row[1]);
                let moved = |at: usize, next: fn(f32) -> f32| {
                    let mut moved = x.clone();
                    moved[at] = f64::from(next(moved[at] as f32));
                    (kernel(&moved) - got).abs()
                };
                let both = |at| moved(at, f32::next_up).max(moved(at, f32::next_down));
                let moves = (0..x.len()).map(both).fold(0.0, f64::max);
                let limit = 32.0 * f64::from(f32::EPSILON) + moves;
                finding.raise((got - right).abs() / limit, || format!("{name}{x:?} = {got} instead of {right}"));
                count += 1;
            }
        }
        if count < file.least {
            finding.broken(|| format!("only {count} points of {name} were read"));
        }
        total += count;
    }
    finding.note(format!("{total} points"));
    finding
}

/// One line of the file.
struct Material {
    parameters: Vec<f64>,
    rows: Vec<f64>,
}

/// What was read, and how many configurations of each model there must be.
struct File {
    materials: Vec<(String, Material)>,
    least: usize,
}

impl File {
    fn materials(&self, model: &str) -> impl Iterator<Item = &Material> {
        self.materials.iter().filter(move |(name, _)| name == model).map(|(_, material)| material)
    }
}

/// The file, read once.
fn file() -> Result<&'static File, &'static String> {
    static FILE: OnceLock<Result<File, String>> = OnceLock::new();
    let read = || match std::env::var_os(VARIABLE) {
        None => parse(REFERENCE, 400),
        Some(path) => {
            let text = std::fs::read_to_string(&path).map_err(|e| format!("{VARIABLE}={}: {e}", path.display()))?;
            parse(&text, 100_000).map_err(|e| format!("{}:{e}", path.display()))
        }
    };
    FILE.get_or_init(read).as_ref()
}

fn parse(text: &str, least: usize) -> Result<File, String> {
    let mut materials = Vec::new();
    for (number, line) in text.lines().enumerate().filter(|(_, line)| line.starts_with("{\"model\"")) {
        let field = |name| field(line, name).ok_or_else(|| format!("{}: no {name}", number + 1));
        let numbers = |name| {
            let list = field(name)?.split(',').map(|x| x.trim().parse::<f32>().map(f64::from));
            list.collect::<Result<Vec<f64>, _>>().map_err(|e| format!("{}: {name}: {e}", number + 1))
        };
        let material = Material { parameters: numbers("parameters")?, rows: numbers("rows")? };
        materials.push((field("model")?.to_owned(), material));
    }
    Ok(File { materials, least })
}

/// The text between the brackets or quotes of a field of one line.
fn field<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!("\"{name}\": "))?;
    rest.get(1..)?.split([']', '"']).next()
}

fn vector(x: &[f64]) -> Dir {
    Vec3::new(x[0], x[1], x[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Effort, Options, Outcome, validate_kernel};

    #[test]
    fn every_model_agrees_and_every_planted_fault_does_not() {
        let options = Options { only: Some("mitsuba".to_owned()), ..Options::new(Effort::Quick) };
        let mut checks = 0;
        validate_kernel(&options, &mut |check| {
            println!("{} {}: {:.3}", check.instrument, check.subject, check.measured);
            assert!(matches!(check.outcome, Outcome::Passed), "{}: {} {}", check.subject, check.measured, check.detail);
            checks += 1;
        });
        assert_eq!(checks, MODELS.len() + 1 + 10);
    }

    #[test]
    fn a_number_that_cannot_be_read_is_an_error_with_its_line() {
        let good = "{\"model\": \"dielectric\", \"parameters\": [1.5], \"rows\": [0.1, 2e-3]}";
        let file = parse(good, 1).unwrap();
        let materials: Vec<&Material> = file.materials("dielectric").collect();
        assert_eq!((materials.len(), &materials[0].parameters[..], materials[0].rows.len()), (1, &[1.5][..], 2));
        let error = |text: String| parse(&text, 1).err().unwrap();
        assert!(error(format!("{good},\n{}", good.replace("1.5", "glass"))).starts_with("2: parameters: "));
        assert!(error(good.replace("rows", "row")).starts_with("1: no rows"));
    }
}
