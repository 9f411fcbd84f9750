//! Who takes part: obvhs with its presets, and Embree, if this build has it, in all its ways.

use gonio_accel::{Accel, Geometry, Intersect, Obvhs, ObvhsOptions, ObvhsPreset, RayKind, Sharing};
#[cfg(feature = "embree")]
use gonio_accel::{Embree, EmbreeOptions, EmbreeQuality, EmbreeWidth};
use std::sync::Arc;

/// Builds a tree of some quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Builder {
    Obvhs(ObvhsPreset),
    /// With trees that instances share.
    Shared,
    #[cfg(feature = "embree")]
    Embree(EmbreeQuality),
}

/// Whose a builder is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Ours,
    Embree,
}

/// A tree, and the ways to cast rays at it.
pub(crate) struct Contender {
    pub(crate) builder: Builder,
    /// What it takes; Embree does not say.
    pub(crate) bytes: Option<usize>,
    /// With nothing chosen.
    unasked: Arc<dyn Accel>,
    /// By name of Embree's width.
    ways: Vec<(&'static str, Arc<dyn Accel>)>,
}

/// A way to answer a ray set.
#[derive(Clone)]
pub(crate) struct Method {
    pub(crate) name: String,
    pub(crate) side: Side,
    pub(crate) accel: Arc<dyn Accel>,
    pub(crate) kind: RayKind,
}

impl Builder {
    /// Those whose speeds are compared.
    pub(crate) fn compared() -> Vec<Self> {
        let other = |builder: &Self| matches!(builder, Self::Obvhs(preset) if *preset != ObvhsPreset::default());
        Self::all().into_iter().filter(|builder| !other(builder)).collect()
    }

    /// Every preset, and both qualities of Embree.
    pub(crate) fn all() -> Vec<Self> {
        let ours = [ObvhsPreset::Medium, ObvhsPreset::Fast, ObvhsPreset::High].into_iter().map(Self::Obvhs);
        #[cfg(feature = "embree")]
        let ours = ours.chain([EmbreeQuality::Medium, EmbreeQuality::High].map(Self::Embree));
        ours.collect()
    }

    pub(crate) fn name(self) -> String {
        match self {
            Self::Obvhs(preset) => format!("obvhs-{preset:?}").to_lowercase(),
            Self::Shared => "obvhs-shared".to_owned(),
            #[cfg(feature = "embree")]
            Self::Embree(quality) => format!("embree-{quality:?}").to_lowercase(),
        }
    }

    pub(crate) fn named(name: &str) -> Result<Self, String> {
        Self::all().into_iter().find(|builder| builder.name() == name).ok_or_else(|| format!("no builder {name}"))
    }

    pub(crate) fn side(self) -> Side {
        match self {
            Self::Obvhs(_) | Self::Shared => Side::Ours,
            #[cfg(feature = "embree")]
            Self::Embree(_) => Side::Embree,
        }
    }

    pub(crate) fn build(self, geometry: &Geometry, intersect: Intersect) -> Result<Contender, String> {
        let ours = |preset: ObvhsPreset, sharing: Sharing| {
            let tree = Obvhs::with(geometry, ObvhsOptions { intersect, preset, sharing }, &mut |_| ());
            let (bytes, tree) = (Some(tree.bytes()), Arc::new(tree));
            Ok(Contender { builder: self, bytes, unasked: tree.clone(), ways: vec![("", tree)] })
        };
        match self {
            Self::Obvhs(preset) => ours(preset, Sharing::Never),
            Self::Shared => ours(ObvhsPreset::default(), Sharing::Always),
            #[cfg(feature = "embree")]
            Self::Embree(quality) => {
                let options = EmbreeOptions { intersect, quality, width: None };
                let scene = Embree::with(geometry, options).map_err(|e| e.to_string())?;
                let widths = [("1", EmbreeWidth::One), ("8", EmbreeWidth::Eight), ("16", EmbreeWidth::Sixteen)];
                let way = |(name, width)| -> (&'static str, Arc<dyn Accel>) { (name, Arc::new(scene.by(width))) };
                let ways = widths.map(way).into();
                Ok(Contender { builder: self, bytes: None, unasked: Arc::new(scene), ways })
            }
        }
    }
}

impl Contender {
    /// All ways to answer rays of that kind: ours is told the kind, of Embree's ways every combination.
    pub(crate) fn methods(&self, kind: RayKind) -> Vec<Method> {
        let side = self.builder.side();
        let mut methods = Vec::new();
        for (width, accel) in &self.ways {
            let kinds = if side == Side::Ours { vec![kind] } else { vec![RayKind::Coherent, RayKind::Incoherent] };
            methods.extend(kinds.into_iter().map(|kind| {
                let flag = if kind == RayKind::Coherent { "coherent" } else { "incoherent" };
                let name = if side == Side::Ours {
                    self.builder.name()
                } else {
                    format!("{} {width} {flag}", self.builder.name())
                };
                Method { name, side, accel: Arc::clone(accel), kind }
            }));
        }
        methods
    }

    /// Asked as a renderer asks it.
    pub(crate) fn as_a_renderer_does(&self) -> &dyn Accel {
        &*self.unasked
    }
}

/// Said at the end of a run that had nobody to compare with.
pub(crate) fn warn_if_alone() {
    if !Builder::all().iter().any(|builder| builder.side() == Side::Embree) {
        println!("\nEmbree was not there: this build lacks the feature `embree`, and nothing was compared with it.");
    }
}
