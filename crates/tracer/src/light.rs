//! Lights: emitting triangles and the constant environment, and the choice between them.
//!
//! A triangle is chosen with probability proportional to its power (area times luminance), so the density of a point is
//! luminance / Σ(area · luminance), the same on all triangles of a material. If there are both kinds of light, each gets
//! half of the samples; an absent kind has probability exactly 0. The environment is sampled by cosine about the shading
//! normal.

use gonio_kernel::{F32x8, Real, Rgb, U32x8, Vec3, each_lane};

/// An emitting triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emitter {
    pub(crate) corners: [Vec3<f32>; 3],
    /// The side of the winding that emits, unit.
    pub(crate) normal: Vec3<f32>,
    pub(crate) radiance: Rgb<f32>,
}

/// All lights of a world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    emitters: Vec<Emitter>,
    alias: Vec<(f32, u32)>,
    /// Σ area · luminance.
    power: f64,
    environment: Option<Rgb<f32>>,
}

/// Eight emitters side by side.
pub(crate) struct Emitters {
    pub(crate) corners: [Vec3<F32x8>; 3],
    pub(crate) normal: Vec3<F32x8>,
    pub(crate) radiance: Rgb<F32x8>,
}

impl Lights {
    /// Lights of positive luminance; zero radiance means no environment.
    pub(crate) fn new(emitters: Vec<Emitter>, environment: Rgb<f32>) -> Self {
        let weights: Vec<f64> = emitters.iter().map(|e| e.area() * f64::from(e.radiance.luminance())).collect();
        let environment = (environment.largest() > 0.0).then_some(environment);
        Self { alias: alias_table(&weights), power: weights.iter().sum(), emitters, environment }
    }

    /// The radiance of the environment, black if there is none.
    pub(crate) fn environment(&self) -> Rgb<f32> {
        self.environment.unwrap_or(Rgb::zero())
    }

    /// Probability of asking the environment.
    pub(crate) fn environment_probability(&self) -> f32 {
        match (self.environment, self.emitters.is_empty()) {
            (None, _) => 0.0,
            (Some(_), true) => 1.0,
            (Some(_), false) => 0.5,
        }
    }

    /// Density per area of choosing a point of an emitting triangle, per luminance of its radiance; the choice of strategy
    /// included.
    pub(crate) fn pdf_area_per_luminance(&self) -> f32 {
        if self.emitters.is_empty() {
            return 0.0;
        }
        let share = 1.0 - f64::from(self.environment_probability());
        (share / self.power) as f32
    }

    /// Eight emitters for two random words each.
    #[inline(always)]
    pub(crate) fn pick(&self, place: U32x8, toss: F32x8) -> Emitters {
        let emitters = each_lane(|lane| &self.emitters[self.slot(place.lane(lane), toss.lane(lane))]);
        let corner = |c: usize| Vec3::from_lanes(|l| emitters[l].corners[c]);
        Emitters {
            corners: [corner(0), corner(1), corner(2)],
            normal: Vec3::from_lanes(|l| emitters[l].normal),
            radiance: Rgb::new(
                F32x8::from_fn(|l| emitters[l].radiance.r),
                F32x8::from_fn(|l| emitters[l].radiance.g),
                F32x8::from_fn(|l| emitters[l].radiance.b),
            ),
        }
    }
}

impl Lights {
    /// An emitter by its power: a 32-bit word times the count gives every slot its share to 2⁻³² of the whole.
    #[inline(always)]
    fn slot(&self, place: u32, toss: f32) -> usize {
        let slot = ((u64::from(place) * self.alias.len() as u64) >> 32) as usize;
        let (keep, other) = self.alias[slot];
        if toss < keep { slot } else { other as usize }
    }
}

impl Emitter {
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners.map(|v| Vec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z)));
        0.5 * (b - a).cross(c - a).length()
    }
}

/// Vose's alias method (1991): slot i keeps itself with the first probability and else yields the second index.
fn alias_table(weights: &[f64]) -> Vec<(f32, u32)> {
    let n = weights.len();
    let sum: f64 = weights.iter().sum();
    let mut scaled: Vec<f64> = weights.iter().map(|w| w * n as f64 / sum).collect();
    let mut table: Vec<(f32, u32)> = (0..n as u32).map(|i| (1.0, i)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
    while let (Some(s), Some(&l)) = (small.pop(), large.last()) {
        table[s] = (scaled[s] as f32, l as u32);
        scaled[l] -= 1.0 - scaled[s];
        if scaled[l] < 1.0 {
            large.pop();
            small.push(l);
        }
    }
    table
}

/// The power heuristic with exponent 2 (Veach & Guibas 1995): the weight of a sample of density `a` that could also have
/// been drawn with density `b`. Written as a ratio, so that huge densities do not overflow; 1 where b is 0.
#[inline(always)]
pub(crate) fn power_heuristic(a: F32x8, b: F32x8) -> F32x8 {
    let r = b / a;
    r.mul_add(r, F32x8::ONE).recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_alias_table_reproduces_the_weights() {
        let weights = [1.0, 0.25, 7.0, 3.5, 0.0, 2.0];
        let table = alias_table(&weights);
        let mut got = [0.0; 6];
        for (i, &(keep, other)) in table.iter().enumerate() {
            got[i] += f64::from(keep) / 6.0;
            got[other as usize] += (1.0 - f64::from(keep)) / 6.0;
        }
        for (g, w) in got.iter().zip(weights) {
            assert!((g - w / 13.75).abs() < 1e-7, "{got:?}");
        }
    }
}
