//! The numbers and words of a plot.

/// A plot with its words.
#[derive(Clone, Debug)]
pub struct Plot {
    /// The lobe that it shows.
    pub lobe: String,
    /// The instrument whose view it is.
    pub instrument: &'static str,
    /// What is drawn.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The numbers.
    pub figure: Figure,
}

/// The numbers of a plot.
#[derive(Clone, Debug)]
pub enum Figure {
    /// A value over two coordinates.
    Map(Map),
    /// How often a value occurs.
    Histogram(Histogram),
}

/// A value over two coordinates.
#[derive(Clone, Debug)]
pub struct Map {
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Values per row.
    pub columns: usize,
    /// Rows from the bottom. A value that is not a number has no colour.
    pub values: Vec<f64>,
    /// How a value becomes a colour.
    pub colours: Colours,
}

/// How often a value occurs, and how often it should.
#[derive(Clone, Debug)]
pub struct Histogram {
    /// The value.
    pub x: Axis,
    /// Counts of equal intervals of the axis.
    pub bars: Vec<f64>,
    /// Expected counts of the same intervals.
    pub expected: Vec<f64>,
}

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

/// How a value becomes a colour; what lies outside of the range has the colour of its end.
#[derive(Clone, Copy, Debug)]
pub enum Colours {
    /// From the least to the most.
    Linear(f64, f64),
    /// From minus to plus so much, with a neutral middle.
    Diverging(f64),
}

impl Axis {
    /// The middle of interval `i` of `n`.
    pub(crate) fn at(&self, i: usize, n: usize) -> f64 {
        let share = (i as f64 + 0.5) / n as f64;
        if self.log { self.lo * (self.hi / self.lo).powf(share) } else { self.lo + (self.hi - self.lo) * share }
    }
}
