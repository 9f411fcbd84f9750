//! The camera: places in the picture to rays.

use crate::scene::{Camera, FilmSettings};
use glam::DVec3;
use gonio_accel::Ray8;
use gonio_kernel::{F32x8, Real, Vec3};

/// The camera, ready to make rays: origin and the vectors to the middle and to the edges of a picture one unit away.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub(crate) origin: Vec3<f32>,
    pub(crate) forward: Vec3<f32>,
    right: Vec3<f32>,
    up: Vec3<f32>,
    /// Columns and rows of the picture.
    size: [f32; 2],
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
            size: [film.width as f32, film.height as f32],
        }
    }

    /// All numbers that its rays depend on.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f32> {
        [self.origin, self.forward, self.right, self.up].into_iter().flat_map(<[f32; 3]>::from).chain(self.size)
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> [f32; 2] {
        self.size
    }

    /// The rays through places (x, y) of the picture in pixels, (0, 0) at the top left corner of the top left pixel.
    #[inline(always)]
    pub fn rays(&self, x: F32x8, y: F32x8) -> Ray8 {
        let [width, height] = self.size.map(F32x8::splat);
        let two = F32x8::splat(2.0);
        let (x, y) = (x * two / width - F32x8::ONE, F32x8::ONE - y * two / height);
        let forward = Vec3::broadcast(self.forward);
        let dir = forward.along(x, Vec3::broadcast(self.right)).along(y, Vec3::broadcast(self.up)).normalize();
        Ray8::new(Vec3::broadcast(self.origin), dir)
    }
}
