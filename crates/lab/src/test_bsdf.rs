//! `TestBsdf`: a lobe with everything that instruments ask of it beyond `f32`: its `f64` twin, its lanes, its numbers.
//!
//! All of it follows from the declaration of the lobe's parameters ([`Parameters::map`] is the one walk over them), so every model,
//! mixture, layer and surface has it, a user's own too, with no line in this crate. Instruments see the lobe through `DynBsdf`, which
//! is the same without the types: they are compiled once, not once per lobe.

use crate::probe::{LobeProbe, Probe, WideProbe, lane_sample, lane_value, lanes_of};
use gonio_kernel::closure::Unguarded;
use gonio_kernel::model::{Parameter, Role};
use gonio_kernel::{BsdfSample, Closure, F32x8, Lobe, Parameters, Properties, Sample, Transport, Value, Vec3};

/// A number of a lobe, in the order of [`Parameters::map`].
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// Its declaration.
    pub parameter: &'static Parameter,
    /// 0, 1, 2: red, green, blue of a colour.
    pub channel: usize,
    /// To which lobe of a combination it belongs: a further one begins where a key comes again.
    pub lobe: usize,
    /// Its value.
    pub value: f32,
}

impl Number {
    /// Its name as in material files: `alpha_x`, `f0.r`.
    pub fn name(&self) -> String {
        let channel = if self.parameter.is_color { ["", ".r", ".g", ".b"][1 + self.channel.min(2)] } else { "" };
        format!("{}{channel}", self.parameter.key)
    }
    /// Whether it is of that role.
    pub(crate) fn is(&self, role: Role) -> bool {
        self.parameter.quantity.role == role
    }
}

/// A lobe with its `f64` twin, its lanes, and the same lobe at other numbers. Every [`Lobe`] in `f32` that is made of [`Parameters`]
/// and exists in `f64` and lanes is one; nobody implements it by hand.
pub trait TestBsdf<'t>: Lobe<f32> + Copy + Send + Sync + 't {
    /// It in `f64`.
    type Double: Lobe<f64> + Sync + 't;
    /// Eight of it side by side.
    type Lanes: Lobe<F32x8> + Sync + 't;

    /// Its numbers.
    fn numbers(&self) -> Vec<Number>;
    /// It in `f64`, each number exactly the same.
    fn double(&self) -> Self::Double;
    /// It in every lane.
    fn lanes(&self) -> Self::Lanes;
    /// With other numbers, in the order of [`TestBsdf::numbers`].
    fn at(&self, numbers: &[f32]) -> Self;
    /// The same in `f64`.
    fn double_at(&self, numbers: &[f64]) -> Self::Double;
    /// The same in lanes, each with its own numbers.
    fn lanes_at(&self, numbers: &[F32x8]) -> Self::Lanes;
    /// Eight side by side.
    fn gathered(eight: [&Self; 8]) -> Self::Lanes;
}

impl<'t, L> TestBsdf<'t> for L
where
    L: Lobe<f32> + Parameters<Real = f32, Of<f32> = L> + Send + Sync + 't,
    L::Of<f64>: Lobe<f64> + Sync + 't,
    L::Of<F32x8>: Lobe<F32x8> + Sync + 't,
{
    type Double = L::Of<f64>;
    type Lanes = L::Of<F32x8>;

    fn numbers(&self) -> Vec<Number> {
        let mut numbers: Vec<Number> = Vec::new();
        let _: L = self.map(&mut |parameter, channel, value| {
            let lobe = numbers.last().map_or(0, |last| last.lobe);
            let again = |n: &Number| n.lobe == lobe && n.parameter.key == parameter.key && n.channel == channel;
            let lobe = lobe + usize::from(numbers.iter().any(again));
            numbers.push(Number { parameter, channel, lobe, value });
            value
        });
        numbers
    }
    fn double(&self) -> L::Of<f64> {
        self.to::<f64>()
    }
    fn lanes(&self) -> L::Of<F32x8> {
        self.to::<F32x8>()
    }
    fn at(&self, numbers: &[f32]) -> L {
        let mut numbers = numbers.iter();
        self.map(&mut |_, _, own| numbers.next().copied().unwrap_or(own))
    }
    fn double_at(&self, numbers: &[f64]) -> L::Of<f64> {
        let mut numbers = numbers.iter();
        self.map(&mut |_, _, own| numbers.next().copied().unwrap_or(f64::from(own)))
    }
    fn lanes_at(&self, numbers: &[F32x8]) -> L::Of<F32x8> {
        let mut numbers = numbers.iter();
        self.map(&mut |_, _, own| numbers.next().copied().unwrap_or(F32x8::splat(own)))
    }
    fn gathered(eight: [&L; 8]) -> L::Of<F32x8> {
        L::gather(eight)
    }
}

/// What a lobe is asked at once: both directions, and three numbers for its sampler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question {
    pub(crate) wo: Vec3<f32>,
    pub(crate) wi: Vec3<f32>,
    pub(crate) u: [f32; 3],
}

/// What it answers without a guard, for radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// `eval` at wi.
    pub(crate) value: Value<f32>,
    /// What was sampled.
    pub(crate) sample: Sample<f32>,
    /// `eval` at the sampled direction.
    pub(crate) again: Value<f32>,
    /// `delta` of the sample.
    pub(crate) delta: Value<f32>,
}

