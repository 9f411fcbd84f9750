//! FLIP (Andersson et al. 2020): how different two pictures look when one flips between them, from 0 to 1.

use gonio_io::png::srgb8;
use gonio_tracer::Picture;
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

/// The mean over the pictures as they look on a screen: clamped, sRGB, 0.7 m from a monitor of usual size.
pub(super) fn mean(reference: &Picture, test: &Picture) -> f64 {
    let image = |picture: &Picture| FlipImageRgb8::with_data(picture.width, picture.height, &srgb8(picture, 0.0));
    let map = nv_flip::flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&map).mean())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_are_0_apart_and_black_and_white_nearly_1() {
        let flat = |x: f32| Picture { width: 16, height: 16, rgb: vec![[x; 3]; 256], alpha: None };
        assert_eq!(mean(&flat(0.5), &flat(0.5)), 0.0);
        assert!(mean(&flat(0.0), &flat(1.0)) > 0.9);
    }
}
