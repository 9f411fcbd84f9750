//! Images on surfaces: kept in eight bits, filtered bilinearly in linear light.
//!
//! The sRGB curve is IEC 61966-2-1. Texels stay 8-bit (a quarter of the memory of f32) and pass through a table of 256
//! entries at every look-up, so filtering happens in linear light and not on encoded values.
//! Coordinates follow the OBJ convention: (0, 0) is the lower left corner of the image, and the image repeats.

use std::sync::LazyLock;

use gonio_kernel::Rgb;

/// An image with an sRGB encoding, at least one texel in size.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    width: u32,
    height: u32,
    /// Rows from the top.
    texels: Vec<[u8; 3]>,
}

impl Texture {
    /// A texture from 8-bit sRGB texels, rows from the top; `None` unless there are `width * height` > 0 of them.
    #[must_use]
    pub fn from_srgb8(width: u32, height: u32, texels: Vec<[u8; 3]>) -> Option<Self> {
        let count = u64::from(width) * u64::from(height);
        (count > 0 && count == texels.len() as u64).then_some(Self { width, height, texels })
    }

    /// Width in texels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in texels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The encoded texels, rows from the top.
    pub(crate) fn texels(&self) -> &[[u8; 3]] {
        &self.texels
    }

    /// Linear Rec. 709 colour at texture coordinates, each channel in [0, 1].
    ///
    /// Bilinear between texel centres (at +0.5), repeating; v = 0 is the bottom edge. Every input has an answer: a
    /// coordinate that is not finite counts as 0.
    #[must_use]
    pub fn sample(&self, u: f32, v: f32) -> Rgb<f32> {
        let [r, g, b] = blend([self.width, self.height], [u, v], |x, y| self.texel(x, y));
        Rgb::new(r, g, b)
    }

    fn texel(&self, x: u32, y: u32) -> [f32; 3] {
        let encoded = self.texels[y as usize * self.width as usize + x as usize];
        encoded.map(|byte| SRGB_TO_LINEAR[usize::from(byte)])
    }
}

/// Bilinear between the centres of `texel(column, row)` in an image that repeats; rows run downwards, v = 0 is the bottom.
#[inline]
pub(crate) fn blend([width, height]: [u32; 2], [u, v]: [f32; 2], texel: impl Fn(u32, u32) -> [f32; 3]) -> [f32; 3] {
    let (x0, x1, tx) = neighbours(u, width);
    let (y0, y1, ty) = neighbours(-v, height); // the image repeats, so -v serves as 1 - v
    let top = mix(texel(x0, y0), texel(x1, y0), tx);
    let bottom = mix(texel(x0, y1), texel(x1, y1), tx);
    mix(top, bottom, ty)
}

/// The two texels around a coordinate in one direction, and the share of the second.
fn neighbours(coordinate: f32, size: u32) -> (u32, u32, f32) {
    let c = if coordinate.is_finite() { coordinate } else { 0.0 };
    let x = (c - c.floor()) * size as f32 - 0.5; // c - floor(c) may round to 1: the wrap below covers it
    let floor = x.floor();
    let first = (floor as i64).rem_euclid(i64::from(size)) as u32;
    let second = if first + 1 == size { 0 } else { first + 1 };
    (first, second, x - floor)
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] * (1.0 - t) + b[i] * t)
}

/// The linear light of an 8-bit sRGB value, in [0, 1].
#[must_use]
pub fn linear_from_srgb8(byte: u8) -> f32 {
    SRGB_TO_LINEAR[usize::from(byte)]
}

/// IEC 61966-2-1, decoding; computed in f64 so that every entry is the nearest f32.
static SRGB_TO_LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| {
        let encoded = byte as f64 / 255.0;
        let linear = if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

#[cfg(test)]
mod tests {
    use super::*;

    /// Top row: black, red; bottom row: green, blue.
    fn four_texels() -> Texture {
        Texture::from_srgb8(2, 2, vec![[0, 0, 0], [255, 0, 0], [0, 255, 0], [0, 0, 255]]).unwrap()
    }

    fn channels(color: Rgb<f32>) -> [f32; 3] {
        [color.r, color.g, color.b]
    }

    #[test]
    fn texel_centres_are_exact_and_v_zero_is_the_bottom() {
        let texture = four_texels();
        assert_eq!(channels(texture.sample(0.25, 0.25)), [0.0, 1.0, 0.0]);
        assert_eq!(channels(texture.sample(0.75, 0.25)), [0.0, 0.0, 1.0]);
        assert_eq!(channels(texture.sample(0.25, 0.75)), [0.0, 0.0, 0.0]);
        assert_eq!(channels(texture.sample(0.75, 0.75)), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn the_image_repeats_and_blends_across_its_border() {
        let texture = four_texels();
        assert_eq!(texture.sample(0.25, 0.25), texture.sample(3.25, -4.75));
        assert_eq!(channels(texture.sample(0.0, 0.25)), [0.0, 0.5, 0.5]);
        assert_eq!(channels(texture.sample(0.5, 0.5)), [0.25, 0.25, 0.25]);
    }

    #[test]
    fn every_coordinate_has_an_answer() {
        let texture = four_texels();
        let awkward = [0.0, -0.0, -1e-12, 1.0, -1e30, f32::MAX, f32::MIN_POSITIVE, f32::NAN, f32::INFINITY];
        for u in awkward {
            for v in awkward {
                assert!(channels(texture.sample(u, v)).iter().all(|c| (0.0..=1.0).contains(c)));
            }
        }
        assert_eq!(texture.sample(f32::NAN, 0.25), texture.sample(0.0, 0.25));
    }

    #[test]
    fn srgb_is_decoded_to_linear_light() {
        let grey = Texture::from_srgb8(1, 1, vec![[188; 3]]).unwrap();
        let [r, _, _] = channels(grey.sample(0.3, 0.9));
        assert!((r - 0.502_886_5).abs() < 1e-6, "{r}"); // ((188/255 + 0.055)/1.055)^2.4
        assert_eq!(SRGB_TO_LINEAR[0], 0.0);
        assert_eq!(SRGB_TO_LINEAR[255], 1.0);
    }

    #[test]
    fn wrong_sizes_are_refused() {
        assert!(Texture::from_srgb8(0, 4, vec![]).is_none());
        assert!(Texture::from_srgb8(2, 2, vec![[0; 3]; 3]).is_none());
    }
}
