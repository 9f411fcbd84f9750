//! The same bits in every build: a feature never changes a result.

use super::results::{physics, reals, triples, truths};
use crate::real::Real;

/// FNV-1a over words; NaN is one number, since hardware and software disagree about its bits.
struct Hash(u64);

impl Hash {
    fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    fn add_real(&mut self, x: f64) {
        self.add(if x.is_nan() { u64::MAX } else { x.to_bits() });
    }
}

/// The hash of all results of `f32` and of `f64`.
fn hash<R: Real<Mask = bool> + From<f32> + Into<f64>>() -> u64 {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    for triple in triples() {
        let triple = triple.map(R::from);
        reals(triple).into_iter().chain(physics(triple)).for_each(|x| hash.add_real(x.into()));
        truths(triple).into_iter().for_each(|x| hash.add(x.into()));
    }
    hash.0
}

#[test]
fn results_have_the_same_bits_with_and_without_wide() {
    let got = [hash::<f32>(), hash::<f64>()];
    // Where `wide` finds no fused multiply-add it rounds twice, and results are others. A formula that changes on purpose changes
    // these numbers, in both builds alike.
    if cfg!(any(not(feature = "wide"), target_feature = "fma")) {
        assert_eq!(got.map(|hash| std::format!("{hash:016x}")), ["fa656f57f48ab94c", "13724deaa467dfff"]);
    }
}
