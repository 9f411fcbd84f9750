//! `transform` of a mesh: steps applied in the order they are written.

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::document::Value;
use crate::SceneError;

/// Reads a list of steps, e.g. `[{ scale = 2 }, { rotate = { axis = [0, 1, 0], degrees = 30 } }]`.
///
/// # Errors
/// A malformed step, or a result that is not finite or squeezes space flat.
pub(super) fn read(value: &Value<'_>) -> Result<DAffine3, SceneError> {
    let mut whole = DAffine3::IDENTITY;
    for item in value.array()? {
        whole = step(&item)? * whole;
    }
    let columns = whole.matrix3;
    let volume = columns.x_axis.length() * columns.y_axis.length() * columns.z_axis.length();
    // 1e-12: flatter than that, and f32 cannot tell it from a plane.
    let flat = columns.determinant().abs() <= 1e-12 * volume || !whole.inverse().is_finite();
    if !whole.is_finite() || !volume.is_finite() || flat {
        return Err(value.error("the transform cannot be inverted: it is not finite or squeezes space flat"));
    }
    Ok(whole)
}

fn step(item: &Value<'_>) -> Result<DAffine3, SceneError> {
    let table = item.table("a step of the transform")?;
    let found = [table.get("scale"), table.get("rotate"), table.get("translate"), table.get("matrix")];
    table.finish()?;
    match found {
        [Some(scale), None, None, None] => factors(&scale).map(DAffine3::from_scale),
        [None, Some(rotate), None, None] => rotation(&rotate),
        [None, None, Some(offset), None] => offset.vector().map(DAffine3::from_translation),
        [None, None, None, Some(rows)] => matrix(&rows),
        _ => Err(item.error("a step has exactly one of \"scale\", \"rotate\", \"translate\", \"matrix\"")),
    }
}

fn factors(value: &Value<'_>) -> Result<DVec3, SceneError> {
    let factors = match value.array() {
        Ok(_) => value.vector()?,
        Err(_) => DVec3::splat(value.number(-1e12..=1e12)?),
    };
    if factors.cmpeq(DVec3::ZERO).any() {
        return Err(value.error("a scale of 0 squeezes space flat"));
    }
    Ok(factors)
}

fn rotation(value: &Value<'_>) -> Result<DAffine3, SceneError> {
    let table = value.table("\"rotate\"")?;
    let (axis, degrees) = (table.get("axis"), table.get("degrees"));
    table.finish()?;
    let (Some(axis), Some(degrees)) = (axis, degrees) else {
        return Err(value.error("\"rotate\" needs \"axis\" and \"degrees\""));
    };
    let angle = degrees.number(-1e6..=1e6)?.to_radians();
    let direction = axis.vector()?.try_normalize().ok_or_else(|| axis.error("\"axis\" has no length"))?;
    Ok(DAffine3::from_quat(DQuat::from_axis_angle(direction, angle)))
}

fn matrix(value: &Value<'_>) -> Result<DAffine3, SceneError> {
    let rows = value.numbers::<16>(-1e12..=1e12)?;
    if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(value.error("the last row of \"matrix\" must be 0, 0, 0, 1"));
    }
    Ok(DAffine3::from_mat4(DMat4::from_cols_array(&rows).transpose()))
}