/// A [`TestBsdf`] without its types: a lobe as a function of its numbers.
pub(crate) trait DynBsdf<'t>: Sync {
    /// Its numbers, with their values in this lobe.
    fn numbers(&self) -> Vec<Number>;
    /// Whether these numbers lie in its domain, as the kernel computes it.
    fn domain_at(&self, numbers: &[f32]) -> bool;
    /// Whether it is a combination of lobes.
    fn is_combination(&self) -> bool;
    /// What it claims of itself at these numbers.
    fn properties_at(&self, numbers: &[f64]) -> Properties<f64>;
    /// In `f32`, batches in lanes.
    fn single_probe(&self, numbers: &[f32]) -> Box<dyn Probe + 't>;
    /// In `f64`.
    fn double_probe(&self, numbers: &[f64]) -> Box<dyn Probe + 't>;
    /// One answer.
    fn answer(&self, numbers: &[f32], question: &Question) -> Answer;
    /// Eight answers in lanes, each with its own numbers.
    fn answer_lanes(&self, numbers: &[[f32; 8]], questions: &[Question; 8]) -> [Answer; 8];
    /// The same, with the lanes gathered from eight scalar lobes.
    fn answer_gathered(&self, numbers: &[Vec<f32>; 8], questions: &[Question; 8]) -> [Answer; 8];
    /// What the guarded closure answers.
    fn guarded(&self, numbers: &[f32], question: &Question) -> (Value<f32>, BsdfSample<f32>);
}

impl<'t, L: TestBsdf<'t>> DynBsdf<'t> for L {
    fn numbers(&self) -> Vec<Number> {
        TestBsdf::numbers(self)
    }
    fn domain_at(&self, numbers: &[f32]) -> bool {
        self.at(numbers).domain()
    }
    fn is_combination(&self) -> bool {
        L::LOBES > 1
    }
    fn properties_at(&self, numbers: &[f64]) -> Properties<f64> {
        self.double_at(numbers).properties()
    }
    fn single_probe(&self, numbers: &[f32]) -> Box<dyn Probe + 't> {
        let lobe = self.at(numbers);
        Box::new(WideProbe::new(lobe, lobe.lanes()))
    }
    fn double_probe(&self, numbers: &[f64]) -> Box<dyn Probe + 't> {
        Box::new(LobeProbe::<f64, L::Double>::new(self.double_at(numbers)))
    }
    fn answer(&self, numbers: &[f32], question: &Question) -> Answer {
        let closure = Unguarded::new(self.at(numbers), question.wo, Transport::Radiance);
        let sample = closure.sample(question.u);
        Answer {
            value: closure.eval(question.wi),
            sample,
            again: closure.eval(sample.wi),
            delta: closure.delta(&sample),
        }
    }
    fn answer_lanes(&self, numbers: &[[f32; 8]], questions: &[Question; 8]) -> [Answer; 8] {
        let numbers: Vec<F32x8> = numbers.iter().copied().map(F32x8::new).collect();
        answers(&self.lanes_at(&numbers), questions)
    }
    fn answer_gathered(&self, numbers: &[Vec<f32>; 8], questions: &[Question; 8]) -> [Answer; 8] {
        let eight: [L; 8] = std::array::from_fn(|l| self.at(&numbers[l]));
        answers(&L::gathered(eight.each_ref()), questions)
    }
    fn guarded(&self, numbers: &[f32], question: &Question) -> (Value<f32>, BsdfSample<f32>) {
        let closure = Closure::new(self.at(numbers), question.wo);
        (closure.eval(question.wi), closure.sample(question.u))
    }
}

fn answers<W: Lobe<F32x8>>(lanes: &W, questions: &[Question; 8]) -> [Answer; 8] {
    let closure = Unguarded::new(lanes, lanes_of(questions.map(|q| q.wo)), Transport::Radiance);
    let sample = closure.sample([0, 1, 2].map(|i| F32x8::new(questions.map(|q| q.u[i]))));
    let value = closure.eval(lanes_of(questions.map(|q| q.wi)));
    let (again, delta) = (closure.eval(sample.wi), closure.delta(&sample));
    std::array::from_fn(|l| Answer {
        value: lane_value(&value, l),
        sample: lane_sample(&sample, l),
        again: lane_value(&again, l),
        delta: lane_value(&delta, l),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_kernel::lobe::{Lambert, Mirror};
    use gonio_kernel::{Rgb, Surface};

    #[test]
    fn numbers_are_named_as_in_material_files_and_counted_by_lobe() {
        let matte = Lambert::new(Rgb::new(0.1_f32, 0.2, 0.3));
        let names = |numbers: Vec<Number>| {
            numbers.iter().map(|n| format!("{} {} {}", n.lobe, n.name(), n.value)).collect::<Vec<_>>().join(", ")
        };
        assert_eq!(names(TestBsdf::numbers(&matte)), "0 base_color.r 0.1, 0 base_color.g 0.2, 0 base_color.b 0.3");
        let surface = Surface::black().with(0.5, matte).unwrap().with(0.25, Mirror::new(Rgb::splat(1.0))).unwrap();
        let numbers = TestBsdf::numbers(&surface);
        assert_eq!(numbers.iter().map(|n| n.lobe).collect::<Vec<_>>(), [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
        assert_eq!(numbers[9].name(), "reflectance.r");
    }

    #[test]
    fn a_lobe_at_its_own_numbers_is_itself() {
        let matte = Lambert::new(Rgb::new(0.1_f32, 0.2, 0.3));
        let values: Vec<f32> = TestBsdf::numbers(&matte).iter().map(|number| number.value).collect();
        assert_eq!(matte.at(&values), matte);
        assert_eq!(matte.at(&[0.5]).albedo, Rgb::new(0.5, 0.2, 0.3));
    }
}
