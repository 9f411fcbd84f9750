//! The zoo: every lobe of the kernel at many parameters, and mixtures of them.
//!
//! A [`Species`] is a lobe as a function of plain numbers, each with its range; it builds itself in `f32`, `f64` and
//! lanes. A [`Row`] is a weighted list of species at given numbers. The table of species is made from the kernel's own
//! table of lobes: a lobe that has none here does not compile.

use crate::anatomy;
use crate::oracle;
use crate::probe::{Dir, Worth};
use gonio_kernel::energy::Compensation;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::eon::Directional;
use gonio_kernel::lobe::{AnyLobe, Conductor, Dielectric, Eon, Lambert, Mirror, Phong, PhongNorm, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx, Masking};
use gonio_kernel::{F32x8, Real, Rgb, Surface};

/// A parameter and its domain, ends included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameter {
    /// The least value.
    pub(crate) lo: f32,
    /// The largest value.
    pub(crate) hi: f32,
    /// From where on random values are uniform in the logarithm; none if they are uniform in the value.
    pub(crate) log_from: Option<f32>,
}

/// Reflectances, weights, roughness.
pub(crate) const UNIT: Parameter = Parameter { lo: 0.0, hi: 1.0, log_from: None };
/// Widths of microfacets.
pub(crate) const ALPHA: Parameter = Parameter { lo: 1e-8, hi: 1.0, log_from: Some(1e-8) };
/// Phong's exponent.
pub(crate) const EXPONENT: Parameter = Parameter { lo: 0.0, hi: 1e7, log_from: Some(1e-2) };
/// The real part of a conductor's index.
pub(crate) const ETA: Parameter = Parameter { lo: 1e-4, hi: 100.0, log_from: Some(1e-4) };
/// Its imaginary part.
pub(crate) const EXTINCTION: Parameter = Parameter { lo: 0.0, hi: 100.0, log_from: Some(1e-4) };
/// A relative index of refraction.
pub(crate) const INDEX: Parameter = Parameter { lo: 0.01, hi: 100.0, log_from: Some(0.01) };

/// Numbers of a species that plots set alike, and over which range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Varied {
    /// In words.
    pub(crate) name: &'static str,
    /// From which number up to which.
    pub(crate) numbers: (usize, usize),
    /// The range.
    pub(crate) range: (f64, f64),
    /// Whether its steps are ratios.
    pub(crate) log: bool,
    /// What plots of a single value take.
    pub(crate) single: f32,
}

impl Varied {
    const REFLECTANCE: Self = Self { name: "reflectance", numbers: (0, 3), range: (0.0, 1.0), log: false, single: 0.5 };
    const WIDTH: Self = Self { name: "width α", numbers: (0, 2), range: (1e-4, 1.0), log: true, single: 0.2 };
    const EXPONENT: Self = Self { name: "exponent", numbers: (3, 4), range: (1.0, 1e4), log: true, single: 30.0 };
    const INDEX: Self = Self { name: "index η", numbers: (0, 1), range: (0.4, 2.5), log: true, single: 1.5 };
}

/// A lobe as a function of plain numbers.
#[derive(Debug)]
pub(crate) struct Species {
    /// Its name.
    pub(crate) name: &'static str,
    /// Its numbers, in order.
    pub(crate) parameters: &'static [Parameter],
    /// In `f32`. The builders want as many numbers as there are parameters.
    pub(crate) single: fn(&[f32]) -> AnyLobe<f32>,
    /// In `f64`.
    pub(crate) double: fn(&[f64]) -> AnyLobe<f64>,
    /// In lanes.
    pub(crate) lanes: fn(&[F32x8]) -> AnyLobe<F32x8>,
    /// The textbook's answer: parameters, wo, wi to f_cos and pdf.
    pub(crate) oracle: fn(&[f64], Dir, Dir) -> Worth,
    /// What its plots vary.
    pub(crate) varied: Varied,
}

