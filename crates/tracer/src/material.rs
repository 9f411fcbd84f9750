//! Materials made ready: a scene's lobe list as a kernel surface, with textures looked up per lane.
//!
//! Materials are ordered by variant, the sequence of their lobes' models, so that a queue sorted by material has equal
//! variants side by side and eight paths can be shaded at once even if no two share a material.

use crate::scene::{
    Color, Compensation, Directional, Distribution, FresnelSpec, LobeSpec, Masking, Material, MicrofacetSpec, Model,
    NormalMapSpec, PhongNorm, Scene,
};
use crate::texture::Texture;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{AnyLobe, Conductor, Dielectric, Eon, Lambert, Mirror, Phong, RoughDielectric};
use gonio_kernel::microfacet::{Beckmann, Ggx, Microfacets};
use gonio_kernel::{F32x8, Real, Rgb, Surface};

/// A material, and what the queue needs to know of it.
#[derive(Clone, Debug)]
pub(crate) struct PreparedMaterial {
    pub(crate) spec: Material,
    /// Its lobes.
    parts: Vec<Part>,
    /// Equal numbers have equal sequences of models.
    pub(crate) variant: u32,
    /// The surface, if no texture is involved.
    pub(crate) surface: Option<Surface<F32x8>>,
    pub(crate) emission: Rgb<f32>,
    pub(crate) two_sided: bool,
    pub(crate) textured: bool,
    pub(crate) anisotropic: bool,
    pub(crate) normal_map: Option<NormalMapSpec>,
    pub(crate) discrete: bool,
    pub(crate) transmits: bool,
}

fn is_anisotropic(model: &Model) -> bool {
    match model {
        Model::Conductor { microfacets: m, .. } | Model::Dielectric { microfacets: Some(m), .. } => {
            m.alpha_x != m.alpha_y
        }
        _ => false,
    }
}

