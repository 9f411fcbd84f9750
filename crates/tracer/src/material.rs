//! Materials made ready: a scene's lobe list as a kernel surface, with textures looked up per lane.
//!
//! Materials are ordered by variant, the sequence of their lobes' models, so that a queue sorted by material has equal
//! variants side by side and eight paths can be shaded at once even if no two share a material.

use crate::scene::{Color, FresnelSpec, LobeSpec, Material, Model, Scene};
use crate::texture::Texture;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{AnyLobe, Conductor, Lambert, Mirror};
use gonio_kernel::microfacet::Ggx;
use gonio_kernel::{F32x8, Real, Rgb, Surface};

/// A material, and what the queue needs to know of it.
#[derive(Clone, Debug)]
pub(crate) struct PreparedMaterial {
    pub(crate) spec: Material,
    /// Equal numbers have equal sequences of models.
    pub(crate) variant: u32,
    /// The surface, if no texture is involved.
    pub(crate) surface: Option<Surface<F32x8>>,
    pub(crate) emission: Rgb<f32>,
    pub(crate) two_sided: bool,
    pub(crate) textured: bool,
    pub(crate) anisotropic: bool,
    pub(crate) discrete: bool,
}

impl PreparedMaterial {
    /// The materials in the order of their variants, and where each of the scene's went.
    pub(crate) fn prepare(scene: &Scene) -> (Vec<Self>, Vec<u32>) {
        let pattern = |m: &Material| m.lobes.iter().map(|l| model_number(&l.model)).collect::<Vec<_>>();
        let mut by_variant: Vec<usize> = (0..scene.materials.len()).collect();
        by_variant.sort_by_key(|&i| pattern(&scene.materials[i])); // stable: the scene's order within a variant
        let mut order = vec![0; scene.materials.len()];
        let mut prepared: Vec<Self> = Vec::with_capacity(scene.materials.len());
        for (place, &i) in by_variant.iter().enumerate() {
            order[i] = place as u32;
            let spec = scene.materials[i].clone();
            let variant = match prepared.last() {
                Some(last) => last.variant + u32::from(pattern(&last.spec) != pattern(&spec)),
                None => 0,
            };
            prepared.push(Self {
                variant,
                surface: constant_surface(&spec),
                emission: spec.emission,
                two_sided: spec.two_sided,
                textured: spec.lobes.iter().any(|l| matches!(color_of(&l.model), Some(Color::Texture { .. }))),
                anisotropic: spec.lobes.iter().any(|l| widths(l)[0] != widths(l)[1]),
                discrete: spec.lobes.iter().any(|l| matches!(l.model, Model::Mirror { .. })),
                spec,
            });
        }
        (prepared, order)
    }

    /// Whether light leaves it by itself.
    pub(crate) fn emits(&self) -> bool {
        self.emission.largest() > 0.0
    }
}

/// The kernel surface of a material without textures, in any precision; `None` if it has textures.
pub fn constant_surface<R: Real>(material: &Material) -> Option<Surface<R>> {
    let constant = |l: &LobeSpec| !matches!(color_of(&l.model), Some(Color::Texture { .. }));
    material.lobes.iter().all(constant).then(|| {
        assemble(
            material,
            |slot, read| R::lit(f64::from(read(&material.lobes[slot]))),
            |slot| match color_of(&material.lobes[slot].model) {
                Some(Color::Constant(c)) => c.map(|x| R::lit(f64::from(x))),
                _ => Rgb::zero(),
            },
        )
    })
}

/// The surfaces of eight materials of one variant at eight texture coordinates.
pub(crate) fn lane_surface(materials: [&Material; 8], textures: &[Texture], uv: [F32x8; 2]) -> Surface<F32x8> {
    let [u, v] = uv.map(F32x8::to_array);
    assemble(
        materials[0],
        |slot, read| F32x8::new(materials.map(|m| read(&m.lobes[slot]))),
        |slot| {
            let colors: [Rgb<f32>; 8] =
                std::array::from_fn(|lane| match color_of(&materials[lane].lobes[slot].model) {
                    Some(Color::Constant(c)) => c,
                    Some(Color::Texture { texture, scale }) => textures[texture].sample(u[lane], v[lane]) * scale,
                    None => Rgb::zero(),
                });
            Rgb::new(F32x8::new(colors.map(|c| c.r)), F32x8::new(colors.map(|c| c.g)), F32x8::new(colors.map(|c| c.b)))
        },
    )
}

/// The one place where scene models become kernel lobes: `number(slot, read)` reads a number of the slot's lobe, and
/// `color(slot)` its colour.
fn assemble<R: Real>(
    pattern: &Material,
    number: impl Fn(usize, &dyn Fn(&LobeSpec) -> f32) -> R,
    color: impl Fn(usize) -> Rgb<R>,
) -> Surface<R> {
    let mut surface = Surface::black();
    for (slot, lobe) in pattern.lobes.iter().enumerate() {
        let weight = number(slot, &|l| l.weight);
        let rgb = |read: &dyn Fn(&LobeSpec) -> Rgb<f32>| {
            Rgb::new(number(slot, &|l| read(l).r), number(slot, &|l| read(l).g), number(slot, &|l| read(l).b))
        };
        let any: AnyLobe<R> = match &lobe.model {
            Model::Diffuse { .. } => Lambert::new(color(slot)).into(),
            Model::Mirror { .. } => Mirror::new(color(slot)).into(),
            Model::Conductor { fresnel, .. } => {
                let ggx = Ggx { alpha_x: number(slot, &|l| widths(l)[0]), alpha_y: number(slot, &|l| widths(l)[1]) };
                let fresnel = match fresnel {
                    FresnelSpec::Conductor { .. } => {
                        Fresnel::Conductor { eta: rgb(&|l| fresnel_of(l)[0]), k: rgb(&|l| fresnel_of(l)[1]) }
                    }
                    FresnelSpec::Schlick { .. } => Fresnel::Schlick { f0: rgb(&|l| fresnel_of(l)[0]) },
                };
                Conductor::new(ggx, fresnel).into()
            }
        };
        surface = surface.with(weight, any);
    }
    surface
}

/// Equal for lobes that can share a lane batch.
fn model_number(model: &Model) -> u32 {
    match model {
        Model::Diffuse { .. } => 0,
        Model::Mirror { .. } => 1,
        Model::Conductor { fresnel: FresnelSpec::Conductor { .. }, .. } => 2,
        Model::Conductor { fresnel: FresnelSpec::Schlick { .. }, .. } => 3,
    }
}

fn color_of(model: &Model) -> Option<Color> {
    match model {
        Model::Diffuse { base_color: c } | Model::Mirror { reflectance: c } => Some(*c),
        Model::Conductor { .. } => None,
    }
}

/// α_x and α_y; equal for lobes that have none.
fn widths(lobe: &LobeSpec) -> [f32; 2] {
    match lobe.model {
        Model::Conductor { alpha_x, alpha_y, .. } => [alpha_x, alpha_y],
        _ => [1.0; 2],
    }
}

/// η and k, or f0 twice; black for lobes that have none.
fn fresnel_of(lobe: &LobeSpec) -> [Rgb<f32>; 2] {
    match lobe.model {
        Model::Conductor { fresnel: FresnelSpec::Conductor { eta, k }, .. } => [eta, k],
        Model::Conductor { fresnel: FresnelSpec::Schlick { f0 }, .. } => [f0, f0],
        _ => [Rgb::zero(); 2],
    }
}
