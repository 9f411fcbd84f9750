//! The warps against their own densities: cosine hemisphere, uniform sphere, uniform triangle.
//!
//! A warp of directions is a probe whose value is its density, so the instruments for lobes measure it: χ², Jacobian,
//! weight 1. The triangle has its own χ², over 64 congruent triangles of expected share 1/64 each.

use crate::finding::{Finding, Run};
use crate::probe::{BsdfValue, Dir, Draw, Kind, Probe, Scalar, demote, promote};
use crate::statistics::chi2_p;
use crate::under_test::{Claims, UnderTest};
use gonio_kernel::{Properties, warp};

/// A warp of directions, as a scattering model that does not look at wo.
pub(crate) struct WarpProbe {
    /// The direction of two uniform numbers.
    pub(crate) sample: fn([f64; 2]) -> Dir,
    /// Its density.
    pub(crate) pdf: fn(Dir) -> f64,
    /// Whether it computes in `f32`.
    pub(crate) single: bool,
}

/// The warps of directions.
pub(crate) fn under_test() -> [UnderTest<'static>; 4] {
    let warp = |name, sample, pdf, single| {
        let properties = Properties { one_to_one: true, ..Properties::LAWFUL };
        let claims = Claims { properties, ..Claims::LAWFUL };
        UnderTest::of_probe(name, WarpProbe { sample, pdf, single }, claims)
    };
    [
        warp(
            "cosine hemisphere",
            |u| promote(warp::sample_cosine_hemisphere(u.map(|u| u as f32))),
            |w| warp::pdf_cosine_hemisphere(demote(w)).widen(),
            true,
        ),
        warp("cosine hemisphere", warp::sample_cosine_hemisphere, warp::pdf_cosine_hemisphere, false),
        warp(
            "uniform sphere",
            |u| promote(warp::sample_uniform_sphere(u.map(|u| u as f32))),
            |_| warp::pdf_uniform_sphere::<f32>().widen(),
            true,
        ),
        warp("uniform sphere", warp::sample_uniform_sphere, |_| warp::pdf_uniform_sphere(), false),
    ]
}

impl Probe for WarpProbe {
    fn eval(&self, _wo: Dir, wi: Dir) -> BsdfValue {
        let pdf = (self.pdf)(wi);
        BsdfValue { f_cos: [pdf; 3], pdf }
    }
    fn sample(&self, _wo: Dir, u: [f64; 3]) -> Draw {
        let wi = (self.sample)([u[1], u[2]]);
        Draw { wi, kind: Kind::Continuous, transmitted: wi.z < 0.0 }
    }
    fn single(&self) -> bool {
        self.single
    }
}

/// Barycentric coordinates (b₁, b₂) of two uniform numbers.
pub(crate) type TriangleWarp = fn([f64; 2]) -> [f64; 2];

/// The kernel's triangle in `f32`.
pub(crate) fn triangle_single(u: [f64; 2]) -> [f64; 2] {
    warp::sample_uniform_triangle(u.map(|u| u as f32)).map(f64::from)
}

/// χ² over the 64 congruent parts of the unit triangle, whose density must be 2.
pub(crate) fn measure_triangle(sample: TriangleWarp, run: &Run) -> Finding {
    const SIDE: usize = 8;
    let mut random = run.random();
    let mut finding = Finding::p_value(run.level);
    let n = run.by_effort(400_000, 4_000_000, 10_000_000);
    let mut counts = [[0_u64; 2]; SIDE * SIDE];
    for _ in 0..n {
        let [b1, b2] = sample([random.coarse(), random.coarse()]);
        if !(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + f64::from(f32::EPSILON)) {
            finding.broken(|| format!("({b1}, {b2}) lies outside the triangle"));
            return finding;
        }
        // The part: a square of the grid, and which half of it. The sum of the fractions rounds nothing in f64.
        let (x, y) = (b1 * SIDE as f64, b2 * SIDE as f64);
        let (i, j) = (x.floor().min(7.0), y.floor().min(7.0));
        let upper = (x - i) + (y - j) > 1.0 && i + j < (SIDE - 1) as f64;
        counts[i as usize * SIDE + j as usize][usize::from(upper)] += 1;
    }
    let expected = n as f64 * warp::pdf_uniform_triangle::<f64>() * 0.5 / (SIDE * SIDE) as f64;
    let mut statistic = 0.0;
    for i in 0..SIDE {
        for j in 0..SIDE - i {
            let halves = if i + j == SIDE - 1 { 1 } else { 2 };
            statistic +=
                counts[i * SIDE + j][..halves].iter().map(|&c| (c as f64 - expected).powi(2) / expected).sum::<f64>();
        }
    }
    finding
        .lower(chi2_p(statistic, (SIDE * SIDE - 1) as f64), || format!("χ² = {statistic:.1} in {} bins", SIDE * SIDE));
    finding
}
