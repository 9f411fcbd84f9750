//! Rendering: tiles of paths through the stages, passes of samples over the film.
//!
//! A tile's paths for a few samples form one queue of at most [`QUEUE`] states, small enough for the second-level cache.
//! Stages: generate, then per bounce closest hit, sort by material, shade, shadow rays; then the film. Tiles are
//! independent and sums are integers, so threads, order and the length of passes change nothing. After each pass every
//! pixel has the same number of samples: the caller may look at the picture, and may stop.

use crate::film::{self, Pixel};
use crate::layers::{DepthUnit, FirstHit, LayerSums, Layers};
use crate::light::Techniques;
use crate::picture::Picture;
use crate::plan::Plan;
use crate::queue::{Batch, Order, Paths, Queue, ShadowQueue};
use crate::sampler::{Purpose, Sampler};
use crate::scene::Scene;
use crate::shade::{self, Context, Gathered};
use crate::stats::{LargeSample, RenderStats, TileStats};
use crate::world::World;
use gonio_accel::{Accel, Hit8, Ray8, RayKind};
use gonio_kernel::{F32x8, Mask8, Real, Rgb, U32x8};
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};
use std::time::Instant;

/// Pixels along a tile's edge.
const TILE: u32 = 16;
/// Most paths in a tile's queue: 16 × 16 pixels, eight samples each.
const QUEUE: usize = 2048;
/// A pass should take about this long \[s\]: a render that is told to stop finishes its pass first.
const PASS_SECONDS: f64 = 2.0;
/// Most samples of the first pass, whose speed is not known yet; at a million per second two passes' time.
const FIRST_PASS: u64 = 1 << 22;
/// Most samples per pixel of a pass: eight full queues of a tile.
const LONGEST_PASS: u32 = 64;

/// A rectangle of pixels, half open. Each pixel keeps the random numbers it has in the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x0: u32,
    /// One past the last column.
    pub x1: u32,
    /// First row.
    pub y0: u32,
    /// One past the last row.
    pub y1: u32,
}

/// How to render a world.
#[derive(Clone, Copy, Debug)]
pub struct RenderSettings {
    /// Samples per pixel, 1 to 2²⁰.
    pub spp: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Scattering events after which a path ends.
    pub max_depth: u32,
    /// Whether faint paths end by chance from the fifth scattering event on (unbiased).
    pub russian_roulette: bool,
    /// Threads; 0 for all that the machine has.
    pub threads: usize,
    /// The part of the picture to render, as far as it lies inside; `None` for all of it.
    pub crop: Option<Crop>,
    /// Whether to gather [`Layers`] as well: about 170 bytes per pixel.
    pub layers: bool,
    /// Which effects to look at; at least the world's own plan.
    pub plan: Plan,
    /// Which ways of finding light take part; anything but both is for comparing them.
    pub techniques: Techniques,
}

impl RenderSettings {
    /// What the scene asks for, with the world's own plan.
    pub fn of(scene: &Scene, world: &World) -> Self {
        Self {
            spp: scene.film.spp,
            seed: scene.integrator.seed,
            max_depth: scene.integrator.max_depth,
            russian_roulette: scene.integrator.russian_roulette,
            threads: 0,
            crop: None,
            layers: false,
            plan: world.plan(),
            techniques: Techniques::Both,
        }
    }
}

/// How far a render has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples per pixel done.
    pub spp_done: u32,
    /// Samples per pixel in all.
    pub spp: u32,
    /// Samples done.
    pub samples: u64,
    /// Since the render began \[s\].
    pub seconds: f64,
}

/// A picture and how it was made.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The mean radiance of each pixel.
    pub picture: Picture,
    /// What lies beside it, if asked for.
    pub layers: Option<Layers>,
    /// Counts and times.
    pub stats: RenderStats,
}

/// A finished pass: every pixel has the same number of samples.
pub struct Pass<'a> {
    film: &'a Film,
    /// How far the render has come.
    pub progress: Progress,
}

impl Pass<'_> {
    /// The picture so far. The render goes on from where it is.
    pub fn develop(&self) -> Rendering {
        self.film.develop(self.progress.seconds)
    }
}

