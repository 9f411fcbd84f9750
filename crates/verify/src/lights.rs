//! **scene-lights.** Point, spot and distant lights over a floor, against their closed forms.
//!
//! A camera looks straight down at a grey floor. Its radiance is a/π · E, with E = I cosθ/d² = I h/d³ below a point at height h,
//! the same times the falloff of the edge for a spot, and E = E⊥ cosθ for a distant light. What is expected of a pixel is the
//! mean of that over a grid of its points; what a picture differs by, in units of the largest expectation, is tested block by
//! block (see [`crate::blocks`]).

use crate::blocks::{Worst, tests, worst_block};
use crate::error::Error;
use crate::outcome::outcome;
use glam::{DAffine3, DVec3};
use gonio_accel::Intersect;
use gonio_kernel::Rgb;
use gonio_kernel::lobe::Lambert;
use gonio_lab::{Check, Effort, Options, sidak};
use gonio_tracer::light::{DistantLight, PointLight, SpotLight};
use gonio_tracer::scene::{CameraSpec, FilmSettings, LobeSpec, Material, Mesh, SceneBuilder};
use gonio_tracer::{Backend, Picture, Prepared, RenderSettings, World, render};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Instant;

/// Name and meaning of the instrument in this file.
pub(crate) const INSTRUMENTS: [(&str, &str); 1] = [(
    "scene-lights",
    "point, spot and distant lights give a floor the irradiance of their closed forms, block by block",
)];

/// Pixels along the edge of the picture.
const SIZE: u32 = 64;
/// Height of the camera, and the tangent of half its field of view: six metres of the floor are seen.
const HEIGHT: f64 = 10.0;
const TAN: f64 = 0.3;
/// What the floor reflects.
const ALBEDO: f64 = 0.5;
/// Points of a pixel along its edge at which the closed form is evaluated.
const GRID: u32 = 16;
/// A difference that is rounding, and that of the grid, relative to the largest radiance.
const SLACK: f64 = 2e-4;

const POINT: PointLight =
    PointLight { position: DVec3::new(0.7, 2.0, -0.4), intensity: Rgb { r: 4.0, g: 3.0, b: 2.0 } };
const SPOT: SpotLight = SpotLight {
    position: DVec3::new(-1.0, 2.5, 0.5),
    target: DVec3::new(0.5, 0.0, 0.0),
    intensity: Rgb { r: 9.0, g: 8.0, b: 7.0 },
    cutoff_angle: 40.0,
    beam_width: 20.0,
};
const DISTANT: DistantLight =
    DistantLight { direction: DVec3::new(0.3, -1.0, 0.2), irradiance: Rgb { r: 0.5, g: 0.6, b: 0.7 } };

/// Irradiance of the floor at a point, by channel.
type Irradiance = fn(DVec3) -> Rgb<f64>;
/// Adds lights to a scene.
type Lights = fn(&mut SceneBuilder) -> &mut SceneBuilder;

