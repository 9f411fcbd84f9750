//! What a scene calls for: the union of what its parts need.

use crate::effects::{Effect, EffectSet, SceneEffects};
use crate::material::PreparedMaterial;
use crate::scene::{Mesh, Scene};

/// The effects, and what was noticed on the way.
pub(super) struct Needs {
    pub(super) effects: SceneEffects,
    pub(super) warnings: Vec<String>,
}

/// Asks every part that is in the world; what no instance uses needs nothing.
pub(super) fn of(scene: &Scene, meshes: &[Mesh], materials: &[PreparedMaterial], order: &[u32]) -> Needs {
    let mut needs = Needs { effects: SceneEffects::default(), warnings: Vec::new() };
    let (mut placed, mut used) = (vec![false; meshes.len()], vec![false; materials.len()]);
    scene.instances.iter().for_each(|instance| placed[instance.mesh] = true);
    for mesh in meshes.iter().zip(&placed).filter_map(|(mesh, placed)| placed.then_some(mesh)) {
        let mut is_anisotropic = false;
        for material in mesh.materials.iter().map(|&m| order[m as usize] as usize) {
            used[material] = true;
            is_anisotropic |= materials[material].anisotropic;
        }
        let with_uvs = mesh.uvs.is_some();
        let effects = EffectSet::when(mesh.normals.is_some(), Effect::SmoothNormals)
            .with(EffectSet::when(is_anisotropic && with_uvs, Effect::Tangents));
        needs.effects.need(effects, || format!("mesh \"{}\"", mesh.name));
        if is_anisotropic && !with_uvs {
            needs.warnings.push(format!(
                "mesh \"{}\" has an anisotropic material but no texture coordinates: its tangents are arbitrary",
                mesh.name
            ));
        }
    }
    for material in materials.iter().zip(&used).filter_map(|(material, used)| used.then_some(material)) {
        let name = || format!("material \"{}\"", material.spec.name);
        needs.effects.need(material.effects(), name);
        material.models().for_each(|model| needs.effects.need_model(model, name()));
    }
    needs.effects.need(scene.camera.effects(), || "the camera".to_owned());
    needs.effects.need(scene.environment.effects(), || "the environment".to_owned());
    for (number, light) in (1..).zip(&scene.lights) {
        needs.effects.need(light.effects(), || format!("light {number}"));
    }
    needs
}