impl Species {
    /// It at the least of its numbers.
    fn least(&self) -> AnyLobe<f32> {
        (self.single)(&self.parameters.iter().map(|p| p.lo).collect::<Vec<_>>())
    }
    /// Whether it is purely discrete.
    pub(crate) fn is_discrete(&self) -> bool {
        anatomy::is_discrete(&self.least())
    }
    /// Whether it scatters to the other side, and from there.
    pub(crate) fn transmits(&self) -> bool {
        anatomy::transmits(&self.least())
    }
    /// Which of its numbers is the relative index of what it transmits.
    pub(crate) fn index(&self) -> Option<usize> {
        self.parameters.iter().position(|p| p.lo == INDEX.lo).filter(|_| self.transmits())
    }
    /// Whether its first two numbers are widths.
    pub(crate) fn has_width(&self) -> bool {
        self.parameters[0].log_from == ALPHA.log_from
    }
    /// It in its first row, with the numbers that plots vary replaced.
    pub(crate) fn specimen(&'static self, number: f32) -> Row {
        let rows = rows();
        let (_, numbers) =
            rows.iter().filter_map(Row::only).find(|(s, _)| std::ptr::eq(*s, self)).expect("every species has a row");
        let mut numbers = numbers.to_vec();
        let (from, to) = self.varied.numbers;
        numbers[from..to].fill(number);
        row(self.name, &[(1.0, self, &numbers)])
    }
}

