//! A plot with two logarithmic axes, as SVG; in a file of its own it needs its own colours, which follow light and dark.

use std::fmt::Write;

/// Points (x, y) above 0, joined in their order.
pub(crate) struct Curve {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
}

/// The plot's place in the picture.
const LEFT: f64 = 60.0;
const TOP: f64 = 10.0;
const ACROSS: f64 = 420.0;
const UP: f64 = 280.0;

/// Two colours for each pair of curves, solid and dashed: Okabe & Ito 2008, apart also for the colour-blind.
const STROKES: [&str; 4] = ["#0072b2", "#0072b2", "#d55e00", "#d55e00"];

/// An axis that covers all values in whole decades.
struct Axis {
    first: f64,
    last: f64,
}

impl Axis {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let logs: Vec<f64> = values.map(f64::log10).collect();
        let first = logs.iter().copied().fold(f64::INFINITY, f64::min).floor();
        let last = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max).ceil();
        Self { first, last: last.max(first + 1.0) }
    }

    fn share(&self, value: f64) -> f64 {
        (value.log10() - self.first) / (self.last - self.first)
    }

    fn decades(&self) -> impl Iterator<Item = i32> {
        self.first as i32..=self.last as i32
    }
}

/// The whole file.
pub(crate) fn log_log(x_name: &str, y_name: &str, curves: &[Curve]) -> String {
    let all = || curves.iter().flat_map(|curve| &curve.points);
    let (x, y) = (Axis::of(all().map(|p| p.0)), Axis::of(all().map(|p| p.1)));
    let place = |(px, py): &(f64, f64)| (LEFT + ACROSS * x.share(*px), TOP + UP * (1.0 - y.share(*py)));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 640 340\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <style>:root{{color-scheme:light dark}}text{{fill:CanvasText}}path,rect{{stroke:GrayText;fill:none}}</style>\n\
         <rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{ACROSS}\" height=\"{UP}\"/>\n"
    );
    let power =
        |decade: i32| format!("10<tspan dy=\"-4\" font-size=\"9\">{}</tspan>", decade.to_string().replace('-', "−"));
    for decade in x.decades() {
        let (at, _) = place(&(10.0_f64.powi(decade), 1.0));
        let label = power(decade);
        let _ = writeln!(
            out,
            "<path d=\"M{at:.1} {}v5\"/><text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            TOP + UP,
            TOP + UP + 20.0
        );
    }
    for decade in y.decades() {
        let (_, at) = place(&(1.0, 10.0_f64.powi(decade)));
        let label = power(decade);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}h-5\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            LEFT - 8.0,
            at + 4.0
        );
    }
    let (middle, side) = (LEFT + 0.5 * ACROSS, TOP + 0.5 * UP);
    let _ = writeln!(out, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{x_name}</text>", TOP + UP + 42.0);
    let _ =
        writeln!(out, "<text transform=\"translate(16 {side}) rotate(-90)\" text-anchor=\"middle\">{y_name}</text>");
    for (i, curve) in curves.iter().enumerate() {
        let places: Vec<String> = curve.points.iter().map(place).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let (stroke, dash) = (STROKES[i % STROKES.len()], if i % 2 == 1 { " stroke-dasharray=\"5 3\"" } else { "" });
        let line = format!("fill=\"none\" stroke=\"{stroke}\" stroke-width=\"2\"{dash}");
        let _ = writeln!(out, "<polyline points=\"{}\" {line}/>", places.join(" "));
        let (at, text) = (TOP + 14.0 + 20.0 * i as f64, LEFT + ACROSS + 12.0);
        let _ = writeln!(out, "<polyline points=\"{text},{at} {},{at}\" {line}/>", text + 24.0);
        let _ = writeln!(out, "<text x=\"{}\" y=\"{}\">{}</text>", text + 30.0, at + 4.0, curve.name);
    }
    out + "</svg>\n"
}
