//! What a census leaves behind: rows of counts, and every disagreement with the ray that makes it.

use super::aim::Ray;
use super::answer::{Answer, Kind};
use super::family::Family;
use super::standard::Standard;
use gonio_accel::Hit;
use gonio_kernel::Vec3;
use serde::Serialize;
use std::fmt;

/// The counts of one family at one scale by one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What was cast at.
    pub specimen: String,
    /// The factor on all lengths.
    pub scale: f64,
    /// Which rays.
    pub family: Family,
    /// Who was asked.
    pub backend: String,
    /// How it was compared with brute.
    pub standard: Standard,
    /// More than one triangle in a hundred is a needle.
    pub needles: bool,
    /// Rays that were cast.
    pub rays: u64,
    /// Those of them that hit something.
    pub hits: u64,
    /// Rays whose answer brute knows; the others were compared with the first backend that is not brute, obvhs as a rule.
    pub seen_by_brute: u64,
    /// Rays that a surface must stop.
    pub must_hit: u64,
    /// Rays that it did not stop.
    pub leaks: u64,
    /// Disagreements with brute, one per ray: only one of the two has a hit.
    pub hit_or_miss: u64,
    /// Another triangle.
    pub prim: u64,
    /// Another distance.
    pub t: u64,
    /// Another place in the triangle.
    pub bary: u64,
    /// Another answer about occlusion.
    pub shadow: u64,
}

/// A disagreement with brute or a leak, with all that is needed to see it again. It is printed in several lines.
#[derive(Clone, Debug, Serialize)]
pub struct Disagreement {
    /// What was cast at.
    pub specimen: String,
    /// The factor on all lengths.
    pub scale: f64,
    /// Which rays.
    pub family: Family,
    /// Of the ray within its family.
    pub number: u64,
    /// Whose answer is wrong.
    pub backend: String,
    /// How it is wrong.
    pub kinds: Vec<Kind>,
    /// The ray.
    pub ray: RayRecord,
    /// What everybody says of it.
    pub told: Vec<Told>,
}

/// A ray, to the last bit.
#[derive(Clone, Debug, Serialize)]
pub struct RayRecord {
    /// Where it starts.
    pub origin: [Number; 3],
    /// Where it goes.
    pub dir: [Number; 3],
    /// Where its interval begins.
    pub t_min: Number,
    /// Where its interval ends.
    pub t_max: Number,
}

/// What one backend says of a ray.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    /// Who says it.
    pub backend: String,
    /// The nearest hit.
    pub hit: Option<HitRecord>,
    /// Whether anything is in the way.
    pub blocked: bool,
    /// With a filter that lets about half of all hits through.
    pub blocked_through_filter: bool,
}

/// A hit, to the last bit.
#[derive(Clone, Debug, Serialize)]
pub struct HitRecord {
    /// The distance.
    pub t: Number,
    /// The triangle's place in its mesh.
    pub prim: u32,
    /// The mesh.
    pub mesh: u32,
    /// The instance.
    pub instance: u32,
    /// The place in the triangle.
    pub bary: [Number; 2],
}

/// A number as the shortest decimal that reads back as the same, and as its bits.
#[derive(Clone, Debug, Serialize)]
pub struct Number {
    /// The decimal.
    pub decimal: String,
    /// The bits, in hexadecimal digits.
    pub bits: String,
}

/// Disagreements that are kept; beyond that they are counted.
const KEPT: usize = 20_000;

/// A census as it grows.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Log {
    /// The counts: brute's, then each backend's, family by family.
    pub rows: Vec<Row>,
    /// Disagreements and leaks, the first of them.
    pub disagreements: Vec<Disagreement>,
    /// Disagreements that were counted but not kept.
    pub left_out: u64,
}

impl Log {
    /// Keeps a disagreement while there is room.
    pub(crate) fn keep(&mut self, disagreement: impl FnOnce() -> Disagreement) {
        if self.disagreements.len() < KEPT {
            self.disagreements.push(disagreement());
        } else {
            self.left_out += 1;
        }
    }
}

