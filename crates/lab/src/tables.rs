//! Makes `energy/tables.rs` of the kernel: quadrature of GGX, a fit of what it loses if white, and fits of what it reflects.
//!
//! Bit for bit the same on every machine: square roots, plain arithmetic and the kernel's own polynomials in `f64`, no
//! function of a mathematics library, one thread. [`generate`] returns the file; `gonio tables` writes or compares it.

mod albedo;
mod decimals;
mod fit;
mod ggx;

pub(crate) use albedo::reflected;
pub(crate) use ggx::missing;

use decimals::{number, rounded};
use gonio_kernel::energy::{MEAN, Table, V, W};
use gonio_kernel::math::{ln, ln_1p};
use std::fmt::Write;

/// The text of `energy/tables.rs`.
pub fn generate() -> String {
    let table = make();
    let error = largest_error(&table);
    let mean_error = largest_error_of_mean(&table);
    let mut text = format!(
        "//! Made by `cargo xtask tables` (`crates/lab/src/tables`); do not edit.\n\
         //!\n\
         //! Against quadrature, between the nodes of the fit, for α in [1e-8, 1] and μ in (0, 1]: the largest error of E is\n\
         //! {error:.1e}. The largest relative error of 1 − E_avg against the integral of the approximation is {mean_error:.1e}.\n\n\
         use super::Table;\n\
         use super::albedo::{{NODES, Node}};\n\n\
         /// The coefficients.\n\
         #[rustfmt::skip]\n\
         pub static TABLE: Table = Table {{\n    missing: [\n"
    );
    for row in table.missing {
        let _ = writeln!(text, "        [{}],", row.map(number).join(", "));
    }
    text.push_str("    ],\n    missing_avg: [\n");
    for part in table.missing_avg.chunks(8) {
        let part: Vec<String> = part.iter().copied().map(number).collect();
        let _ = writeln!(text, "        {},", part.join(", "));
    }
    text.push_str("    ],\n};\n");
    text.push_str(&albedo::text(&albedo::make()));
    text
}

/// Fits both parts.
fn make() -> Table {
    let mut table = Table { missing: [[0.0; W]; V], missing_avg: [0.0; MEAN] };
    // The fit of ln P wants the absolute error of 1 − E least, so rows are weighted with it, and a little with 1, because small
    // losses should be right too; a breath of regularisation keeps coefficients small where no μ ≤ 1 lies.
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    for (mu, alpha) in nodes() {
        let v = (mu * (1.0 + 12.0 * alpha) / (mu + 12.0 * alpha)).sqrt().sqrt();
        let (tv, tw) = (fit::chebyshev(2.0 * v - 1.0, V), fit::chebyshev(2.0 * w_of(alpha) - 1.0, W));
        let far = mu + 4.0 * alpha;
        let factor = 4.0 * (mu / far) * (alpha / far) * (alpha / (mu + alpha)) * (1.0 + 12.0 * alpha * alpha);
        let missing = missing(mu, alpha);
        let weight = missing + 1e-4;
        rows.push(tv.iter().flat_map(|tv| tw.iter().map(move |tw| weight * tv * tw)).collect());
        right.push(weight * ln(missing / factor));
    }
    let solution = fit::least_squares(rows, right, 1e-6);
    for (row, fitted) in table.missing.iter_mut().zip(solution.chunks(W)) {
        for (c, fitted) in row.iter_mut().zip(fitted) {
            *c = rounded(*fitted);
        }
    }
    // The mean is that of the approximation. Every row counts relative to its value.
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    let widths = fit::nodes(2 * MEAN).chain([0.0, 1.0]).map(width_of);
    for alpha in widths.chain(fit::nodes(2 * MEAN)) {
        let scale = alpha * alpha * ln_1p(0.218 / alpha) / mean(&table, alpha);
        rows.push(fit::chebyshev(2.0 * alpha.sqrt() - 1.0, MEAN).into_iter().map(|t| scale * t).collect());
        right.push(1.0);
    }
    for (c, fitted) in table.missing_avg.iter_mut().zip(fit::least_squares(rows, right, 0.0)) {
        *c = rounded(fitted);
    }
    table
}

/// w of α in [0, 1].
fn w_of(alpha: f64) -> f64 {
    5.0 * alpha / (1.0 + 4.0 * alpha)
}

/// Where the fit is made: Chebyshev nodes of α and v, as far as quadrature reaches, and the edges.
fn nodes() -> Vec<(f64, f64)> {
    let mut nodes = Vec::new();
    for alpha in fit::nodes(24).chain([1.0, 0.03, 3e-3, 1e-3, 1e-5]) {
        for v in fit::nodes(30).chain([1.0]) {
            let mu = mu_of(v, alpha);
            // Beyond this the missing light is below 1e-9, and quadrature has nothing to add.
            if mu < 3e4 * alpha {
                nodes.push((mu, alpha));
            }
        }
        nodes.extend([1e-9, 1e-7, 1e-5, 1e-3].map(|t| (t * alpha, alpha)));
    }
    nodes
}

