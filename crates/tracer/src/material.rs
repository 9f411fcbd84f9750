//! Materials made ready: a scene's lobes as a BSDF over eight lanes, with textures looked up per lane.
//!
//! Materials are ordered by variant, the code that their lobes run, so that a queue sorted by material has equal variants side by
//! side and eight paths can be shaded at once even if no two share a material. How many places a surface has follows from the
//! variant: one lobe is asked by itself, up to four and up to twelve have a surface of that size. A batch of eight is shaded through
//! one dynamic call, behind which everything about its lobes is known.

use std::sync::Arc;

use crate::bsdf::{BatchBsdf, CustomLobe};
use crate::effects::{Effect, EffectSet};
use crate::error::WorldError;
use crate::scene::{LobeSpec, Material, NormalMapSpec, Scene, TexturedParameter};
use crate::texture::Texture;
use gonio_kernel::lobe::{AnyLobe, Weighted};
use gonio_kernel::model::Model;
use gonio_kernel::surface::SurfaceError;
use gonio_kernel::{F32x8, Lobe, Parameters, Real, Rgb, Surface, each_lane};

/// The kernel's lobes in f32.
type Kernel = AnyLobe<'static, f32>;
/// And in eight lanes.
type Kernel8 = AnyLobe<'static, F32x8>;
/// How many lobes a [`Material`] may have.
pub const MOST_LOBES: usize = 12;
/// How many lobes of a [`Material`] may be coats.
pub const MOST_COATS: usize = 3;

/// A surface with room for any material: twelve lobes, three of them coats.
pub type MaterialSurface<R> = Surface<R, AnyLobe<'static, R>, MOST_LOBES, MOST_COATS>;
/// The usual size: a coat over up to three.
type SmallSurface<R> = Surface<R, AnyLobe<'static, R>, 4, 1>;

/// A material, and what the queue needs to know of it.
#[derive(Clone, Debug)]
pub(crate) struct PreparedMaterial {
    pub(crate) spec: Material,
    /// Equal numbers run the same code.
    pub(crate) variant: u32,
    /// The BSDF, if no texture is involved.
    constant: Option<Arc<dyn BatchBsdf>>,
    pub(crate) emission: Rgb<f32>,
    pub(crate) two_sided: bool,
    pub(crate) textured: bool,
    pub(crate) anisotropic: bool,
    pub(crate) normal_map: Option<NormalMapSpec>,
    pub(crate) has_delta: bool,
    pub(crate) transmits: bool,
}

impl PreparedMaterial {
    /// The materials in the order of their variants, and where each of the scene's went.
    ///
    /// # Errors
    /// A material's lobes do not fit into a surface.
    pub(crate) fn prepare(scene: &Scene) -> Result<(Vec<Self>, Vec<u32>), WorldError> {
        for material in &scene.materials {
            let fits = surface::<f32, MOST_LOBES, MOST_COATS>(&material.lobes, |spec, _| (spec.weight, spec.lobe));
            fits.map_err(|why| WorldError::Lobes { material: material.name.clone(), why })?;
        }
        // Variants have no order of their own: they are numbered as the scene first shows them.
        let mut variants: Vec<&Material> = Vec::new();
        let mut number = |material| {
            let known = variants.iter().position(|v| same_code(v, material));
            known.unwrap_or_else(|| {
                variants.push(material);
                variants.len() - 1
            })
        };
        let variant_of: Vec<usize> = scene.materials.iter().map(&mut number).collect();
        let mut by_variant: Vec<usize> = (0..scene.materials.len()).collect();
        by_variant.sort_by_key(|&i| variant_of[i]); // stable: the scene's order within a variant
        let mut order = vec![0; scene.materials.len()];
        let mut prepared: Vec<Self> = Vec::with_capacity(scene.materials.len());
        for (place, &i) in by_variant.iter().enumerate() {
            order[i] = place as u32;
            prepared.push(Self::new(&scene.materials[i], variant_of[i] as u32));
        }
        Ok((prepared, order))
    }

