//! What a render counted.

use gonio_kernel::F32x8;

/// How many of the largest samples are kept: a firefly is found by its pixel.
const KEPT: usize = 10;

/// Counts and times of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderStats {
    /// Wall time of the render alone \[s\].
    pub render_seconds: f64,
    /// Samples per pixel: fewer than were asked for if the render was stopped.
    pub spp: u32,
    /// Camera samples.
    pub samples: u64,
    /// Live lanes sent to the closest-hit query.
    pub closest_rays: u64,
    /// Live lanes sent to the occlusion query.
    pub shadow_rays: u64,
    /// Mean live lanes per closure call, over eight: 1 is full.
    pub lanes_full: f64,
    /// Samples that were not finite or too large, and count as black.
    pub dropped_samples: u64,
    /// The largest sample values and where they fell, largest first.
    pub largest: Vec<LargeSample>,
    /// A hash of the film's integers.
    pub film_hash: String,
    /// Threads used.
    pub threads: usize,
}

/// A large sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LargeSample {
    /// Its largest channel.
    pub value: f32,
    /// Column.
    pub x: u32,
    /// Row.
    pub y: u32,
    /// Sample number.
    pub sample: u32,
}

/// The counts of one tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct TileStats {
    pub(crate) samples: u64,
    pub(crate) closest_rays: u64,
    pub(crate) shadow_rays: u64,
    pub(crate) closure_calls: u64,
    pub(crate) closure_lanes: u64,
    largest: Vec<LargeSample>,
}

impl TileStats {
    /// Keeps a sample if it is among the largest; `place` says where it fell.
    #[inline]
    pub(crate) fn note(&mut self, rgb: [f32; 3], place: impl FnOnce() -> LargeSample) {
        let value = rgb[0].max(rgb[1]).max(rgb[2]);
        if self.largest.len() == KEPT && value <= self.largest[KEPT - 1].value {
            return;
        }
        if value > 0.0 {
            self.keep(LargeSample { value, ..place() });
        }
    }

    fn keep(&mut self, sample: LargeSample) {
        // Ties by place, so that the list does not depend on the order of tiles.
        let key = |s: &LargeSample| (s.y, s.x, s.sample);
        let before = |s: &LargeSample| s.value > sample.value || (s.value == sample.value && key(s) < key(&sample));
        let at = self.largest.partition_point(before);
        self.largest.insert(at, sample);
        self.largest.truncate(KEPT);
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.closest_rays += other.closest_rays;
        self.shadow_rays += other.shadow_rays;
        self.closure_calls += other.closure_calls;
        self.closure_lanes += other.closure_lanes;
        other.largest.iter().for_each(|&s| self.keep(s));
    }

    pub(crate) fn finish(
        self,
        render_seconds: f64,
        spp: u32,
        dropped: u64,
        film_hash: String,
        threads: usize,
    ) -> RenderStats {
        let slots = F32x8::LANES as f64 * self.closure_calls as f64;
        RenderStats {
            render_seconds,
            spp,
            samples: self.samples,
            closest_rays: self.closest_rays,
            shadow_rays: self.shadow_rays,
            lanes_full: if slots > 0.0 { self.closure_lanes as f64 / slots } else { 0.0 },
            dropped_samples: dropped,
            largest: self.largest,
            film_hash,
            threads,
        }
    }
}
