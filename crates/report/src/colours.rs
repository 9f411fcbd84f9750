//! False colours: how a value becomes a colour of a map, and a deviation a shade around grey.

/// How a value becomes a colour; what lies outside of the range has the colour of its end.
#[derive(Clone, Copy, Debug)]
pub enum Colours {
    /// From the least to the most.
    Linear(f64, f64),
    /// From minus to plus so much, with a neutral middle.
    Diverging(f64),
}

impl Colours {
    /// The colour of a value, 8-bit sRGB; grey for what is not a number.
    pub fn of(&self, value: f64) -> [u8; 3] {
        const NOTHING: [u8; 3] = [0x80; 3];
        let (lo, hi) = self.range();
        let t = (value - lo) / (hi - lo);
        if t.is_nan() {
            return NOTHING;
        }
        let stops: &[[u8; 3]] = match self {
            Self::Linear(..) => &SEQUENTIAL,
            Self::Diverging(_) => &DIVERGING,
        };
        let place = t.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let below = (place as usize).min(stops.len() - 2);
        let share = place - below as f64;
        let mix = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
        std::array::from_fn(|c| mix(stops[below][c], stops[below + 1][c]))
    }

    /// The values at the two ends.
    pub fn range(&self) -> (f64, f64) {
        match *self {
            Self::Linear(lo, hi) => (lo, hi),
            Self::Diverging(most) => (-most, most),
        }
    }
}

/// A deviation as a shade, linear: mid grey (0.5 in sRGB) where there is none, black at −1, twice mid grey at 1.
pub fn around_mid_grey(deviation: f64) -> f32 {
    const MID_GREY: f64 = 0.214;
    (MID_GREY * (1.0 + deviation)) as f32
}

/// Nine stops of `viridis` (Smith & van der Walt 2015): even to the eye, also without colour.
const SEQUENTIAL: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Blue, white, red after ColorBrewer's `RdBu` (Brewer 2002).
const DIVERGING: [[u8; 3]; 7] =
    [[33, 102, 172], [103, 169, 207], [209, 229, 240], [247, 247, 247], [253, 219, 199], [239, 138, 98], [178, 24, 43]];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_have_ends_a_middle_and_none_for_what_is_no_number() {
        assert_eq!(Colours::Linear(0.0, 1.0).of(-5.0), SEQUENTIAL[0]);
        assert_eq!(Colours::Linear(0.0, 1.0).of(5.0), SEQUENTIAL[8]);
        assert_eq!(Colours::Diverging(4.0).of(0.0), DIVERGING[3]);
        assert_eq!(Colours::Diverging(4.0).of(f64::NAN), [0x80; 3]);
    }
}