macro_rules! species {
    ($name:ident, $text:literal, $build:ident, $oracle:path, [$($parameter:expr),*]) => {
        species!($name, $text, $build, $oracle, [$($parameter),*], Varied::WIDTH);
    };
    ($name:ident, $text:literal, $build:ident, $oracle:path, [$($parameter:expr),*], $varied:expr) => {
        /// See the builder of the same name.
        pub(crate) static $name: Species = Species {
            name: $text,
            parameters: &[$($parameter),*],
            single: $build,
            double: $build,
            lanes: $build,
            oracle: $oracle,
            varied: $varied,
        };
    };
}
species!(LAMBERT, "lambert", lambert, oracle::lambert, [UNIT, UNIT, UNIT], Varied::REFLECTANCE);
species!(MIRROR, "mirror", mirror, oracle::discrete, [UNIT, UNIT, UNIT], Varied::REFLECTANCE);
species!(EON_EXACT, "eon-exact", eon_exact, oracle::eon_exact, [UNIT, UNIT, UNIT, UNIT], Varied::REFLECTANCE);
species!(EON_FITTED, "eon-fitted", eon_fitted, oracle::eon_fitted, [UNIT, UNIT, UNIT, UNIT], Varied::REFLECTANCE);
species!(METAL, "conductor", metal, oracle::metal, [ALPHA, ALPHA, ETA, ETA, ETA, EXTINCTION, EXTINCTION, EXTINCTION]);
species!(SCHLICK, "conductor-schlick", schlick, oracle::schlick, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(F82, "conductor-f82", f82, oracle::f82, [ALPHA, ALPHA, UNIT, UNIT, UNIT, UNIT, UNIT, UNIT]);
species!(SEPARABLE, "conductor-separable", separable, oracle::separable, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(BECKMANN, "conductor-beckmann", beckmann, oracle::beckmann, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(KULLA_CONTY, "conductor-kulla-conty", kulla_conty, oracle::kulla_conty, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(
    METAL_KULLA_CONTY,
    "conductor-kulla-conty-metal",
    metal_kulla_conty,
    oracle::metal_kulla_conty,
    [ALPHA, ALPHA, ETA, ETA, ETA, EXTINCTION, EXTINCTION, EXTINCTION]
);
species!(TURQUIN, "conductor-turquin", turquin, oracle::turquin, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(COAT, "dielectric-reflection", coat, oracle::coat, [ALPHA, ALPHA, INDEX]);
species!(GLASS, "dielectric", glass, oracle::discrete, [INDEX], Varied::INDEX);
species!(GROUND_BECKMANN, "rough-dielectric-beckmann", ground_beckmann, oracle::ground_beckmann, [ALPHA, ALPHA, INDEX]);
species!(GROUND, "rough-dielectric", ground, oracle::ground, [ALPHA, ALPHA, INDEX]);
species!(
    PHONG_LECTURE,
    "phong-lecture",
    phong_lecture,
    oracle::phong_lecture,
    [UNIT, UNIT, UNIT, EXPONENT],
    Varied::EXPONENT
);
species!(
    PHONG_LAFORTUNE,
    "phong-lafortune",
    phong_lafortune,
    oracle::phong_lafortune,
    [UNIT, UNIT, UNIT, EXPONENT],
    Varied::EXPONENT
);

fn rgb<R: Real>(p: &[R]) -> Rgb<R> {
    Rgb::new(p[0], p[1], p[2])
}
fn lambert<R: Real>(p: &[R]) -> AnyLobe<R> {
    Lambert::new(rgb(p)).into()
}
fn mirror<R: Real>(p: &[R]) -> AnyLobe<R> {
    Mirror::new(rgb(p)).into()
}
fn metal<R: Real>(p: &[R]) -> AnyLobe<R> {
    metal_lobe(p).into()
}
fn metal_lobe<R: Real>(p: &[R]) -> Conductor<R> {
    Conductor::new(ggx(p), Fresnel::Conductor { eta: rgb(&p[2..]), k: rgb(&p[5..]) })
}
fn schlick<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(ggx(p), Fresnel::Schlick { f0: rgb(&p[2..]) }).into()
}

fn ggx<R: Real>(p: &[R]) -> Ggx<R> {
    Ggx { alpha_x: p[0], alpha_y: p[1] }
}
fn f82<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(ggx(p), Fresnel::F82 { f0: rgb(&p[2..]), tint: rgb(&p[5..]) }).into()
}
fn separable<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(ggx(p), Fresnel::Schlick { f0: rgb(&p[2..]) }).with_masking(Masking::Separable).into()
}
fn turquin<R: Real>(p: &[R]) -> AnyLobe<R> {
    let single = Conductor::new(ggx(p), Fresnel::Schlick { f0: rgb(&p[2..]) });
    single.with_compensation(Compensation::Turquin).into()
}
fn metal_kulla_conty<R: Real>(p: &[R]) -> AnyLobe<R> {
    metal_lobe(p).with_compensation(Compensation::KullaConty).into()
}
fn kulla_conty<R: Real>(p: &[R]) -> AnyLobe<R> {
    let single = Conductor::new(ggx(p), Fresnel::Schlick { f0: rgb(&p[2..]) });
    single.with_compensation(Compensation::KullaConty).into()
}
fn coat<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(ggx(p), Fresnel::Dielectric { eta: p[2] }).into()
}
fn glass<R: Real>(p: &[R]) -> AnyLobe<R> {
    Dielectric::new(p[0]).into()
}
fn beckmann<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(Beckmann { alpha_x: p[0], alpha_y: p[1] }, Fresnel::Schlick { f0: rgb(&p[2..]) }).into()
}
fn ground_beckmann<R: Real>(p: &[R]) -> AnyLobe<R> {
    RoughDielectric::new(Beckmann { alpha_x: p[0], alpha_y: p[1] }, p[2]).into()
}
fn ground<R: Real>(p: &[R]) -> AnyLobe<R> {
    RoughDielectric::new(ggx(p), p[2]).into()
}

/// Three k_d, α; k_s = 1 − k_d, so that every number of its range is in the domain.
fn phong<R: Real>(p: &[R], norm: PhongNorm) -> Phong<R> {
    let diffuse = rgb(p);
    Phong { diffuse, glossy: diffuse.map(|k| R::ONE - k), exponent: p[3], norm }
}
fn phong_lecture<R: Real>(p: &[R]) -> AnyLobe<R> {
    phong(p, PhongNorm::Lecture).into()
}
fn phong_lafortune<R: Real>(p: &[R]) -> AnyLobe<R> {
    phong(p, PhongNorm::Lafortune).into()
}
fn eon_exact<R: Real>(p: &[R]) -> AnyLobe<R> {
    Eon::new(rgb(p), p[3]).into()
}
fn eon_fitted<R: Real>(p: &[R]) -> AnyLobe<R> {
    Eon { directional: Directional::Fitted, ..Eon::new(rgb(p), p[3]) }.into()
}

