//! The integrator: the paths of a tile, advanced together.
//!
//! A tile's paths for a few samples form one queue of at most [`QUEUE`] states, small enough for the second-level cache.
//! Stages: generate, then per bounce closest hit, sort by material, shade, shadow rays; then the film. Tiles are independent.

use crate::effects::Effect;
use crate::film::{FilmTile, TILE};
use crate::layers::{DepthUnit, FirstHit};
use crate::queue::{Batch, Order, Paths, Queue, ShadowQueue};
use crate::sampler::Purpose;
use crate::shade::{self, Context, Gathered};
use crate::stats::{LargeSample, TileStats};
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, Real, Rgb, U32x8};
use std::ops::Range;

/// Most paths in a tile's queue: 16 × 16 pixels, eight samples each.
const QUEUE: usize = 2048;
/// Most samples per pixel for which a whole tile has room in its queue.
pub(crate) const SAMPLES_PER_QUEUE: u32 = QUEUE as u32 / (TILE * TILE);

/// The queues of one thread, kept from tile to tile.
#[derive(Default)]
pub(crate) struct TileWorker {
    queue: Queue,
    next: Queue,
    shadow: ShadowQueue,
    order: Order,
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    pixel: Vec<u32>,
    sample: Vec<u32>,
    radiance: Vec<[f32; 3]>,
    /// Whether the camera ray met a surface.
    met: Vec<bool>,
    /// The part of it that scattered at most once; empty unless layers are gathered, as is the next.
    direct: Vec<[f32; 3]>,
    first: Vec<FirstHit>,
}

impl TileWorker {
    /// Adds samples to every pixel of a tile.
    pub(crate) fn render(
        &mut self,
        ctx: &Context,
        accel: &dyn Accel,
        tile: &mut FilmTile,
        depth_unit: Option<DepthUnit>,
        samples: Range<u32>,
    ) {
        let per_queue = (QUEUE / tile.pixels.len().max(1)).clamp(1, QUEUE) as u32;
        let mut first = samples.start;
        while first < samples.end {
            let count = per_queue.min(samples.end - first);
            self.generate(ctx, tile, first, count);
            if depth_unit.is_some() {
                self.first.clear();
                self.first.resize(self.pixel.len(), FirstHit::default());
            }
            self.trace(ctx, accel, &mut tile.stats);
            for (path, (&rgb, (&pixel, &sample))) in
                self.radiance.iter().zip(self.pixel.iter().zip(&self.sample)).enumerate()
            {
                let (x, y) = (pixel & 0xffff, pixel >> 16);
                let at = ((y - tile.y0) * tile.width + (x - tile.x0)) as usize;
                let counts = tile.pixels[at].add(rgb, pixel, sample, self.met[path]);
                if let Some(unit) = depth_unit.filter(|_| counts) {
                    tile.layers[at].add(rgb, self.direct[path], &self.first[path], unit, (pixel, sample));
                }
                tile.stats.note(rgb, || LargeSample { value: 0.0, x, y, sample });
            }
            tile.stats.samples += self.radiance.len() as u64;
            first += count;
        }
    }

    /// Camera rays: the samples of a pixel lie side by side, so that eight rays are nearly one.
    fn generate(&mut self, ctx: &Context, tile: &FilmTile, first: u32, count: u32) {
        self.queue.clear();
        self.pixel.clear();
        self.sample.clear();
        for at in 0..tile.pixels.len() as u32 {
            let (x, y) = (tile.x0 + at % tile.width, tile.y0 + at / tile.width);
            self.pixel.extend((0..count).map(|_| x | y << 16));
            self.sample.extend(first..first + count);
        }
        self.radiance.clear();
        self.radiance.resize(self.pixel.len(), [0.0; 3]);
        self.met.clear();
        self.met.resize(self.pixel.len(), true);

        for start in (0..self.pixel.len()).step_by(F32x8::LANES) {
            let lanes = (self.pixel.len() - start).min(F32x8::LANES);
            let path = U32x8::from_fn(|l| (start + l.min(lanes - 1)) as u32);
            let pixel = U32x8::from_fn(|l| self.pixel[path.lane(l) as usize]);
            let sample = U32x8::from_fn(|l| self.sample[path.lane(l) as usize]);
            let u = ctx.sampler.draw(pixel, sample, 0, Purpose::Camera);
            let x = (pixel & U32x8::splat(0xffff)).to_real() + u.unit(0);
            let y = (pixel >> 16).to_real() + u.unit(1);
            self.queue.push(
                Ray8 { mask: Mask8::first(lanes), ..ctx.world.view.rays(x, y, [u.unit(2), u.unit(3)]) },
                Paths {
                    throughput: Rgb::splat(F32x8::ONE),
                    pdf: F32x8::ZERO,
                    pdf_environment: F32x8::ZERO,
                    path,
                    pixel,
                    sample,
                },
            );
        }
    }

