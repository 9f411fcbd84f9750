//! Tables: values measured or computed elsewhere, borrowed and looked up by number.
//!
//! Indices are integers, computed in 32 bits; no look-up can panic, whatever the index. Eight lanes look up one by one, so a table
//! belongs into what a lobe prepares once per `wo`; what depends on `wi` is better a formula.
//!
//! ```
//! use gonio_kernel::{Real, Table};
//!
//! // A measured curve at five points from 0 to 1.
//! let curve = Table::new(&[0.04, 0.05, 0.1, 0.4, 1.0], 0);
//! assert_eq!(curve.linear(0.875_f32), 0.7);
//! assert_eq!(f32::lookup(curve, 2), 0.1);
//! assert_eq!(f32::lookup(curve, 99), 1.0);
//! ```

mod slice;

pub use slice::Table;

use crate::real::{LARGEST_INT, Real};

impl Table<'_> {
    /// The value at x in \[0, 1\], between the first value at 0 and the last one at 1, linear between neighbours.
    ///
    /// Exact at 0 and 1 and, if one less than the number of values is a power of two, at every value. x outside \[0, 1\] is moved
    /// to its end, and NaN to 0. Of finite values that are below half the largest number the result is finite; it lies
    /// between its two neighbours to one ulp. A table of more than 2²² values is used up to there.
    ///
    /// ```
    /// use gonio_kernel::Table;
    /// let ramp = Table::new(&[1.0, 3.0, 2.0], 0);
    /// assert_eq!([0.0_f32, 0.25, 0.5, 1.0, 7.0].map(|x| ramp.linear(x)), [1.0, 2.0, 3.0, 2.0, 2.0]);
    /// ```
    #[inline(always)]
    pub fn linear<R: Real>(self, x: R) -> R {
        let last = self.len().saturating_sub(1).min(LARGEST_INT as usize) as u32;
        let place = x.clamp(0.0, 1.0) * R::lit(f64::from(last));
        let index = place.to_int();
        let part = place - R::from_int(index); // exact
        let (below, above) = (R::lookup(self, index), R::lookup(self, R::int_add(index, R::int(1))));
        part.mul_add(above, (R::ONE - part) * below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Random, close, special_values};
    use std::vec::Vec;

    #[test]
    fn beyond_the_end_lies_the_last_value_and_an_empty_table_is_zero() {
        let table = Table::new(&[1.0, 2.0, 4.0], 7);
        assert_eq!([0, 2, 3, u32::MAX].map(|index| f64::lookup(table, index)), [1.0, 4.0, 4.0, 4.0]);
        assert_eq!(f32::lookup(Table::new(&[], 0), 0), 0.0);
        assert_eq!((table.len(), table.id(), table.is_empty(), table.values().len()), (3, 7, false, 3));
    }

    #[test]
    fn no_number_and_no_table_breaks_a_look_up() {
        for count in 0..6 {
            let values: Vec<f32> = (0..count).map(|i| (i * i) as f32).collect();
            let (table, most) = (Table::new(&values, 0), values.last().copied().unwrap_or(0.0));
            for x in special_values() {
                let y = table.linear(x);
                assert!((0.0..=most).contains(&y), "{count} values at {x}: {y}");
                assert!((0.0..=f64::from(most)).contains(&table.linear(f64::from(x))), "{count} values at {x}");
            }
        }
    }

    #[test]
    fn between_its_values_a_line_is_a_line() {
        let values: Vec<f32> = (0..=1000).map(|i| i as f32).collect();
        let (table, mut random) = (Table::new(&values, 0), Random(81));
        for i in 0..=1000 {
            assert!(close(table.linear(f64::from(i) / 1000.0), f64::from(i), 1e-9));
        }
        for _ in 0..10_000 {
            let x = random.unit();
            assert!(close(table.linear(x).into(), f64::from(x) * 1000.0, 1e-4), "{x}");
        }
        assert_eq!((table.linear(0.0_f32), table.linear(1.0_f32)), (0.0, 1000.0));
    }

    #[test]
    fn integers_are_the_whole_part_of_reals() {
        for x in special_values() {
            let expected = if x.is_nan() { 0 } else { x.clamp(0.0, 4_194_303.0) as u32 };
            assert_eq!((x.to_int(), f64::from(x).to_int()), (expected, expected), "{x}");
        }
        for x in [4_194_302.5_f32, 4_194_303.0, 4_194_303.5, 4_194_304.0] {
            assert_eq!(x.to_int(), x.min(4_194_303.0) as u32);
        }
        assert_eq!(f64::from(f32::from_int(16_777_217)), 16_777_216.0);
        assert_eq!(f64::from_int(16_777_217), 16_777_217.0);
    }
}
