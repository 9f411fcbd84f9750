//! Normal maps: images of tangent-space normals, n = 2c − 1, filtered bilinearly and made unit again.
//!
//! The convention is that of OpenGL, glTF and Mitsuba: red along the tangent ∂p/∂u, green along ∂p/∂v (upwards in the
//! image), blue along the shading normal; the numbers are linear, whatever the file says of its curve. What a tilted frame
//! then means is in [`gonio_kernel::frame`]. Texels are kept in 16 bits, which hold 8-bit values exactly (257·c of 65535).

use gonio_kernel::Vec3;

use crate::texture::blend;

/// An image of normals, at least one texel in size.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    width: u32,
    height: u32,
    /// Rows from the top.
    texels: Vec<[u16; 3]>,
}

impl NormalMap {
    /// A normal map from 16-bit texels, rows from the top; `None` unless there are `width * height` > 0 of them.
    #[must_use]
    pub fn from_linear16(width: u32, height: u32, texels: Vec<[u16; 3]>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (count > 0 && count == texels.len() as u64).then_some(Self { width, height, texels })
    }

    /// The texels, rows from the top.
    pub(crate) fn texels(&self) -> &[[u16; 3]] {
        &self.texels
    }

    /// The normal at texture coordinates in tangent space, x and y times `scale`; unit. (0, 0, 1) where the image holds none.
    ///
    /// Bilinear between texel centres (at +0.5), repeating; v = 0 is the bottom edge, and a coordinate that is not finite
    /// counts as 0, as for [`crate::texture::Texture::sample`].
    #[must_use]
    pub fn sample(&self, u: f32, v: f32, scale: f32) -> Vec3<f32> {
        let texel = |x: u32, y: u32| {
            self.texels[y as usize * self.width as usize + x as usize].map(|c| f32::from(c) * (2.0 / 65_535.0) - 1.0)
        };
        let [x, y, z] = blend([self.width, self.height], [u, v], texel);
        Vec3::new(x * scale, y * scale, z).normalize_or(Vec3::unit_z())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: [u16; 3] = [32_768, 32_768, 65_535];

    fn assert_near(n: Vec3<f32>, expected: [f32; 3]) {
        assert!((n - Vec3::from(expected)).length() < 5e-5, "{n:?}, not {expected:?}");
    }

    #[test]
    fn colours_are_normals_and_the_scale_steepens_them() {
        // 0.6, 0, 0.8 as 16 bits.
        let map = NormalMap::from_linear16(1, 1, vec![[52_428, 32_768, 58_982]]).unwrap();
        assert_near(map.sample(0.3, 0.9, 1.0), [0.6, 0.0, 0.8]);
        assert_near(map.sample(0.3, 0.9, 0.0), [0.0, 0.0, 1.0]);
        assert_near(map.sample(0.3, 0.9, 2.0), [1.2 / 2.08_f32.sqrt(), 0.0, 0.8 / 2.08_f32.sqrt()]);
    }

    #[test]
    fn between_texels_the_normal_is_unit_and_v_zero_is_the_bottom() {
        let (east, north) = ([65_535, 32_768, 32_768], [32_768, 65_535, 32_768]);
        let map = NormalMap::from_linear16(1, 2, vec![east, north]).unwrap();
        assert_near(map.sample(0.5, 0.25, 1.0), [0.0, 1.0, 0.0]);
        assert_near(map.sample(0.5, 0.75, 1.0), [1.0, 0.0, 0.0]);
        let half = 0.5_f32.sqrt();
        assert_near(map.sample(0.5, 0.5, 1.0), [half, half, 0.0]);
    }

    #[test]
    fn every_coordinate_has_a_unit_normal() {
        let map = NormalMap::from_linear16(2, 1, vec![FLAT, [0, 65_535, 32_767]]).unwrap();
        for u in [0.0, -0.0, 1.0, -1e30, f32::MAX, f32::NAN, f32::INFINITY] {
            for scale in [0.0, 1.0, 10.0] {
                assert!((map.sample(u, u, scale).length() - 1.0).abs() < 1e-6, "{u} {scale}");
            }
        }
        // (0, 0, 0) at the middle of two opposite normals.
        let map = NormalMap::from_linear16(2, 1, vec![[0; 3], [65_535; 3]]).unwrap();
        assert_eq!(map.sample(0.5, 0.5, 1.0), Vec3::unit_z());
    }

    #[test]
    fn wrong_sizes_are_refused() {
        assert!(NormalMap::from_linear16(0, 4, vec![]).is_none());
        assert!(NormalMap::from_linear16(2, 2, vec![FLAT; 3]).is_none());
    }
}
