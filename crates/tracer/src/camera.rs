//! The camera: what a scene says of it, what it is where a scene leaves it open (a view of everything), and its rays.

use glam::{DMat4, DVec3};
use gonio_accel::Ray8;
use gonio_kernel::warp::sample_cosine_hemisphere;
use gonio_kernel::{F32x8, Real, Vec3};
use thiserror::Error;

use crate::effects::{Effect, EffectSet};
use crate::scene::FilmSettings;
use crate::scene::fields::{Fields, Refusal};

/// Vertical field of view in degrees: about a 50 mm lens on 35 mm film held upright.
const VFOV: f64 = 40.0;
/// From the target to the camera: right, above and in front, with y up.
const THREE_QUARTER: DVec3 = DVec3::new(0.6, 0.45, 1.0);
/// Room around the scene.
const MARGIN: f64 = 1.08;

/// A camera with a thin lens, or a pinhole. `up` is not parallel to the view direction, and `target` is not `origin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position, in metres.
    pub origin: DVec3,
    /// A point that appears at the centre of the picture, in metres.
    pub target: DVec3,
    /// Points towards the top of the picture; any length above 0.
    pub up: DVec3,
    /// Vertical field of view in degrees, above 0 and below 180.
    pub vfov: f64,
    /// Diameter of the lens \[m\]; 0 for a pinhole, which has everything in focus.
    pub aperture: f64,
    /// Distance of the plane in focus from the camera's plane \[m\], above 0.
    pub focus_distance: f64,
}

/// What a scene says about its camera; what is `None` follows from the scene's bounds.
///
/// ```
/// use glam::DVec3;
/// use gonio_tracer::scene::CameraSpec;
///
/// let camera = CameraSpec::default().complete([DVec3::ZERO, DVec3::ONE], 4.0 / 3.0)?;
/// assert_eq!(camera.target, DVec3::splat(0.5));
/// # Ok::<(), gonio_tracer::scene::CameraError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraSpec {
    /// Position, in metres; otherwise a place from which all of the scene is seen.
    pub origin: Option<DVec3>,
    /// A point that appears at the centre of the picture, in metres; otherwise the middle of the scene.
    pub target: Option<DVec3>,
    /// Points towards the top of the picture; otherwise +y.
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees; otherwise 40.
    pub vfov: Option<f64>,
    /// Diameter of the lens \[m\]; otherwise 0, a pinhole.
    pub aperture: Option<f64>,
    /// Distance of the plane in focus from the camera's plane \[m\]; otherwise that of `target`.
    pub focus_distance: Option<f64>,
}

/// Why a camera has no view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// It looks nowhere.
    #[error("\"origin\" and \"target\" of the camera are the same point")]
    NoDirection,
    /// The top of the picture is nowhere.
    #[error("\"up\" of the camera has no length")]
    NoUp,
    /// The top of the picture is anywhere.
    #[error("\"up\" of the camera is parallel to the view direction")]
    UpAlongView,
}

impl CameraSpec {
    /// What a scene says of it.
    ///
    /// # Errors
    /// What the fields refuse.
    pub fn read(fields: &mut dyn Fields) -> Result<Self, Refusal> {
        Ok(Self {
            origin: fields.vector("origin")?,
            target: fields.vector("target")?,
            up: fields.vector("up")?,
            vfov: fields.number("vfov", 0.01..=179.0)?,
            aperture: fields.number("aperture", 0.0..=1e9)?,
            focus_distance: fields.number("focus_distance", 1e-9..=1e12)?,
        })
    }

    /// Fills in the rest. `bounds` are the least and the largest coordinates of the scene in the world, `aspect` is width
    /// over height.
    ///
    /// # Errors
    /// The view direction has no length, or `up` has none or is parallel to it.
    pub fn complete(self, bounds: [DVec3; 2], aspect: f64) -> Result<Camera, CameraError> {
        let up = self.up.unwrap_or(DVec3::Y);
        let vfov = self.vfov.unwrap_or(VFOV);
        let target = self.target.unwrap_or((bounds[0] + bounds[1]) * 0.5);
        let origin = self.origin.unwrap_or_else(|| framing(target, up, vfov, bounds, aspect));
        let view = (target - origin).try_normalize().ok_or(CameraError::NoDirection)?;
        let sideways = view.cross(up.try_normalize().ok_or(CameraError::NoUp)?);
        if sideways.length() < 1e-6 {
            return Err(CameraError::UpAlongView);
        }
        let pinhole = Camera::pinhole(origin, target, up, vfov);
        Ok(Camera {
            aperture: self.aperture.unwrap_or(pinhole.aperture),
            focus_distance: self.focus_distance.unwrap_or(pinhole.focus_distance),
            ..pinhole
        })
    }
}

impl Camera {
    /// A camera that has everything in focus.
    pub fn pinhole(origin: DVec3, target: DVec3, up: DVec3, vfov: f64) -> Self {
        Self { origin, target, up, vfov, aperture: 0.0, focus_distance: (target - origin).length() }
    }

