//! What a census proves: limits on the counts, per specimen, scale and backend.
//!
//! An exact backend may not differ from brute in one bit of one ray, and may leak nowhere. A close one may differ on at most
//! 1 in 10⁵ ordinary rays, and may not leak at edges from inside of closed surfaces. That Embree does leak at vertices, in its
//! robust mode too, is counted and listed, but is no fault of ours; and what it does with rays aimed at edges, vertices and
//! planes otherwise is rounding's to decide. Of a fast backend
//! nothing is required.

use super::family::Family;
use super::record::Row;
use super::standard::{ORACLE, Standard};
use serde::Serialize;

/// One ray in so many may disagree.
const RATE: u64 = 100_000;

/// A count and the most that it may be.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// What was cast at.
    pub specimen: String,
    /// The factor on all lengths.
    pub scale: f64,
    /// Whose rays were counted.
    pub backend: String,
    /// What was counted.
    pub what: What,
    /// Rays that were looked at.
    pub rays: u64,
    /// How many of them.
    pub count: u64,
    /// The most that may be.
    pub limit: u64,
}

/// What was counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// Rays that disagree with brute.
    Disagreements,
    /// Rays that pass a surface which must stop them.
    Leaks,
}

impl Finding {
    /// Whether the count keeps its limit.
    pub fn passed(&self) -> bool {
        self.count <= self.limit
    }
}

/// Whether disagreements count against a backend.
pub(crate) fn counts_disagreements(standard: Standard, family: Family, needles: bool) -> bool {
    match standard {
        Standard::Exact => true,
        // Which side of a needle a ray starts on is rounding's to decide as well.
        Standard::Close => family.is_ordinary() && !(needles && family.leaves_a_surface()),
        Standard::Reported => false,
    }
}

/// Whether leaks count against a backend.
pub(crate) fn counts_leaks(standard: Standard, family: Family) -> bool {
    match standard {
        Standard::Exact => true,
        Standard::Close => family == Family::EdgeFromInside,
        Standard::Reported => false,
    }
}

/// Whether the disagreements of a row are limited; brute cannot disagree with itself.
pub(crate) fn is_judged(row: &Row) -> bool {
    row.backend != ORACLE && counts_disagreements(row.standard, row.family, row.needles)
}

/// Whether the leaks of a row are limited: those of rays that a surface must stop.
pub(crate) fn forbids_leaks(row: &Row) -> bool {
    counts_leaks(row.standard, row.family) && (row.standard != Standard::Exact || row.must_hit > 0)
}

/// How many of so many rays may disagree.
pub(crate) fn allowed(standard: Standard, rays: u64) -> u64 {
    if standard == Standard::Exact { 0 } else { rays.div_ceil(RATE) }
}

/// The findings of all rows, families taken together.
pub(crate) fn judge(rows: &[Row]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    let mut add = |row: &Row, what, rays, count| {
        let same = |f: &Finding| {
            f.what == what && f.specimen == row.specimen && f.backend == row.backend && f.scale == row.scale
        };
        let place = findings.iter().position(same).unwrap_or_else(|| {
            let (specimen, backend) = (row.specimen.clone(), row.backend.clone());
            findings.push(Finding { specimen, scale: row.scale, backend, what, rays: 0, count: 0, limit: 0 });
            findings.len() - 1
        });
        let finding = &mut findings[place];
        finding.rays += rays;
        finding.count += count;
        if what == What::Disagreements {
            finding.limit = allowed(row.standard, finding.rays);
        }
    };
    for row in rows {
        if is_judged(row) {
            add(row, What::Disagreements, row.rays, row.exceptions());
        }
        if forbids_leaks(row) {
            add(row, What::Leaks, row.must_hit, row.leaks);
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(standard: Standard, family: Family, rays: u64, prim: u64, leaks: u64) -> Row {
        Row { rays, must_hit: rays, prim, leaks, ..Row::new("s", 1.0, family, "b", standard) }
    }

    fn verdict(rows: &[Row]) -> Vec<(What, u64, u64, bool)> {
        judge(rows).iter().map(|f| (f.what, f.count, f.limit, f.passed())).collect()
    }

    #[test]
    fn an_exact_backend_may_not_differ_once_nor_leak_once() {
        use What::{Disagreements, Leaks};
        let rows = |prim, leaks| [row(Standard::Exact, Family::Far, 1_000_000, prim, leaks)];
        assert_eq!(verdict(&rows(0, 0)), [(Disagreements, 0, 0, true), (Leaks, 0, 0, true)]);
        assert_eq!(verdict(&rows(1, 0))[0], (Disagreements, 1, 0, false));
        assert_eq!(verdict(&rows(0, 1))[1], (Leaks, 1, 0, false));
    }

    #[test]
    fn a_close_backend_may_differ_on_one_ordinary_ray_in_100000_and_leak_at_edges_from_inside_never() {
        let ordinary = [Family::Camera, Family::Random].map(|f| row(Standard::Close, f, 150_000, 2, 0));
        assert_eq!(verdict(&ordinary), [(What::Disagreements, 4, 3, false)]);
        assert_eq!(verdict(&ordinary[..1]), [(What::Disagreements, 2, 2, true)]);
        assert_eq!(verdict(&[row(Standard::Close, Family::Edge, 10, 10, 10)]), []);
        let needles = |standard, family| verdict(&[Row { needles: true, ..row(standard, family, 10, 10, 0) }]).len();
        assert_eq!(needles(Standard::Close, Family::Secondary), 0);
        assert!(needles(Standard::Close, Family::Camera) > 0 && needles(Standard::Exact, Family::Secondary) > 0);
        assert_eq!(verdict(&[row(Standard::Close, Family::EdgeFromInside, 10, 10, 1)]), [(What::Leaks, 1, 0, false)]);
        assert_eq!(verdict(&[row(Standard::Close, Family::VertexFromInside, 10, 10, 1)]), []);
    }

    #[test]
    fn of_a_fast_backend_nothing_is_required() {
        assert_eq!(verdict(&[row(Standard::Reported, Family::EdgeFromInside, 10, 10, 10)]), []);
    }
}
