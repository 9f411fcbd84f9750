//! The families of rays: each asks for something that ray casters get wrong.

use gonio_accel::RayKind;
use serde::{Serialize, Serializer};
use std::fmt;

/// A way of choosing rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// From the camera, in blocks of four by two pixels.
    Camera,
    /// From camera hits, distributed by cosine.
    Bounce,
    /// From camera hits to a point of a light, or of a wide lamp above everything if there is none.
    Shadow,
    /// From anywhere in any direction.
    Random,
    /// From a point of a triangle, moved off it as a renderer does.
    Secondary,
    /// From a point of a triangle, on it as far as rounding can tell.
    OnSurface,
    /// At a point of an edge.
    Edge,
    /// At a vertex.
    Vertex,
    /// Exactly along an axis, often at the very coordinates of a vertex or an edge.
    AxisParallel,
    /// In the plane of a triangle, or nearly.
    Grazing,
    /// With an interval that begins or ends at a triangle, to the last bit.
    Bounded,
    /// At triangles, edges and vertices from ten to a million times the size of the scene away.
    Far,
    /// From inside of a closed surface at its edges.
    EdgeFromInside,
    /// From inside of a closed surface at its vertices.
    VertexFromInside,
    /// From inside of a closed surface exactly along an axis, at the coordinates of a vertex or an edge.
    AxisFromInside,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Camera,
        Self::Bounce,
        Self::Shadow,
        Self::Random,
        Self::Secondary,
        Self::OnSurface,
        Self::Edge,
        Self::Vertex,
        Self::AxisParallel,
        Self::Grazing,
        Self::Bounded,
        Self::Far,
        Self::EdgeFromInside,
        Self::VertexFromInside,
        Self::AxisFromInside,
    ];

    /// Rays as a renderer casts them, which no rounding decides: another ray caster must agree on all but 1 in 10⁵.
    pub fn is_ordinary(self) -> bool {
        matches!(self, Self::Camera | Self::Bounce | Self::Shadow | Self::Random | Self::Secondary)
    }

    /// Rays that start on a triangle, or next to it.
    pub fn leaves_a_surface(self) -> bool {
        matches!(self, Self::Bounce | Self::Shadow | Self::Secondary)
    }

    /// Rays that start inside of a closed surface: each must hit something.
    pub fn is_inside(self) -> bool {
        matches!(self, Self::EdgeFromInside | Self::VertexFromInside | Self::AxisFromInside)
    }

    /// Rays aimed at places between triangles, so that many of them can leak.
    pub fn is_aimed_between_triangles(self) -> bool {
        self.is_inside() || matches!(self, Self::Edge | Self::Vertex | Self::AxisParallel | Self::Far)
    }

    /// What a renderer would say of them.
    pub fn kind(self) -> RayKind {
        if self == Self::Camera { RayKind::Coherent } else { RayKind::Incoherent }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Camera => "camera",
            Self::Bounce => "bounce",
            Self::Shadow => "shadow",
            Self::Random => "random",
            Self::Secondary => "secondary",
            Self::OnSurface => "on-surface",
            Self::Edge => "edge-aimed",
            Self::Vertex => "vertex-aimed",
            Self::AxisParallel => "axis-parallel",
            Self::Grazing => "grazing",
            Self::Bounded => "bounded",
            Self::Far => "far",
            Self::EdgeFromInside => "edge-from-inside",
            Self::VertexFromInside => "vertex-from-inside",
            Self::AxisFromInside => "axis-from-inside",
        })
    }
}

impl Serialize for Family {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