    /// What it calls for.
    pub(crate) fn effects(&self) -> EffectSet {
        EffectSet::when(self.aperture > 0.0, Effect::DepthOfField)
    }

    /// World to camera, and world to normalized device coordinates, as OpenEXR defines both for row vectors: p·M, rows one
    /// after the other. In camera space x points right, y up and z forward; in the plane of the picture (0, 0) is the upper
    /// left corner and (1, 1) the lower right one, after division by w. `aspect` is width over height.
    pub fn matrices(&self, aspect: f64) -> [[f32; 16]; 2] {
        let forward = (self.target - self.origin).normalize();
        let right = forward.cross(self.up).normalize();
        let axes = [right, right.cross(forward), forward];
        let mut world_to_camera = DMat4::IDENTITY; // as columns, for M·p
        for (row, axis) in axes.into_iter().enumerate() {
            for column in 0..3 {
                world_to_camera.col_mut(column)[row] = axis[column];
            }
            world_to_camera.col_mut(3)[row] = -axis.dot(self.origin);
        }
        let (y, half) = (0.5 / (self.vfov.to_radians() * 0.5).tan(), 0.5);
        let camera_to_picture = DMat4::from_cols_array_2d(&[
            [y / aspect, 0.0, 0.0, 0.0],
            [0.0, -y, 0.0, 0.0],
            [half, half, 1.0, 1.0],
            [0.0, 0.0, -1.0, 0.0], // so that it can be inverted
        ]);
        // Columns one after the other of M·p are the rows of p·M.
        [world_to_camera, camera_to_picture * world_to_camera].map(|m| m.as_mat4().to_cols_array())
    }
}

/// The camera, ready to make rays: origin and the vectors to the middle and to the edges of a picture one unit away.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub(crate) origin: Vec3<f32>,
    pub(crate) forward: Vec3<f32>,
    right: Vec3<f32>,
    up: Vec3<f32>,
    lens: Option<Lens>,
    /// Columns and rows of the picture.
    size: [f32; 2],
}

/// A thin lens: half its width and height as vectors, and the distance at which it is focused.
#[derive(Clone, Copy, Debug)]
struct Lens {
    right: Vec3<f32>,
    up: Vec3<f32>,
    focus: f32,
}

impl View {
    /// The view of a camera in a world whose origin is at `center` of the scene's coordinates.
    pub fn new(camera: &Camera, film: &FilmSettings, center: DVec3) -> Self {
        let forward = (camera.target - camera.origin).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let tan = (camera.vfov.to_radians() * 0.5).tan();
        let aspect = f64::from(film.width) / f64::from(film.height);
        let narrow = |v: DVec3| v.as_vec3().to_array().into();
        Self {
            origin: narrow(camera.origin - center),
            forward: narrow(forward),
            right: narrow(right * tan * aspect),
            up: narrow(up * tan),
            lens: (camera.aperture > 0.0).then(|| Lens {
                right: narrow(right * (0.5 * camera.aperture)),
                up: narrow(up * (0.5 * camera.aperture)),
                focus: camera.focus_distance as f32,
            }),
            size: [film.width as f32, film.height as f32],
        }
    }

    /// All numbers that its rays depend on.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f32> {
        let lens = self.lens.into_iter().flat_map(|l| [l.right.into(), l.up.into(), [l.focus; 3]]).flatten();
        let frame = [self.origin, self.forward, self.right, self.up].into_iter().flat_map(<[f32; 3]>::from);
        frame.chain(self.size).chain(lens)
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> [f32; 2] {
        self.size
    }

    /// The rays through places (x, y) of the picture in pixels, (0, 0) at the top left corner of the top left pixel; `u` are
    /// numbers in [0, 1) that choose a place on the lens, its middle for ½ and ½.
    #[inline(always)]
    pub fn rays(&self, x: F32x8, y: F32x8, u: [F32x8; 2]) -> Ray8 {
        let [width, height] = self.size.map(F32x8::splat);
        let two = F32x8::splat(2.0);
        let (x, y) = (x * two / width - F32x8::ONE, F32x8::ONE - y * two / height);
        let forward = Vec3::broadcast(self.forward);
        let dir = forward.along(x, Vec3::broadcast(self.right)).along(y, Vec3::broadcast(self.up));
        let Some(lens) = self.lens else {
            return Ray8::new(Vec3::broadcast(self.origin), dir.normalize());
        };
        // The x and y of a cosine-distributed direction are uniform on the disk (Malley's method).
        let place = sample_cosine_hemisphere(u);
        let offset = (Vec3::broadcast(lens.right) * place.x).along(place.y, Vec3::broadcast(lens.up));
        // All rays through a place of the picture meet where the pinhole's ray crosses the plane in focus.
        let dir = dir * F32x8::splat(lens.focus) - offset;
        Ray8::new(Vec3::broadcast(self.origin) + offset, dir.normalize())
    }
}

