//! Plots as SVG: axes and bars in the colours of the page, so that they follow light and dark; maps as embedded pictures.
//!
//! Drawn here rather than by a plotting crate: those write fixed colours into the file, and three kinds of mark are all
//! that is needed.

use super::html::{base64, escape};
use gonio_io::png::encode_rgb8;
use gonio_lab::plots::{Axis, Colours, Figure, Histogram, Map, Plot};
use std::fmt::Write;

/// Size of a drawing and of the space around its plot, in units of the view box.
const WIDTH: f64 = 320.0;
const HEIGHT: f64 = 220.0;
const LEFT: f64 = 46.0;
const RIGHT: f64 = 52.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 40.0;
const ACROSS: f64 = WIDTH - LEFT - RIGHT;
const UP: f64 = HEIGHT - TOP - BOTTOM;

/// A plot with its words.
pub(crate) fn figure(plot: &Plot) -> String {
    let inner = match &plot.figure {
        Figure::Map(map) => map_marks(map),
        Figure::Histogram(histogram) => histogram_marks(histogram),
    };
    format!(
        "<figure><h4>{}</h4><svg class=\"plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">{inner}</svg>\
         <figcaption>{}</figcaption></figure>\n",
        escape(&plot.title),
        escape(&plot.title),
        escape(&plot.caption)
    )
}

fn map_marks(map: &Map) -> String {
    let rows = map.values.len() / map.columns.max(1);
    // Pictures have their rows from the top.
    let pixels: Vec<u8> = map.values.chunks(map.columns).rev().flatten().flat_map(|&v| map.colours.of(v)).collect();
    const STEPS: usize = 64;
    let (lo, hi) = map.colours.range();
    let scale: Vec<u8> =
        (0..STEPS).rev().flat_map(|i| map.colours.of(lo + (hi - lo) * (i as f64 + 0.5) / STEPS as f64)).collect();
    let mut marks = picture(LEFT, TOP, ACROSS, UP, [map.columns, rows], &pixels);
    marks += &picture(WIDTH - RIGHT + 10.0, TOP, 10.0, UP, [1, STEPS], &scale);
    for (value, y) in [(hi, TOP + 4.0), (0.5 * (lo + hi), TOP + 0.5 * UP + 4.0), (lo, TOP + UP + 4.0)] {
        let _ = write!(marks, "<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>", WIDTH - RIGHT + 24.0, number(value));
    }
    marks + &axes(&map.x, Some(&map.y))
}

fn histogram_marks(histogram: &Histogram) -> String {
    let n = histogram.bars.len().max(1) as f64;
    let most = histogram.bars.iter().chain(&histogram.expected).copied().fold(1e-300, f64::max);
    let step = ACROSS / n;
    let height = |value: f64| UP * value / (1.05 * most);
    let mut marks = String::new();
    for (i, &bar) in histogram.bars.iter().enumerate() {
        let (x, h) = (LEFT + step * i as f64, height(bar));
        let _ = write!(
            marks,
            "<rect class=\"fill\" x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{h:.1}\"/>",
            x + 0.5,
            TOP + UP - h,
            step - 1.0
        );
    }
    let points = histogram
        .expected
        .iter()
        .enumerate()
        .map(|(i, &value)| format!("{:.1},{:.1}", LEFT + step * (i as f64 + 0.5), TOP + UP - height(value)));
    let _ = write!(marks, "<polyline points=\"{}\"/>", points.collect::<Vec<_>>().join(" "));
    marks + &axes(&histogram.x, None)
}

