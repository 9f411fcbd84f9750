//! `Probe`: a scattering model as an instrument sees it. Plain `f64` in and out, whatever computes inside.
//!
//! Instruments are written once against this trait and compiled once. A direction or random number handed to a probe of
//! `f32` arithmetic must lie on its lattice: [`Probe::snap`] puts it there, so that nothing is rounded unseen. Lobes are asked for
//! importance, of which energy is conserved, and without the closure's guard: what is measured is what the formulas do by themselves.

use gonio_kernel::closure::Unguarded;
use gonio_kernel::{Event, F32x8, Lobe, Mask8, Precision, Real, Rgb, Sample, Transport, Value, Vec3};
use std::marker::PhantomData;

/// A direction, local.
pub(crate) type Dir = Vec3<f64>;

/// f·|cos_i| per channel and density, as the probe's arithmetic gave them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BsdfValue {
    /// f·|cos_i| \[1/sr\]; for a delta event its weight times its probability.
    pub(crate) f_cos: [f64; 3],
    /// Density \[1/sr\]; for a delta event its probability.
    pub(crate) pdf: f64,
}

impl BsdfValue {
    /// The same numbers in `f64`.
    pub(crate) fn of<R: Scalar>(value: Value<R>) -> Self {
        let Rgb { r, g, b } = value.f_cos;
        Self { f_cos: [r.widen(), g.widen(), b.widen()], pdf: value.pdf.widen() }
    }
    /// f_cos / pdf per channel.
    pub(crate) fn weight(&self) -> [f64; 3] {
        self.f_cos.map(|f| f / self.pdf)
    }
    /// The four numbers.
    pub(crate) fn numbers(&self) -> [f64; 4] {
        [self.f_cos[0], self.f_cos[1], self.f_cos[2], self.pdf]
    }
    /// All four finite and none negative.
    pub(crate) fn is_sound(&self) -> bool {
        self.numbers().iter().all(|x| x.is_finite() && *x >= 0.0)
    }
}

/// What a sample turned out to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// From the continuous part: its value is that of `eval`.
    Continuous,
    /// A delta event of this value. The label tells events of one wo apart: lobe, reflected or transmitted.
    Delta(BsdfValue, (u32, bool)),
    /// Nothing was sampled.
    Failed,
}

/// A sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw {
    /// Its direction.
    pub(crate) wi: Dir,
    /// What it is.
    pub(crate) kind: Kind,
    /// Whether it claims to have crossed the surface.
    pub(crate) transmitted: bool,
}

/// A scattering model, measurable.
pub(crate) trait Probe: Sync {
    /// Value and density of the continuous part.
    fn eval(&self, wo: Dir, wi: Dir) -> BsdfValue;
    /// One sample.
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw;
    /// Many samples for one wo, appended to `out`.
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        out.extend(u.iter().map(|&u| self.sample(wo, u)));
    }
    /// Whether the arithmetic inside is `f32`.
    fn single(&self) -> bool;
    /// η² seen from wo, which transmitted radiance would be divided by.
    fn radiance_scale(&self, _wo: Dir) -> f64 {
        1.0
    }
    /// The largest weight that sampling may give at wo. Infinite if nothing is promised.
    fn largest_weight(&self, _wo: Dir) -> f64 {
        1.0
    }

    /// About how much of the light from wo is scattered, by its own account.
    fn albedo_estimate(&self, _wo: Dir) -> f64 {
        0.0
    }

    /// Half a unit in the last place of 1.
    fn epsilon(&self) -> f64 {
        if self.single() { f64::from(f32::EPSILON) } else { f64::EPSILON }
    }
    /// The nearest direction of the probe's lattice.
    fn snap(&self, w: Dir) -> Dir {
        if self.single() { promote(demote(w)) } else { w }
    }
}

/// A scalar real that converts from and to `f64`.
pub(crate) trait Scalar: Real<Mask = bool, Int = u32> + Sync {
    /// Exactly the same number.
    fn widen(self) -> f64;
}
impl Scalar for f32 {
    fn widen(self) -> f64 {
        f64::from(self)
    }
}
impl Scalar for f64 {
    fn widen(self) -> f64 {
        self
    }
}

/// The `f32` direction nearest to a direction.
pub(crate) fn demote(w: Dir) -> Vec3<f32> {
    Vec3::new(w.x as f32, w.y as f32, w.z as f32)
}
/// The same direction in `f64`.
pub(crate) fn promote(w: Vec3<f32>) -> Dir {
    widen(w)
}
fn widen<R: Scalar>(w: Vec3<R>) -> Dir {
    Vec3::new(w.x.widen(), w.y.widen(), w.z.widen())
}
fn narrow<R: Scalar>(w: Dir) -> Vec3<R> {
    Vec3::new(R::lit(w.x), R::lit(w.y), R::lit(w.z))
}