    /// The path loop: every path of the queue to its end. With layers, `direct` is a copy of the radiance from the moment
    /// when the second hit's emission has arrived and its shadow rays have not.
    fn trace(&mut self, ctx: &Context, accel: &dyn Accel, stats: &mut TileStats) {
        let materials = &ctx.world.materials;
        self.direct.clear();
        for depth in 0..=ctx.max_depth {
            if self.queue.rays.is_empty() {
                break;
            }
            let kind = if depth == 0 { RayKind::Coherent } else { RayKind::Incoherent };
            self.hits.resize(self.queue.rays.len(), Hit8::miss());
            accel.closest(kind, &self.queue.rays, &mut self.hits);
            let material_of = |instance, prim| ctx.world.surfaces.material(instance, prim);
            self.order.sort(&self.queue.rays, &self.hits, materials.len(), material_of);
            stats.closest_rays += self.order.lanes.len() as u64;

            if depth == 0 {
                for &lane in self.order.range(0, 1) {
                    let (block, lane) = (lane as usize / F32x8::LANES, lane as usize % F32x8::LANES);
                    self.met[self.queue.paths[block].path.lane(lane) as usize] = false;
                }
            }

            self.next.clear();
            self.shadow.clear();
            let mut gathered = Gathered(&mut self.radiance);
            let first: &mut [FirstHit] = if depth == 0 { &mut self.first } else { &mut [] };
            if ctx.effects.has(Effect::Environment) {
                for lanes in self.order.range(0, 1).chunks(F32x8::LANES) {
                    shade::miss(ctx, depth, &Batch::new(lanes, &self.queue, &self.hits), &mut gathered);
                }
            }
            let mut from = 0;
            while from < materials.len() {
                let variant = materials[from].variant;
                let to = from + materials[from..].iter().take_while(|m| m.variant == variant).count();
                for lanes in self.order.range(1 + from, 1 + to).chunks(F32x8::LANES) {
                    let batch = Batch::new(lanes, &self.queue, &self.hits);
                    let used = shade::hit(ctx, depth, &batch, &mut gathered, first, &mut self.shadow, &mut self.next);
                    stats.closure_lanes += u64::from(used);
                    stats.closure_calls += u64::from(used > 0);
                }
                from = to;
            }

            if depth == 1 && !self.first.is_empty() {
                self.direct.extend_from_slice(gathered.0);
            }
            self.shadow.close();
            self.blocked.resize(self.shadow.rays.len(), Mask8::first(0));
            accel.occluded(RayKind::Incoherent, &self.shadow.rays, None, &mut self.blocked);
            for (((ray, blocked), light), path) in
                self.shadow.rays.iter().zip(&self.blocked).zip(&self.shadow.arriving).zip(&self.shadow.path)
            {
                stats.shadow_rays += u64::from(ray.mask.to_bits().count_ones());
                gathered.add(path, ray.mask & !*blocked, *light);
            }
            std::mem::swap(&mut self.queue, &mut self.next);
        }
        if self.direct.is_empty() && !self.first.is_empty() {
            self.direct.extend_from_slice(&self.radiance); // no path came to a second hit
        }
    }
}