    fn new(spec: &Material, variant: u32) -> Self {
        let properties: Vec<_> = spec.lobes.iter().map(|l| l.lobe.properties()).collect();
        let custom = |is: fn(&CustomLobe) -> bool| spec.custom.as_ref().is_some_and(is);
        let textured = spec.is_textured();
        Self {
            variant,
            constant: (!textured).then(|| match &spec.custom {
                Some(custom) => custom.lanes.clone(),
                None => constant(spec),
            }),
            emission: spec.emission,
            two_sided: spec.two_sided,
            textured,
            normal_map: spec.normal_map,
            anisotropic: properties.iter().any(|p| p.anisotropic) || custom(|c| c.anisotropic),
            has_delta: properties.iter().any(|p| p.has_delta) || custom(|c| c.has_delta),
            transmits: properties.iter().any(|p| p.transmits) || custom(|c| c.transmits),
            spec: spec.clone(),
        }
    }

    /// What it calls for; tangents only on a mesh that has texture coordinates.
    pub(crate) fn effects(&self) -> EffectSet {
        EffectSet::when(self.emits(), Effect::AreaLights)
            .with(EffectSet::when(self.textured, Effect::Textures))
            .with(EffectSet::when(self.normal_map.is_some(), Effect::NormalMaps))
            .with(EffectSet::when(!self.two_sided, Effect::OneSided))
            .with(EffectSet::when(self.has_delta, Effect::DeltaLobes))
            .with(EffectSet::when(self.transmits, Effect::Transmission))
    }

    /// The scattering models that it is made of.
    pub(crate) fn models(&self) -> impl Iterator<Item = &'static str> {
        let custom = self.spec.custom.is_some().then_some("custom");
        custom.into_iter().chain(self.spec.lobes.iter().map(|lobe| lobe.lobe.model_name()))
    }

    /// Whether light leaves it by itself.
    pub(crate) fn emits(&self) -> bool {
        self.emission.largest() > 0.0
    }
}

/// Whether both materials' lobes run the same code. Two lobes of a user's never do.
fn same_code(a: &Material, b: &Material) -> bool {
    let alike = |(a, b): (&LobeSpec, &LobeSpec)| a.coat == b.coat && a.lobe.same_code(&b.lobe);
    a.custom == b.custom && a.lobes.len() == b.lobes.len() && a.lobes.iter().zip(&b.lobes).all(alike)
}

impl Material {
    fn is_textured(&self) -> bool {
        self.custom.is_none() && self.lobes.iter().any(|lobe| !lobe.textures.is_empty())
    }
}

/// The kernel surface of a material without textures; none if it has textures or is a user's own lobe.
pub fn constant_surface(material: &Material) -> Option<MaterialSurface<f32>> {
    if material.is_textured() || material.custom.is_some() {
        return None;
    }
    surface(&material.lobes, |spec, _| (spec.weight, spec.lobe)).ok()
}

/// The lobes of a material as a surface; `lobe` says what each becomes.
fn surface<R: Real, const N: usize, const C: usize>(
    lobes: &[LobeSpec],
    lobe: impl Fn(&LobeSpec, usize) -> (Rgb<R>, AnyLobe<'static, R>),
) -> Result<Surface<R, AnyLobe<'static, R>, N, C>, SurfaceError> {
    lobes.iter().enumerate().try_fold(Surface::empty(), |surface, (slot, spec)| {
        let (weight, lobe) = lobe(spec, slot);
        match spec.coat {
            Some(layering) => surface.coat(weight, lobe, layering),
            None => surface.with(weight, lobe),
        }
    })
}

