//! `gonio render`: a scene in, pictures and statistics out.

mod origin;
mod pictures;
mod progress;
mod stats;

use crate::output::{Output, Target, extension, probe, write_text};
use crate::scene::warn_of;
use crate::signals;
use crate::usage::{Usage, several, warn};
use anyhow::{Context, Result};
use gonio_accel::Intersect;
use gonio_tracer::scene::Scene;
use gonio_tracer::{Backend, Crop, Prepared, RenderSettings, World};
use origin::{Origin, Times};
use pictures::is_picture;
use std::cell::LazyCell;
use std::io::{self, IsTerminal};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Render a scene.
///
/// Reads a scene file (.toml) or an OBJ file alone (.obj), and writes linear OpenEXR (.exr) or 8-bit sRGB (.png). The
/// picture depends on the scene, the seed and the number of samples, never on the number of threads. An EXR file also has
/// the layers albedo, normal, depth, direct, indirect, variance and sampleCount. Warnings and progress go to standard error.
///
/// Ctrl-C or SIGTERM: the pass over the picture is finished, the picture written, and the exit code is 75; a second one
/// quits at once, with 130. SIGHUP: the picture so far is written, and the render goes on.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scene file (.toml) or OBJ file (.obj)
    scene: PathBuf,
    /// Picture to write, .exr or .png; may be repeated; - writes OpenEXR to standard output
    #[arg(short, long, value_name = "OUT", required = true, value_parser = picture)]
    output: Vec<Target>,
    /// Samples per pixel, instead of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    spp: Option<u32>,
    /// Seed of all random numbers, instead of the scene's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of threads; 0 for all
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Ray-casting backend
    #[arg(long, value_name = "NAME", default_value = "obvhs", value_parser = backend, help = backend_help())]
    backend: Backend,
    /// Test triangles faster; a ray aimed exactly at an edge between two may fall through
    #[arg(long)]
    fast_intersect: bool,
    /// Number of scattering events after which a path ends, instead of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1024))]
    max_depth: Option<u32>,
    /// Let every path run to its full length
    #[arg(long)]
    no_russian_roulette: bool,
    /// Size of the picture, instead of the scene's
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Render only the pixels X0 ≤ x < X1, Y0 ≤ y < Y1, counted from the top left; each is as in the whole picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = crop)]
    crop: Option<[u32; 4]>,
    /// Write the picture alone into EXR files, without layers
    #[arg(long)]
    no_layers: bool,
    /// How progress is shown on standard error
    #[arg(long, value_enum, value_name = "HOW", default_value_t = progress::Mode::Auto)]
    progress: progress::Mode,
    /// Write statistics as JSON; - for standard output
    #[arg(long, value_name = "STATS.json")]
    stats: Option<Target>,
    /// Print the statistics to standard output as JSON on one line
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.fast_intersect && args.backend == Backend::Brute {
        return Err(Usage("--fast-intersect: the backend brute is always robust".to_owned()).into());
    }
    check_outputs(args)?;
    let start = Instant::now();
    let mut report = progress::Report::new(args.progress);
    let mut scene = gonio_io::load_with(&args.scene, &mut |loading| report.loading(&loading))?;
    if let Some([width, height]) = args.size {
        (scene.film.width, scene.film.height) = (width, height);
    }
    check_crop(args, &scene)?;
    let world = World::take(&mut scene, &mut |loading| report.loading(&loading)).context("scene")?;
    report.finish();
    let load_seconds = start.elapsed().as_secs_f64();
    warn_of(&scene, &world);

    let start = Instant::now();
    let mut tell = |loading| report.loading(&loading);
    let prepared = Prepared::new_with(world, args.backend, intersect(args), &mut tell)?;
    let build_seconds = start.elapsed().as_secs_f64();

    let settings = settings(args, &scene);
    let times = Times { load_seconds, build_seconds };
    let origin = Origin {
        scene_file: &args.scene,
        scene: &scene,
        scene_hash: LazyCell::new(Box::new(|| prepared.world().fingerprint())),
        settings: &settings,
        effects: prepared.world().effects().set(),
        backend: args.backend,
        intersect: intersect(args),
        times,
    };
    signals::work_in_passes();
    let rendering = gonio_tracer::render(&prepared, &settings, &mut |pass| {
        report.pass(&pass.progress);
        let done = pass.progress.spp_done == pass.progress.spp;
        if signals::show() && !done {
            let files: Vec<Target> = args.output.iter().filter(|target| **target != Target::Stdout).cloned().collect();
            if let Err(error) = pictures::write(&files, &origin, &pass.develop()) {
                warn(&format!("{error:#}"));
            }
        }
        if signals::stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    report.finish();
    let samples = &rendering.stats;
    if samples.dropped_samples > 0 {
        let (dropped, all) = (samples.dropped_samples, samples.samples);
        warn(&format!("{dropped} of {all} samples were not finite or out of range and count as black"));
    }
    let stopped = samples.spp < settings.spp;
    if stopped {
        warn(&format!("stopped with {} of {} samples per pixel", samples.spp, settings.spp));
    }
    pictures::write_or_rescue(&args.output, &origin, &rendering)?;
    if args.stats.is_some() || args.json {
        let stats = stats::stats(&origin, &rendering);
        if let Some(target) = &args.stats {
            write_text(target, &format!("{stats:#}\n"))?;
        }
        if args.json {
            write_text(&Target::Stdout, &format!("{stats}\n"))?;
        }
    }
    Ok(if stopped { ExitCode::from(signals::STOPPED) } else { ExitCode::SUCCESS })
}

/// Finds out before the work starts whether its results can be kept.
fn check_outputs(args: &Args) -> Result<()> {
    let mut to_stdout = usize::from(args.json);
    for target in args.output.iter().chain(&args.stats) {
        match target {
            Target::Stdout => to_stdout += 1,
            Target::File(path) if is_picture(path) => probe(path)?,
            Target::File(_) => {} // the statistics: checked below
        }
    }
    if let Some(target @ Target::File(_)) = &args.stats {
        drop(Output::create(target)?);
    }
    if to_stdout > 1 {
        return Err(Usage("only one result can go to standard output".to_owned()).into());
    }
    if args.output.contains(&Target::Stdout) && io::stdout().is_terminal() {
        return Err(Usage("OpenEXR is not written to a terminal: redirect standard output".to_owned()).into());
    }
    Ok(())
}

fn check_crop(args: &Args, scene: &Scene) -> Result<()> {
    let (width, height) = (scene.film.width, scene.film.height);
    match args.crop {
        Some([x0, y0, x1, y1]) if x1 > width || y1 > height => {
            let text = format!("--crop {x0},{y0},{x1},{y1} does not fit the picture of {width} x {height} pixels");
            Err(Usage(text).into())
        }
        _ => Ok(()),
    }
}

fn intersect(args: &Args) -> Intersect {
    if args.fast_intersect { Intersect::Fast } else { Intersect::Robust }
}

fn settings(args: &Args, scene: &Scene) -> RenderSettings {
    let mut settings = RenderSettings::of(scene);
    settings.spp = args.spp.unwrap_or(settings.spp);
    settings.seed = args.seed.unwrap_or(settings.seed);
    settings.max_depth = args.max_depth.unwrap_or(settings.max_depth);
    settings.russian_roulette &= !args.no_russian_roulette;
    settings.threads = args.threads;
    let shows_layers = |target: &Target| !matches!(target, Target::File(path) if extension(path) == "png");
    settings.layers = !args.no_layers && args.output.iter().any(shows_layers);
    settings.crop = args.crop.map(|[x0, y0, x1, y1]| Crop { x0, x1, y0, y1 });
    settings
}

fn picture(text: &str) -> Result<Target, String> {
    match Target::named(text) {
        Target::File(path) if !is_picture(&path) => Err("pictures are written as .exr or .png".to_owned()),
        target => Ok(target),
    }
}

fn backend_names() -> String {
    Backend::ALL.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

fn backend_help() -> String {
    format!("Ray-casting backend: one of {}", backend_names())
}

fn backend(text: &str) -> Result<Backend, String> {
    text.parse()
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let size = several(text, 'x').filter(|size| size.iter().all(|n| (1..=65_536).contains(n)));
    size.ok_or_else(|| "a size is WIDTHxHEIGHT, each from 1 to 65536".to_owned())
}

fn crop(text: &str) -> Result<[u32; 4], String> {
    let crop = several(text, ',').filter(|&[x0, y0, x1, y1]| x0 < x1 && y0 < y1);
    crop.ok_or_else(|| "a crop is X0,Y0,X1,Y1 in pixels, with X0 < X1 and Y0 < Y1".to_owned())
}
