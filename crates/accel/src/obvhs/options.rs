//! What may be chosen of a tree: how long it takes to build, and what instances share.

use crate::triangle::Intersect;

/// How much time is spent to build a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ObvhsPreset {
    /// As little as possible: the tree of `obvhs`' PLOC builder.
    Fast,
    /// From the top down, by the surface area heuristic.
    #[default]
    Medium,
    /// The same, then improved by `obvhs`' reinsertion: several times the time.
    High,
}

/// Which instances share what is kept of their mesh, instead of being laid out in the world. No hit depends on it. A shared tree saves
/// memory and time to build; rays take about twice as long, because what they meet is moved to the world whenever they do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sharing {
    /// Those of meshes that are placed more than once, if all instances together have more than four million triangles.
    #[default]
    Large,
    /// None.
    Never,
    /// All, as far as their maps can be inverted.
    Always,
}

impl Sharing {
    /// More triangles than that are not laid out if they need not be: their tree would take a quarter of a gigabyte.
    pub const LARGE: usize = 1 << 22;

    /// Whether the instances of a mesh share it, if all instances together have so many triangles, and the mesh so many
    /// instances.
    pub fn shares(self, triangles: usize, instances: usize) -> bool {
        match self {
            Self::Large => triangles > Self::LARGE && instances > 1,
            Self::Never => false,
            Self::Always => true,
        }
    }
}

/// How a tree is built and rays are tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObvhsOptions {
    /// How strictly rays are tested. A list of few triangles keeps the watertight test, which costs it nothing.
    pub intersect: Intersect,
    /// How much time is spent to build.
    pub preset: ObvhsPreset,
    /// Which instances share a tree.
    pub sharing: Sharing,
}