impl Row {
    /// A row without rays.
    pub(crate) fn new(specimen: &str, scale: f64, family: Family, backend: &str, standard: Standard) -> Self {
        Self {
            specimen: specimen.to_owned(),
            scale,
            family,
            backend: backend.to_owned(),
            standard,
            needles: false,
            rays: 0,
            hits: 0,
            seen_by_brute: 0,
            must_hit: 0,
            leaks: 0,
            hit_or_miss: 0,
            prim: 0,
            t: 0,
            bary: 0,
            shadow: 0,
        }
    }

    /// Counts one ray of a kind.
    pub(crate) fn note(&mut self, kind: Kind) {
        *match kind {
            Kind::Leak => &mut self.leaks,
            Kind::HitOrMiss => &mut self.hit_or_miss,
            Kind::Prim => &mut self.prim,
            Kind::T => &mut self.t,
            Kind::Bary => &mut self.bary,
            Kind::Shadow => &mut self.shadow,
        } += 1;
    }

    /// The sum of the counts of two rows; names and scale are those of the first.
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            seen_by_brute: self.seen_by_brute + other.seen_by_brute,
            must_hit: self.must_hit + other.must_hit,
            leaks: self.leaks + other.leaks,
            hit_or_miss: self.hit_or_miss + other.hit_or_miss,
            prim: self.prim + other.prim,
            t: self.t + other.t,
            bary: self.bary + other.bary,
            shadow: self.shadow + other.shadow,
            ..self.clone()
        }
    }

    /// Rays on which the backend disagrees with brute.
    pub fn exceptions(&self) -> u64 {
        self.hit_or_miss + self.prim + self.t + self.bary + self.shadow
    }
}

impl From<f32> for Number {
    fn from(x: f32) -> Self {
        Self { decimal: format!("{x:?}"), bits: format!("{:08x}", x.to_bits()) }
    }
}

impl From<&Ray> for RayRecord {
    fn from(ray: &Ray) -> Self {
        let three = |v: Vec3<f32>| <[f32; 3]>::from(v).map(Number::from);
        Self { origin: three(ray.origin), dir: three(ray.dir), t_min: ray.t_min.into(), t_max: ray.t_max.into() }
    }
}

impl Told {
    pub(crate) fn new(backend: &str, answer: &Answer) -> Self {
        let hit = answer.hit.map(|h: Hit| HitRecord {
            t: h.t.into(),
            prim: h.prim,
            mesh: h.mesh,
            instance: h.instance,
            bary: h.bary.map(Number::from),
        });
        Self { backend: backend.to_owned(), hit, blocked: answer.blocked, blocked_through_filter: answer.filtered }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Leak => "a leak",
            Self::HitOrMiss => "hit or miss",
            Self::Prim => "another triangle",
            Self::T => "another distance",
            Self::Bary => "another place in the triangle",
            Self::Shadow => "another shadow",
        })
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} [{}]", self.decimal, self.bits)
    }
}

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.hit {
            Some(h) => {
                write!(f, "{}: t {}, prim {}, mesh {}, instance {}", self.backend, h.t, h.prim, h.mesh, h.instance)?;
                write!(f, ", bary {} {}", h.bary[0], h.bary[1])?;
            }
            None => write!(f, "{}: no hit", self.backend)?,
        }
        let word = |blocked| if blocked { "blocked" } else { "free" };
        write!(f, "; {}, {} through a filter", word(self.blocked), word(self.blocked_through_filter))
    }
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds: Vec<String> = self.kinds.iter().map(Kind::to_string).collect();
        let ray = &self.ray;
        writeln!(
            f,
            "{}: {}, {} ray {} on {} at scale {}",
            self.backend,
            kinds.join(" and "),
            self.family,
            self.number,
            self.specimen,
            self.scale
        )?;
        writeln!(f, "  origin {} {} {}", ray.origin[0], ray.origin[1], ray.origin[2])?;
        writeln!(f, "  dir {} {} {}", ray.dir[0], ray.dir[1], ray.dir[2])?;
        write!(f, "  t from {} to {}", ray.t_min, ray.t_max)?;
        self.told.iter().try_for_each(|told| write!(f, "\n  {told}"))
    }
}
