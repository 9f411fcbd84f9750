//! The zoo: every lobe of the kernel at many parameters, and mixtures of them.
//!
//! A [`Species`] is a lobe as a function of plain numbers, each with its range; it builds itself in `f32`, `f64` and
//! lanes. A [`Row`] is a weighted list of species at given numbers. The table of species is made from the kernel's own
//! table of lobes: a lobe that has none here does not compile.

use crate::oracle;
use crate::probe::{Dir, Worth};
use gonio_kernel::lobe::{AnyLobe, Conductor, Lambert, Mirror, Phong, PhongNorm};
use gonio_kernel::{F32x8, Real, Rgb, Surface, fresnel::Fresnel, microfacet::Ggx};

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

const UNIT: Parameter = Parameter { lo: 0.0, hi: 1.0, log_from: None };
const ALPHA: Parameter = Parameter { lo: 1e-4, hi: 1.0, log_from: Some(1e-4) };
const EXPONENT: Parameter = Parameter { lo: 0.0, hi: 1e7, log_from: Some(1e-2) };
const ETA: Parameter = Parameter { lo: 1e-4, hi: 100.0, log_from: Some(1e-4) };
const EXTINCTION: Parameter = Parameter { lo: 0.0, hi: 100.0, log_from: Some(1e-4) };

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
    /// The largest weight of a sample at these numbers.
    pub(crate) weight_bound: fn(&[f32]) -> f64,
    /// Whether the sampler is one to one at these numbers.
    pub(crate) one_to_one: fn(&[f32]) -> bool,
    /// The textbook's answer: parameters, wo, wi to f_cos and pdf.
    pub(crate) oracle: fn(&[f64], Dir, Dir) -> Worth,
}

impl Species {
    /// Whether its first two numbers are widths.
    pub(crate) fn has_width(&self) -> bool {
        self.parameters[0].log_from == ALPHA.log_from
    }
}

