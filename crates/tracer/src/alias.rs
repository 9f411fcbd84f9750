//! Vose's alias method (1991): one of n things by its weight, in constant time.

/// A table of the weights: slot i keeps itself with the first probability and else yields the second index.
///
/// A weight of 0 is never chosen. If all are 0, every slot keeps itself.
pub(crate) fn alias_table(weights: &[f64]) -> Vec<(f32, u32)> {
    let n = weights.len();
    let sum: f64 = weights.iter().sum();
    let mut table: Vec<(f32, u32)> = (0..n as u32).map(|i| (1.0, i)).collect();
    if sum <= 0.0 {
        return table;
    }
    let mut scaled: Vec<f64> = weights.iter().map(|w| w * n as f64 / sum).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = (scaled[s] as f32, l as u32);
        scaled[l] -= 1.0 - scaled[s];
        if scaled[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    table
}

/// One index, for a random word and a random number in [0, 1): the word times the count gives every slot its share to
/// 2⁻³² of the whole.
#[inline(always)]
pub(crate) fn pick(table: &[(f32, u32)], place: u32, toss: f32) -> usize {
    let slot = ((u64::from(place) * table.len() as u64) >> 32) as usize;
    let (keep, other) = table[slot];
    if toss < keep { slot } else { other as usize }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_alias_table_reproduces_the_weights() {
        let weights = [1.0, 0.25, 7.0, 3.5, 0.0, 2.0];
        let table = alias_table(&weights);
        let mut got = [0.0; 6];
        for (i, &(keep, other)) in table.iter().enumerate() {
            got[i] += f64::from(keep) / 6.0;
            got[other as usize] += (1.0 - f64::from(keep)) / 6.0;
        }
        for (g, w) in got.iter().zip(weights) {
            assert!((g - w / 13.75).abs() < 1e-7, "{got:?}");
        }
    }

    #[test]
    fn what_has_no_weight_is_never_chosen() {
        let mut weights = vec![0.0; 1000];
        weights[7] = 1e-12;
        weights[700] = 3.0;
        let table = alias_table(&weights);
        for place in (0..1000_u64).map(|slot| (slot << 32).div_ceil(1000) as u32) {
            for toss in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
                assert!(weights[pick(&table, place, toss)] > 0.0);
            }
        }
        assert_eq!(pick(&alias_table(&[0.0; 4]), u32::MAX, 0.5), 3);
    }
}
