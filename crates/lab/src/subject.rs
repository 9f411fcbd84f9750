//! `Subject`: a model with its probes, with what is claimed of it, and with its integrals at the four views.

use crate::anatomy;
use crate::cells::Cells;
use crate::directions::{VIEWS, any_above, partner};
use crate::probe::{Dir, Kind, LobeProbe, Probe, SurfaceProbe, demote, promote};
use crate::quadrature::Integral;
use crate::random::{Random, direction, seed_for};
use gonio_kernel::{Lobe, Properties, Rgb, Surface, Vec3};
use std::sync::OnceLock;

/// Narrower than the lattice of f32 directions a lobe has no shape there.
pub(crate) const NARROWEST: f32 = 1e-4;

/// What is claimed of a model, beyond the laws that hold for all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claims {
    /// Which laws it says it obeys: those that it says it breaks are measured to be broken.
    pub(crate) properties: Properties,
    /// The directional albedo, where it is known exactly.
    pub(crate) albedo: Option<[f64; 3]>,
    /// A single continuous lobe whose sampler maps the unit square to directions one to one: then pdf · |∂ω/∂u| = 1.
    pub(crate) one_to_one: bool,
    /// Written so that exchanging the directions exchanges commutative operands only: see the reciprocity instrument.
    pub(crate) symmetric: bool,
    /// A single discrete event, sampled with probability 1.
    pub(crate) one_event: bool,
    /// Purely discrete.
    pub(crate) discrete: bool,
    /// Scatters to the other side, and from there.
    pub(crate) transmits: bool,
    /// How far the albedo may lie from its known value.
    pub(crate) slack: f64,
    /// No lobe has a positive weight: nothing is ever sampled.
    pub(crate) empty: bool,
}

impl Claims {
    /// Nothing but the laws.
    pub(crate) const LAWFUL: Self = Self {
        properties: Properties::LAWFUL,
        albedo: None,
        one_to_one: false,
        symmetric: false,
        one_event: false,
        discrete: false,
        transmits: false,
        slack: 0.0,
        empty: false,
    };
}

/// A model, measurable.
pub(crate) struct Subject<'a> {
    /// Its name.
    pub(crate) name: String,
    /// In `f32`.
    pub(crate) single: Option<Box<dyn Probe + 'a>>,
    /// In `f64`.
    pub(crate) double: Option<Box<dyn Probe + 'a>>,
    /// In `f64`, each with one parameter moved to the next `f32`.
    pub(crate) nudged: Vec<Box<dyn Probe + 'a>>,
    /// What is claimed of it.
    pub(crate) claims: Claims,
    /// Cells and integrals at each view: made by the first instrument that asks, the same for all of them.
    prepared: [OnceLock<Prepared>; VIEWS.len()],
}

/// A view with the cells that follow the model there and the integrals over them.
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

impl<'a> Subject<'a> {
    /// A probe of either precision that is its own reference.
    pub(crate) fn of_probe(name: &str, probe: impl Probe + 'a, claims: Claims) -> Self {
        let probe: Box<dyn Probe + 'a> = Box::new(probe);
        let (single, double) = if probe.single() { (Some(probe), None) } else { (None, Some(probe)) };
        Self { name: name.to_owned(), single, double, nudged: Vec::new(), claims, prepared: Default::default() }
    }

    /// A user's lobe in `f32`.
    pub(crate) fn of_lobe<L: Lobe<f32> + Sync>(name: &str, lobe: &'a L) -> Self {
        let claims = Claims { properties: lobe.properties(), ..Claims::LAWFUL };
        Self::of_probe(name, LobeProbe::<f32, L>::new(lobe), claims)
    }

    /// A surface of the kernel's lobes, in every arithmetic in which it has a shape.
    pub(crate) fn of_surface(name: &str, surface: &Surface<f32>) -> Self {
        let subject = Self::of_surface_at_any_width(name, surface);
        let narrow = anatomy::least_width(surface) < NARROWEST;
        if narrow { Self { single: None, ..subject } } else { subject }
    }

