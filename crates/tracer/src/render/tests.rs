//! Pruning: what a scene calls for is looked at, and a render that leaves some of it out has another hash.

use super::*;
use crate::backend::Backend;
use crate::effects::Effect;
use crate::light::{DistantLight, PointLight, SpotLight};
use crate::normal_map::NormalMap;
use crate::scene::{
    CameraSpec, Environment, FilmSettings, Instance, IntegratorSettings, LobeSpec, Material, Mesh, NormalMapSpec, Scene,
};
use crate::texture::Texture;
use crate::world::World;
use glam::{DAffine3, DVec3};
use gonio_accel::Intersect;
use gonio_kernel::Rgb;
use gonio_kernel::fresnel::Fresnel;
use gonio_kernel::lobe::{AnyLobe, Conductor, Dielectric, Lambert, Mirror};
use gonio_kernel::microfacet::Ggx;
use std::sync::Arc;

/// A square of side 2 in the plane z = 0, facing +z, with normals that are not its own and texture coordinates that are turned.
fn square(name: &str, material: u32) -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    Mesh {
        name: name.to_owned(),
        positions: corners.map(|[x, y]| [x, y, 0.0]).to_vec(),
        normals: Some(
            corners.map(|[x, y]: [f64; 2]| DVec3::new(0.3 * x, 0.3 * y, 1.0).normalize().as_vec3().to_array()).into(),
        ),
        uvs: Some(corners.map(|[x, y]| [(0.4 * x + 0.3 * y) as f32, (0.4 * y - 0.3 * x) as f32]).to_vec()),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        materials: vec![material; 2],
    }
}

/// One square for each effect of a material, under every kind of light.
fn everything() -> Scene {
    let grey = |x: f32| Lambert::new(Rgb::splat(x));
    let brushed = Conductor::new(Ggx { alpha_x: 0.1, alpha_y: 0.5 }, Fresnel::Schlick { f0: Rgb::splat(0.9) });
    let material = |name: &str, lobe: AnyLobe<'static, f32>| Material::new(name, vec![LobeSpec::new(lobe)]);
    let materials = vec![
        Material::new("image", vec![LobeSpec::new(grey(0.8)).with_texture("base_color", 0)]),
        material("brushed", brushed.into()),
        Material { normal_map: Some(NormalMapSpec { map: 0, scale: 1.0 }), ..material("bumps", grey(0.7).into()) },
        material("glass", Dielectric::new(1.5).into()),
        Material { two_sided: false, ..material("one-sided", grey(0.6).into()) },
        Material { emission: Rgb::splat(3.0), ..material("lamp", grey(0.0).into()) },
        material("mirror", Mirror::new(Rgb::splat(0.9)).into()),
    ];
    let meshes: Vec<Mesh> = materials.iter().zip(0..).map(|(m, i)| square(&m.name, i)).collect();
    let place = |i: usize| {
        let turn = if i == 4 { 2.6 } else { 0.2 * i as f64 };
        let at = DVec3::new((i % 3) as f64 * 2.2 - 2.2, (i / 3) as f64 * 2.2 - 2.2, -0.3 * i as f64);
        DAffine3::from_translation(at) * DAffine3::from_rotation_y(turn)
    };
    let instances = meshes.iter().enumerate();
    let instances =
        instances.map(|(mesh, m)| Instance { name: m.name.clone(), mesh, transform: place(mesh) }).collect();
    let camera = CameraSpec { origin: Some(DVec3::new(0.5, 0.5, 9.0)), aperture: Some(0.1), ..CameraSpec::default() };
    let texels = (0..16).map(|i| [(i * 16) as u8, (255 - i * 8) as u8, ((i * 77) % 256) as u8]).collect();
    let bumps = (0..16_u16).map(|i| [20_000 + i * 1_500, 45_000 - i * 1_200, 60_000]).collect();
    let (position, target) = (DVec3::new(1.0, 2.0, 4.0), DVec3::ZERO);
    Scene {
        film: FilmSettings { width: 32, height: 32, spp: 16, exposure: 0.0 },
        camera: camera.complete([DVec3::splat(-3.0), DVec3::splat(3.0)], 1.0).unwrap(),
        integrator: IntegratorSettings::default(),
        materials,
        textures: vec![Texture::from_srgb8(4, 4, texels).unwrap()],
        normal_maps: vec![NormalMap::from_linear16(4, 4, bumps).unwrap()],
        meshes,
        instances,
        environment: Environment::constant(Rgb::splat(0.4)),
        lights: vec![
            Arc::new(PointLight { position, intensity: Rgb::splat(8.0) }),
            Arc::new(SpotLight {
                position: -position + DVec3::Z * 8.0,
                target,
                intensity: Rgb::splat(20.0),
                cutoff_angle: 40.0,
                beam_width: 20.0,
            }),
            Arc::new(DistantLight { direction: DVec3::new(0.2, -1.0, -1.0), irradiance: Rgb::splat(0.5) }),
        ],
        warnings: Vec::new(),
    }
}

