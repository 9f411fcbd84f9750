//! The numbers of a surface: each with its name and domain, and the surface rebuilt from other numbers in any arithmetic.
//!
//! A material arrives as a `Surface<f32>`. Its `f64` form, its lanes, itself with one number moved by an ulp or far beyond its
//! domain, and its white twin all are [`rebuilt`] from it: what the kernel would have made of those numbers.

use crate::zoo::{ALPHA, ETA, EXPONENT, EXTINCTION, INDEX, Parameter, UNIT};
use gonio_kernel::energy::Compensation;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{
    AnyLobe, Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric, eon,
};
use gonio_kernel::microfacet::{Beckmann, Ggx, Microfacets};
use gonio_kernel::{Real, Rgb, Surface};

/// A number of a lobe.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dial {
    /// Which lobe of the surface.
    pub(crate) lobe: usize,
    /// As in a material file, `albedo.g` for a channel.
    pub(crate) name: &'static str,
    /// Its domain.
    pub(crate) range: Parameter,
    /// What it is in a lobe that absorbs nothing, if it says how much is absorbed.
    pub(crate) white: Option<f32>,
    /// Whether it says how rough the surface is.
    pub(crate) rough: Option<Rough>,
}

/// In which way a number says how rough a surface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rough {
    /// The width α of microfacets.
    Width,
    /// EON's roughness.
    Diffuse,
    /// Phong's exponent.
    Exponent,
}

impl Rough {
    /// Name, least and largest value of a map, and whether its steps are ratios.
    pub(crate) fn axis(self) -> (&'static str, f64, f64, bool) {
        match self {
            Self::Width => ("width α", 1e-3, 1.0, true),
            Self::Diffuse => ("roughness", 0.0, 1.0, false),
            Self::Exponent => ("exponent", 1.0, 1e4, true),
        }
    }
}

/// The surface with number(dial, x) in the place of each number x, in the order of [`dials`].
pub(crate) fn rebuilt<S: Real>(surface: &Surface<f32>, mut number: impl FnMut(Dial, f32) -> S) -> Surface<S> {
    surface.lobes().enumerate().fold(Surface::black(), |built, (lobe, l)| {
        let mut number = |name, range, white, rough, x| number(Dial { lobe, name, range, white, rough }, x);
        let weight = number("weight", UNIT, None, None, l.weight);
        built.with(weight, lobe_of(&l.lobe, &mut Numbers(&mut number)))
    })
}

/// All numbers of a surface with their values.
pub(crate) fn dials(surface: &Surface<f32>) -> Vec<(Dial, f32)> {
    let mut dials = Vec::new();
    rebuilt(surface, |dial, x| {
        dials.push((dial, x));
        x
    });
    dials
}

/// The same surface in another arithmetic.
pub(crate) fn converted<S: Real>(surface: &Surface<f32>) -> Surface<S> {
    rebuilt(surface, |_, x| S::lit(f64::from(x)))
}

/// The surface with number `index` of [`dials`] replaced.
pub(crate) fn with_number<S: Real>(surface: &Surface<f32>, index: usize, number: S) -> Surface<S> {
    let mut at = 0..;
    rebuilt(surface, |_, x| if at.next() == Some(index) { number } else { S::lit(f64::from(x)) })
}

/// The surface in `f64` with each number in turn moved to the next `f32`, up and down, where that stays in its domain.
pub(crate) fn nudged(surface: &Surface<f32>) -> Vec<Surface<f64>> {
    let moves = |(index, (dial, x)): (usize, (Dial, f32))| {
        let inside = move |moved: &f32| dial.range.lo <= *moved && *moved <= dial.range.hi;
        [x.next_up(), x.next_down()]
            .into_iter()
            .filter(inside)
            .map(move |moved| with_number(surface, index, f64::from(moved)))
    };
    dials(surface).into_iter().enumerate().flat_map(moves).collect()
}

type Visit<'a, S> = dyn FnMut(&'static str, Parameter, Option<f32>, Option<Rough>, f32) -> S + 'a;

/// Names for the visits of a lobe's numbers.
struct Numbers<'a, S>(&'a mut Visit<'a, S>);

