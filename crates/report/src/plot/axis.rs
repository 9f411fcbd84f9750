//! Axes, and the places on them that deserve a label.

/// An axis: what it measures, and from where to where.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name with unit.
    pub name: &'static str,
    /// Its beginning.
    pub lo: f64,
    /// Its end.
    pub hi: f64,
    /// Whether equal steps are equal factors.
    pub log: bool,
}

impl Axis {
    /// The middle of interval `i` of `n`.
    pub fn at(&self, i: usize, n: usize) -> f64 {
        let share = (i as f64 + 0.5) / n as f64;
        if self.log { self.lo * (self.hi / self.lo).powf(share) } else { self.lo + (self.hi - self.lo) * share }
    }

    /// Values worth a label, and where they lie on the axis, from 0 to 1.
    pub(crate) fn ticks(&self) -> Vec<(f64, f64)> {
        if self.log {
            let (lo, hi) = (self.lo.log10(), self.hi.log10());
            return (lo.ceil() as i32..=hi.floor() as i32)
                .map(|decade| (10.0_f64.powi(decade), (f64::from(decade) - lo) / (hi - lo)))
                .collect();
        }
        // Steps of 1, 2 or 5 times a power of ten, four to eight of them.
        let span = self.hi - self.lo;
        let power = 10.0_f64.powf((span / 8.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| span / s <= 8.0).unwrap_or(span);
        let first = (self.lo / step).ceil() as i64;
        let last = (self.hi / step + 1e-9).floor() as i64;
        (first..=last).map(|i| (i as f64 * step, (i as f64 * step - self.lo) / span)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::tick;

    #[test]
    fn ticks_are_round_and_lie_on_the_axis() {
        let axis = |lo, hi, log| Axis { name: "", lo, hi, log };
        let values = |axis: Axis| axis.ticks().iter().map(|t| tick(t.0)).collect::<Vec<_>>();
        assert_eq!(values(axis(0.0, 1.0, false)), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(values(axis(-4.25, 4.25, false)), ["−4", "−2", "0", "2", "4"]);
        assert_eq!(values(axis(1e-4, 1.0, true)), ["1e−4", "0.001", "0.01", "0.1", "1"]);
        assert!(axis(0.0, 17.0, false).ticks().iter().all(|t| (0.0..=1.0).contains(&t.1)));
        assert_eq!(axis(1.0, 100.0, true).at(0, 1), 10.0);
    }
}
