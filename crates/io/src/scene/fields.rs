//! A table of the scene file as the fields of a part of the scene.

use std::ops::RangeInclusive;

use glam::DVec3;
use gonio_kernel::Rgb;
use gonio_tracer::scene::fields::{Fields, Refusal};

use super::document::{Table, Value};
use crate::SceneError;

/// Reads a part of the scene from a table, which may hold no other keys.
pub(super) fn read<T>(
    table: &mut Table<'_>,
    read: impl FnOnce(&mut dyn Fields) -> Result<T, Refusal>,
) -> Result<T, SceneError> {
    let part = read(table).map_err(|refusal| match refusal.downcast::<SceneError>() {
        Ok(error) => *error,
        Err(other) => table.error(other.to_string()),
    })?;
    table.finish()?;
    Ok(part)
}

impl<'d> Table<'d> {
    fn read<T>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Value<'d>) -> Result<T, SceneError>,
    ) -> Result<Option<T>, Refusal> {
        Ok(self.get(key).as_ref().map(read).transpose()?)
    }
}

impl Fields for Table<'_> {
    fn number(&mut self, key: &'static str, range: RangeInclusive<f64>) -> Result<Option<f64>, Refusal> {
        self.read(key, |value| value.number(range))
    }
    fn integer(&mut self, key: &'static str, range: RangeInclusive<u64>) -> Result<Option<u64>, Refusal> {
        self.read(key, |value| value.integer(range))
    }
    fn boolean(&mut self, key: &'static str) -> Result<Option<bool>, Refusal> {
        self.read(key, Value::boolean)
    }
    fn color(&mut self, key: &'static str, range: RangeInclusive<f64>) -> Result<Option<Rgb<f32>>, Refusal> {
        self.read(key, |value| value.rgb(range))
    }
    fn vector(&mut self, key: &'static str) -> Result<Option<DVec3>, Refusal> {
        self.read(key, Value::vector)
    }
    fn refuse(&self, key: &'static str, why: String) -> Refusal {
        self.get(key)
            .map_or_else(|| self.error(format!("{} {why}", self.name())), |value| value.error(why.clone()))
            .into()
    }
}
