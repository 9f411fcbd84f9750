//! `Probe`: a scattering model as an instrument sees it. Plain `f64` in and out, whatever computes inside.
//!
//! Instruments are written once against this trait and compiled once. A direction or random number handed to a probe of
//! `f32` arithmetic must lie on its lattice: [`Probe::snap`] puts it there, so that nothing is rounded unseen.

use gonio_kernel::{
    Event, F32x8, Lobe, Mask8, Precision, Real, Rgb, Sample, Surface, Value, Vec3,
    closure::{Transport, Unguarded},
};

/// A direction, local.
pub(crate) type Dir = Vec3<f64>;

/// f·|cos_i| per channel and density, as the probe's arithmetic gave them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worth {
    /// f·|cos_i| \[1/sr\]; for a discrete event its strength.
    pub(crate) f_cos: [f64; 3],
    /// Density \[1/sr\]; for a discrete event its probability.
    pub(crate) pdf: f64,
}

impl Worth {
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
    /// From the continuous part: its worth is that of `eval`.
    Continuous,
    /// A discrete event of this worth. The label tells events of one wo apart: lobe, reflected or transmitted.
    Discrete(Worth, (u32, bool)),
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
    fn eval(&self, wo: Dir, wi: Dir) -> Worth;
    /// One sample.
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw;
    /// Many samples for one wo, appended to `out`.
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        out.extend(u.iter().map(|&u| self.sample(wo, u)));
    }
    /// Whether the arithmetic inside is `f32`.
    fn single(&self) -> bool;
    /// η² seen from wo, which transmitted radiance would be divided by.
    fn compression(&self, _wo: Dir) -> f64 {
        1.0
    }
    /// The largest weight that sampling may give at wo: 1 unless a mixture must trade between its lobes. Infinite if
    /// nothing is promised.
    fn weight_bound(&self, _wo: Dir) -> f64 {
        1.0
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
/// The same numbers in `f64`.
pub(crate) fn worth<R: Scalar>(value: Value<R>) -> Worth {
    let Rgb { r, g, b } = value.f_cos;
    Worth { f_cos: [r.widen(), g.widen(), b.widen()], pdf: value.pdf.widen() }
}
fn draw<R: Scalar>(sample: Sample<R>, discrete: impl FnOnce(&Event<R>) -> Worth) -> Draw {
    let Sample { wi, event } = sample;
    let kind = if event.failed {
        Kind::Failed
    } else if event.discrete {
        Kind::Discrete(discrete(&event), (event.lobe, event.transmitted))
    } else {
        Kind::Continuous
    };
    Draw { wi: widen(wi), kind, transmitted: event.transmitted }
}

/// A lobe by itself.
pub(crate) struct LobeProbe<'a, R, L> {
    lobe: &'a L,
    precision: std::marker::PhantomData<fn() -> R>,
}

impl<'a, R: Scalar, L: Lobe<R>> LobeProbe<'a, R, L> {
    /// The lobe, measurable.
    pub(crate) fn new(lobe: &'a L) -> Self {
        Self { lobe, precision: std::marker::PhantomData }
    }
    fn as_importance(&self, wo: Dir, through: bool, value: Value<R>) -> Worth {
        let factor = if through { self.lobe.compression(narrow(wo)) } else { R::ONE };
        worth(Value { f_cos: value.f_cos * factor, ..value })
    }
}

impl<R: Scalar, L: Lobe<R> + Sync> Probe for LobeProbe<'_, R, L> {
    fn eval(&self, wo: Dir, wi: Dir) -> Worth {
        self.as_importance(wo, wo.z * wi.z < 0.0, self.lobe.eval(narrow(wo), narrow(wi)))
    }
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw {
        let o = narrow(wo);
        let sample = self.lobe.sample(o, u.map(R::lit));
        let through = sample.event.transmitted;
        draw(sample, |event| self.as_importance(wo, through, self.lobe.discrete(o, event)))
    }
    fn compression(&self, wo: Dir) -> f64 {
        self.lobe.compression(narrow(wo)).widen()
    }
    fn single(&self) -> bool {
        R::PRECISION == Precision::Single
    }
    fn weight_bound(&self, _wo: Dir) -> f64 {
        f64::INFINITY
    }
}

/// A surface, through the unguarded mixture: what the formulas do by themselves.
pub(crate) struct SurfaceProbe<R> {
    surface: Surface<R>,
    lanes: Option<Surface<F32x8>>,
    weight_bounds: Vec<f64>,
}

impl<R: Scalar> SurfaceProbe<R> {
    /// The surface, measurable. With its eight-lane twin, batches are sampled in lanes (whose equality is tested apart).
    /// Its lobes weigh at most 1, each by itself.
    pub(crate) fn new(surface: Surface<R>, lanes: Option<Surface<F32x8>>) -> Self {
        let weight_bounds = surface.lobes().map(|_| 1.0).collect();
        Self { surface, lanes, weight_bounds }
    }
    /// The same, but its lobes weigh at most this, each by itself.
    pub(crate) fn with_weight_bounds(self, weight_bounds: Vec<f64>) -> Self {
        Self { weight_bounds, ..self }
    }
    fn at(&self, wo: Dir) -> Unguarded<'_, R> {
        Unguarded::new(&self.surface, narrow(wo)).carrying(Transport::Importance)
    }
}