impl<S: Real> Numbers<'_, S> {
    fn plain(&mut self, name: &'static str, range: Parameter, x: f32) -> S {
        (self.0)(name, range, None, None, x)
    }
    fn rough(&mut self, name: &'static str, range: Parameter, rough: Rough, x: f32) -> S {
        (self.0)(name, range, None, Some(rough), x)
    }
    fn colour(&mut self, names: [&'static str; 3], range: Parameter, white: f32, c: Rgb<f32>) -> Rgb<S> {
        let mut channel = |name, x| (self.0)(name, range, Some(white), None, x);
        Rgb::new(channel(names[0], c.r), channel(names[1], c.g), channel(names[2], c.b))
    }
    fn microfacets(&mut self, microfacets: &Microfacets<f32>) -> Microfacets<S> {
        let mut width = |name, x| self.rough(name, ALPHA, Rough::Width, x);
        match microfacets {
            Microfacets::Ggx(d) => {
                Ggx { alpha_x: width("alpha_x", d.alpha_x), alpha_y: width("alpha_y", d.alpha_y) }.into()
            }
            Microfacets::Beckmann(d) => {
                Beckmann { alpha_x: width("alpha_x", d.alpha_x), alpha_y: width("alpha_y", d.alpha_y) }.into()
            }
        }
    }
    fn fresnel(&mut self, fresnel: &Fresnel<f32>) -> Fresnel<S> {
        match *fresnel {
            // An index without a real part reflects everything: 1 − R = 4η/((η + 1)² + k²).
            Fresnel::Conductor { eta, k } => Fresnel::Conductor {
                eta: self.colour(["eta.r", "eta.g", "eta.b"], ETA, ETA.lo, eta),
                k: self.colour(["k.r", "k.g", "k.b"], EXTINCTION, EXTINCTION.hi, k),
            },
            Fresnel::Schlick { f0 } => Fresnel::Schlick { f0: self.colour(["f0.r", "f0.g", "f0.b"], UNIT, 1.0, f0) },
            Fresnel::F82 { f0, tint } => Fresnel::F82 {
                f0: self.colour(["f0.r", "f0.g", "f0.b"], UNIT, 1.0, f0),
                tint: self.colour(["f82.r", "f82.g", "f82.b"], UNIT, 1.0, tint),
            },
            Fresnel::Dielectric { eta } => Fresnel::Dielectric { eta: self.plain("ior", INDEX, eta) },
        }
    }
}

/// The one place that knows the numbers of every lobe.
fn lobe_of<S: Real>(lobe: &AnyLobe<f32>, numbers: &mut Numbers<S>) -> AnyLobe<S> {
    const ALBEDO: [&str; 3] = ["albedo.r", "albedo.g", "albedo.b"];
    match lobe {
        AnyLobe::Lambert(l) => Lambert::new(numbers.colour(ALBEDO, UNIT, 1.0, l.albedo)).into(),
        AnyLobe::Mirror(l) => {
            let names = ["reflectance.r", "reflectance.g", "reflectance.b"];
            Mirror::new(numbers.colour(names, UNIT, 1.0, l.reflectance)).into()
        }
        AnyLobe::Conductor(l) => {
            let (microfacets, fresnel) = (numbers.microfacets(&l.microfacets), numbers.fresnel(&l.fresnel));
            Conductor::new(microfacets, fresnel).with_masking(l.masking).with_compensation(l.compensation).into()
        }
        AnyLobe::Dielectric(l) => Dielectric::new(numbers.plain("ior", INDEX, l.eta)).into(),
        AnyLobe::RoughDielectric(l) => {
            let microfacets = numbers.microfacets(&l.microfacets);
            RoughDielectric::new(microfacets, numbers.plain("ior", INDEX, l.eta)).with_masking(l.masking).into()
        }
        AnyLobe::Phong(l) => Phong {
            // Both white would be too much: the diffuse part gives way.
            diffuse: numbers.colour(["diffuse.r", "diffuse.g", "diffuse.b"], UNIT, 0.0, l.diffuse),
            glossy: numbers.colour(["glossy.r", "glossy.g", "glossy.b"], UNIT, 1.0, l.glossy),
            exponent: numbers.rough("exponent", EXPONENT, Rough::Exponent, l.exponent),
            norm: l.norm,
        }
        .into(),
        AnyLobe::Eon(l) => Eon {
            albedo: numbers.colour(ALBEDO, UNIT, 1.0, l.albedo),
            roughness: numbers.rough("roughness", UNIT, Rough::Diffuse, l.roughness),
            directional: l.directional,
        }
        .into(),
    }
}

/// Purely discrete.
pub(crate) fn is_discrete(lobe: &AnyLobe<f32>) -> bool {
    matches!(lobe, AnyLobe::Mirror(_) | AnyLobe::Dielectric(_))
}

/// Scatters to the other side, and from there.
pub(crate) fn transmits(lobe: &AnyLobe<f32>) -> bool {
    matches!(lobe, AnyLobe::Dielectric(_) | AnyLobe::RoughDielectric(_))
}

