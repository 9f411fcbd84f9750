use super::*;
use crate::lobe::{Lambert, Mirror};

#[test]
fn a_lobe_that_does_not_fit_is_an_error() {
    let mirror = Mirror::new(Rgb::splat(0.1_f32));
    let mut surface = Surface::black();
    for count in 0..4 {
        assert_eq!(surface.lobes().count(), count);
        surface = surface.with(0.5, mirror).unwrap();
    }
    assert_eq!(surface.with(0.5, mirror).unwrap_err(), SurfaceError::Full);
    let coated = Surface::black().coat(1.0, mirror, Layering::Reciprocal).unwrap();
    assert_eq!(coated.coat(1.0, mirror, Layering::Reciprocal).unwrap_err(), SurfaceError::TooManyCoats);
    let chalk = Lambert::new(Rgb::splat(0.5_f32));
    assert_eq!(Surface::black().coat(1.0, chalk, Layering::Reciprocal).unwrap_err(), SurfaceError::NoCoat);
}

#[test]
fn a_parameter_out_of_range_or_nan_leaves_the_domain() {
    for (weight, reflectance) in [(1.1_f32, 0.5), (-0.1, 0.5), (f32::NAN, 0.5), (1.0, 1.1), (1.0, f32::NAN)] {
        let surface = Surface::black().with(weight, Mirror::new(Rgb::splat(reflectance))).unwrap();
        assert!(!surface.domain(), "weight {weight}, reflectance {reflectance}");
    }
    assert!(Surface::<f32>::black().domain());
}
