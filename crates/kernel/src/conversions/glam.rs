//! From and to [glam](https://docs.rs/glam).

use crate::frame::Frame;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

macro_rules! three {
    ($($ours:ident<$real:ident> $theirs:ident),*) => {$(
        /// The same three numbers.
        impl From<glam::$theirs> for $ours<$real> {
            #[inline(always)]
            fn from(v: glam::$theirs) -> Self {
                v.to_array().into()
            }
        }
        /// The same three numbers.
        impl From<$ours<$real>> for glam::$theirs {
            #[inline(always)]
            fn from(v: $ours<$real>) -> Self {
                Self::from_array(v.into())
            }
        }
    )*};
}
three!(Vec3<f32> Vec3, Vec3<f32> Vec3A, Vec3<f64> DVec3, Rgb<f32> Vec3, Rgb<f32> Vec3A, Rgb<f64> DVec3);

macro_rules! frame {
    ($($real:ident $matrix:ident),*) => {$(
        /// The frame about the third column whose tangent is as close to the first as it can be.
        impl From<glam::$matrix> for Frame<$real> {
            #[inline(always)]
            fn from(m: glam::$matrix) -> Self {
                Self::from_normal_tangent(m.z_axis.into(), m.x_axis.into())
            }
        }
        /// The matrix that takes local vectors to the world: tangent, bitangent and normal are its columns.
        impl From<Frame<$real>> for glam::$matrix {
            #[inline(always)]
            fn from(frame: Frame<$real>) -> Self {
                Self::from_cols(frame.x.into(), frame.y.into(), frame.z.into())
            }
        }
    )*};
}
frame!(f32 Mat3, f32 Mat3A, f64 DMat3);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close};

    #[test]
    fn vectors_and_colours_come_back_as_they_went() {
        let v = Vec3::new(1.0_f32, -0.0, 3.5e-40);
        assert_eq!(Vec3::from(glam::Vec3::from(v)), v);
        assert_eq!(Vec3::from(glam::Vec3A::from(v)), v);
        assert_eq!(glam::Vec3::from(v), glam::Vec3::new(1.0, -0.0, 3.5e-40));
        let c = Rgb::new(0.1_f64, 0.2, 0.3);
        assert_eq!(Rgb::from(glam::DVec3::from(c)), c);
    }

    #[test]
    fn a_frame_is_the_matrix_from_local_to_world() {
        let mut random = Random(91);
        let frame = Frame::from_normal_tangent(random.direction(), random.direction());
        let w = random.direction();
        let by_matrix = Vec3::from(glam::Mat3::from(frame) * glam::Vec3::from(w));
        assert!(close((by_matrix - frame.to_world(w)).length().into(), 0.0, 1e-6));
        let back = Frame::from(glam::Mat3::from(frame));
        assert!(close((back.y - frame.y).length().into(), 0.0, 1e-6));
        assert_eq!(Frame::from(glam::DMat3::ZERO).z, Vec3::unit_z());
    }
}
