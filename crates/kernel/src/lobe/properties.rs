//! What lobes claim of themselves.

use crate::real::Real;
use crate::rgb::Rgb;

/// What a lobe claims of itself at its parameters: `Properties { one_to_one: true, ..Properties::LAWFUL }`. Instruments measure every
/// claim, those of broken laws too, so a claim can be stale in either way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties<R> {
    /// Helmholtz reciprocity, f(wo, wi) = f(wi, wo), through an interface up to η²; else it is measurably broken.
    pub reciprocal: bool,
    /// No directional albedo exceeds 1 + `excess`; else one measurably exceeds 1 (at parameters as bright as the domain allows).
    pub conserving: bool,
    /// How far above 1 the albedo may lie by the model's own admission, as that of a fitted model does; 0 for most.
    pub excess: f32,
    /// By how many units `f32` may differ from `f64` on the same numbers; a unit is the larger of eps·f and the largest change
    /// of f when one input moves by one unit in the last place. 8, unless a fitted function adds roundings of its own.
    pub units: f32,
    /// Some of it is delta events.
    pub has_delta: bool,
    /// All of it is delta events.
    pub all_delta: bool,
    /// Turning both directions about the normal changes the value: the tangent matters.
    pub anisotropic: bool,
    /// Scatters to the other side, and from there.
    pub transmits: bool,
    /// The sampler maps the unit square to directions one to one: then pdf · |∂ω/∂u| = 1.
    pub one_to_one: bool,
    /// Exchanging the directions exchanges operands of commutative operations only, so that even rounding is reciprocal.
    pub symmetric: bool,
    /// The directional albedo, where it is known and the same at all angles.
    pub albedo: Option<Rgb<R>>,
    /// How far the albedo may lie from its known value.
    pub albedo_error: f32,
}

impl<R> Properties<R> {
    /// Reciprocal but for rounding, conserves energy exactly, accurate to 8 units; continuous reflection whose albedo is not known.
    pub const LAWFUL: Self = Self {
        reciprocal: true,
        conserving: true,
        excess: 0.0,
        units: 8.0,
        has_delta: false,
        all_delta: false,
        anisotropic: false,
        transmits: false,
        one_to_one: false,
        symmetric: false,
        albedo: None,
        albedo_error: 0.0,
    };

    /// What two lobes claim together, each as it is; their known albedos add.
    pub fn and(self, other: Self) -> Self
    where
        R: Real,
    {
        Self {
            reciprocal: self.reciprocal && other.reciprocal,
            conserving: self.conserving && other.conserving,
            excess: self.excess.max(other.excess),
            units: self.units.max(other.units),
            has_delta: self.has_delta || other.has_delta,
            all_delta: self.all_delta && other.all_delta,
            anisotropic: self.anisotropic || other.anisotropic,
            transmits: self.transmits || other.transmits,
            one_to_one: false,
            symmetric: self.symmetric && other.symmetric,
            albedo: self.albedo.zip(other.albedo).map(|(a, b)| a + b),
            albedo_error: self.albedo_error + other.albedo_error,
        }
    }
}
