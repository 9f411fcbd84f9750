//! Cells of about equal probability that follow a lobe, however narrow, and integrals over them.
//!
//! Samples of a pilot run are sorted into 16 slabs of t = 1 − cosθ, and each slab into 8 cells of azimuth φ about the
//! mirror direction, at their quantiles; the horizon t = 1 is always a border. So the cells are as small as the lobe where
//! the lobe is, their number of samples is known in advance, and they are rectangles in coordinates that preserve solid
//! angle: dω = dt dφ. Integration runs over s = √t (dω = 2s ds dφ), because sinθ = s√(2 − s²) is smooth at the pole.
//! The pilot only places borders: cells need not be exactly equal for a test to be exact.

use crate::probe::{BsdfValue, Dir, Kind, Probe};
use crate::quadrature::{Integral, integrate};
use crate::random::Random;
use gonio_kernel::Vec3;

const SLABS: usize = 16;
const SECTORS: usize = 8;
/// How many bins a lobe of one hemisphere has, with that of failures.
pub(crate) const USUAL_BINS: usize = SLABS * SECTORS + 1;
/// Cells hold 128 pilot samples on average, so their probabilities are equal to about 9 %.
const PILOT: usize = 16_384;

/// The partition of the sphere for one wo.
#[derive(Debug)]
pub(crate) struct Cells {
    /// Cosine and sine of the mirror direction's azimuth.
    azimuth: (f64, f64),
    /// Borders of the slabs in t, from 0 to 2.
    slabs: Vec<f64>,
    /// Borders of each slab's sectors as pseudo-angles, from −2 to 2.
    sectors: Vec<Vec<f64>>,
    /// The same without the ends, in arrays of fixed length, which are searched without a branch.
    inner: ([f64; SLABS], Vec<[f64; SECTORS - 1]>),
}

impl Cells {
    /// Cells that follow what `probe` samples at wo.
    pub(crate) fn following(probe: &dyn Probe, wo: Dir, random: &mut Random) -> Self {
        let azimuth = if wo.x == 0.0 && wo.y == 0.0 {
            (1.0, 0.0)
        } else {
            let sin = wo.x.hypot(wo.y);
            (-wo.x / sin, -wo.y / sin)
        };
        let u: Vec<[f64; 3]> = (0..PILOT).map(|_| random.sampler_input(probe.single())).collect();
        let mut draws = Vec::with_capacity(PILOT);
        probe.sample_all(wo, &u, &mut draws);
        let mut points: Vec<(f64, f64)> = draws
            .iter()
            .filter(|draw| draw.kind == Kind::Continuous)
            .filter_map(|draw| coordinates(draw.wi, azimuth))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));

        let mut slabs = quantiles(&points.iter().map(|p| p.0).collect::<Vec<_>>(), SLABS, 0.0, 2.0);
        if let Err(at) = slabs.binary_search_by(|b| b.total_cmp(&1.0)) {
            slabs.insert(at, 1.0);
        }
        let sectors: Vec<Vec<f64>> = slabs
            .windows(2)
            .map(|slab| {
                let mut phi: Vec<f64> =
                    points.iter().filter(|p| slab[0] <= p.0 && p.0 < slab[1]).map(|p| p.1).collect();
                phi.sort_by(f64::total_cmp);
                quantiles(&phi, SECTORS, -2.0, 2.0)
            })
            .collect();
        // Should a quantile lie at the horizon itself, there is one border less.
        let inner_slabs = std::array::from_fn(|i| *slabs[1..slabs.len() - 1].get(i).unwrap_or(&f64::INFINITY));
        let inner_sectors = sectors.iter().map(|s| std::array::from_fn(|i| s[i + 1])).collect();
        Self { azimuth, slabs, sectors, inner: (inner_slabs, inner_sectors) }
    }

    /// How many cells there are.
    pub(crate) fn len(&self) -> usize {
        self.sectors.iter().map(|s| s.len() - 1).sum()
    }

    /// The cell of a direction, or none if it is not a direction.
    pub(crate) fn index(&self, wi: Dir) -> Option<usize> {
        let (t, phi) = coordinates(wi, self.azimuth)?;
        let slab = find(&self.inner.0, t);
        Some(slab * SECTORS + find(&self.inner.1[slab], phi))
    }

    /// The width of a typical cell \[rad\], the lesser of its two.
    pub(crate) fn width(&self) -> f64 {
        let median = |widths: Vec<f64>| {
            let mut widths = widths;
            widths.sort_by(f64::total_cmp);
            widths[widths.len() / 2]
        };
        let sin = |t: f64| (t * (2.0 - t)).sqrt();
        let along = self.slabs.windows(2).map(|t| (t[1] - t[0]) / sin(0.5 * (t[0] + t[1])));
        let across = self.slabs.windows(2).zip(&self.sectors).map(|(t, sectors)| {
            sin(0.5 * (t[0] + t[1])) * median(sectors.windows(2).map(|p| angle(p[1]) - angle(p[0])).collect())
        });
        median(along.collect()).min(median(across.collect()))
    }

    /// ∫ f_cos dω (three channels), ∫ pdf dω and ∫ f_cos²/pdf dω (three channels) over each cell.
    pub(crate) fn integrate(&self, probe: &dyn Probe, wo: Dir) -> Vec<Integral> {
        let (cos, sin) = self.azimuth;
        let f = |s: f64, phi: f64| {
            let z = 1.0 - s * s;
            let radius = s * (2.0 - s * s).max(0.0).sqrt();
            let (x, y) = (radius * phi.cos(), radius * phi.sin());
            let wi = probe.snap(Vec3::new(x * cos - y * sin, x * sin + y * cos, z));
            let BsdfValue { f_cos: f, pdf } = probe.eval(wo, wi);
            // Where the density has run out of numbers, f has nearly.
            let square = |f: f64| if f < 1e-290 { 0.0 } else { f * f / pdf };
            [f[0], f[1], f[2], pdf, square(f[0]), square(f[1]), square(f[2])].map(|v| 2.0 * s * v)
        };
        // An f32 integrand is rough at the level of its rounding: refining beyond that is waste.
        let budget = if probe.single() { 2_000 } else { 40_000 };
        let mut cells = Vec::with_capacity(self.len());
        let slabs: Vec<f64> = self.slabs.iter().map(|t| t.sqrt()).collect();
        for (slab, sectors) in graded(&slabs).into_iter().zip(&self.sectors) {
            let sectors: Vec<f64> = sectors.iter().map(|&p| angle(p)).collect();
            for sector in graded(&sectors) {
                let mut cell = Integral::default();
                for s in slab.windows(2) {
                    for phi in sector.windows(2) {
                        cell.add(&integrate(&f, [[s[0], s[1]], [phi[0], phi[1]]], TOLERANCE, budget));
                    }
                }
                cells.push(cell);
            }
        }
        cells
    }

    /// The sum of the cells.
    pub(crate) fn total(cells: &[Integral]) -> Integral {
        let mut sum = Integral::default();
        cells.iter().for_each(|cell| sum.add(cell));
        sum
    }
}