/// Frame, ticks and names.
fn axes(x: &Axis, y: Option<&Axis>) -> String {
    let mut marks = format!("<rect class=\"frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{ACROSS}\" height=\"{UP}\"/>");
    for (value, share) in ticks(x) {
        let at = LEFT + ACROSS * share;
        let _ = write!(
            marks,
            "<path d=\"M{at:.1} {:.1}v4\"/><text class=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
            TOP + UP,
            TOP + UP + 16.0,
            number(value)
        );
    }
    let middle = LEFT + 0.5 * ACROSS;
    let _ =
        write!(marks, "<text class=\"middle name\" x=\"{middle}\" y=\"{}\">{}</text>", HEIGHT - 6.0, escape(x.name));
    let Some(y) = y else { return marks };
    for (value, share) in ticks(y) {
        let at = TOP + UP * (1.0 - share);
        let _ = write!(
            marks,
            "<path d=\"M{LEFT} {at:.1}h-4\"/><text class=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT - 6.0,
            at + 4.0,
            number(value)
        );
    }
    let (at, up) = (10.0, TOP + 0.5 * UP);
    let _ = write!(
        marks,
        "<text class=\"middle name\" transform=\"translate({at} {up}) rotate(-90)\">{}</text>",
        escape(y.name)
    );
    marks
}

/// Values worth a label, and where they lie on the axis.
fn ticks(axis: &Axis) -> Vec<(f64, f64)> {
    if axis.log {
        let (lo, hi) = (axis.lo.log10(), axis.hi.log10());
        return (lo.ceil() as i32..=hi.floor() as i32)
            .map(|decade| (10.0_f64.powi(decade), (f64::from(decade) - lo) / (hi - lo)))
            .collect();
    }
    // Steps of 1, 2 or 5 times a power of ten, four to eight of them.
    let span = axis.hi - axis.lo;
    let power = 10.0_f64.powf((span / 8.0).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| span / s <= 8.0).unwrap_or(span);
    let first = (axis.lo / step).ceil() as i64;
    let last = (axis.hi / step + 1e-9).floor() as i64;
    (first..=last).map(|i| (i as f64 * step, (i as f64 * step - axis.lo) / span)).collect()
}

/// A number as short as it can be said.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) {
        return format!("{value:.0e}").replace('-', "−");
    }
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

fn picture(x: f64, y: f64, width: f64, height: f64, [columns, rows]: [usize; 2], rgb: &[u8]) -> String {
    let Ok(png) = encode_rgb8(columns as u32, rows as u32, rgb) else { return String::new() };
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
         href=\"data:image/png;base64,{}\"/>",
        base64(&png)
    )
}

/// The colour of a value.
trait Palette {
    /// 8-bit sRGB.
    fn of(&self, value: f64) -> [u8; 3];
    fn range(&self) -> (f64, f64);
}

impl Palette for Colours {
    fn of(&self, value: f64) -> [u8; 3] {
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
    fn range(&self) -> (f64, f64) {
        match *self {
            Self::Linear(lo, hi) => (lo, hi),
            Self::Diverging(most) => (-most, most),
        }
    }
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
    fn ticks_are_round_and_lie_on_the_axis() {
        let axis = |lo, hi, log| Axis { name: "", lo, hi, log };
        let values = |axis: &Axis| ticks(axis).iter().map(|t| number(t.0)).collect::<Vec<_>>();
        assert_eq!(values(&axis(0.0, 1.0, false)), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(values(&axis(-4.25, 4.25, false)), ["−4", "−2", "0", "2", "4"]);
        assert_eq!(values(&axis(1e-4, 1.0, true)), ["1e−4", "0.001", "0.01", "0.1", "1"]);
        assert!(ticks(&axis(0.0, 17.0, false)).iter().all(|t| (0.0..=1.0).contains(&t.1)));
    }

    #[test]
    fn colours_have_ends_a_middle_and_none_for_what_is_no_number() {
        assert_eq!(Colours::Linear(0.0, 1.0).of(-5.0), SEQUENTIAL[0]);
        assert_eq!(Colours::Linear(0.0, 1.0).of(5.0), SEQUENTIAL[8]);
        assert_eq!(Colours::Diverging(4.0).of(0.0), DIVERGING[3]);
        assert_eq!(Colours::Diverging(4.0).of(f64::NAN), [0x80; 3]);
    }
}
