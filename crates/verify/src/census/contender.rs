//! Who is looked at: a backend by its name, how it is built, and the standard that it is held to.

use super::faults::Fault;
use super::specimen::Specimen;
use super::standard::Standard;
use crate::error::Error;
use gonio_accel::{Accel, Geometry, Hit8, Intersect, Opacity, Ray8, RayKind};
use gonio_kernel::Mask8;
use gonio_tracer::Backend;

/// How a backend is built over a geometry.
type Build<'a> = Box<dyn Fn(&Geometry) -> Result<Box<dyn Accel>, Box<dyn std::error::Error + Send + Sync>> + 'a>;

/// A backend that takes part in a census: it is built anew at every scale.
pub struct Contender<'a> {
    name: String,
    standard: Standard,
    build: Build<'a>,
    fault: Option<&'static Fault>,
}

impl<'a> Contender<'a> {
    /// A backend of any kind.
    pub fn new(
        name: &str,
        standard: Standard,
        build: impl Fn(&Geometry) -> Result<Box<dyn Accel>, Box<dyn std::error::Error + Send + Sync>> + 'a,
    ) -> Self {
        Self { name: name.to_owned(), standard, build: Box::new(build), fault: None }
    }

    /// A backend of this build, of which its usual standard is required.
    pub fn of_backend(backend: Backend, intersect: Intersect) -> Self {
        let build = move |geometry: &Geometry| Ok(backend.build(geometry, intersect)?);
        Self::new(&backend.to_string(), Standard::of(backend, intersect), build)
    }

    /// The same, made wrong on purpose: a census must notice it.
    #[must_use]
    pub fn with_fault(self, fault: &'static Fault) -> Self {
        Self { fault: Some(fault), ..self }
    }

    /// The backend, built over a specimen.
    pub(crate) fn witness(&self, specimen: &Specimen) -> Result<Witness<'static>, Error> {
        let right = (self.build)(&specimen.geometry).map_err(Error::Backend)?;
        let accel = match self.fault {
            Some(fault) => (fault.plant)(right, specimen.scale),
            None => right,
        };
        Ok(Witness { name: self.name.clone(), accel, standard: self.standard })
    }
}

/// A backend under observation.
pub(crate) struct Witness<'a> {
    pub(crate) name: String,
    pub(crate) accel: Box<dyn Accel + 'a>,
    pub(crate) standard: Standard,
}

/// A backend that belongs to somebody else.
pub(super) struct Borrowed<'a>(pub(super) &'a dyn Accel);

impl Accel for Borrowed<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn closest(&self, kind: RayKind, rays: &[Ray8], hits: &mut [Hit8]) {
        self.0.closest(kind, rays, hits);
    }

    fn occluded(&self, kind: RayKind, rays: &[Ray8], filter: Option<&dyn Opacity>, blocked: &mut [Mask8]) {
        self.0.occluded(kind, rays, filter, blocked);
    }
}
