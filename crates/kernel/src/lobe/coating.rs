//! `Coating`: the coat of plastic, lacquer or varnish, as material files say it: a dielectric, smooth or rough, with an index and a
//! colour.
//!
//! It becomes the top of a [`super::Layer`] or of a [`crate::Surface`]: a [`SmoothConductor`] or a [`Conductor`] with the reflectance
//! of a dielectric, which attenuates what lies below. Its colour is that of light which goes down and up through it along the normal;
//! it does not follow the angle.
//!
//! ```toml
//! type = "layered"
//! ior = 1.5
//! roughness = 0.1
//! base = { type = "diffuse", base_color = [0.7, 0.1, 0.1] }
//! ```

use super::{AnyLobe, Conductor, Layering, SmoothConductor};
use crate::fresnel::Fresnel;
use crate::microfacet::{ALPHA_MIN, Ggx};
use crate::model::{COATING_ALPHA, COATING_INDEX, COATING_ROUGHNESS, REFLECTANCE};
use crate::real::Real;
use crate::rgb::Rgb;

crate::one_of! {
    /// How rough the coat is; smooth if nothing is given.
    pub struct CoatingAlphas<R> {
        /// Along the tangent.
        alpha_x: R in COATING_ALPHA,
        /// Along the bitangent.
        alpha_y: R in COATING_ALPHA,
    }
    or (
        /// Along both; 0 is smooth.
        alpha: R in COATING_ALPHA
    ) => Self { alpha_x: alpha, alpha_y: alpha };
    or (
        /// Its square is alpha: 0 is smooth, 0.1 polished, 0.3 satin.
        roughness: R in COATING_ROUGHNESS
    ) => Self { alpha_x: roughness * roughness, alpha_y: roughness * roughness };
    or () => Self { alpha_x: R::ZERO, alpha_y: R::ZERO };
}

crate::group! {
    /// A dielectric coat over any base.
    pub struct Coating<R> {
        /// Index of the coat over that of the outside.
        eta("ior"): R = 1.5 in COATING_INDEX,
        /// What the base's light is multiplied by.
        color: Rgb<R> = 1.0 in REFLECTANCE,
        /// How rough.
        alphas: CoatingAlphas<R>,
        /// How the coat attenuates what lies below.
        layering: Layering = Reciprocal,
    }
}

impl Coating<f32> {
    /// The lobe that lies on top.
    ///
    /// ```
    /// use gonio_kernel::{Surface, Rgb, lobe::{Coating, Lambert, Layering}};
    /// let lacquer = Coating::new(1.5_f32, 0.0);
    /// let red = Lambert::new(Rgb::new(0.6, 0.1, 0.1));
    /// let plastic: Surface<f32> = Surface::black().coat(1.0, lacquer.lobe(), Layering::Reciprocal)?.with(lacquer.color, red)?;
    /// # Ok::<(), gonio_kernel::surface::SurfaceError>(())
    /// ```
    pub fn lobe(&self) -> AnyLobe<'static, f32> {
        let CoatingAlphas { alpha_x, alpha_y } = self.alphas;
        let fresnel = Fresnel::Dielectric { eta: self.eta };
        let least = ALPHA_MIN as f32;
        if alpha_x < least && alpha_y < least {
            SmoothConductor::new(fresnel).into()
        } else {
            Conductor::new(Ggx { alpha_x: alpha_x.max(least), alpha_y: alpha_y.max(least) }, fresnel).into()
        }
    }
}

impl<R: Real> Coating<R> {
    /// A colourless coat of that index in \[1, 3\] and alpha in \[0, 1\].
    pub fn new(eta: R, alpha: R) -> Self {
        let alphas = CoatingAlphas { alpha_x: alpha, alpha_y: alpha };
        Self { eta, color: Rgb::splat(R::ONE), alphas, layering: Layering::Reciprocal }
    }
}
