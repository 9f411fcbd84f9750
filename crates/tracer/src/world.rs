//! The world: a scene made ready to be traced.
//!
//! Everything is placed, recentred and rounded once. The middle of the scene becomes the origin while positions are still
//! `f64`, so a scene far from its own origin (georeferenced data) keeps its precision.
//!
//! The parts, each in its file: how meshes come to the world (`placement`), what shading knows of the triangles
//! (`surfaces`), which effects the scene calls for (`needs`), and the fingerprint.

mod building;
mod fingerprint;
mod needs;
mod placement;
mod surfaces;
mod triangle;

use crate::camera::View;
use crate::effects::SceneEffects;
use crate::error::WorldError;
use crate::light::area::Emitter;
use crate::light::delta::{Bounds, DeltaLights, Light};
use crate::light::lights::Lights;
use crate::material::PreparedMaterial;
use crate::normal_map::NormalMap;
use crate::scene::{FilmSettings, Loading, Mesh, Scene};
use crate::texture::Texture;
use building::Placing;
use gonio_accel::{Geometry, Sharing};
use gonio_kernel::Vec3;
use std::borrow::Cow;
use std::sync::Arc;
use surfaces::Surfaces;

/// A scene made ready: surfaces, materials, lights, camera, and the effects that it calls for.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) film: FilmSettings,
    pub(crate) view: View,
    pub(crate) surfaces: Surfaces,
    pub(crate) materials: Vec<PreparedMaterial>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) normal_maps: Vec<NormalMap>,
    pub(crate) lights: Lights,
    effects: SceneEffects,
    warnings: Vec<String>,
}

impl World {
    /// Places the scene. O(triangles).
    ///
    /// # Errors
    /// If the scene cannot be cast at or shaded.
    pub fn new(scene: &Scene) -> Result<Self, WorldError> {
        Self::by(scene, Sharing::default())
    }

    /// Places the scene; `sharing` says which meshes are instanced, and not flattened. O(triangles).
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn by(scene: &Scene, sharing: Sharing) -> Result<Self, WorldError> {
        let images = (scene.textures.clone(), scene.normal_maps.clone());
        Self::place(scene, Cow::Borrowed(&scene.meshes[..]), images, sharing, &mut |_| ())
    }

    /// Places the scene and takes its meshes and images out of it, each mesh freed once it is placed: for scenes that fill
    /// the memory. `progress` is told how many triangles are placed.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn take(scene: &mut Scene, progress: &mut dyn FnMut(Loading)) -> Result<Self, WorldError> {
        let images = (std::mem::take(&mut scene.textures), std::mem::take(&mut scene.normal_maps));
        let meshes = std::mem::take(&mut scene.meshes);
        Self::place(scene, Cow::Owned(meshes), images, Sharing::default(), progress)
    }

    fn place(
        scene: &Scene,
        meshes: Cow<'_, [Mesh]>,
        (textures, normal_maps): (Vec<Texture>, Vec<NormalMap>),
        sharing: Sharing,
        progress: &mut dyn FnMut(Loading),
    ) -> Result<Self, WorldError> {
        let bounds = placement::bounds(&scene.instances, &meshes);
        let (materials, order) = PreparedMaterial::prepare(scene)?;
        let needs::Needs { effects, warnings } = needs::of(scene, &meshes, &materials, &order);
        let placing = Placing {
            instances: &scene.instances,
            center: bounds.center,
            order: &order,
            effects: effects.set(),
            sharing,
        };
        let surfaces = placing.place(meshes, progress)?;
        let lights = Lights::new(
            emitters(&surfaces, &materials),
            &scene.environment,
            DeltaLights::new(prepare_lights(scene, &bounds)?),
        );
        Ok(Self {
            film: scene.film,
            view: View::new(&scene.camera, &scene.film, bounds.center),
            surfaces,
            materials,
            textures,
            normal_maps,
            lights,
            effects,
            warnings,
        })
    }

    /// What was noticed while placing the scene: one sentence each.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// What rays are cast at.
    pub fn geometry(&self) -> &Geometry {
        &self.surfaces.geometry
    }

    /// The camera's rays.
    pub fn view(&self) -> View {
        self.view
    }

    /// The corners of every triangle that emits light, in the order (instance, prim).
    pub fn emitters(&self) -> impl Iterator<Item = [Vec3<f32>; 3]> {
        self.lights.triangles.emitters().iter().map(|emitter| emitter.corners)
    }

    /// Which effects the scene calls for, and what in it does so.
    pub fn effects(&self) -> &SceneEffects {
        &self.effects
    }

    /// The largest distance of a corner from the camera's plane; at least 0.
    pub(crate) fn farthest_depth(&self) -> f32 {
        let depth = |corner: &Vec3<f32>| (*corner - self.view.origin).dot(self.view.forward);
        let places = self.surfaces.places();
        let corners = places.flat_map(|(instance, prim)| self.surfaces.triangle(instance, prim).corners);
        corners.map(|corner| depth(&corner)).fold(0.0, f32::max)
    }
}

/// The triangles whose material emits light.
fn emitters(surfaces: &Surfaces, materials: &[PreparedMaterial]) -> Vec<Emitter> {
    let emitter = |(instance, prim): (u32, u32)| {
        let radiance = materials[surfaces.material(instance, prim) as usize].emission;
        (radiance.luminance() > 0.0).then(|| {
            let t = surfaces.triangle(instance, prim);
            Emitter { corners: t.corners, normal: t.normal, radiance }
        })
    };
    surfaces.places().filter_map(emitter).collect()
}

/// The lights that are no triangles.
fn prepare_lights(scene: &Scene, bounds: &Bounds) -> Result<Vec<Arc<dyn Light>>, WorldError> {
    let prepared = (1..)
        .zip(&scene.lights)
        .map(|(number, light)| light.prepare(bounds).map_err(|why| WorldError::Light { number, why }));
    prepared.collect()
}
