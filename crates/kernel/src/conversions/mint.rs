//! From and to [mint](https://docs.rs/mint), through which most vectors of other crates come.

use crate::frame::Frame;
use crate::real::Real;
use crate::rgb::Rgb;
use crate::vec3::Vec3;

macro_rules! three {
    ($($ours:ident $theirs:ident),*) => {$(
        /// The same three numbers.
        impl<R> From<mint::$theirs<R>> for $ours<R> {
            #[inline(always)]
            fn from(v: mint::$theirs<R>) -> Self {
                Self::new(v.x, v.y, v.z)
            }
        }
        /// The same three numbers.
        impl<R> From<$ours<R>> for mint::$theirs<R> {
            #[inline(always)]
            fn from(v: $ours<R>) -> Self {
                <[R; 3]>::from(v).into()
            }
        }
    )*};
}
three!(Vec3 Vector3, Vec3 Point3, Rgb Vector3);

impl<R> mint::IntoMint for Vec3<R> {
    type MintType = mint::Vector3<R>;
}
impl<R> mint::IntoMint for Rgb<R> {
    type MintType = mint::Vector3<R>;
}
impl<R> mint::IntoMint for Frame<R> {
    type MintType = mint::ColumnMatrix3<R>;
}

/// The frame about the third column whose tangent is as close to the first as it can be.
impl<R: Real> From<mint::ColumnMatrix3<R>> for Frame<R> {
    #[inline(always)]
    fn from(m: mint::ColumnMatrix3<R>) -> Self {
        Self::from_normal_tangent(m.z.into(), m.x.into())
    }
}
/// The matrix that takes local vectors to the world: tangent, bitangent and normal are its columns.
impl<R> From<Frame<R>> for mint::ColumnMatrix3<R> {
    #[inline(always)]
    fn from(frame: Frame<R>) -> Self {
        Self { x: frame.x.into(), y: frame.y.into(), z: frame.z.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_points_colours_and_frames_come_back_as_they_went() {
        let v = Vec3::new(1.0_f32, -0.0, 3.5e-40);
        assert_eq!(Vec3::from(mint::Vector3::from(v)), v);
        assert_eq!(Vec3::from(mint::Point3::from(v)), v);
        assert_eq!(Rgb::from(mint::Vector3::from(Rgb::new(0.1, 0.2, 0.3))), Rgb::new(0.1, 0.2, 0.3));
        let up = Frame::from_normal(Vec3::<f64>::unit_z());
        assert_eq!(Frame::from(mint::ColumnMatrix3::from(up)), up);
    }
}
