//! Bars in cells of a table.

use crate::check::Check;
use crate::grade::severity;
use crate::markup::Html;
use crate::number::short;

/// Measured over limit on a logarithmic scale from 10⁻⁶ to 10, 100 wide.
pub(crate) fn of_check(check: &Check) -> Html {
    let place = |ratio: f64| (100.0 * (ratio.max(1e-300).log10() + 6.0) / 7.0).clamp(0.0, 100.0);
    let severity = severity(check);
    // Too small for the scale is still something; nothing at all is nothing.
    let width = if severity == 0.0 { 0.0 } else { place(severity).max(1.0) };
    let class = if check.failed() { "over" } else { "fill" };
    Html::raw(format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 8\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"{} of the limit\">\
         <rect class=\"track\" y=\"3\" width=\"100\" height=\"2\"/><rect class=\"{class}\" y=\"1\" width=\"{width:.1}\" height=\"6\"/>\
         <rect class=\"limit\" x=\"{:.1}\" width=\"1\" height=\"8\"/></svg>",
        short(severity),
        place(1.0),
    ))
}

/// A part of the most that there is. The number is beside it, so that it says nothing to those who do not see it.
pub(crate) fn of_share(share: f64) -> Html {
    Html::raw(format!(
        "<svg class=\"bar\" viewBox=\"0 0 100 8\" preserveAspectRatio=\"none\" aria-hidden=\"true\"><rect class=\"fill\" \
         y=\"1\" width=\"{:.1}\" height=\"6\"/></svg>",
        100.0 * share
    ))
}