/// A lobe of the kernel with its species. Implement it for a new lobe, or the table below does not compile.
trait InZoo {
    const SPECIES: &'static [&'static Species];
}
impl InZoo for Lambert<f32> {
    const SPECIES: &'static [&'static Species] = &[&LAMBERT];
}
impl InZoo for Mirror<f32> {
    const SPECIES: &'static [&'static Species] = &[&MIRROR];
}
impl InZoo for Eon<f32> {
    const SPECIES: &'static [&'static Species] = &[&EON_EXACT, &EON_FITTED];
}
impl InZoo for Conductor<f32> {
    const SPECIES: &'static [&'static Species] =
        &[&METAL, &SCHLICK, &F82, &SEPARABLE, &BECKMANN, &KULLA_CONTY, &METAL_KULLA_CONTY, &TURQUIN, &COAT];
}
impl InZoo for Dielectric<f32> {
    const SPECIES: &'static [&'static Species] = &[&GLASS];
}
impl InZoo for RoughDielectric<f32> {
    const SPECIES: &'static [&'static Species] = &[&GROUND, &GROUND_BECKMANN];
}

impl InZoo for Phong<f32> {
    const SPECIES: &'static [&'static Species] = &[&PHONG_LECTURE, &PHONG_LAFORTUNE];
}

macro_rules! table {
    ($($model:ident),*) => {
        /// Every lobe of the kernel, by name, with its species.
        const TABLE: &[(&str, &[&Species])] = &[$((stringify!($model), <$model<f32> as InZoo>::SPECIES)),*];
    };
}
gonio_kernel::for_each_lobe!(table);

/// All species.
pub(crate) fn species() -> impl Iterator<Item = &'static Species> {
    TABLE.iter().flat_map(|(_, species)| species.iter().copied())
}

/// A weighted list of species at given numbers.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Its name.
    pub(crate) name: String,
    /// Weight, species, numbers.
    pub(crate) lobes: Vec<(f32, &'static Species, Vec<f32>)>,
}

impl Row {
    /// The surface.
    pub(crate) fn surface(&self) -> Surface<f32> {
        self.lobes.iter().fold(Surface::black(), |s, (w, species, p)| s.with(*w, (species.single)(p)))
    }
    /// The numbers behind a single lobe of weight 1.
    pub(crate) fn only(&self) -> Option<(&'static Species, &[f32])> {
        match &self.lobes[..] {
            [(weight, species, p)] if *weight == 1.0 => Some((species, p)),
            _ => None,
        }
    }
}

/// Indices near gold's and silver's at red, green and blue.
const GOLD: [f32; 6] = [0.143, 0.375, 1.442, 3.983, 2.386, 1.603];
const SILVER: [f32; 6] = [0.155, 0.117, 0.138, 4.828, 3.122, 2.147];
const WHITE: [f32; 3] = [1.0; 3];
const COLOUR: [f32; 3] = [0.8, 0.5, 0.2];

