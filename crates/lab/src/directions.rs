//! Directions that instruments look from and along: fixed views for integrals, random ones of every difficult kind for sweeps.

use crate::probe::Dir;
use crate::random::{Random, direction};
use gonio_kernel::Vec3;

/// The views of the integral instruments: cosine to the normal and azimuth. Near the normal, at 45°, 80° and 89°, with
/// azimuths off the axes and in four quadrants, so that a wrong sign or a swapped axis shows.
pub(crate) const VIEWS: [(f64, f64); 4] = [(0.999, 0.65), (0.707, 2.2), (0.1736, 4.0), (0.01745, 5.5)];

/// A direction above the surface: uniform, near the horizon (down to cosθ = 10⁻⁸), near the normal, or along an axis.
pub(crate) fn any_above(random: &mut Random) -> Dir {
    let phi = random.between(0.0, std::f64::consts::TAU);
    match random.bits() % 8 {
        0..4 => random.above(),
        4..6 => direction(random.log_between(1e-8, 1.0), phi),
        6 => {
            let sin = random.log_between(1e-8, 1.0);
            Vec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - sin * sin).sqrt())
        }
        _ => {
            let cos = random.pick(&[1.0, 0.6, 1e-3]);
            let sin = (1.0_f64 - cos * cos).sqrt();
            let (x, y) = random.pick(&[(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]);
            Vec3::new(sin * x, sin * y, cos)
        }
    }
}

/// A partner of wo above the surface: as [`any_above`], or near the mirror direction, or near wo itself.
pub(crate) fn partner(random: &mut Random, wo: Dir) -> Dir {
    let near = match random.bits() % 4 {
        0 | 1 => return any_above(random),
        2 => Vec3::new(-wo.x, -wo.y, wo.z),
        _ => wo,
    };
    let distance = random.log_between(1e-6, 1.0);
    let mut offset = || random.between(-distance, distance);
    let moved = near + Vec3::new(offset(), offset(), offset());
    Vec3::new(moved.x, moved.y, moved.z.abs().max(1e-12)).normalize()
}

/// A direction as text for the detail of a check.
pub(crate) fn show(w: Dir) -> String {
    format!("({:.6e}, {:.6e}, {:.6e})", w.x, w.y, w.z)
}
