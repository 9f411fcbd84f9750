//! A BSDF as the renderer calls it, once per batch of eight: any lobe over eight lanes, ours or a user's.

use gonio_kernel::{BsdfSample, Closure, F32x8, Lobe, Parameters, Real, Rgb, Value, Vec3};
use std::fmt::Debug;
use std::sync::Arc;

/// What a BSDF does with eight paths.
#[derive(Clone, Copy, Debug)]
pub struct Scattered {
    /// Value and density towards the light sample; zeros if there was none.
    pub light: Value<F32x8>,
    /// The direction in which the paths go on.
    pub sample: BsdfSample<F32x8>,
}

/// A BSDF as the renderer calls it: once per batch of eight. Every lobe over eight lanes is one.
pub trait BatchBsdf: Debug + Send + Sync {
    /// The value at the light sample's direction, if there is one, and a sampled direction, all local.
    fn scatter(&self, wo: Vec3<F32x8>, light: Option<Vec3<F32x8>>, u: [F32x8; 3]) -> Scattered;
    /// About how much light it returns, seen along the normal: what the layer "albedo" shows.
    fn albedo(&self) -> Rgb<F32x8>;
}

impl<L: Lobe<F32x8> + Debug + Send + Sync> BatchBsdf for L {
    fn scatter(&self, wo: Vec3<F32x8>, light: Option<Vec3<F32x8>>, u: [F32x8; 3]) -> Scattered {
        let closure = Closure::new(self, wo);
        let light = light.map_or(Value::zero(), |wi| closure.eval(wi));
        Scattered { light, sample: closure.sample(u) }
    }
    fn albedo(&self) -> Rgb<F32x8> {
        self.albedo_estimate(Vec3::unit_z()).map(|x| x.min(F32x8::ONE))
    }
}

/// A user's own lobe as a material: any lobe made of parameters, alone or in a combination.
///
/// ```
/// use gonio_kernel::{Rgb, lobe::{Lambert, Layer, Layering, Mirror}};
/// use gonio_tracer::CustomLobe;
///
/// let coated = Layer::new(Mirror::new(Rgb::splat(0.05_f32)), Lambert::new(Rgb::splat(0.5)), Layering::Reciprocal)?;
/// let lobe = CustomLobe::new(coated);
/// # Ok::<(), gonio_kernel::lobe::NoCoat>(())
/// ```
#[derive(Clone, Debug)]
pub struct CustomLobe {
    pub(crate) lanes: Arc<dyn BatchBsdf>,
    pub(crate) transmits: bool,
    pub(crate) has_delta: bool,
    pub(crate) anisotropic: bool,
}

impl CustomLobe {
    /// The lobe in every lane.
    pub fn new<L>(lobe: L) -> Self
    where
        L: Lobe<f32> + Parameters<Real = f32>,
        L::Of<F32x8>: Lobe<F32x8> + Debug + Send + Sync + 'static,
    {
        let properties = lobe.properties();
        Self {
            lanes: Arc::new(lobe.to::<F32x8>()),
            transmits: properties.transmits,
            has_delta: properties.has_delta,
            anisotropic: properties.anisotropic,
        }
    }
}

/// Equal if it is the same lobe, not a copy of it.
impl PartialEq for CustomLobe {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.lanes, &other.lanes)
    }
}
