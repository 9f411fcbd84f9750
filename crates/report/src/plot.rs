//! Plots: numbers with their axes and words, drawn as SVG.
//!
//! Drawn here rather than by a plotting crate: those write fixed colours into the file, and maps and histograms are all that is
//! needed. Axes and bars take the colours of the page, so that they follow light and dark; maps are embedded pictures.

mod axis;
mod draw;

pub use axis::Axis;

use crate::colours::Colours;

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