impl<R: Scalar> Probe for SurfaceProbe<R> {
    fn eval(&self, wo: Dir, wi: Dir) -> Worth {
        worth(self.at(wo).eval(narrow(wi)))
    }
    fn sample(&self, wo: Dir, u: [f64; 3]) -> Draw {
        let closure = self.at(wo);
        draw(closure.sample(u.map(R::lit)), |event| worth(closure.discrete(event)))
    }
    fn sample_all(&self, wo: Dir, u: &[[f64; 3]], out: &mut Vec<Draw>) {
        let Some(lanes) = &self.lanes else {
            let closure = self.at(wo);
            out.extend(u.iter().map(|u| draw(closure.sample(u.map(R::lit)), |event| worth(closure.discrete(event)))));
            return;
        };
        let closure = Unguarded::new(lanes, demote(wo).splat_lanes()).carrying(Transport::Importance);
        for eight in u.chunks(8) {
            let number = |i: usize| F32x8::new(std::array::from_fn(|l| eight.get(l).map_or(0.0, |u| u[i] as f32)));
            let Sample { wi, event } = closure.sample([number(0), number(1), number(2)]);
            let (x, y, z) = (wi.x.to_array(), wi.y.to_array(), wi.z.to_array());
            let [failed, discrete, transmitted] = [event.failed, event.discrete, event.transmitted].map(Mask8::to_bits);
            let value = if discrete == 0 { Value::zero() } else { closure.discrete(&event) };
            for (l, _) in eight.iter().enumerate() {
                let is = |mask: u32| (mask >> l) & 1 != 0;
                let kind = if is(failed) {
                    Kind::Failed
                } else if is(discrete) {
                    Kind::Discrete(worth(lane_value(&value, l)), (event.lobe.to_array()[l], is(transmitted)))
                } else {
                    Kind::Continuous
                };
                out.push(Draw { wi: widen(Vec3::new(x[l], y[l], z[l])), kind, transmitted: is(transmitted) });
            }
        }
    }
    fn single(&self) -> bool {
        R::PRECISION == Precision::Single
    }
    fn compression(&self, wo: Dir) -> f64 {
        // At most one lobe of a row transmits.
        self.surface.lobes().map(|l| l.lobe.compression(narrow(wo)).widen()).fold(1.0, |product, one| product * one)
    }
    fn weight_bound(&self, wo: Dir) -> f64 {
        // Lobe i is chosen with pᵢ = wᵢYᵢ/Σwⱼ Yⱼ and weighs at most bᵢ by itself: Σwᵢfᵢ/Σpᵢpdfᵢ ≤ max wᵢbᵢ/pᵢ.
        let estimates = self.surface.lobes().zip(&self.weight_bounds).filter(|(l, _)| l.weight.widen() > 0.0);
        let estimates = estimates.map(|(l, &bound)| {
            (l.weight.widen(), Lobe::albedo_estimate(&l.lobe, narrow::<R>(wo)).luminance().widen(), bound)
        });
        let bright: Vec<(f64, f64, f64)> = estimates.filter(|(_, y, _)| *y > 0.0).collect();
        match bright[..] {
            [] => 1.0,
            [(weight, _, bound)] => weight * bound,
            _ => {
                let sum: f64 = bright.iter().map(|(w, y, _)| w * y).sum();
                sum * bright.iter().fold(0.0, |most: f64, (_, y, bound)| most.max(bound / y))
            }
        }
    }
}

/// Eight copies of a scalar direction.
pub(crate) trait SplatLanes {
    /// The same direction in every lane.
    fn splat_lanes(self) -> Vec3<F32x8>;
}
impl SplatLanes for Vec3<f32> {
    fn splat_lanes(self) -> Vec3<F32x8> {
        Vec3::new(F32x8::splat(self.x), F32x8::splat(self.y), F32x8::splat(self.z))
    }
}

/// Lane `l` of an event.
pub(crate) fn lane_event(event: &Event<F32x8>, l: usize) -> Event<f32> {
    let lane = |mask: Mask8| mask.lane(l);
    Event {
        lobe: event.lobe.to_array()[l],
        transmitted: lane(event.transmitted),
        discrete: lane(event.discrete),
        failed: lane(event.failed),
    }
}

/// Lane `l` of a value.
pub(crate) fn lane_value(value: &Value<F32x8>, l: usize) -> Value<f32> {
    Value { f_cos: value.f_cos.map(|x| x.to_array()[l]), pdf: value.pdf.to_array()[l] }
}
