//! A surface as plain numbers in `f64`, whatever arithmetic computes inside: one at a time or eight side by side.

use super::precision::Precision;
use anyhow::{Context, Result, anyhow};
use gonio_kernel::{Closure, F32x8, Mask8, Parameters, Real, Rgb, Value, Vec3};
use gonio_tracer::{MaterialSurface, constant_surface};
use std::path::Path;

/// A local direction.
pub(super) type Direction = [f64; 3];

/// Value and density of a pair of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    /// f·|cos_i|, red, green and blue.
    pub(super) f_cos: [f64; 3],
    /// Density per solid angle.
    pub(super) pdf: f64,
}

/// What a sample did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Happening {
    Reflect,
    Transmit,
    Mirror,
    DiscreteTransmit,
    Failed,
}

/// A sampled direction and its value; all zeros if it failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drawn {
    pub(super) wi: Direction,
    pub(super) answer: Answer,
    /// f_cos / pdf.
    pub(super) weight: [f64; 3],
    pub(super) happening: Happening,
}

impl Happening {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Reflect => "reflect",
            Self::Transmit => "transmit",
            Self::Mirror => "mirror",
            Self::DiscreteTransmit => "discrete-transmit",
            Self::Failed => "failed",
        }
    }
}

/// A surface behind one of the arithmetics.
pub(super) trait Model {
    /// Values of pairs (wo, wi), in order.
    fn eval(&self, pairs: &[[Direction; 2]]) -> Vec<Answer>;
    /// One sample for each triple of uniform numbers, in order.
    fn sample(&self, wo: Direction, u: &[[f64; 3]]) -> Vec<Drawn>;
}

/// Reads a material file and prepares it for the wanted arithmetic.
pub(super) fn load(path: &Path, precision: Precision) -> Result<Box<dyn Model>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let material = gonio_io::material_from_toml_str(&text, path)?;
    let surface = constant_surface(&material)
        .ok_or_else(|| anyhow!("{}: a material with images cannot be evaluated by itself", path.display()))?;
    Ok(match precision {
        Precision::F32 => Box::new(surface),
        Precision::F64 => Box::new(surface.to::<f64>()),
        Precision::Lanes => Box::new(surface.to::<F32x8>()),
    })
}

/// A `Real` that is filled from, and read as, `f64`.
trait Packed: Real {
    /// How many numbers it holds.
    const COUNT: usize;
    /// Number i is `f(i)`, rounded.
    fn pack(f: impl FnMut(usize) -> f64) -> Self;
    /// Number i.
    fn get(self, i: usize) -> f64;
    /// Truth i.
    fn truth(mask: Self::Mask, i: usize) -> bool;
}

macro_rules! packed_scalar {
    ($t:ty) => {
        impl Packed for $t {
            const COUNT: usize = 1;
            fn pack(mut f: impl FnMut(usize) -> f64) -> $t {
                f(0) as $t
            }
            fn get(self, _: usize) -> f64 {
                f64::from(self)
            }
            fn truth(mask: bool, _: usize) -> bool {
                mask
            }
        }
    };
}
packed_scalar!(f32);
packed_scalar!(f64);

impl Packed for F32x8 {
    const COUNT: usize = F32x8::LANES;
    fn pack(mut f: impl FnMut(usize) -> f64) -> Self {
        Self::new(std::array::from_fn(|i| f(i) as f32))
    }
    fn get(self, i: usize) -> f64 {
        f64::from(self.to_array()[i])
    }
    fn truth(mask: Mask8, i: usize) -> bool {
        mask.lane(i)
    }
}

impl<R: Packed> Model for MaterialSurface<R> {
    fn eval(&self, pairs: &[[Direction; 2]]) -> Vec<Answer> {
        let mut answers = Vec::with_capacity(pairs.len());
        for group in pairs.chunks(R::COUNT) {
            // Lanes without a row get the zero vector, which is outside of the domain.
            let side = |which: usize| gather(|i, axis| group.get(i).map_or(0.0, |pair| pair[which][axis]));
            let value = Closure::new(self, side(0)).eval(side(1));
            answers.extend((0..group.len()).map(|i| answer(&value, i)));
        }
        answers
    }

