use super::*;
use crate::testing::results::{physics, reals, triples, truths};
use crate::testing::same_bits;
use std::vec::Vec;

#[test]
fn every_lane_has_the_bits_of_the_scalar() {
    for eight in triples().chunks_exact(8) {
        let lanes = [0, 1, 2].map(|part| F32x8::new(core::array::from_fn(|lane| eight[lane][part])));
        let together: Vec<_> = reals(lanes).into_iter().chain(physics(lanes)).collect();
        let true_together = truths(lanes);
        for (lane, &alone) in eight.iter().enumerate() {
            let scalar = reals(alone).into_iter().chain(physics(alone));
            for (op, (&x, scalar)) in together.iter().zip(scalar).enumerate() {
                let x = x.to_array()[lane];
                assert!(same_bits(x, scalar), "real {op} of {alone:?}: {x:e} in lanes, {scalar:e} alone");
            }
            for (op, (x, scalar)) in true_together.iter().zip(truths(alone)).enumerate() {
                assert_eq!(x.lane(lane), scalar, "truth {op} of {alone:?}");
            }
        }
    }
}

#[test]
fn min_and_max_choose_the_second_where_the_first_is_not_smaller_or_larger() {
    assert_eq!(Real::min(0.0_f32, -0.0).to_bits(), (-0.0_f32).to_bits());
    assert_eq!(Real::max(-0.0_f32, 0.0).to_bits(), 0.0_f32.to_bits());
    assert_eq!((Real::min(f32::NAN, 1.0), Real::max(f32::NAN, 1.0)), (1.0, 1.0));
    assert!(Real::min(1.0, f32::NAN).is_nan() && Real::max(1.0, f32::NAN).is_nan());
}

#[test]
fn a_mask_counts_its_lanes_from_the_first() {
    for count in 0..=9 {
        let mask = Mask8::first(count);
        let bits = (1_u32 << count.min(8)) - 1;
        assert_eq!(mask.to_bits(), bits);
        assert_eq!(Mask8::from_bits(bits).to_bits(), bits);
        assert_eq!((mask.any(), mask.all()), (count > 0, count >= 8));
        assert_eq!((mask.lane(0), mask.lane(7)), (count > 0, count >= 8));
    }
}

#[test]
fn whole_numbers_wrap_and_convert() {
    let x = U32x8::splat(u32::MAX);
    assert_eq!((x + U32x8::splat(2)).to_array(), [1; 8]);
    assert_eq!((x * x).to_array(), [1; 8]);
    assert_eq!((x >> 31).to_array(), [1; 8]);
    assert_eq!(((x ^ U32x8::splat(5)) & U32x8::splat(7)).to_array(), [2; 8]);
    assert_eq!(U32x8::new([0, 1, 2, 3, 4, 5, 6, 16_777_217]).to_real().to_array()[7], 16_777_216.0);
    assert_eq!(U32x8::new([0, 1, 2, 3, 4, 5, 6, 7]).lt(U32x8::splat(3)).to_bits(), 0b111);
}
