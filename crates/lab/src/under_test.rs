//! `UnderTest`: a lobe with its probes, with what it claims of itself, and with its integrals at the four views.

use crate::cells::Cells;
use crate::directions::{VIEWS, any_above, partner};
use crate::probe::{Dir, Kind, LobeProbe, Probe, demote, promote};
use crate::quadrature::Integral;
use crate::random::{Random, direction, seed_for};
use crate::test_bsdf::{DynBsdf, Number};
use gonio_kernel::model::Role;
use gonio_kernel::{Lobe, Properties, Rgb, Vec3};
use std::sync::OnceLock;

/// Of a lesser alpha a lobe is narrower than the lattice of f32 directions and has no shape there.
pub(crate) const NARROWEST: f32 = 1e-4;

/// What is claimed of a lobe, beyond the laws that hold for all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claims {
    /// What it says of itself. Laws that it says it breaks are measured to be broken.
    pub(crate) properties: Properties<f64>,
    /// A single delta event, sampled with probability 1.
    pub(crate) one_event: bool,
    /// Returns nothing: all delta, its events need never be sampled.
    pub(crate) empty: bool,
}

impl Claims {
    /// Nothing but the laws.
    pub(crate) const LAWFUL: Self = Self { properties: Properties::LAWFUL, one_event: false, empty: false };

    /// What a lobe says, and what its samples show of its delta events.
    fn of(properties: Properties<f64>, probe: &dyn Probe) -> Self {
        let symmetric = properties.reciprocal && properties.symmetric;
        let mut claims = Self { properties: Properties { symmetric, ..properties }, ..Self::LAWFUL };
        if properties.all_delta {
            let mut random = Random::new(seed_for(0, "delta events"));
            let mut lobes = Vec::new();
            claims.empty = true;
            for _ in 0..256 {
                let draw = probe.sample(probe.snap(random.above()), random.sampler_input(probe.single()));
                let Kind::Delta(value, (lobe, _)) = draw.kind else { continue };
                lobes.push(lobe);
                claims.empty &= value.f_cos == [0.0; 3];
            }
            claims.one_event = !properties.transmits && lobes.windows(2).all(|pair| pair[0] == pair[1]);
        }
        claims
    }
}

/// A lobe, measurable.
pub(crate) struct UnderTest<'a> {
    /// Its name.
    pub(crate) name: String,
    /// In `f32`.
    pub(crate) single: Option<Box<dyn Probe + 'a>>,
    /// In `f64`.
    pub(crate) double: Option<Box<dyn Probe + 'a>>,
    /// In `f64`, each with one number moved to the next `f32`.
    pub(crate) nudged: Vec<Box<dyn Probe + 'a>>,
    /// What is claimed of it.
    pub(crate) claims: Claims,
    /// Cells and integrals at each view: made by the first instrument that asks, the same for all of them.
    prepared: [OnceLock<Prepared>; VIEWS.len()],
}

/// A view with the cells that follow the lobe there and the integrals over them.
#[derive(Debug)]
pub(crate) struct Prepared {
    /// The view in words.
    pub(crate) name: String,
    /// Its direction: exact in `f32`, so that both precisions are measured at the same place.
    pub(crate) wo: Dir,
    /// The cells.
    pub(crate) cells: Cells,
    /// The integrals over each.
    pub(crate) integrals: Vec<Integral>,
    /// Their sum.
    pub(crate) total: Integral,
}

impl<'a> UnderTest<'a> {
    /// A probe of either precision that is its own reference.
    pub(crate) fn of_probe(name: &str, probe: impl Probe + 'a, claims: Claims) -> Self {
        let probe: Box<dyn Probe + 'a> = Box::new(probe);
        let (single, double) = if probe.single() { (Some(probe), None) } else { (None, Some(probe)) };
        Self { name: name.to_owned(), single, double, nudged: Vec::new(), claims, prepared: Default::default() }
    }

    /// A lobe that exists in `f32` only.
    pub(crate) fn of_single<L: Lobe<f32> + Sync>(name: &str, lobe: &'a L) -> Self {
        let probe = LobeProbe::<f32, &'a L>::new(lobe);
        let claims = Claims::of(widened(lobe.properties()), &probe);
        Self::of_probe(name, probe, claims)
    }

    /// A lobe in every arithmetic in which it has a shape.
    pub(crate) fn of(name: &str, bsdf: &dyn DynBsdf<'a>) -> Self {
        let numbers = bsdf.numbers();
        let values: Vec<f32> = numbers.iter().map(|number| number.value).collect();
        let under_test = Self::at(name, bsdf, &numbers, &values);
        let narrow = least_alpha(&numbers).is_some_and(|alpha| alpha < NARROWEST);
        if narrow { Self { single: None, ..under_test } } else { under_test }
    }

    /// A lobe at other values of its numbers, also in `f32` where that has no shape: finite and sound it must be nevertheless.
    pub(crate) fn at(name: &str, bsdf: &dyn DynBsdf<'a>, numbers: &[Number], values: &[f32]) -> Self {
        let doubles: Vec<f64> = values.iter().copied().map(f64::from).collect();
        let double = bsdf.double_probe(&doubles);
        let mut nudged = Vec::new();
        for (index, (number, x)) in numbers.iter().zip(values).enumerate() {
            let quantity = number.parameter.quantity;
            for moved in [x.next_up(), x.next_down()].map(f64::from) {
                if quantity.lo <= moved && moved <= quantity.hi {
                    let mut doubles = doubles.clone();
                    doubles[index] = moved;
                    nudged.push(bsdf.double_probe(&doubles));
                }
            }
        }
        Self {
            name: name.to_owned(),
            single: Some(bsdf.single_probe(values)),
            claims: Claims::of(bsdf.properties_at(&doubles), double.as_ref()),
            double: Some(double),
            nudged,
            prepared: Default::default(),
        }
    }