    /// The same, also in `f32` where that has no shape: finite and sound it must be nevertheless.
    pub(crate) fn of_surface_at_any_width(name: &str, surface: &Surface<f32>) -> Self {
        let lobes: Vec<_> = surface.lobes().map(|l| (f64::from(l.weight), &l.lobe)).collect();
        let only = match lobes[..] {
            [(1.0, lobe)] => Some(lobe),
            _ => None,
        };
        let albedo = lobes.iter().try_fold([0.0; 3], |sum, (weight, lobe)| {
            let Rgb { r, g, b } = anatomy::known_albedo(lobe)?;
            Some([sum[0] + weight * r, sum[1] + weight * g, sum[2] + weight * b])
        });
        let transmits = lobes.iter().any(|(_, lobe)| anatomy::transmits(lobe));
        let discrete = lobes.iter().all(|(_, lobe)| anatomy::is_discrete(lobe));
        let properties = surface.properties();
        let claims = Claims {
            properties,
            albedo,
            one_to_one: only.is_some_and(anatomy::one_to_one),
            symmetric: properties.reciprocal && lobes.iter().all(|(_, lobe)| anatomy::symmetric(lobe)),
            one_event: only.is_some() && discrete && !transmits,
            discrete,
            transmits,
            slack: lobes.iter().map(|(weight, lobe)| weight * anatomy::slack(lobe)).sum(),
            empty: lobes.iter().all(|(weight, _)| *weight == 0.0),
        };
        let bounds: Vec<f64> = lobes.iter().map(|(_, lobe)| anatomy::largest_weight(lobe)).collect();
        let double = |surface: Surface<f64>| -> Box<dyn Probe> {
            Box::new(SurfaceProbe::new(surface, None).with_weight_bounds(bounds.clone()))
        };
        Self {
            name: name.to_owned(),
            single: Some(Box::new(
                SurfaceProbe::new(*surface, Some(anatomy::converted(surface))).with_weight_bounds(bounds.clone()),
            )),
            double: Some(double(anatomy::converted(surface))),
            nudged: anatomy::nudged(surface).into_iter().map(double).collect(),
            claims,
            prepared: Default::default(),
        }
    }

    /// The subject in each precision that it has.
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

/// A subject in one precision, with the most precise form of the same model as its reference.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// What is measured.
    pub(crate) probe: &'a dyn Probe,
    /// What it is compared with: the `f64` form where there is one, else the probe itself.
    pub(crate) reference: &'a dyn Probe,
    /// The reference with one parameter moved by one unit in the last place of `f32`.
    pub(crate) nudged: &'a [Box<dyn Probe + 'a>],
    /// What is claimed of it.
    pub(crate) claims: Claims,
    /// Whether the subject has a form in `f32`.
    pub(crate) has_single: bool,
    prepared: &'a [OnceLock<Prepared>; VIEWS.len()],
}

impl<'a> View<'a> {
    /// The four views, with cells and integrals of the reference.
    pub(crate) fn prepared(&self) -> impl Iterator<Item = &'a Prepared> {
        let (reference, transmits, has_single) = (self.reference, self.claims.transmits, self.has_single);
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
            let down = self.claims.transmits && random.bits().is_multiple_of(2);
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
        let inside = |w: Dir| w.z > 0.0 || (self.claims.transmits && w.z < 0.0);
        (inside(wo) && inside(wi)).then_some((wo, wi))
    }
    /// wo of every difficult kind, from below too if light passes through.
    pub(crate) fn any_wo(&self, random: &mut Random) -> Dir {
        let w = any_above(random);
        let down = self.claims.transmits && random.bits().is_multiple_of(2);
        self.probe.snap(if down { Vec3::new(w.x, w.y, -w.z) } else { w })
    }
    /// The precision as a suffix of a name.
    pub(crate) fn precision(&self) -> &'static str {
        if self.probe.single() { "f32" } else { "f64" }
    }
}
