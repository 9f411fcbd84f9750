//! A world with the acceleration structure that belongs to it.

use crate::backend::{Backend, BackendError};
use crate::scene::Loading;
use crate::world::World;
use gonio_accel::{Accel, Geometry, Intersect};
use std::fmt;
use std::sync::Arc;

/// A world and what casts its rays: made together, so that they cannot be of different scenes. The example of the crate
/// makes one.
pub struct Prepared {
    world: Arc<World>,
    accel: Box<dyn Accel>,
}

impl Prepared {
    /// Builds the backend's structure over the world.
    ///
    /// # Errors
    /// If the backend lacks something that it needs, such as memory or its library.
    pub fn new(world: impl Into<Arc<World>>, backend: Backend, intersect: Intersect) -> Result<Self, BackendError> {
        Self::new_with(world, backend, intersect, &mut |_| ())
    }

    /// Like [`Prepared::new`]; `progress` is told of how many triangles it is done, by those backends that know.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn new_with(
        world: impl Into<Arc<World>>,
        backend: Backend,
        intersect: Intersect,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Self, BackendError> {
        Self::by(world, |geometry| backend.build_with(geometry, intersect, progress))
    }

    /// Builds a structure of one's own over the world's triangles.
    ///
    /// # Errors
    /// What `build` says.
    pub fn by<E>(
        world: impl Into<Arc<World>>,
        build: impl FnOnce(&Geometry) -> Result<Box<dyn Accel>, E>,
    ) -> Result<Self, E> {
        let world = world.into();
        Ok(Self { accel: build(world.geometry())?, world })
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What casts its rays.
    pub fn accel(&self) -> &dyn Accel {
        &*self.accel
    }
}

impl fmt::Debug for Prepared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prepared").field("world", &self.world).finish_non_exhaustive()
    }
}