macro_rules! species {
    ($name:ident, $text:literal, $build:ident, $oracle:path, [$($parameter:expr),*]) => {
        species!($name, $text, $build, $oracle, [$($parameter),*], |_| 1.0, |_| true);
    };
    ($name:ident, $text:literal, $build:ident, $oracle:path, [$($parameter:expr),*], $weight:expr, $one_to_one:expr) => {
        /// See the builder of the same name.
        pub(crate) static $name: Species = Species {
            name: $text,
            parameters: &[$($parameter),*],
            single: $build,
            double: $build,
            lanes: $build,
            weight_bound: $weight,
            one_to_one: $one_to_one,
            oracle: $oracle,
        };
    };
}
species!(LAMBERT, "lambert", lambert, oracle::lambert, [UNIT, UNIT, UNIT]);
species!(MIRROR, "mirror", mirror, oracle::mirror, [UNIT, UNIT, UNIT]);
species!(METAL, "conductor", metal, oracle::metal, [ALPHA, ALPHA, ETA, ETA, ETA, EXTINCTION, EXTINCTION, EXTINCTION]);
species!(SCHLICK, "conductor-schlick", schlick, oracle::schlick, [ALPHA, ALPHA, UNIT, UNIT, UNIT]);
species!(
    PHONG_LECTURE,
    "phong-lecture",
    phong_lecture,
    oracle::phong_lecture,
    [UNIT, UNIT, UNIT, EXPONENT],
    |p| phong_weight(p, 1.0),
    one_part
);
species!(
    PHONG_LAFORTUNE,
    "phong-lafortune",
    phong_lafortune,
    oracle::phong_lafortune,
    [UNIT, UNIT, UNIT, EXPONENT],
    |p| phong_weight(p, (f64::from(p[3]) + 2.0) / (f64::from(p[3]) + 1.0)),
    one_part
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
    let fresnel = Fresnel::Conductor { eta: rgb(&p[2..]), k: rgb(&p[5..]) };
    Conductor::new(Ggx { alpha_x: p[0], alpha_y: p[1] }, fresnel).into()
}
fn schlick<R: Real>(p: &[R]) -> AnyLobe<R> {
    Conductor::new(Ggx { alpha_x: p[0], alpha_y: p[1] }, Fresnel::Schlick { f0: rgb(&p[2..]) }).into()
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
/// max(k_d/p_d, k_s/p_s · excess) over channels.
fn phong_weight(p: &[f32], excess: f64) -> f64 {
    let phong = phong(&[p[0], p[1], p[2], p[3]].map(f64::from), PhongNorm::Lecture);
    let part = |k: Rgb<f64>| if k.luminance() > 0.0 { k.largest() / k.luminance() } else { 0.0 };
    // Their luminances add up to 1, and so do the probabilities.
    part(phong.diffuse).max(part(phong.glossy) * excess)
}
fn one_part(p: &[f32]) -> bool {
    p[..3] == [0.0; 3] || p[..3] == [1.0; 3]
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
impl InZoo for Conductor<f32> {
    const SPECIES: &'static [&'static Species] = &[&METAL, &SCHLICK];
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
    /// The directional albedo, where it is known exactly.
    pub(crate) albedo: Option<[f64; 3]>,
}

impl Row {
    /// The surface in `f32`.
    pub(crate) fn single(&self) -> Surface<f32> {
        self.lobes.iter().fold(Surface::black(), |s, (w, species, p)| s.with(*w, (species.single)(p)))
    }
    /// The surface in `f64`, of exactly the same numbers.
    pub(crate) fn double(&self) -> Surface<f64> {
        self.lobes.iter().fold(Surface::black(), |s, (w, species, p)| {
            let p: Vec<f64> = p.iter().copied().map(f64::from).collect();
            s.with(f64::from(*w), (species.double)(&p))
        })
    }
    /// The largest weight of each lobe.
    pub(crate) fn weight_bounds(&self) -> Vec<f64> {
        self.lobes.iter().map(|(_, species, p)| (species.weight_bound)(p)).collect()
    }
    /// The surface in lanes, all alike.
    pub(crate) fn lanes(&self) -> Surface<F32x8> {
        self.lobes.iter().fold(Surface::black(), |s, (w, species, p)| {
            let p: Vec<F32x8> = p.iter().copied().map(F32x8::splat).collect();
            s.with(F32x8::splat(*w), (species.lanes)(&p))
        })
    }
    /// The numbers behind a single lobe of weight 1.
    pub(crate) fn only(&self) -> Option<(&'static Species, &[f32])> {
        match &self.lobes[..] {
            [(weight, species, p)] if *weight == 1.0 => Some((species, p)),
            _ => None,
        }
    }
    /// Whether all lobes are purely discrete.
    pub(crate) fn is_discrete(&self) -> bool {
        self.lobes.iter().all(|(_, species, _)| species.name == "mirror")
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
    // Lambert and mirror return ρ at every angle, so what is made of them has a known albedo.
    let known = lobes.iter().all(|(_, s, _)| s.name == "lambert" || s.name == "mirror");
    let albedo =
        known.then(|| std::array::from_fn(|c| lobes.iter().map(|(w, _, p)| f64::from(*w) * f64::from(p[c])).sum()));
    Row { name: name.into(), lobes, albedo }
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
    let sharp: &[f32] = &[0.03, 0.3, 0.9, 0.6, 0.4];
    let wide: &[f32] = &[0.5, 0.5, 0.04, 0.04, 0.04];
    let gold: Vec<f32> = [0.2, 0.2].into_iter().chain(GOLD).collect();
    rows.extend([
        row("half lambert half mirror", &[(0.5, &LAMBERT, &WHITE), (0.5, &MIRROR, &WHITE)]),
        row("mirror before lambert", &[(0.25, &MIRROR, &COLOUR), (0.75, &LAMBERT, &COLOUR)]),
        row("phong over mirror", &[(0.5, &PHONG_LAFORTUNE, &[0.5, 0.25, 0.125, 30.0]), (0.5, &MIRROR, &WHITE)]),
        row("two mirrors", &[(0.25, &MIRROR, &COLOUR), (0.5, &MIRROR, &WHITE)]),
        row("lambert weight 0.3", &[(0.3, &LAMBERT, &COLOUR)]),
        row("lambert weight 0", &[(0.0, &LAMBERT, &WHITE)]),
        row("conductor over lambert", &[(0.4, &SCHLICK, sharp), (0.6, &LAMBERT, &COLOUR)]),
        row("conductor weight 0, lambert", &[(0.0, &SCHLICK, sharp), (1.0, &LAMBERT, &COLOUR)]),
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