/// All sums of a render.
struct Film {
    crop: Crop,
    tiles: Vec<FilmTile>,
    /// If layers are gathered.
    depth_unit: Option<DepthUnit>,
    threads: usize,
    spp_done: u32,
}

/// A square of the film and its sums.
struct FilmTile {
    x0: u32,
    y0: u32,
    width: u32,
    pixels: Vec<Pixel>,
    /// One per pixel, or none at all.
    layers: Vec<LayerSums>,
    stats: TileStats,
}

/// Renders the world. `after_pass` is called on the calling thread after each pass of samples over the film; if it
/// breaks, the render ends with the samples it has ([`RenderStats::spp`]).
///
/// # Panics
/// Never for a world and settings in their domains; a thread pool that cannot be made falls back to the global one.
pub fn render(
    world: &World,
    accel: &dyn Accel,
    settings: &RenderSettings,
    after_pass: &mut dyn FnMut(&Pass) -> ControlFlow<()>,
) -> Rendering {
    let start = Instant::now();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build().ok();
    let threads = pool.as_ref().map_or_else(rayon::current_num_threads, rayon::ThreadPool::current_num_threads);
    let mut film = Film::new(world, settings, threads);
    let ctx = Context {
        world,
        plan: settings.plan,
        sampler: Sampler::new(settings.seed),
        max_depth: settings.max_depth,
        russian_roulette: settings.russian_roulette,
        techniques: settings.techniques,
    };
    let per_sample = film.crop.pixels().max(1);
    let mut length = (FIRST_PASS / per_sample).clamp(1, QUEUE as u64 / u64::from(TILE * TILE)) as u32;
    while film.spp_done < settings.spp {
        let began = Instant::now();
        let samples = film.spp_done..film.spp_done.saturating_add(length).min(settings.spp);
        let mut pass = || film.expose(&ctx, accel, samples.clone());
        match &pool {
            Some(pool) => pool.install(pass),
            None => pass(),
        }
        film.spp_done = samples.end;
        let progress = Progress {
            spp_done: samples.end,
            spp: settings.spp,
            samples: film.crop.pixels() * u64::from(samples.end),
            seconds: start.elapsed().as_secs_f64(),
        };
        if after_pass(&Pass { film: &film, progress }).is_break() {
            break;
        }
        // At most twice as long as the one before, because the first may have been unusual.
        let rate = f64::from(samples.end - samples.start) / began.elapsed().as_secs_f64().max(1e-9);
        length = ((rate * PASS_SECONDS) as u32).clamp(1, length * 2).min(LONGEST_PASS);
    }
    film.develop(start.elapsed().as_secs_f64())
}

impl Crop {
    fn pixels(&self) -> u64 {
        u64::from(self.x1 - self.x0) * u64::from(self.y1 - self.y0)
    }
}

impl Film {
    fn new(world: &World, settings: &RenderSettings, threads: usize) -> Self {
        let film = world.film;
        let whole = Crop { x0: 0, x1: film.width, y0: 0, y1: film.height };
        let crop = settings.crop.map_or(whole, |c| Crop {
            x0: c.x0.min(c.x1).min(film.width),
            x1: c.x1.min(film.width),
            y0: c.y0.min(c.y1).min(film.height),
            y1: c.y1.min(film.height),
        });
        let depth_unit = settings.layers.then(|| DepthUnit::for_depths_up_to(world.farthest_depth()));
        Self { crop, tiles: tiles_of(crop, settings.layers), depth_unit, threads, spp_done: 0 }
    }

    /// Adds these samples to every pixel.
    fn expose(&mut self, ctx: &Context, accel: &dyn Accel, samples: Range<u32>) {
        let depth_unit = self.depth_unit;
        self.tiles.par_iter_mut().for_each_init(TileWorker::default, |worker, tile| {
            worker.render(ctx, accel, tile, depth_unit, samples.clone());
        });
    }