    /// It in each precision that it has.
    pub(crate) fn views(&self) -> impl Iterator<Item = View<'_>> {
        [&self.single, &self.double].into_iter().flatten().map(|probe| View {
            probe: probe.as_ref(),
            reference: self.double.as_deref().unwrap_or(probe.as_ref()),
            nudged: &self.nudged,
            claims: self.claims,
            has_single: self.single.is_some(),
            prepared: &self.prepared,
        })
    }
}

/// A lobe in one precision, with the most precise form of the same lobe as its reference.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// What is measured.
    pub(crate) probe: &'a dyn Probe,
    /// What it is compared with: the `f64` form where there is one, else the probe itself.
    pub(crate) reference: &'a dyn Probe,
    /// The reference with one number moved by one unit in the last place of `f32`.
    pub(crate) nudged: &'a [Box<dyn Probe + 'a>],
    /// What is claimed of it.
    pub(crate) claims: Claims,
    /// Whether there is a form in `f32`.
    pub(crate) has_single: bool,
    prepared: &'a [OnceLock<Prepared>; VIEWS.len()],
}

impl<'a> View<'a> {
    /// The four views, with cells and integrals of the reference.
    pub(crate) fn prepared(&self) -> impl Iterator<Item = &'a Prepared> {
        let (reference, transmits, has_single) = (self.reference, self.claims.properties.transmits, self.has_single);
        let rounded = move |w: Dir| if has_single { promote(demote(w)) } else { w };
        VIEWS.iter().zip(self.prepared).enumerate().map(move |(index, (&(cos, phi), slot))| {
            slot.get_or_init(|| {
                // Exact in f32, and unit beyond it: z is chosen after x and y were rounded. At 89° an error of 6e-8 in |wo|
                // tilts the half vector by 2 % of a lobe of alpha 1e-4, which is a true difference of sample and density.
                let w = rounded(direction(cos, phi));
                let z = (1.0 - w.x * w.x - w.y * w.y).max(0.0).sqrt();
                // What transmits is seen from below at every other view.
                let below = transmits && index % 2 == 1;
                let wo = rounded(Vec3::new(w.x, w.y, if below { -z } else { z }));
                let theta = if below { std::f64::consts::PI - cos.acos() } else { cos.acos() };
                let name = format!("wo at {:.0}°, azimuth {:.0}°", theta.to_degrees(), phi.to_degrees());
                // The pilot only places borders, so it may be the same in every run.
                let cells = Cells::following(reference, wo, &mut Random::new(seed_for(0, &name)));
                let integrals = cells.integrate(reference, wo);
                let total = Cells::total(&integrals);
                Prepared { name, wo, cells, integrals, total }
            })
        })
    }
    /// Two directions of the lattice as sweeps want them: wo of every difficult kind, wi any, near the mirror direction, near
    /// wo, or sampled; on every side if light passes through. None if one lies in the surface.
    pub(crate) fn pair(&self, random: &mut Random) -> Option<(Dir, Dir)> {
        let side = |w: Dir, random: &mut Random| {
            let down = self.claims.properties.transmits && random.bits().is_multiple_of(2);
            self.probe.snap(Vec3::new(w.x, w.y, if down { -w.z } else { w.z }))
        };
        let above = any_above(random);
        let beside = partner(random, above);
        let (wo, mut wi) = (side(above, random), side(beside, random));
        if random.bits().is_multiple_of(4) {
            let draw = self.probe.sample(wo, random.sampler_input(self.probe.single()));
            if draw.kind == Kind::Continuous {
                wi = draw.wi;
            }
        }
        let inside = |w: Dir| w.z > 0.0 || (self.claims.properties.transmits && w.z < 0.0);
        (inside(wo) && inside(wi)).then_some((wo, wi))
    }
    /// wo of every difficult kind, from below too if light passes through.
    pub(crate) fn any_wo(&self, random: &mut Random) -> Dir {
        let w = any_above(random);
        let down = self.claims.properties.transmits && random.bits().is_multiple_of(2);
        self.probe.snap(if down { Vec3::new(w.x, w.y, -w.z) } else { w })
    }
    /// The precision as a suffix of a name.
    pub(crate) fn precision(&self) -> &'static str {
        if self.probe.single() { "f32" } else { "f64" }
    }
}

/// The least alpha of its microfacets; none if it has none.
pub(crate) fn least_alpha(numbers: &[Number]) -> Option<f32> {
    let alphas = numbers.iter().filter(|number| number.is(Role::Alpha)).map(|number| number.value);
    alphas.min_by(f32::total_cmp)
}

/// The same claims, their albedo in `f64`.
fn widened(properties: Properties<f32>) -> Properties<f64> {
    let Properties { reciprocal, conserving, excess, units, has_delta, all_delta, .. } = properties;
    let Properties { anisotropic, transmits, one_to_one, symmetric, albedo, albedo_error, .. } = properties;
    Properties {
        reciprocal,
        conserving,
        excess,
        units,
        has_delta,
        all_delta,
        anisotropic,
        transmits,
        one_to_one,
        symmetric,
        albedo: albedo.map(|albedo: Rgb<f32>| albedo.map(f64::from)),
        albedo_error,
    }
}