/// The nearest place in the three-quarter direction from which all corners of the bounds are in the picture.
fn framing(target: DVec3, up: DVec3, vfov: f64, bounds: [DVec3; 2], aspect: f64) -> DVec3 {
    let back = THREE_QUARTER.normalize();
    let right = up.cross(back).normalize_or(DVec3::X);
    let top = back.cross(right);
    let tan_y = (vfov.to_radians() * 0.5).tan() / MARGIN;
    let tan_x = tan_y * aspect;
    let mut distance = 0.0_f64;
    for corner in 0..8 {
        let pick = |axis: usize| bounds[(corner >> axis) & 1][axis];
        let offset = DVec3::new(pick(0), pick(1), pick(2)) - target;
        let needed = (offset.dot(right).abs() / tan_x).max(offset.dot(top).abs() / tan_y);
        distance = distance.max(offset.dot(back) + needed);
    }
    target + back * distance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_automatic_camera_sees_every_corner() {
        for aspect in [0.25, 1.0, 4.0] {
            for vfov in [5.0, 40.0, 120.0] {
                let bounds = [DVec3::new(4e6, -1.0, 2.0), DVec3::new(4e6 + 3.0, 5.0, 2.5)];
                let spec = CameraSpec { vfov: Some(vfov), ..CameraSpec::default() };
                let camera = spec.complete(bounds, aspect).unwrap();
                let view = (camera.target - camera.origin).normalize();
                let right = view.cross(camera.up).normalize();
                let top = right.cross(view);
                let tan = (vfov.to_radians() * 0.5).tan();
                for corner in 0..8 {
                    let p = DVec3::from_array(std::array::from_fn(|axis| bounds[(corner >> axis) & 1][axis]));
                    let d = p - camera.origin;
                    assert!(d.dot(view) > 0.0);
                    assert!((d.dot(top) / d.dot(view)).abs() <= tan);
                    assert!((d.dot(right) / d.dot(view)).abs() <= tan * aspect);
                }
            }
        }
    }

    #[test]
    fn matrices_put_the_target_in_the_middle_and_the_edge_at_the_edge() {
        let (origin, target) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, -1.0));
        let camera = Camera::pinhole(origin, target, DVec3::Y, 90.0);
        let [to_camera, to_picture] = camera.matrices(2.0);
        // Row vectors: p·M.
        let apply = |m: [f32; 16], p: DVec3| -> [f32; 4] {
            let p = [p.x as f32, p.y as f32, p.z as f32, 1.0];
            std::array::from_fn(|column| (0..4).map(|row| p[row] * m[row * 4 + column]).sum())
        };
        assert_eq!(apply(to_camera, target + DVec3::new(1.0, 2.0, 0.0)), [1.0, 2.0, 4.0, 1.0]);
        let seen = |p| {
            let [x, y, _, w] = apply(to_picture, p);
            [x / w, y / w]
        };
        assert_eq!(seen(target), [0.5, 0.5]);
        assert_eq!(seen(target + DVec3::new(-8.0, 4.0, 0.0)), [0.0, 0.0]); // 4 away, tan 45° = 1, twice as wide as high
    }

    #[test]
    fn rays_through_the_lens_meet_in_the_plane_in_focus() {
        let pinhole = Camera::pinhole(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, DVec3::Y, 50.0);
        let lens = Camera { aperture: 0.5, focus_distance: 2.0, ..pinhole };
        let film = FilmSettings { width: 40, height: 30, ..FilmSettings::default() };
        let view = View::new(&lens, &film, DVec3::ZERO);
        let axis = (lens.target - lens.origin).normalize();
        let (x, y) = (F32x8::splat(31.0), F32x8::splat(4.0));
        let sharp = View::new(&pinhole, &film, DVec3::ZERO).rays(x, y, [F32x8::splat(0.5); 2]);
        let u = [F32x8::from_fn(|l| l as f32 / 8.0), F32x8::from_fn(|l| (3 * l % 8) as f32 / 8.0)];
        let rays = view.rays(x, y, u);
        let of = |v: &Vec3<F32x8>, l: usize| DVec3::new(v.x.lane(l).into(), v.y.lane(l).into(), v.z.lane(l).into());
        let meet = of(&sharp.origin, 0) + of(&sharp.dir, 0) * (2.0 / of(&sharp.dir, 0).dot(axis));
        for l in 0..F32x8::LANES {
            let (origin, dir) = (of(&rays.origin, l), of(&rays.dir, l));
            assert!((origin - lens.origin).dot(axis).abs() < 1e-6);
            assert!((origin - lens.origin).length() <= 0.25 + 1e-6);
            let away = meet - origin;
            assert!((away - dir * away.dot(dir)).length() < 1e-5, "lane {l}");
        }
    }

    #[test]
    fn a_camera_without_a_direction_is_refused() {
        let bounds = [DVec3::ZERO, DVec3::ONE];
        let same = CameraSpec { origin: Some(DVec3::ONE), target: Some(DVec3::ONE), ..CameraSpec::default() };
        assert_eq!(same.complete(bounds, 1.0), Err(CameraError::NoDirection));
        let above = CameraSpec { origin: Some(DVec3::Y), target: Some(DVec3::ZERO), ..CameraSpec::default() };
        assert_eq!(above.complete(bounds, 1.0), Err(CameraError::UpAlongView));
    }
}