    /// The tiles put together.
    fn develop(&self, seconds: f64) -> Rendering {
        let mut stats = TileStats::default();
        self.tiles.iter().for_each(|tile| stats.add(&tile.stats));
        let pixels = self.gather(|tile| &tile.pixels);
        let layers = self.depth_unit.map(|unit| Layers::develop(&pixels, &self.gather(|tile| &tile.layers), unit));
        let dropped = pixels.iter().map(|p| u64::from(p.dropped())).sum();
        let (width, height) = (self.crop.x1 - self.crop.x0, self.crop.y1 - self.crop.y0);
        Rendering {
            picture: Picture { width, height, rgb: pixels.iter().map(Pixel::mean).collect() },
            layers,
            stats: stats.finish(seconds, self.spp_done, dropped, film::hash(pixels.iter()), self.threads),
        }
    }

    /// One value per pixel of the crop, rows from the top.
    fn gather<T: Copy + Default>(&self, of: impl Fn(&FilmTile) -> &[T]) -> Vec<T> {
        let width = (self.crop.x1 - self.crop.x0) as usize;
        let mut all = vec![T::default(); width * (self.crop.y1 - self.crop.y0) as usize];
        for tile in &self.tiles {
            for (row, line) in of(tile).chunks(tile.width as usize).enumerate() {
                let (x, y) = ((tile.x0 - self.crop.x0) as usize, (tile.y0 - self.crop.y0) as usize + row);
                all[y * width + x..][..line.len()].copy_from_slice(line);
            }
        }
        all
    }
}

/// The crop cut into tiles, row by row.
fn tiles_of(crop: Crop, layers: bool) -> Vec<FilmTile> {
    let mut tiles = Vec::new();
    for y0 in (crop.y0..crop.y1).step_by(TILE as usize) {
        for x0 in (crop.x0..crop.x1).step_by(TILE as usize) {
            let (width, height) = (TILE.min(crop.x1 - x0), TILE.min(crop.y1 - y0));
            let pixels = vec![Pixel::default(); (width * height) as usize];
            let layers = vec![LayerSums::default(); if layers { pixels.len() } else { 0 }];
            tiles.push(FilmTile { x0, y0, width, pixels, layers, stats: TileStats::default() });
        }
    }
    tiles
}

/// The queues of one thread, kept from tile to tile.
#[derive(Default)]
struct TileWorker {
    queue: Queue,
    next: Queue,
    shadow: ShadowQueue,
    order: Order,
    hits: Vec<Hit8>,
    blocked: Vec<Mask8>,
    pixel: Vec<u32>,
    sample: Vec<u32>,
    radiance: Vec<[f32; 3]>,
    /// The part of it that scattered at most once; empty unless layers are gathered, as is the next.
    direct: Vec<[f32; 3]>,
    first: Vec<FirstHit>,
}

impl TileWorker {
    fn render(
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
                let counts = tile.pixels[at].add(rgb, pixel, sample);
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

        for start in (0..self.pixel.len()).step_by(F32x8::LANES) {
            let lanes = (self.pixel.len() - start).min(F32x8::LANES);
            let path = U32x8::from_fn(|l| (start + l.min(lanes - 1)) as u32);
            let pixel = U32x8::from_fn(|l| self.pixel[path.lane(l) as usize]);
            let sample = U32x8::from_fn(|l| self.sample[path.lane(l) as usize]);
            let u = ctx.sampler.draw(pixel, sample, 0, Purpose::Camera);
            let x = (pixel & U32x8::splat(0xffff)).to_real() + u.unit(0);
            let y = (pixel >> 16).to_real() + u.unit(1);
            self.queue.push(
                Ray8 { mask: Mask8::first(lanes), ..ctx.world.view.rays(x, y) },
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
            let material_of = |instance, prim| ctx.world.material(instance, prim);
            self.order.sort(&self.queue.rays, &self.hits, materials.len(), material_of);
            stats.closest_rays += self.order.lanes.len() as u64;

            self.next.clear();
            self.shadow.clear();
            let mut gathered = Gathered(&mut self.radiance);
            let first: &mut [FirstHit] = if depth == 0 { &mut self.first } else { &mut [] };
            if ctx.plan.environment {
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