/// Calls `with` with the BSDF that the lobes of a variant make; `lobe` says what each becomes.
fn assemble<T>(
    lobes: &[LobeSpec],
    lobe: impl Fn(&LobeSpec, usize) -> (Rgb<F32x8>, Kernel8),
    with: impl FnOnce(&dyn IntoShared) -> T,
) -> T {
    let coats = lobes.iter().filter(|spec| spec.coat.is_some()).count();
    // `prepare` has seen to it that the lobes fit.
    match (lobes, coats) {
        ([only], 0) => {
            let (weight, lobe) = lobe(only, 0);
            with(&Weighted { weight, lobe })
        }
        ([_, .., _] | [_], 0..=1) if lobes.len() <= 4 => {
            with(&surface(lobes, lobe).unwrap_or(SmallSurface::<F32x8>::empty()))
        }
        _ => with(&surface(lobes, lobe).unwrap_or(MaterialSurface::<F32x8>::empty())),
    }
}

/// A BSDF that can be used at once, or kept.
trait IntoShared: BatchBsdf {
    fn share(&self) -> Arc<dyn BatchBsdf>;
}
impl<B: BatchBsdf + Copy + 'static> IntoShared for B {
    fn share(&self) -> Arc<dyn BatchBsdf> {
        Arc::new(*self)
    }
}

fn constant(material: &Material) -> Arc<dyn BatchBsdf> {
    let lobe = |spec: &LobeSpec, _| (Rgb::broadcast(spec.weight), spec.lobe.to::<F32x8>());
    assemble(&material.lobes, lobe, |bsdf| bsdf.share())
}

/// What eight paths scatter by: materials of one variant at eight texture coordinates. `with` is called once.
pub(crate) fn with_lanes<T>(
    materials: &[&PreparedMaterial; F32x8::LANES],
    alike: bool,
    textures: &[Texture],
    [u, v]: [F32x8; 2],
    with: impl FnOnce(&dyn BatchBsdf) -> T,
) -> T {
    // A user's lobe has one variant of its own, whichever materials share it.
    let whole_variant = alike || materials[0].spec.custom.is_some();
    if let (Some(bsdf), true) = (&materials[0].constant, whole_variant) {
        return with(&**bsdf);
    }
    let coordinates = [u, v].map(F32x8::to_array);
    let lobe = |_: &LobeSpec, slot: usize| gather(materials.map(|m| &m.spec.lobes[slot]), textures, coordinates);
    assemble(&materials[0].spec.lobes, lobe, |bsdf| with(bsdf))
}

/// Eight lobes that run the same code, side by side, with their textures looked up.
fn gather(
    specs: [&LobeSpec; F32x8::LANES],
    textures: &[Texture],
    [u, v]: [[f32; F32x8::LANES]; 2],
) -> (Rgb<F32x8>, Kernel8) {
    let weight = Rgb::from_lanes(|l| specs[l].weight);
    let constant = Kernel::gather(each_lane(|l| &specs[l].lobe));
    if specs.iter().all(|spec| spec.textures.is_empty()) {
        return (weight, constant);
    }
    // Each textured number is its constant times the texture; numbers are counted as `map` meets them.
    let factors = |at: usize| {
        let of = |l: usize| specs[l].textures.iter().find(|t| t.covers(at));
        let factor = |l: usize| of(l).map_or(1.0, |t| t.channel(textures[t.texture].sample(u[l], v[l]), at));
        (0..F32x8::LANES).any(|l| of(l).is_some()).then(|| F32x8::from_fn(factor))
    };
    let mut at = 0..;
    let lobe = constant.map(&mut |parameter, _, x| match at.next().and_then(factors) {
        Some(factor) => parameter.quantity.clamp(x * factor),
        None => x,
    });
    (weight, lobe)
}

impl TexturedParameter {
    /// Whether the number in that place is one of its channels.
    fn covers(&self, at: usize) -> bool {
        (self.at..self.at + 3).contains(&at)
    }
    fn channel(&self, color: Rgb<f32>, at: usize) -> f32 {
        [color.r, color.g, color.b][at - self.at]
    }
}