/// Absolute tolerance per cell: 10⁻⁹ over all of them, a hundredth of what 10⁷ samples can resolve in an empty bin.
const TOLERANCE: f64 = 1e-11;

/// Each interval between borders, cut into parts that grow eightfold from the width of a much narrower neighbour. The
/// outermost cells hold the whole tail of a lobe, with nearly all of its mass at one corner: a rule laid over the whole
/// cell would miss it, and so would its halves, and they would agree.
fn graded(borders: &[f64]) -> Vec<Vec<f64>> {
    const RATIO: f64 = 8.0;
    let widths: Vec<f64> = borders.windows(2).map(|b| b[1] - b[0]).collect();
    let from = |width: f64, neighbour: Option<&f64>| -> Vec<f64> {
        let mut steps = Vec::new();
        let mut step = neighbour.map_or(width, |&n| n.max(1e-12));
        while RATIO * step < width {
            steps.push(step);
            step *= RATIO;
        }
        steps
    };
    (0..widths.len())
        .map(|i| {
            let left = i.checked_sub(1).and_then(|i| widths.get(i));
            let mut parts: Vec<f64> = vec![borders[i], borders[i + 1]];
            parts.extend(from(widths[i], left).iter().map(|step| borders[i] + step));
            parts.extend(from(widths[i], widths.get(i + 1)).iter().map(|step| borders[i + 1] - step));
            parts.sort_by(f64::total_cmp);
            parts
        })
        .collect()
}

/// t = 1 − cosθ in [0, 2] without cancellation, and the pseudo-angle of φ. A direction above the horizon has t < 1.
fn coordinates(w: Dir, (cos, sin): (f64, f64)) -> Option<(f64, f64)> {
    let sin2 = w.x * w.x + w.y * w.y;
    let length = (sin2 + w.z * w.z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let t = if w.z > 0.0 {
        (sin2 / (length * (length + w.z))).min(1.0 - f64::EPSILON)
    } else {
        (1.0 - w.z / length).clamp(1.0, 2.0)
    };
    Some((t, pseudo_angle(w.x * cos + w.y * sin, w.y * cos - w.x * sin)))
}

/// Monotone in atan2(y, x), from −2 to 2, without a transcendental function: the position along a square's rim.
fn pseudo_angle(x: f64, y: f64) -> f64 {
    let norm = x.abs() + y.abs();
    if norm == 0.0 {
        return 0.0;
    }
    let p = y / norm;
    if x >= 0.0 { p } else { 2.0_f64.copysign(y) - p }
}

/// The angle of a pseudo-angle.
fn angle(p: f64) -> f64 {
    let y = if p.abs() <= 1.0 { p } else { (2.0 - p.abs()).copysign(p) };
    y.atan2(1.0 - p.abs())
}

/// Borders of `n` parts with equally many of the sorted values, from lo to hi; equal parts of the range if too few.
fn quantiles(sorted: &[f64], n: usize, lo: f64, hi: f64) -> Vec<f64> {
    let mut borders: Vec<f64> = (0..=n)
        .map(|i| {
            if sorted.len() < 4 * n {
                return lo + (hi - lo) * i as f64 / n as f64;
            }
            let at = i * sorted.len() / n;
            0.5 * (sorted[at.saturating_sub(1)] + sorted[at.min(sorted.len() - 1)])
        })
        .collect();
    borders[0] = lo;
    borders[n] = hi;
    borders
}

/// How many of the borders are not above x.
fn find<const N: usize>(borders: &[f64; N], x: f64) -> usize {
    borders.iter().map(|&b| usize::from(b <= x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::direction;

    #[test]
    fn pseudo_angles_follow_angles() {
        for i in -31..=31 {
            let phi = f64::from(i) * 0.1;
            assert!((angle(pseudo_angle(phi.cos(), phi.sin())) - phi).abs() < 1e-14);
        }
    }

    #[test]
    fn a_direction_just_above_the_horizon_stays_above() {
        let (t, _) = coordinates(direction(1e-40, 1.0), (1.0, 0.0)).unwrap();
        assert!(t < 1.0);
    }
}
