//! The plan: which effects a scene calls for. The rest is left out, and leaving it out never changes a bit.
//!
//! The flags are tested once per queue stage. An absent effect is skipped, not evaluated with neutral numbers, and random
//! numbers have fixed addresses (see [`crate::sampler`]), so a picture rendered with [`Plan::everything`] has the same
//! hash.

use std::fmt;

/// One flag per effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Some triangle emits.
    pub area_lights: bool,
    /// The environment is not black.
    pub environment: bool,
    /// Some colour comes from an image.
    pub textures: bool,
    /// Some mesh has shading normals.
    pub smooth_normals: bool,
    /// Some lobe depends on the tangent, on a mesh with texture coordinates.
    pub tangents: bool,
    /// Some material tilts its frame by an image.
    pub normal_maps: bool,
    /// Some material is black from behind.
    pub one_sided: bool,
    /// Some lobe is discrete.
    pub discrete: bool,
    /// Some material lets light through.
    pub transmission: bool,
}

impl Plan {
    /// Every effect, needed or not: the slow twin that the pruned plan is compared with.
    pub fn everything() -> Self {
        Self {
            area_lights: true,
            environment: true,
            textures: true,
            smooth_normals: true,
            tangents: true,
            normal_maps: true,
            one_sided: true,
            discrete: true,
            transmission: true,
        }
    }

    /// Whether anything is looked up at texture coordinates, or leans on them.
    pub(crate) fn uvs(&self) -> bool {
        self.textures || self.tangents || self.normal_maps
    }

    fn named(&self) -> [(bool, &'static str); 9] {
        [
            (self.area_lights, "area lights"),
            (self.environment, "environment"),
            (self.textures, "textures"),
            (self.smooth_normals, "smooth normals"),
            (self.tangents, "tangents"),
            (self.normal_maps, "normal maps"),
            (self.one_sided, "one-sided materials"),
            (self.discrete, "mirrors"),
            (self.transmission, "transmission"),
        ]
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pick = |wanted| {
            let names: Vec<_> = self.named().iter().filter(|(on, _)| *on == wanted).map(|(_, name)| *name).collect();
            if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
        };
        write!(f, "needed: {}; left out: {}", pick(true), pick(false))
    }
}
