//! `Subject`: a model with its probes and with what is claimed of it.

use crate::probe::{LobeProbe, Probe, SurfaceProbe};
use crate::zoo::Row;
use gonio_kernel::Lobe;

/// What is claimed of a model, beyond the laws that hold for all.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Claims {
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
    /// No lobe has a positive weight: nothing is ever sampled.
    pub(crate) empty: bool,
}

/// A model, measurable.
pub(crate) struct Subject<'a> {
    /// Its name.
    pub(crate) name: String,
    /// In `f32`.
    pub(crate) single: Option<Box<dyn Probe + 'a>>,
    /// In `f64`.
    pub(crate) double: Option<Box<dyn Probe + 'a>>,
    /// What is claimed of it.
    pub(crate) claims: Claims,
}

impl<'a> Subject<'a> {
    /// A row of the zoo.
    pub(crate) fn of_row(row: &Row) -> Self {
        let claims = Claims {
            albedo: row.albedo,
            one_to_one: row.only().is_some() && !row.is_discrete(),
            symmetric: true,
            one_event: row.only().is_some() && row.is_discrete(),
            discrete: row.is_discrete(),
            empty: row.lobes.iter().all(|(weight, ..)| *weight == 0.0),
        };
        Self {
            name: row.name.clone(),
            single: Some(Box::new(SurfaceProbe::new(row.single(), Some(row.lanes())))),
            double: Some(Box::new(SurfaceProbe::new(row.double(), None))),
            claims,
        }
    }

    /// A user's lobe in `f32`.
    pub(crate) fn of_lobe<L: Lobe<f32> + Sync>(name: &str, lobe: &'a L) -> Self {
        let single: Box<dyn Probe + 'a> = Box::new(LobeProbe::<f32, L>::new(lobe));
        Self { name: name.to_owned(), single: Some(single), double: None, claims: Claims::default() }
    }

    /// The subject in each precision that it has.
    pub(crate) fn views(&self) -> impl Iterator<Item = View<'_>> {
        [&self.single, &self.double].into_iter().flatten().map(|probe| View {
            probe: probe.as_ref(),
            reference: self.double.as_deref().unwrap_or(probe.as_ref()),
            claims: self.claims,
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
    /// What is claimed of it.
    pub(crate) claims: Claims,
}

impl<'a> View<'a> {
    /// One probe that is its own reference.
    pub(crate) fn alone(probe: &'a dyn Probe, claims: Claims) -> Self {
        Self { probe, reference: probe, claims }
    }
    /// The precision as a suffix of a name.
    pub(crate) fn precision(&self) -> &'static str {
        if self.probe.single() { "f32" } else { "f64" }
    }
}
