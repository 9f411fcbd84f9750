//! What a scene may hold, whether it is built in code or read from files.

use glam::DVec3;
use std::ops::RangeInclusive;

/// Largest radiance a material or the environment may have: the film's range ends a little above.
pub const MAX_RADIANCE: f64 = 1e6;
/// Largest intensity of a light: 10⁶ W/(m² sr) over a square kilometre.
pub const MAX_INTENSITY: f64 = 1e12;
/// Largest number of materials: an index fits sixteen bits.
pub const MAX_MATERIALS: usize = 65_535;
/// Size of a scene in metres, along its longest axis: outside, products of four lengths leave the range of f32.
pub const EXTENT: RangeInclusive<f64> = 1e-6..=1e9;

/// Whether the corners of a triangle span more than the rounding of their coordinates. What does not is left out.
pub fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let largest = a.abs().max(b.abs()).max(c.abs()).max_element();
    let edge = (b - a).length().max((c - a).length()).max((c - b).length());
    (b - a).cross(c - a).length() > 4.0 * f64::EPSILON * largest * edge
}