    fn sample(&self, wo: Direction, u: &[[f64; 3]]) -> Vec<Drawn> {
        let closure = Closure::new(self, gather(|_, axis| wo[axis]));
        let mut all = Vec::with_capacity(u.len());
        for group in u.chunks(R::COUNT) {
            let column = |axis: usize| R::pack(|i| group.get(i).map_or(0.0, |u| u[axis]));
            let sample = closure.sample([column(0), column(1), column(2)]);
            let value = Value { f_cos: sample.f_cos, pdf: sample.pdf };
            let weight = sample.weight;
            for i in 0..group.len() {
                let event = &sample.event;
                let happening = match (R::truth(event.is_delta, i), R::truth(event.transmitted, i)) {
                    _ if R::truth(event.failed, i) => Happening::Failed,
                    (false, false) => Happening::Reflect,
                    (false, true) => Happening::Transmit,
                    (true, false) => Happening::Mirror,
                    (true, true) => Happening::DiscreteTransmit,
                };
                let nothing = Answer { f_cos: [0.0; 3], pdf: 0.0 };
                all.push(if happening == Happening::Failed {
                    Drawn { wi: [0.0; 3], answer: nothing, weight: [0.0; 3], happening }
                } else {
                    let wi = [sample.wi.x, sample.wi.y, sample.wi.z].map(|x| x.get(i));
                    Drawn { wi, answer: answer(&value, i), weight: channels(&weight, i), happening }
                });
            }
        }
        all
    }
}

fn gather<R: Packed>(mut f: impl FnMut(usize, usize) -> f64) -> Vec3<R> {
    let mut axis = |axis| R::pack(|i| f(i, axis));
    Vec3::new(axis(0), axis(1), axis(2))
}

fn answer<R: Packed>(value: &Value<R>, i: usize) -> Answer {
    Answer { f_cos: channels(&value.f_cos, i), pdf: value.pdf.get(i) }
}

fn channels<R: Packed>(rgb: &Rgb<R>, i: usize) -> [f64; 3] {
    [rgb.r, rgb.g, rgb.b].map(|x| x.get(i))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::lobe::{Lambert, Mirror};

    fn surface<R: Real>() -> MaterialSurface<R> {
        let (half, lambert) = (R::lit(0.5), Lambert::new(Rgb::splat(R::lit(0.8))));
        let surface = MaterialSurface::empty().with(half, lambert);
        surface.and_then(|surface| surface.with(half, Mirror::new(Rgb::splat(R::ONE)))).expect("there is room for two")
    }

    #[test]
    fn eight_side_by_side_give_the_same_bits_as_one_by_one() {
        let u: Vec<[f64; 3]> =
            (0..1003).map(|i| std::array::from_fn(|k| gonio_lab::random::unit(3, i, k as u64))).collect();
        let wo = [0.6, 0.0, 0.8];
        let (ones, eights) = (surface::<f32>().sample(wo, &u), surface::<F32x8>().sample(wo, &u));
        assert_eq!(ones, eights);
        let pairs: Vec<_> = ones.iter().map(|drawn| [wo, drawn.wi]).collect();
        assert_eq!(surface::<f32>().eval(&pairs), surface::<F32x8>().eval(&pairs));
    }

    #[test]
    fn a_mirror_is_worth_its_probability_times_its_weight() {
        let drawn = surface::<f64>().sample([0.6, 0.0, 0.8], &[[0.99, 0.5, 0.5]])[0];
        assert_eq!(drawn.happening, Happening::Mirror);
        assert_eq!(drawn.wi, [-0.6, 0.0, 0.8]);
        // It is chosen with probability 0.5·1/(0.5·0.8 + 0.5·1) and returns 0.5·1 of the light on the whole.
        assert!((drawn.answer.pdf - 0.5 / 0.9).abs() < 1e-15);
        assert!((drawn.answer.f_cos[0] - 0.5).abs() < 1e-15);
        assert!((drawn.weight[0] - 0.9).abs() < 1e-15);
    }
}