/// A floor under some lights.
struct Floor {
    name: &'static str,
    lights: Lights,
    irradiance: Irradiance,
    /// A closed form that is wrong on purpose, and must be noticed.
    fault: Option<(&'static str, Irradiance)>,
}

const FLOORS: [Floor; 4] = [
    Floor {
        name: "point",
        lights: |scene| scene.light(POINT),
        irradiance: of_point,
        fault: Some(("without the cosine of the floor", without_cosine)),
    },
    Floor {
        name: "spot",
        lights: |scene| scene.light(SPOT),
        irradiance: of_spot,
        fault: Some(("light beyond the edge", beyond_the_edge)),
    },
    Floor {
        name: "distant",
        lights: |scene| scene.light(DISTANT),
        irradiance: of_distant,
        fault: Some(("two percent more", two_percent_more)),
    },
    Floor {
        name: "all three",
        lights: |scene| scene.light(POINT).light(SPOT).light(DISTANT),
        irradiance: of_all,
        fault: None,
    },
];

fn of_point(p: DVec3) -> Rgb<f64> {
    let to = POINT.position - p;
    POINT.intensity.map(f64::from) * (to.y / to.length().powi(3))
}

fn of_spot(p: DVec3) -> Rgb<f64> {
    let away = p - SPOT.position;
    let angle = away.angle_between(SPOT.target - SPOT.position).to_degrees();
    let falloff = ((SPOT.cutoff_angle - angle) / (SPOT.cutoff_angle - SPOT.beam_width)).clamp(0.0, 1.0);
    SPOT.intensity.map(f64::from) * (falloff * -away.y / away.length().powi(3))
}

fn of_distant(_: DVec3) -> Rgb<f64> {
    DISTANT.irradiance.map(f64::from) * -DISTANT.direction.normalize().y
}

fn of_all(p: DVec3) -> Rgb<f64> {
    of_point(p) + of_spot(p) + of_distant(p)
}

/// Wrong on purpose: the cosine of the floor is forgotten.
fn without_cosine(p: DVec3) -> Rgb<f64> {
    POINT.intensity.map(f64::from) * (POINT.position - p).length_squared().recip()
}

/// Wrong on purpose.
fn two_percent_more(p: DVec3) -> Rgb<f64> {
    of_distant(p) * 1.02
}

/// Wrong on purpose: a hundredth of the intensity passes the edge.
fn beyond_the_edge(p: DVec3) -> Rgb<f64> {
    let angle = (p - SPOT.position).angle_between(SPOT.target - SPOT.position).to_degrees();
    if angle < SPOT.cutoff_angle { of_spot(p) } else { of_spot(p) + SPOT.intensity.map(f64::from) * 0.01 }
}

/// Renders the floors and hands their checks to `sink`.
///
/// # Errors
/// If the backend cannot be built.
pub(crate) fn run(options: &Options, sink: &mut dyn FnMut(Check)) -> Result<(), Error> {
    let level = sidak(options.significance, FLOORS.len() * tests(SIZE, SIZE));
    let mut send = |instrument: &str, subject: &str, passed, meaning: &str, worst: Worst, start: Instant| {
        if options.want(instrument, subject) {
            sink(Check {
                instrument: instrument.to_owned(),
                subject: subject.to_owned(),
                outcome: outcome(passed),
                measured: worst.p,
                limit: level,
                meaning: meaning.to_owned(),
                detail: worst.place,
                seconds: start.elapsed().as_secs_f64(),
            });
        }
    };
    for Floor { name, lights, irradiance, fault } in FLOORS {
        let fault = fault.map(|(fault, wrong)| (format!("scene-lights: {name}, {fault}"), wrong));
        let wants_fault = fault.as_ref().is_some_and(|(subject, _)| options.want("planted-faults", subject));
        if !wants_fault && !options.want("scene-lights", name) {
            continue;
        }
        let start = Instant::now();
        let picture = floor(options, lights)?;
        let worst = compare(&picture, irradiance);
        send("scene-lights", name, worst.p >= level, "p ≥", worst, start);
        if let Some((subject, wrong)) = fault {
            let start = Instant::now();
            let worst = compare(&picture, wrong);
            send("planted-faults", &subject, worst.p < level, "p of the fault <", worst, start);
        }
    }
    Ok(())
}

/// The picture of the floor under these lights.
fn floor(options: &Options, lights: Lights) -> Result<Picture, Error> {
    let spp = match options.effort {
        Effort::Quick => 64,
        Effort::Standard => 256,
        Effort::Full => 4096,
    };
    let mut scene = SceneBuilder::new();
    let grey = LobeSpec::new(Lambert::new(Rgb::splat(ALBEDO as f32)));
    let grey = scene.material(Material::new("grey", vec![grey]));
    let corners = [[-20.0, 0.0, -20.0], [-20.0, 0.0, 20.0], [20.0, 0.0, 20.0], [20.0, 0.0, -20.0]];
    let mesh = scene.mesh(Mesh::of("floor", corners, [[0, 1, 2], [0, 2, 3]], grey));
    lights(&mut scene).place(mesh, DAffine3::IDENTITY);
    scene.film(FilmSettings { width: SIZE, height: SIZE, spp, ..FilmSettings::default() });
    scene.camera(CameraSpec {
        origin: Some(DVec3::Y * HEIGHT),
        target: Some(DVec3::ZERO),
        up: Some(-DVec3::Z),
        vfov: Some(2.0 * TAN.atan().to_degrees()),
        ..CameraSpec::default()
    });
    let scene = scene.build()?;
    let prepared = Prepared::new(World::new(&scene)?, Backend::Obvhs, Intersect::Robust)?;
    let settings = RenderSettings { seed: options.seed, ..RenderSettings::of(&scene) };
    Ok(render(&prepared, &settings, &mut |_| ControlFlow::Continue(())).picture)
}

/// The block test of what a picture differs by from a/π · E.
fn compare(picture: &Picture, irradiance: Irradiance) -> Worst {
    let expected: Vec<[f64; 3]> = (0..SIZE * SIZE).map(|i| expected(i % SIZE, i / SIZE, irradiance)).collect();
    let largest = expected.iter().flatten().fold(0.0, |a: f64, &b| a.max(b));
    let mut difference = picture.clone();
    for (rgb, expected) in difference.rgb.iter_mut().zip(&expected) {
        *rgb = std::array::from_fn(|c| (1.0 + (f64::from(rgb[c]) - expected[c]) / largest) as f32);
    }
    worst_block(&difference, [1.0; 3], SLACK)
}

/// The mean of a/π · E over a pixel.
fn expected(x: u32, y: u32, irradiance: Irradiance) -> [f64; 3] {
    let place = |pixel: u32, i: u32| {
        let at = f64::from(pixel) + (f64::from(i) + 0.5) / f64::from(GRID);
        (2.0 * at / f64::from(SIZE) - 1.0) * TAN * HEIGHT
    };
    let points = (0..GRID * GRID).map(|i| DVec3::new(place(x, i % GRID), 0.0, place(y, i / GRID)));
    let sum = points.fold(Rgb::splat(0.0), |sum, p| sum + irradiance(p));
    (sum * (ALBEDO / PI / f64::from(GRID * GRID))).into()
}