fn prepared(scene: &Scene) -> Prepared {
    Prepared::new(World::new(scene).unwrap(), Backend::Obvhs, Intersect::Robust).unwrap()
}

fn hash(effects: EffectSet, prepared: &Prepared, scene: &Scene) -> String {
    let settings = RenderSettings::of(scene);
    render_looking_at(effects, prepared, &settings, &mut |_| ControlFlow::Continue(())).stats.film_hash
}

/// What the stages of a path test. The other effects are lists that may be empty and code that may not be called.
const TESTED: [Effect; 7] = [
    Effect::AreaLights,
    Effect::Environment,
    Effect::SmoothNormals,
    Effect::Tangents,
    Effect::NormalMaps,
    Effect::OneSided,
    Effect::Transmission,
];

#[test]
fn leaving_out_an_effect_that_a_scene_calls_for_changes_its_hash() {
    let scene = everything();
    let prepared = prepared(&scene);
    let needed = prepared.world().effects().set();
    let missing: Vec<_> = Effect::ALL.iter().filter(|effect| !needed.has(**effect)).collect();
    assert_eq!(missing, [&Effect::CustomLights], "the scene has one of everything else");
    let expected = hash(needed, &prepared, &scene);
    assert_eq!(hash(EffectSet::ALL, &prepared, &scene), expected);
    for effect in TESTED {
        assert_ne!(hash(needed.without(effect), &prepared, &scene), expected, "{}", effect.name());
    }
}

#[test]
fn every_part_of_a_scene_calls_for_its_own_effects() {
    let scene = everything();
    let world = World::new(&scene).unwrap();
    let by = |effect| world.effects().needed_by(effect).join(", ");
    assert_eq!(by(Effect::Textures), "material \"image\"");
    assert_eq!(by(Effect::Tangents), "mesh \"brushed\"");
    assert_eq!(by(Effect::NormalMaps), "material \"bumps\"");
    assert_eq!(by(Effect::Transmission), "material \"glass\"");
    assert_eq!(by(Effect::OneSided), "material \"one-sided\"");
    assert_eq!(by(Effect::AreaLights), "material \"lamp\"");
    assert_eq!(by(Effect::DeltaLobes), "material \"glass\", material \"mirror\"");
    assert_eq!(by(Effect::PointLights), "light 1");
    assert_eq!(by(Effect::SpotLights), "light 2");
    assert_eq!(by(Effect::DistantLights), "light 3");
    assert_eq!(by(Effect::DepthOfField), "the camera");
    assert_eq!(by(Effect::Environment), "the environment");
    assert_eq!(world.effects().needed_by(Effect::SmoothNormals).len(), scene.meshes.len());
    let models: Vec<_> = world.effects().models().map(|(model, _)| model).collect();
    assert_eq!(models, ["conductor", "dielectric", "diffuse", "mirror"]);
}

#[test]
fn a_material_that_nothing_is_made_of_calls_for_nothing() {
    let mut scene = everything();
    scene.instances.truncate(1);
    scene.lights.clear();
    let world = World::new(&scene).unwrap();
    let needed: Vec<_> = world.effects().set().iter().map(Effect::name).collect();
    assert_eq!(needed, ["environment", "depth of field", "textures", "smooth normals"]);
}