/// A row; weight, species and numbers of each lobe.
pub(crate) fn row(name: impl Into<String>, lobes: &[(f32, &'static Species, &[f32])]) -> Row {
    let lobes: Vec<_> = lobes.iter().map(|(w, s, p)| (*w, *s, p.to_vec())).collect();
    Row { name: name.into(), lobes }
}

/// Every row.
pub(crate) fn rows() -> Vec<Row> {
    let mut rows = vec![
        row("lambert white", &[(1.0, &LAMBERT, &WHITE)]),
        row("lambert colour", &[(1.0, &LAMBERT, &COLOUR)]),
        row("lambert black", &[(1.0, &LAMBERT, &[0.0; 3])]),
        row("mirror white", &[(1.0, &MIRROR, &WHITE)]),
        row("mirror colour", &[(1.0, &MIRROR, &COLOUR)]),
    ];
    // Widths over four decades, isotropic; then anisotropic, each way round.
    let widths = [1e-4, 1e-3, 0.01, 0.05, 0.2, 0.5, 1.0].map(|a: f32| (a, a));
    let stretched = [(0.3, 0.03), (0.03, 0.3), (0.05, 0.9), (0.9, 0.05)];
    for (index, (x, y)) in widths.into_iter().chain(stretched).enumerate() {
        rows.push(row(format!("conductor {x}x{y} white"), &[(1.0, &SCHLICK, &[x, y, 1.0, 1.0, 1.0])]));
        let (name, metal) = if index % 2 == 0 { ("gold", GOLD) } else { ("silver", SILVER) };
        let numbers: Vec<f32> = [x, y].into_iter().chain(metal).collect();
        rows.push(row(format!("conductor {x}x{y} {name}"), &[(1.0, &METAL, &numbers)]));
    }
    for (name, species) in [("phong lecture", &PHONG_LECTURE), ("phong lafortune", &PHONG_LAFORTUNE)] {
        for exponent in [0.0_f32, 1.0, 10.0, 100.0, 1e4, 1e7] {
            rows.push(row(format!("{name} {exponent} glossy"), &[(1.0, species, &[0.0, 0.0, 0.0, exponent])]));
            rows.push(row(format!("{name} {exponent} both"), &[(1.0, species, &[0.5, 0.25, 0.125, exponent])]));
        }
        rows.push(row(format!("{name} diffuse"), &[(1.0, species, &[1.0, 1.0, 1.0, 100.0])]));
    }
    for roughness in [0.0_f32, 0.25, 0.5, 1.0] {
        for (name, species) in [("exact", &EON_EXACT), ("fitted", &EON_FITTED)] {
            for (colour, [r, g, b]) in [("white", WHITE), ("colour", COLOUR)] {
                rows.push(row(format!("eon {name} {roughness} {colour}"), &[(1.0, species, &[r, g, b, roughness])]));
            }
        }
    }
    let sharp: &[f32] = &[0.03, 0.3, 0.9, 0.6, 0.4];
    let wide: &[f32] = &[0.5, 0.5, 0.04, 0.04, 0.04];
    let gold: Vec<f32> = [0.2, 0.2].into_iter().chain(GOLD).collect();
    rows.extend([
        row("conductor 1e-8x1e-8 white", &[(1.0, &SCHLICK, &[1e-8, 1e-8, 1.0, 1.0, 1.0])]),
        row("conductor 1e-3x1 white", &[(1.0, &SCHLICK, &[1e-3, 1.0, 1.0, 1.0, 1.0])]),
        row("beckmann 1e-4x1e-4 white", &[(1.0, &BECKMANN, &[1e-4, 1e-4, 1.0, 1.0, 1.0])]),
        row("beckmann 0.02x0.3 white", &[(1.0, &BECKMANN, &[0.02, 0.3, 1.0, 1.0, 1.0])]),
        row("beckmann 0.4x0.4 colour", &[(1.0, &BECKMANN, &[0.4, 0.4, 0.8, 0.5, 0.2])]),
        row("beckmann 1x1 white", &[(1.0, &BECKMANN, &[1.0, 1.0, 1.0, 1.0, 1.0])]),
        row("compensated 0.01x0.01 white", &[(1.0, &KULLA_CONTY, &[0.01, 0.01, 1.0, 1.0, 1.0])]),
        row("compensated 0.2x0.2 white", &[(1.0, &KULLA_CONTY, &[0.2, 0.2, 1.0, 1.0, 1.0])]),
        row("compensated 1x1 white", &[(1.0, &KULLA_CONTY, &[1.0, 1.0, 1.0, 1.0, 1.0])]),
        row("compensated 0.6x0.6 gold", &[(1.0, &KULLA_CONTY, &[0.6, 0.6, 0.9, 0.6, 0.3])]),
        row("compensated 0.3x0.3 gold metal", &[(1.0, &METAL_KULLA_CONTY, &[&[0.3, 0.3], &gold[2..]].concat())]),
        row("compensated 0.3x0.9 white", &[(1.0, &KULLA_CONTY, &[0.3, 0.9, 1.0, 1.0, 1.0])]),
        row("turquin 0.5x0.5 white", &[(1.0, &TURQUIN, &[0.5, 0.5, 1.0, 1.0, 1.0])]),
        row("turquin 1x1 gold", &[(1.0, &TURQUIN, &[1.0, 1.0, 0.9, 0.6, 0.3])]),
        row("conductor f82", &[(1.0, &F82, &[0.3, 0.2, 0.9, 0.6, 0.4, 0.5, 0.8, 1.0])]),
        row("conductor separable", &[(1.0, &SEPARABLE, &[0.6, 0.3, 0.9, 0.6, 0.4])]),
        row("coat", &[(1.0, &COAT, &[0.2, 0.2, 1.5])]),
        row("coat from within", &[(1.0, &COAT, &[0.2, 0.4, 0.66])]),
        row("coat over lambert", &[(0.5, &COAT, &[0.1, 0.1, 1.5]), (0.5, &LAMBERT, &COLOUR)]),
    ]);
    // Smooth and rough interfaces: glass, from within, diamond, a thin one, none.
    for eta in [1.5, 1.0 / 1.5, 2.4, 1.01, 1.0] {
        rows.push(row(format!("glass {eta}"), &[(1.0, &GLASS, &[eta])]));
    }
    for (x, y, eta) in [(0.01, 0.01, 1.5), (0.3, 0.1, 1.5), (0.5, 0.5, 0.66), (1.0, 1.0, 2.4), (0.2, 0.2, 1.2)] {
        rows.push(row(format!("ground glass {x}x{y} {eta}"), &[(1.0, &GROUND, &[x, y, eta])]));
    }
    rows.extend([
        row("ground glass beckmann 0.3x0.1 1.5", &[(1.0, &GROUND_BECKMANN, &[0.3, 0.1, 1.5])]),
        row("ground glass between equal indices", &[(1.0, &GROUND, &[0.3, 0.3, 1.0])]),
        row("glass and lambert", &[(0.5, &GLASS, &[1.5]), (0.5, &LAMBERT, &COLOUR)]),
        row("half lambert half mirror", &[(0.5, &LAMBERT, &WHITE), (0.5, &MIRROR, &WHITE)]),
        row("mirror before lambert", &[(0.25, &MIRROR, &COLOUR), (0.75, &LAMBERT, &COLOUR)]),
        row("phong over mirror", &[(0.5, &PHONG_LAFORTUNE, &[0.5, 0.25, 0.125, 30.0]), (0.5, &MIRROR, &WHITE)]),
        row("two mirrors", &[(0.25, &MIRROR, &COLOUR), (0.5, &MIRROR, &WHITE)]),
        row("lambert weight 0.3", &[(0.3, &LAMBERT, &COLOUR)]),
        row("lambert weight 0", &[(0.0, &LAMBERT, &WHITE)]),
        row("conductor over lambert", &[(0.4, &SCHLICK, sharp), (0.6, &LAMBERT, &COLOUR)]),
        row("conductor weight 0, lambert", &[(0.0, &SCHLICK, sharp), (1.0, &LAMBERT, &COLOUR)]),
        row("conductor over eon", &[(0.4, &SCHLICK, sharp), (0.6, &EON_EXACT, &[0.8, 0.5, 0.2, 0.7])]),
        row("two conductors", &[(0.5, &METAL, &gold), (0.5, &SCHLICK, sharp)]),
        row("three lobes", &[(0.3, &SCHLICK, wide), (0.2, &MIRROR, &COLOUR), (0.5, &LAMBERT, &COLOUR)]),
        row(
            "four lobes",
            &[(0.25, &METAL, &gold), (0.1, &MIRROR, &WHITE), (0.25, &SCHLICK, sharp), (0.4, &LAMBERT, &COLOUR)],
        ),
    ]);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::Lobe;

    #[test]
    fn every_species_has_a_row() {
        for species in species() {
            assert!(rows().iter().any(|r| r.only().is_some_and(|(s, _)| std::ptr::eq(s, species))), "{}", species.name);
        }
    }

    #[test]
    fn the_ends_of_every_range_lie_in_the_domain() {
        for species in species() {
            let lo: Vec<f32> = species.parameters.iter().map(|p| p.lo).collect();
            let hi: Vec<f32> = species.parameters.iter().map(|p| p.hi).collect();
            assert!((species.single)(&lo).domain() && (species.single)(&hi).domain(), "{}", species.name);
        }
    }
}
