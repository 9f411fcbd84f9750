//! The furnace scenes themselves: their files, their answers, and how they are rendered.
//!
//! The files are written to the report's folder, where a scene that fails can be rendered again by hand.

use crate::error::Error;
use crate::shipped::{Files, shipped, unpack};
use gonio_accel::Intersect;
use gonio_kernel::{Lobe, Rgb};
use gonio_tracer::scene::{Scene, Sky};
use gonio_tracer::{Backend, Prepared, RenderSettings, Rendering, World, render};
use std::fmt;
use std::iter;
use std::ops::ControlFlow;
use std::path::Path;

/// A scene whose radiance is known.
pub(super) struct Furnace {
    /// Its file, without the extension.
    pub(super) name: &'static str,
    /// Pixels along each edge, as in the file.
    pub(super) size: u32,
    /// Whether its samples have any variance at all.
    pub(super) noisy: bool,
    law: Law,
    /// Name and text; the scene file comes first.
    files: Files,
}

/// Where the answer comes from.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// Inside of emitting walls: the finite geometric series.
    ClosedRoom,
    /// A convex object in front of the camera, under a uniform sky: the sky times the albedo.
    SkyTimesAlbedo,
}

/// All of them.
pub(super) const FURNACES: [Furnace; 6] = [
    Furnace {
        name: "furnace-box",
        size: 64,
        noisy: true,
        law: Law::ClosedRoom,
        files: &[shipped!("furnace-box.toml"), shipped!("furnace-box.obj")],
    },
    Furnace {
        name: "furnace-mix",
        size: 64,
        noisy: true,
        law: Law::ClosedRoom,
        files: &[shipped!("furnace-mix.toml"), shipped!("furnace-box.obj")],
    },
    Furnace {
        name: "furnace-white",
        size: 64,
        noisy: true,
        law: Law::SkyTimesAlbedo,
        files: &[shipped!("furnace-white.toml"), shipped!("furnace-object.obj")],
    },
    Furnace {
        name: "furnace-map",
        size: 64,
        noisy: true,
        law: Law::SkyTimesAlbedo,
        files: &[shipped!("furnace-map.toml"), shipped!("furnace-object.obj"), shipped!("furnace-map.hdr")],
    },
    Furnace {
        name: "furnace-mirror",
        size: 64,
        noisy: false,
        law: Law::SkyTimesAlbedo,
        files: &[shipped!("furnace-mirror.toml"), shipped!("furnace-object.obj")],
    },
    Furnace {
        name: "furnace-grey",
        size: 64,
        noisy: true,
        law: Law::SkyTimesAlbedo,
        files: &[shipped!("furnace-grey.toml"), shipped!("furnace-box.obj")],
    },
];

/// One way to render a scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    pub(super) backend: Backend,
    /// 0 for all.
    pub(super) threads: usize,
    /// Whether to look at every effect, needed or not.
    pub(super) every_effect: bool,
    pub(super) roulette: bool,
}

impl fmt::Display for Shot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let threads = match self.threads {
            0 => "all threads".to_owned(),
            1 => "1 thread".to_owned(),
            n => format!("{n} threads"),
        };
        let effects = if self.every_effect { "every effect" } else { "own effects" };
        let roulette = if self.roulette { "" } else { ", no roulette" };
        write!(f, "{}, {threads}, {effects}{roulette}", self.backend)
    }
}

impl Furnace {
    /// How the picture is rendered for the test: with every backend, obvhs first, and without Russian roulette if it takes part.
    pub(super) fn shots(&self) -> Vec<Shot> {
        let mut shots = Vec::new();
        let others = Backend::ALL.into_iter().filter(|backend| *backend != Backend::Obvhs);
        for backend in iter::once(Backend::Obvhs).chain(others) {
            let shot = Shot { backend, threads: 0, every_effect: false, roulette: true };
            shots.push(shot);
            if matches!(self.law, Law::ClosedRoom) {
                shots.push(Shot { roulette: false, ..shot });
            }
        }
        shots
    }

    /// Writes the files to a folder and reads the scene.
    pub(super) fn unpack(&self, folder: &Path) -> Result<Scene, Error> {
        unpack(self.files, folder)
    }

    /// Renders the scene.
    pub(super) fn render(&self, scene: &Scene, shot: &Shot, spp: u32, seed: u64) -> Result<Rendering, Error> {
        let prepared = Prepared::new(World::new(scene)?, shot.backend, Intersect::Robust)?;
        let mut settings = RenderSettings { spp, seed, threads: shot.threads, ..RenderSettings::of(scene) };
        settings.russian_roulette = shot.roulette;
        settings.every_effect = shot.every_effect;
        Ok(render(&prepared, &settings, &mut |_| ControlFlow::Continue(())))
    }

    /// The radiance of every pixel.
    pub(super) fn answer(&self, scene: &Scene) -> [f64; 3] {
        let material = &scene.materials[0];
        let mut albedo = [0.0; 3];
        for lobe in &material.lobes {
            // What the shipped furnaces are made of says of itself what it returns.
            let known = lobe.lobe.properties().albedo.unwrap_or(Rgb::splat(f32::NAN));
            for (sum, x) in albedo.iter_mut().zip(<[f32; 3]>::from(known * lobe.weight)) {
                *sum += f64::from(x);
            }
        }
        let light: [f32; 3] = match self.law {
            Law::ClosedRoom => material.emission.into(),
            Law::SkyTimesAlbedo => match &scene.environment.sky {
                Sky::Constant(radiance) => (*radiance).into(),
                Sky::Map(map) => map.picture.rgb[0].map(|x| x * map.intensity),
            },
        };
        std::array::from_fn(|c| {
            let (a, light) = (albedo[c], f64::from(light[c]));
            match self.law {
                Law::ClosedRoom => (0..=scene.integrator.max_depth).map(|k| light * a.powi(k as i32)).sum(),
                Law::SkyTimesAlbedo => light * a,
            }
        })
    }

    /// The relative difference that rounding can make, the same way in every sample: some sixteen operations per
    /// scattering event, each off by 2⁻²⁴.
    pub(super) fn slack(&self, scene: &Scene) -> f64 {
        16.0 * f64::from(scene.integrator.max_depth + 1) / 16_777_216.0
    }

    /// The answer in words.
    pub(super) fn law(&self) -> &'static str {
        match self.law {
            Law::ClosedRoom => "L·(1 − a^(d+1))/(1 − a)",
            Law::SkyTimesAlbedo => "sky · albedo",
        }
    }
}
