//! The fingerprint of a world.

use super::World;
use crate::fingerprint::Fingerprint;
use crate::material::PreparedMaterial;
use crate::normal_map::NormalMap;
use gonio_kernel::Parameters;

impl World {
    /// A fingerprint of everything that the picture depends on beside the settings: triangles, materials, images, lights, and
    /// the camera. Equal scenes have equal ones; half a second for ten million triangles. A user's own lobe counts as different
    /// from any other by its place alone.
    pub fn fingerprint(&self) -> String {
        let mut print = Fingerprint::new();
        for triangle in &self.surfaces.triangles {
            print.numbers(triangle.corners.iter().flat_map(|c| [c.x, c.y, c.z]));
            print.bytes(&triangle.material.to_le_bytes());
        }
        for placement in &self.surfaces.placements {
            print.bytes(&placement.instance.mesh.to_le_bytes());
            let transform = placement.instance.transform.as_flattened();
            transform.iter().for_each(|x| print.bytes(&x.to_le_bytes()));
        }
        print.numbers(self.surfaces.normals.iter().flat_map(|n| [n.x, n.y, n.z]));
        print.numbers(self.surfaces.uvs.iter().flatten().copied());
        self.materials.iter().for_each(|material| describe(material, &mut print));
        self.textures.iter().for_each(|texture| print.bytes(texture.texels().as_flattened()));
        let normals = self.normal_maps.iter().flat_map(NormalMap::texels).flatten();
        normals.for_each(|c| print.bytes(&c.to_le_bytes()));
        self.lights.describe(&mut print);
        print.numbers(self.view.numbers());
        [self.film.width, self.film.height].iter().for_each(|x| print.bytes(&x.to_le_bytes()));
        print.text()
    }
}

/// Takes a material into a fingerprint.
fn describe(material: &PreparedMaterial, print: &mut Fingerprint) {
    let spec = &material.spec;
    for lobe in &spec.lobes {
        lobe.lobe.each_choice(&mut |choice| print.text_of(choice));
        let _ = lobe.lobe.map(&mut |parameter, _, x: f32| {
            print.text_of(parameter.key);
            print.numbers([x]);
            x
        });
        print.numbers(<[f32; 3]>::from(lobe.weight));
        print.bytes(&[lobe.coat.map_or(0, |layering| 1 + layering as u8)]);
        for texture in &lobe.textures {
            print.bytes(&[texture.at, texture.texture].map(usize::to_le_bytes).concat());
        }
    }
    print.numbers(<[f32; 3]>::from(spec.emission));
    print.bytes(&[u8::from(spec.two_sided), u8::from(spec.custom.is_some())]);
    if let Some(map) = spec.normal_map {
        print.bytes(&map.map.to_le_bytes());
        print.numbers([map.scale]);
    }
}