/// μ of v: v⁴ = μ(1 + 12α)/(μ + 12α).
fn mu_of(v: f64, alpha: f64) -> f64 {
    let part = v * v * v * v / (1.0 + 12.0 * alpha);
    (12.0 * alpha * part / (1.0 - part)).min(1.0)
}

/// 2∫(1 − E) μ dμ of the approximation.
fn mean(table: &Table, alpha: f64) -> f64 {
    let missing = table.missing(alpha);
    2.0 * ggx::double_exponential(160).iter().map(|n| n.weight * n.x * missing.at(n.x)).sum::<f64>()
}

/// The largest error of E between the nodes: another grid, in α, v and μ.
fn largest_error(table: &Table) -> f64 {
    let mut largest = 0.0_f64;
    let widths = (0..24).map(|i| (f64::from(i) + 0.5) / 24.0).chain([1e-8, 1e-6, 1e-4, 1e-3, 4e-3, 0.01, 0.03, 1.0]);
    for alpha in widths {
        let approximation = table.missing(alpha);
        for i in 0..=36 {
            // Evenly in v, and in μ.
            for mu in [mu_of((f64::from(i) + 0.3) / 37.0, alpha), f64::from(i).max(0.5) / 36.0] {
                if mu < 1e4 * alpha {
                    largest = largest.max((approximation.at(mu) - missing(mu, alpha)).abs());
                } else {
                    // There all that matters is that it is small: below α²/μ² times a constant.
                    largest = largest.max(approximation.at(mu) - 2.0 * (alpha / mu) * (alpha / mu));
                }
            }
        }
    }
    largest
}

fn largest_error_of_mean(table: &Table) -> f64 {
    let parts = (0..=100).map(|i| f64::from(i) / 100.0);
    let widths = parts.clone().map(width_of).chain(parts.skip(1));
    widths.map(|alpha| (table.missing_avg(alpha) / mean(table, alpha) - 1.0).abs()).fold(0.0, f64::max)
}

/// From 1e-8 for 0 to 1 for 1, evenly in the eighth root.
fn width_of(part: f64) -> f64 {
    let root = 0.1 + 0.9 * part;
    (0..3).fold(root, |power, _| power * power)
}

#[cfg(test)]
mod tests {
    use gonio_kernel::energy;

    #[test]
    fn a_compensated_white_surface_returns_all_light_also_between_the_nodes() {
        // E_true + (1 − E) · (integral of the approximation)/(1 − E_avg), at widths and angles that no table knows.
        let (mut least, mut most) = (1.0_f64, 1.0_f64);
        for i in 0..60 {
            let alpha = 10.0_f64.powf(-8.0 + 8.0 * f64::from(i) / 59.0);
            let ratio = super::mean(&energy::TABLE, alpha) / energy::missing_avg(alpha);
            for j in 0..60 {
                let mu = if j % 2 == 0 {
                    f64::from(j + 1) / 60.0
                } else {
                    (alpha * 10.0_f64.powf(-4.0 + f64::from(j) / 10.0)).min(1.0)
                };
                // Beyond this the true loss is below 1e-8.
                let lost = if mu < 1e4 * alpha { super::missing(mu, alpha) } else { 0.0 };
                let total = 1.0 - lost + energy::Missing::of(alpha).at(mu) * ratio;
                (least, most) = (least.min(total), most.max(total));
            }
        }
        assert!(least >= 1.0 - 1e-4 && most <= 1.0 + 1e-4, "{least} {most}");
    }

    /// A table of the test data as numbers; says so in one line if it is not there.
    fn cycles(name: &str) -> Option<Vec<f64>> {
        let usual = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
        let folder = std::env::var_os("GONIO_DATA").unwrap_or(usual.into());
        let path = std::path::Path::new(&folder).join("tables").join(name);
        let Ok(text) = std::fs::read_to_string(&path) else {
            println!("{name}: not there ({}), not run", path.display());
            return None;
        };
        Some(text.split([',', '\n', '\r']).filter_map(|x| x.trim().parse().ok()).collect())
    }

    #[test]
    fn blenders_tables_say_the_same() {
        let (Some(e), Some(mean)) = (cycles("cycles_ggx_E_32x32.csv"), cycles("cycles_ggx_Eavg_32.csv")) else {
            return;
        };
        assert!(e.len() == 1024 && mean.len() == 32, "{} {}", e.len(), mean.len());
        for j in 0..32 {
            let alpha = (j as f64 / 31.0).powi(2).max(1e-4);
            for i in 1..32 {
                // The rows are μ = i/31, the columns roughness j/31. Their noise and six digits: 1e-6 at most is seen.
                let (mu, there) = (i as f64 / 31.0, e[32 * i + j]);
                let (truth, fit) = (1.0 - super::missing(mu, alpha), energy::albedo(mu, alpha));
                assert!((truth - there).abs() < 5e-6, "μ {mu}, α {alpha}: {truth} and {there}");
                assert!((fit - there).abs() < 6e-5, "μ {mu}, α {alpha}: {fit} and {there}");
            }
            let fit = energy::albedo_avg(alpha);
            assert!((fit - mean[j]).abs() < 1e-4, "α {alpha}: {fit} and {}", mean[j]);
        }
    }
}
