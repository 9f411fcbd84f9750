//! Conversions from and to the vectors of other crates, behind the features that bear their names.
//!
//! Numbers are copied as they are. A matrix becomes a frame by its third and first columns, since a frame is orthonormal whatever
//! the matrix is; a frame becomes the matrix that takes local vectors to the world.

#[cfg(feature = "glam")]
mod glam;
#[cfg(feature = "mint")]
mod mint;

#[cfg(all(test, feature = "bytemuck"))]
mod tests {
    use crate::{Rgb, Vec3};

    #[test]
    fn slices_of_numbers_are_slices_of_vectors_without_a_copy() {
        let numbers = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0];
        let vectors: &[Vec3<f32>] = bytemuck::cast_slice(&numbers);
        assert_eq!(vectors, [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)]);
        let colours: &[Rgb<f32>] = bytemuck::cast_slice(&[[0.1_f32, 0.2, 0.3]]);
        assert_eq!(colours, [Rgb::new(0.1, 0.2, 0.3)]);
        assert_eq!(<Vec3<f64> as bytemuck::Zeroable>::zeroed(), Vec3::splat(0.0));
    }

    #[cfg(feature = "wide")]
    #[test]
    fn lanes_are_bytes_and_bytes_are_lanes() {
        use crate::{F32x8, U32x8};
        let lanes = [F32x8::new([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])];
        assert_eq!(bytemuck::cast_slice::<_, f32>(&lanes), lanes[0].to_array());
        assert_eq!(bytemuck::cast::<_, U32x8>(lanes[0]), lanes[0].to_bits());
    }
}
