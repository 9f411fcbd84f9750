//! The drawing of a plot: one view box, a frame with ticks, and the marks inside.

use super::{Axis, Figure, Histogram, Map, Plot};
use crate::markup::{Html, escape, png_address};
use crate::number::tick;
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

impl Plot {
    /// The drawing with its words.
    pub(crate) fn figure(&self) -> Html {
        let inner = match &self.figure {
            Figure::Map(map) => map_marks(map),
            Figure::Histogram(histogram) => histogram_marks(histogram),
        };
        let title = escape(&self.title);
        Html::raw(format!(
            "<figure><h4>{title}</h4><svg class=\"plot\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}\">{inner}</svg>\
             <figcaption>{}</figcaption></figure>\n",
            escape(&self.caption)
        ))
    }
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
        let _ = write!(marks, "<text x=\"{:.1}\" y=\"{y:.1}\">{}</text>", WIDTH - RIGHT + 24.0, tick(value));
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
    for (value, share) in x.ticks() {
        let at = LEFT + ACROSS * share;
        let _ = write!(
            marks,
            "<path d=\"M{at:.1} {:.1}v4\"/><text class=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
            TOP + UP,
            TOP + UP + 16.0,
            tick(value)
        );
    }
    let middle = LEFT + 0.5 * ACROSS;
    let _ =
        write!(marks, "<text class=\"middle name\" x=\"{middle}\" y=\"{}\">{}</text>", HEIGHT - 6.0, escape(x.name));
    let Some(y) = y else { return marks };
    for (value, share) in y.ticks() {
        let at = TOP + UP * (1.0 - share);
        let _ = write!(
            marks,
            "<path d=\"M{LEFT} {at:.1}h-4\"/><text class=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT - 6.0,
            at + 4.0,
            tick(value)
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

/// Pixels, stretched over a rectangle; nothing if there are none.
fn picture(x: f64, y: f64, width: f64, height: f64, [columns, rows]: [usize; 2], rgb: &[u8]) -> String {
    let Some(file) = encode(columns as u32, rows as u32, rgb) else { return String::new() };
    format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
        png_address(&file)
    )
}

/// A PNG file of 8-bit sRGB colours, three bytes per pixel, rows from the top.
fn encode(columns: u32, rows: u32, rgb: &[u8]) -> Option<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, columns, rows);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(rgb).ok()?;
    writer.finish().ok()?;
    Some(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::Colours;

    fn plot(figure: Figure) -> String {
        let (title, caption) = ("a < b".to_owned(), "how".to_owned());
        Plot { lobe: String::new(), instrument: "", title, caption, figure }.figure().as_str().to_owned()
    }

    const UNIT: Axis = Axis { name: "cosθ", lo: 0.0, hi: 1.0, log: false };

    #[test]
    fn a_map_is_two_pictures_and_a_histogram_has_a_bar_for_each_count() {
        let values = vec![0.0, 0.5, 1.0, f64::NAN];
        let map = Map { x: UNIT, y: UNIT, columns: 2, values, colours: Colours::Linear(0.0, 1.0) };
        let drawn = plot(Figure::Map(map));
        assert_eq!(drawn.matches("<image ").count(), 2);
        assert!(drawn.contains("<h4>a &lt; b</h4>") && drawn.contains(">cosθ</text>"));
        let histogram = Histogram { x: UNIT, bars: vec![1.0, 2.0, 4.0], expected: vec![2.0; 3] };
        let drawn = plot(Figure::Histogram(histogram));
        assert_eq!(drawn.matches("<rect class=\"fill\"").count(), 3);
        assert_eq!(drawn.matches("<polyline").count(), 1);
    }

    #[test]
    fn pixels_are_encoded_if_there_are_as_many_as_is_said() {
        assert!(encode(2, 1, &[0; 6]).is_some_and(|file| file.starts_with(b"\x89PNG")));
        assert!(encode(2, 2, &[0; 6]).is_none() && encode(0, 0, &[]).is_none());
    }
}