/// Whether the sampler maps the unit square to directions one to one.
pub(crate) fn one_to_one(lobe: &AnyLobe<f32>) -> bool {
    match lobe {
        AnyLobe::Lambert(_) => true,
        // Beckmann's steep slopes are reached from two places, and Kulla and Conty's lobe has a sampler of its own.
        AnyLobe::Conductor(l) => {
            matches!(l.microfacets, Microfacets::Ggx(_)) && l.compensation != Compensation::KullaConty
        }
        AnyLobe::Phong(l) => l.diffuse.largest() == 0.0 || l.glossy.largest() == 0.0,
        _ => false,
    }
}

/// Whether exchanging the directions exchanges the operands of commutative operations only: see the reciprocity instrument.
pub(crate) fn symmetric(lobe: &AnyLobe<f32>) -> bool {
    !matches!(lobe, AnyLobe::RoughDielectric(_))
}

/// The albedo, where it is known and the same at all angles: of Lambert, mirror, exact EON that is white or smooth, and a white
/// isotropic metal whose multiple scattering is given back.
pub(crate) fn known_albedo(lobe: &AnyLobe<f32>) -> Option<Rgb<f64>> {
    let white = Rgb::splat(1.0);
    match lobe {
        AnyLobe::Lambert(l) => Some(l.albedo.map(f64::from)),
        AnyLobe::Mirror(l) => Some(l.reflectance.map(f64::from)),
        AnyLobe::Eon(l) if l.directional == eon::Directional::Exact && (l.roughness == 0.0 || l.albedo == white) => {
            Some(l.albedo.map(f64::from))
        }
        AnyLobe::Conductor(Conductor {
            microfacets: Microfacets::Ggx(ggx),
            fresnel: Fresnel::Schlick { f0 },
            compensation: Compensation::KullaConty,
            ..
        }) if ggx.alpha_x == ggx.alpha_y && *f0 == white => Some(Rgb::splat(1.0)),
        _ => None,
    }
}

/// How far the albedo may lie from its known value. EON's closed form holds for unit directions, and those of the instruments are
/// unit to the precision of `f32` only.
pub(crate) fn slack(lobe: &AnyLobe<f32>) -> f64 {
    if matches!(lobe, AnyLobe::Eon(_)) { 1e-7 } else { 0.0 }
}

/// The largest weight of a sample; infinite where none is promised.
pub(crate) fn largest_weight(lobe: &AnyLobe<f32>) -> f64 {
    match lobe {
        AnyLobe::Eon(_) => eon::LARGEST_WEIGHT,
        AnyLobe::Phong(l) => {
            let (d, s) = (l.diffuse.map(f64::from), l.glossy.map(f64::from));
            let sum = d.luminance() + s.luminance();
            let exponent = f64::from(l.exponent);
            let excess = if l.norm == PhongNorm::Lafortune { (exponent + 2.0) / (exponent + 1.0) } else { 1.0 };
            let part = |k: Rgb<f64>| if k.luminance() > 0.0 { k.largest() * sum / k.luminance() } else { 0.0 };
            part(d).max(part(s) * excess)
        }
        AnyLobe::Conductor(l) => match l.compensation {
            Compensation::None => 1.0,
            Compensation::KullaConty => 4.0,
            Compensation::Turquin => 3.3,
        },
        _ => 1.0,
    }
}

/// The least width of a microfacet distribution; 1 if there is none.
pub(crate) fn least_width(surface: &Surface<f32>) -> f32 {
    let widths = dials(surface).into_iter().filter(|(dial, _)| dial.rough == Some(Rough::Width));
    widths.fold(1.0, |least, (_, width)| width.min(least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zoo::species;

    #[test]
    fn every_species_is_rebuilt_as_it_was_and_from_the_numbers_that_its_builder_takes() {
        for species in species() {
            let numbers: Vec<f32> = species.parameters.iter().map(|p| 0.5 * (p.lo.max(0.0) + p.hi.min(2.0))).collect();
            let surface = Surface::of((species.single)(&numbers));
            let again: Surface<f32> = converted(&surface);
            assert_eq!(format!("{surface:?}"), format!("{again:?}"), "{}", species.name);
            let doubles: Vec<f64> = numbers.iter().copied().map(f64::from).collect();
            let (double, built) = (Surface::of((species.double)(&doubles)), converted::<f64>(&surface));
            // Phong's builder makes k_s = 1 − k_d, which rounds differently in f64.
            if !species.name.starts_with("phong") {
                assert_eq!(format!("{double:?}"), format!("{built:?}"), "{}", species.name);
            }
            let found = dials(&surface);
            for (x, range) in numbers.iter().zip(species.parameters) {
                assert!(found.iter().any(|(d, y)| x == y && d.range.hi == range.hi), "{}: {x}", species.name);
            }
        }
    }
}