fn draw<R: Scalar>(sample: &Sample<R>, delta: impl FnOnce() -> Value<R>) -> Draw {
    let Sample { wi, event } = sample;
    let kind = if event.failed {
        Kind::Failed
    } else if event.is_delta {
        Kind::Delta(BsdfValue::of(delta()), (event.lobe, event.transmitted))
    } else {
        Kind::Continuous
    };
    Draw { wi: widen(*wi), kind, transmitted: event.transmitted }
}

/// A lobe in one scalar arithmetic: a model, a mixture, a surface, or a borrowed lobe.
pub(crate) struct LobeProbe<R, L> {
    lobe: L,
    precision: PhantomData<fn() -> R>,
}

impl<R: Scalar, L: Lobe<R>> LobeProbe<R, L> {
    /// The lobe, measurable.
    pub(crate) fn new(lobe: L) -> Self {
        Self { lobe, precision: PhantomData }
    }
    fn at(&self, wo: Dir) -> Unguarded<R, &L> {
        Unguarded::new(&self.lobe, narrow(wo), Transport::Importance)
    }
}

impl<R: Scalar, L: Lobe<R> + Sync> Probe for LobeProbe<R, L> {
    fn eval(&self, wo: Dir, wi: Dir) -> BsdfValue {
        BsdfValue::of(self.at(wo).eval(narrow(wi)))
    }
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw {
        let closure = self.at(wo);
        let sample = closure.sample(u.map(R::lit));
        draw(&sample, || closure.delta(&sample))
    }
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        let closure = self.at(wo);
        out.extend(u.iter().map(|u| {
            let sample = closure.sample(u.map(R::lit));
            draw(&sample, || closure.delta(&sample))
        }));
    }
    fn single(&self) -> bool {
        R::PRECISION == Precision::Single
    }
    fn radiance_scale(&self, wo: Dir) -> f64 {
        self.lobe.radiance_scale(narrow(wo)).widen()
    }
    fn largest_weight(&self, wo: Dir) -> f64 {
        self.lobe.largest_weight(narrow(wo)).widen()
    }
    fn albedo_estimate(&self, wo: Dir) -> f64 {
        self.lobe.albedo_estimate(narrow(wo)).largest().widen()
    }
}

/// A lobe in `f32` with its eight lanes, in which batches are sampled (that both give the same bits is tested apart).
pub(crate) struct WideProbe<L, W> {
    scalar: LobeProbe<f32, L>,
    lanes: W,
}

impl<L: Lobe<f32>, W: Lobe<F32x8>> WideProbe<L, W> {
    /// The lobe, measurable.
    pub(crate) fn new(lobe: L, lanes: W) -> Self {
        Self { scalar: LobeProbe::new(lobe), lanes }
    }
}

impl<L: Lobe<f32> + Sync, W: Lobe<F32x8> + Sync> Probe for WideProbe<L, W> {
    fn eval(&self, wo: Dir, wi: Dir) -> BsdfValue {
        self.scalar.eval(wo, wi)
    }
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw {
        self.scalar.sample(wo, u)
    }
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        let wo = demote(wo);
        let wo = Vec3::new(F32x8::splat(wo.x), F32x8::splat(wo.y), F32x8::splat(wo.z));
        let closure = Unguarded::new(&self.lanes, wo, Transport::Importance);
        for eight in u.chunks(8) {
            let number = |i: usize| F32x8::new(std::array::from_fn(|l| eight.get(l).map_or(0.0, |u| u[i] as f32)));
            let sample = closure.sample([number(0), number(1), number(2)]);
            let delta = if sample.event.is_delta.to_bits() == 0 { Value::zero() } else { closure.delta(&sample) };
            for l in 0..eight.len() {
                out.push(draw(&lane_sample(&sample, l), || lane_value(&delta, l)));
            }
        }
    }
    fn single(&self) -> bool {
        true
    }
    fn radiance_scale(&self, wo: Dir) -> f64 {
        self.scalar.radiance_scale(wo)
    }
    fn largest_weight(&self, wo: Dir) -> f64 {
        self.scalar.largest_weight(wo)
    }
}

/// The directions side by side.
pub(crate) fn lanes_of(w: [Vec3<f32>; 8]) -> Vec3<F32x8> {
    Vec3::new(F32x8::new(w.map(|w| w.x)), F32x8::new(w.map(|w| w.y)), F32x8::new(w.map(|w| w.z)))
}

/// Lane `l` of a sample.
pub(crate) fn lane_sample(sample: &Sample<F32x8>, l: usize) -> Sample<f32> {
    let Sample { wi, event } = sample;
    let lane = |mask: Mask8| mask.lane(l);
    Sample {
        wi: Vec3::new(wi.x.to_array()[l], wi.y.to_array()[l], wi.z.to_array()[l]),
        event: Event {
            lobe: event.lobe.to_array()[l],
            transmitted: lane(event.transmitted),
            is_delta: lane(event.is_delta),
            failed: lane(event.failed),
        },
    }
}

/// Lane `l` of a value.
pub(crate) fn lane_value(value: &Value<F32x8>, l: usize) -> Value<f32> {
    Value { f_cos: value.f_cos.map(|x| x.to_array()[l]), pdf: value.pdf.to_array()[l] }
}
