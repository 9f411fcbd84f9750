//! Effects: what a scene calls for. The rest is left out, and leaving it out never changes a bit.
//!
//! Every part of a scene (material, mesh, light, camera, environment) says which effects it needs; the scene's set is their
//! union, and who needs what can be asked ([`SceneEffects`]). Nobody else can make a set: a render looks at the world's own, or
//! at [`EffectSet::ALL`] for the proof that the picture is the same.
//!
//! Effects are tested once per queue stage. An absent effect is skipped, not evaluated with neutral numbers, and random numbers
//! have fixed addresses (see `sampler.rs`), so both pictures have the same hash. A scattering model is an effect too: its
//! code runs if a material is made of it, see [`SceneEffects::models`].

use std::collections::BTreeMap;
use std::fmt;

/// Declares the effects; their list follows.
macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal,)+) => {
        /// What a render may have to look at.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Effect {
            $($(#[doc = $doc])+ $name,)+
        }

        impl Effect {
            /// Every effect.
            pub const ALL: &'static [Self] = &[$(Self::$name),+];

            /// What it is called.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                }
            }
        }
    };
}

effects! {
    /// Some triangle emits.
    AreaLights = "area lights",
    /// The environment is not black.
    Environment = "environment",
    /// Some light is a point.
    PointLights = "point lights",
    /// Some light is a spot.
    SpotLights = "spot lights",
    /// Some light is infinitely far away.
    DistantLights = "distant lights",
    /// Some light is of a user's own kind.
    CustomLights = "custom lights",
    /// The camera has a lens.
    DepthOfField = "depth of field",
    /// Some parameter comes from an image.
    Textures = "textures",
    /// Some mesh has shading normals.
    SmoothNormals = "smooth normals",
    /// Some lobe depends on the tangent, on a mesh with texture coordinates.
    Tangents = "tangents",
    /// Some material tilts its frame by an image.
    NormalMaps = "normal maps",
    /// Some material is black from behind.
    OneSided = "one-sided materials",
    /// Some lobe is a delta function of direction.
    DeltaLobes = "delta lobes",
    /// Some material lets light through.
    Transmission = "transmission",
}

/// A set of effects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EffectSet(u32);

impl EffectSet {
    /// No effect.
    pub const NONE: Self = Self(0);
    /// Every effect, needed or not.
    pub const ALL: Self = Self((1 << Effect::ALL.len()) - 1);

    /// One effect.
    pub const fn of(effect: Effect) -> Self {
        Self(1 << effect as u32)
    }

    /// The effect if `needed`, else none.
    pub fn when(needed: bool, effect: Effect) -> Self {
        if needed { Self::of(effect) } else { Self::NONE }
    }

    /// What is in either set.
    #[must_use]
    pub const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the effect is in the set.
    #[inline(always)]
    pub const fn has(self, effect: Effect) -> bool {
        self.0 >> effect as u32 & 1 != 0
    }

    /// Whether something is looked up at texture coordinates, or leans on them.
    #[inline(always)]
    pub(crate) const fn has_uvs(self) -> bool {
        self.has(Effect::Textures) || self.has(Effect::Tangents) || self.has(Effect::NormalMaps)
    }

    /// The effects of the set.
    pub fn iter(self) -> impl Iterator<Item = Effect> {
        Effect::ALL.iter().copied().filter(move |&effect| self.has(effect))
    }

    /// The set without one effect: what a render must never be given, for the test that the hash would tell.
    #[cfg(test)]
    pub(crate) fn without(self, effect: Effect) -> Self {
        Self(self.0 & !Self::of(effect).0)
    }
}

/// Which effects a scene calls for, and what in it does so.
#[derive(Clone, Debug, Default)]
pub struct SceneEffects {
    set: EffectSet,
    by: BTreeMap<Effect, Vec<String>>,
    models: BTreeMap<&'static str, Vec<String>>,
}

impl SceneEffects {
    /// Notes what a part of the scene needs; `part` is its name, as in `material "gold"`.
    pub(crate) fn need(&mut self, effects: EffectSet, part: impl Fn() -> String) {
        self.set = self.set.with(effects);
        for effect in effects.iter() {
            let (parts, part) = (self.by.entry(effect).or_default(), part());
            // Parts of one file have one name.
            if parts.last() != Some(&part) {
                parts.push(part);
            }
        }
    }

    /// Notes that a part of the scene scatters by a model.
    pub(crate) fn need_model(&mut self, model: &'static str, part: String) {
        let parts = self.models.entry(model).or_default();
        if !parts.contains(&part) {
            parts.push(part);
        }
    }

    /// The union of what all parts need.
    pub fn set(&self) -> EffectSet {
        self.set
    }

    /// The parts that need an effect, in the order of the scene; empty if none does.
    pub fn needed_by(&self, effect: Effect) -> &[String] {
        self.by.get(&effect).map_or(&[], Vec::as_slice)
    }

    /// The scattering models that materials are made of, and which; `custom` stands for lobes of a user's own.
    pub fn models(&self) -> impl Iterator<Item = (&'static str, &[String])> {
        self.models.iter().map(|(&model, parts)| (model, parts.as_slice()))
    }
}

impl fmt::Display for EffectSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pick = |needed| {
            let names = Effect::ALL.iter().filter(|&&effect| self.has(effect) == needed).map(|effect| effect.name());
            let names: Vec<_> = names.collect();
            if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
        };
        write!(f, "needed: {}; left out: {}", pick(true), pick(false))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_is_the_union_of_what_its_parts_need() {
        let mut effects = SceneEffects::default();
        effects.need(EffectSet::of(Effect::Textures), || "material \"wood\"".to_owned());
        effects.need(EffectSet::of(Effect::Textures).with(EffectSet::of(Effect::OneSided)), || {
            "material \"tile\"".to_owned()
        });
        assert_eq!(effects.set().iter().collect::<Vec<_>>(), [Effect::Textures, Effect::OneSided]);
        assert_eq!(effects.needed_by(Effect::Textures), ["material \"wood\"", "material \"tile\""]);
        assert!(effects.needed_by(Effect::Transmission).is_empty());
        assert_eq!(EffectSet::ALL.iter().count(), Effect::ALL.len());
    }
}