impl PreparedMaterial {
    /// The materials in the order of their variants, and where each of the scene's went.
    pub(crate) fn prepare(scene: &Scene) -> (Vec<Self>, Vec<u32>) {
        let parts_of: Vec<Vec<Part>> = scene.materials.iter().map(parts).collect();
        // Kinds have no order of their own: variants are numbered as the scene first shows them.
        let mut variants: Vec<Vec<Kind>> = Vec::new();
        let mut number = |parts: &Vec<Part>| {
            let pattern = parts.iter().map(|part| part.kind).collect();
            let known = variants.iter().position(|v| *v == pattern);
            known.unwrap_or_else(|| {
                variants.push(pattern);
                variants.len() - 1
            })
        };
        let variant_of: Vec<usize> = parts_of.iter().map(&mut number).collect();
        let mut by_variant: Vec<usize> = (0..scene.materials.len()).collect();
        by_variant.sort_by_key(|&i| variant_of[i]); // stable: the scene's order within a variant
        let mut order = vec![0; scene.materials.len()];
        let mut prepared: Vec<Self> = Vec::with_capacity(scene.materials.len());
        for (place, &i) in by_variant.iter().enumerate() {
            order[i] = place as u32;
            let (spec, parts) = (&scene.materials[i], parts_of[i].clone());
            let has = |is: fn(&LobeSpec) -> bool| spec.lobes.iter().any(is);
            prepared.push(Self {
                variant: variant_of[i] as u32,
                surface: surface_of(&parts),
                emission: spec.emission,
                two_sided: spec.two_sided,
                textured: parts.iter().any(Part::is_textured),
                normal_map: spec.normal_map,
                anisotropic: has(|l| is_anisotropic(&l.model)),
                discrete: has(|l| matches!(l.model, Model::Mirror { .. } | Model::Dielectric { .. })),
                transmits: has(|l| matches!(l.model, Model::Dielectric { .. })),
                spec: spec.clone(),
                parts,
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
    surface_of(&parts(material))
}

fn surface_of<R: Real>(parts: &[Part]) -> Option<Surface<R>> {
    let constant = |x: f32| R::lit(f64::from(x));
    (!parts.iter().any(Part::is_textured)).then(|| {
        parts.iter().fold(Surface::black(), |surface, part| {
            let color = match part.color {
                Some(Color::Constant(c)) => c.map(constant),
                _ => Rgb::zero(),
            };
            surface.with(constant(part.weight), put_together(part.kind, color, part.numbers.map(constant)))
        })
    })
}

/// The surfaces of eight materials of one variant at eight texture coordinates.
pub(crate) fn lane_surface(
    materials: [&PreparedMaterial; F32x8::LANES],
    textures: &[Texture],
    uv: [F32x8; 2],
) -> Surface<F32x8> {
    let [u, v] = uv.map(F32x8::to_array);
    let slots = 0..materials[0].parts.len();
    slots.fold(Surface::black(), |surface, slot| {
        let parts = materials.map(|m| &m.parts[slot]);
        let color = |lane: usize| match parts[lane].color {
            Some(Color::Constant(c)) => c,
            Some(Color::Texture { texture, scale }) => textures[texture].sample(u[lane], v[lane]) * scale,
            None => Rgb::zero(),
        };
        let colors: [Rgb<f32>; F32x8::LANES] = std::array::from_fn(color);
        let color =
            Rgb::new(F32x8::new(colors.map(|c| c.r)), F32x8::new(colors.map(|c| c.g)), F32x8::new(colors.map(|c| c.b)));
        let numbers = std::array::from_fn(|i| F32x8::new(parts.map(|part| part.numbers[i])));
        surface.with(F32x8::new(parts.map(|part| part.weight)), put_together(parts[0].kind, color, numbers))
    })
}

/// A lobe taken apart: what decides its code, and numbers that may differ from lane to lane.
#[derive(Clone, Debug)]
struct Part {
    kind: Kind,
    color: Option<Color>,
    /// Widths first, then what follows in the kernel's lobe.
    numbers: [f32; NUMBERS],
    weight: f32,
}

impl Part {
    fn is_textured(&self) -> bool {
        matches!(self.color, Some(Color::Texture { .. }))
    }
}

fn parts(material: &Material) -> Vec<Part> {
    material.lobes.iter().map(taken_apart).collect()
}

/// What decides which code a lobe runs: equal for lobes that can share a lane batch. All else about it are numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Diffuse,
    Eon(Directional),
    Mirror,
    Phong(PhongNorm),
    Conductor { distribution: Distribution, masking: Masking, fresnel: FresnelKind, compensation: Compensation },
    Dielectric,
    RoughDielectric { distribution: Distribution, masking: Masking },
}

/// Which Fresnel's equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FresnelKind {
    Conductor,
    Schlick,
    F82,
    Dielectric,
}

/// The most numbers that a lobe has.
const NUMBERS: usize = 8;

fn taken_apart(lobe: &LobeSpec) -> Part {
    let numbers = |given: &[f32]| {
        let mut all = [0.0; NUMBERS];
        all[..given.len()].copy_from_slice(given);
        all
    };
    let (kind, color, numbers) = match lobe.model {
        Model::Diffuse { base_color } => (Kind::Diffuse, Some(base_color), numbers(&[])),
        Model::Eon { base_color, roughness, directional } => {
            (Kind::Eon(directional), Some(base_color), numbers(&[roughness]))
        }
        Model::Mirror { reflectance } => (Kind::Mirror, Some(reflectance), numbers(&[])),
        Model::Phong { diffuse, glossy: s, exponent, norm } => {
            (Kind::Phong(norm), Some(diffuse), numbers(&[s.r, s.g, s.b, exponent]))
        }
        Model::Conductor { fresnel, microfacets, compensation } => {
            let MicrofacetSpec { distribution, masking, alpha_x: x, alpha_y: y } = microfacets;
            let (fresnel, p) = match fresnel {
                FresnelSpec::Conductor { eta: n, k } => (FresnelKind::Conductor, [x, y, n.r, n.g, n.b, k.r, k.g, k.b]),
                FresnelSpec::Schlick { f0: f } => (FresnelKind::Schlick, numbers(&[x, y, f.r, f.g, f.b])),
                FresnelSpec::F82 { f0: f, tint: t } => (FresnelKind::F82, [x, y, f.r, f.g, f.b, t.r, t.g, t.b]),
                FresnelSpec::Dielectric { ior } => (FresnelKind::Dielectric, numbers(&[x, y, ior])),
            };
            (Kind::Conductor { distribution, masking, fresnel, compensation }, None, p)
        }
        Model::Dielectric { ior, microfacets: None } => (Kind::Dielectric, None, numbers(&[ior])),
        Model::Dielectric { ior, microfacets: Some(microfacets) } => {
            let MicrofacetSpec { distribution, masking, alpha_x, alpha_y } = microfacets;
            (Kind::RoughDielectric { distribution, masking }, None, numbers(&[alpha_x, alpha_y, ior]))
        }
    };
    Part { kind, color, numbers, weight: lobe.weight }
}

/// The one place where scene models become kernel lobes.
fn put_together<R: Real>(kind: Kind, color: Rgb<R>, p: [R; NUMBERS]) -> AnyLobe<R> {
    let rgb = |at: usize| Rgb::new(p[at], p[at + 1], p[at + 2]);
    let microfacets = |distribution| -> Microfacets<R> {
        match distribution {
            Distribution::Ggx => Ggx { alpha_x: p[0], alpha_y: p[1] }.into(),
            Distribution::Beckmann => Beckmann { alpha_x: p[0], alpha_y: p[1] }.into(),
        }
    };
    match kind {
        Kind::Diffuse => Lambert::new(color).into(),
        Kind::Eon(directional) => Eon { directional, ..Eon::new(color, p[0]) }.into(),
        Kind::Mirror => Mirror::new(color).into(),
        Kind::Phong(norm) => Phong { diffuse: color, glossy: rgb(0), exponent: p[3], norm }.into(),
        Kind::Conductor { distribution, masking, fresnel, compensation } => {
            let fresnel = match fresnel {
                FresnelKind::Conductor => Fresnel::Conductor { eta: rgb(2), k: rgb(5) },
                FresnelKind::Schlick => Fresnel::Schlick { f0: rgb(2) },
                FresnelKind::F82 => Fresnel::F82 { f0: rgb(2), tint: rgb(5) },
                FresnelKind::Dielectric => Fresnel::Dielectric { eta: p[2] },
            };
            let conductor = Conductor::new(microfacets(distribution), fresnel);
            conductor.with_masking(masking).with_compensation(compensation).into()
        }
        Kind::Dielectric => Dielectric::new(p[0]).into(),
        Kind::RoughDielectric { distribution, masking } => {
            RoughDielectric::new(microfacets(distribution), p[2]).with_masking(masking).into()
        }
    }
}
