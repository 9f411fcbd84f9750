//! Rendering: passes of samples over the film.
//!
//! Tiles are independent and sums are integers, so threads, order and the length of passes change nothing. After each pass every
//! pixel has the same number of samples: the caller may look at the picture, and may stop.

use crate::effects::EffectSet;
use crate::film::{Crop, Film, Rendering};
use crate::integrator::{SAMPLES_PER_QUEUE, TileWorker};
use crate::light::Techniques;
use crate::prepared::Prepared;
use crate::sampler::Sampler;
use crate::scene::Scene;
use crate::shade::Context;
use std::ops::ControlFlow;
use std::time::Instant;

/// A pass should take about this long \[s\]: a render that is told to stop finishes its pass first.
const PASS_SECONDS: f64 = 2.0;
/// Most samples of the first pass, whose speed is not known yet; at a million per second two passes' time.
const FIRST_PASS: u64 = 1 << 22;
/// Most samples per pixel of a pass: eight full queues of a tile.
const LONGEST_PASS: u32 = 64;

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
    /// Whether to gather [`Layers`](crate::Layers) as well: about 170 bytes per pixel.
    pub layers: bool,
    /// Whether to look at every effect, needed or not: slower, and the same picture, which is the proof.
    pub every_effect: bool,
    /// Which ways of finding light take part; anything but both is for comparing them.
    pub techniques: Techniques,
}

impl RenderSettings {
    /// What the scene asks for, looking at what the scene calls for.
    pub fn of(scene: &Scene) -> Self {
        Self {
            spp: scene.film.spp,
            seed: scene.integrator.seed,
            max_depth: scene.integrator.max_depth,
            russian_roulette: scene.integrator.russian_roulette,
            threads: 0,
            crop: None,
            layers: false,
            every_effect: false,
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

/// Renders the world. `after_pass` is called on the calling thread after each pass of samples over the film; if it
/// breaks, the render ends with the samples it has ([`RenderStats::spp`](crate::RenderStats::spp)).
///
/// # Panics
/// Never for a world and settings in their domains; a thread pool that cannot be made falls back to the global one.
pub fn render(
    prepared: &Prepared,
    settings: &RenderSettings,
    after_pass: &mut dyn FnMut(&Pass) -> ControlFlow<()>,
) -> Rendering {
    let needed = prepared.world().effects().set();
    render_looking_at(if settings.every_effect { EffectSet::ALL } else { needed }, prepared, settings, after_pass)
}

fn render_looking_at(
    effects: EffectSet,
    prepared: &Prepared,
    settings: &RenderSettings,
    after_pass: &mut dyn FnMut(&Pass) -> ControlFlow<()>,
) -> Rendering {
    let start = Instant::now();
    let (world, accel) = (prepared.world(), prepared.accel());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads).build().ok();
    let threads = pool.as_ref().map_or_else(rayon::current_num_threads, rayon::ThreadPool::current_num_threads);
    let mut film = Film::new(world, settings.crop, settings.layers, threads);
    let ctx = Context {
        world,
        effects,
        sampler: Sampler::new(settings.seed),
        max_depth: settings.max_depth,
        russian_roulette: settings.russian_roulette,
        techniques: settings.techniques,
    };
    let per_sample = film.crop.pixels().max(1);
    let mut length = (FIRST_PASS / per_sample).clamp(1, u64::from(SAMPLES_PER_QUEUE)) as u32;
    while film.spp_done < settings.spp {
        let began = Instant::now();
        let samples = film.spp_done..film.spp_done.saturating_add(length).min(settings.spp);
        let mut pass = || {
            film.expose(|worker: &mut TileWorker, tile, unit| worker.render(&ctx, accel, tile, unit, samples.clone()));
        };
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

#[cfg(test)]
mod tests;
