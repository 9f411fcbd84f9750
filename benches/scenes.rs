//! Scenes to cast rays at, of four characters that ask a tree for different things. All are generated, from the same numbers on
//! every machine, and as fine as one asks for:
//!
//! | character | at full size | what it asks for |
//! |---|---|---|
//! | [`Character::Atrium`] | 0.32 M triangles | huge walls beside finely divided columns; closed, so that every ray hits |
//! | [`Character::Terrain`] | 1.0 M | a fractal height field of even, tiny triangles; no cache holds it |
//! | [`Character::Hair`] | 1.0 M | long thin triangles at every angle, in boxes that overlap everywhere |
//! | [`Character::Scans`] | 0.63 M | dense irregular objects in a large and otherwise empty box |
//!
//! The scans are those of the Stanford bunny if the test data are there, see [`scans`], and a generated likeness otherwise; the
//! scene's name says which. [`rays`] makes the rays that a renderer would cast.

mod atrium;
mod hair;
mod random;
pub(crate) mod rays;
pub(crate) mod room;
mod scans;
mod sheet;
mod terrain;

use gonio_accel::Geometry;
use gonio_kernel::Vec3;
pub(crate) use random::Random;
use sheet::Sheets;

/// A geometry, and what a renderer would need besides to cast rays at it.
pub(crate) struct Scene {
    /// The character, and where it matters, what it was made of.
    pub(crate) name: String,
    /// One mesh, placed once, but for [`instances`].
    pub(crate) geometry: Geometry,
    /// From where it is looked at.
    pub(crate) camera: Camera,
    /// What shadow rays point to. It is not part of the geometry.
    pub(crate) light: Quad,
}

/// A pinhole camera; up is y.
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    /// Where it is.
    pub(crate) eye: Vec3<f32>,
    /// What is in the middle of its picture.
    pub(crate) target: Vec3<f32>,
    /// Vertical field of view in degrees.
    pub(crate) field_of_view: f32,
}

/// A parallelogram: corner + a·edges[0] + b·edges[1], a and b in [0, 1].
#[derive(Clone, Copy)]
pub(crate) struct Quad {
    /// One of its corners.
    pub(crate) corner: Vec3<f32>,
    /// The edges that start there.
    pub(crate) edges: [Vec3<f32>; 2],
}

/// What a scene is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Character {
    /// A closed interior with columns, arches, boxes and cloth.
    Atrium,
    /// A height field.
    Terrain,
    /// Curly ribbons.
    Hair,
    /// Scanned objects in a box.
    Scans,
}

impl Character {
    /// All four.
    pub(crate) const ALL: [Self; 4] = [Self::Atrium, Self::Terrain, Self::Hair, Self::Scans];

    /// What the command line calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Atrium => "atrium",
            Self::Terrain => "terrain",
            Self::Hair => "hair",
            Self::Scans => "scans",
        }
    }

    /// How many triangles it has, about, where speeds are compared.
    pub(crate) fn full_size(self) -> usize {
        match self {
            Self::Atrium => 320_000,
            Self::Terrain => 1_002_528,
            Self::Hair => 1_000_000,
            Self::Scans => 630_000,
        }
    }

    /// A scene of about that many triangles, from a few hundred to ten million; generated, whatever files are there.
    pub(crate) fn scene(self, triangles: usize) -> Scene {
        match self {
            Self::Atrium => atrium::scene(triangles),
            Self::Terrain => terrain::scene(triangles),
            Self::Hair => hair::scene(triangles),
            Self::Scans => scans::generated(triangles),
        }
    }

    /// The scene on which speeds are compared, with the scans of the test data if they are there.
    pub(crate) fn full_scene(self) -> Scene {
        let real = if self == Self::Scans { scans::bunnies() } else { None };
        real.unwrap_or_else(|| self.scene(self.full_size()))
    }
}

/// The scans as instances of one mesh.
pub(crate) fn instances() -> Scene {
    scans::instances()
}

/// A scene of one mesh.
fn assemble(name: impl Into<String>, sheets: Sheets, camera: Camera, light: Quad) -> Scene {
    let geometry = Geometry::of_mesh(sheets.mesh).expect("generated meshes are sound");
    Scene { name: name.into(), geometry, camera, light }
}

/// A light that hangs with its middle at `middle`, level, `width` by `depth`.
fn lamp(middle: Vec3<f32>, width: f32, depth: f32) -> Quad {
    let edges = [Vec3::new(width, 0.0, 0.0), Vec3::new(0.0, 0.0, depth)];
    Quad { corner: middle - (edges[0] + edges[1]) * 0.5, edges }
}
