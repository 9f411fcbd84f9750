//! `validate_kernel`: every instrument over the whole catalog.
//!
//! A run is a list of tasks, one row of the report each. The list is made first, so that the number of statistical tests
//! is known and they can share one significance. Then threads take tasks from it; each has its own random stream, addressed
//! by its name, and results are handed on in the order of the list, so neither threads nor order change anything.

use crate::catalog::{Row, rows, variants};
use crate::faults;
use crate::finding::{Finding, Run};
use crate::statistics::sidak;
use crate::task::{Options, Task};
use crate::under_test::{UnderTest, View};
use crate::{
    chi2, consistency, delta, elementary, frames, furnace, lanes, mitsuba, normal_map, normalisation, precision,
    reciprocity,
};
use crate::{layering, reference, totality, walk, warps, weight};
use gonio_kernel::lobe::Layering;
use gonio_kernel::model::Choice;
use gonio_kernel::{Properties, Surface};
use gonio_report::Check;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// The instruments: name, and what it proves in one sentence.
pub fn instruments() -> &'static [(&'static str, &'static str)] {
    &[
        ("furnace", "albedo by quadrature and by sampling agree"),
        ("energy", "no albedo exceeds 1, and white Lambert and mirror return exactly all light"),
        ("normalisation", "densities, probabilities of delta events and failures add up to 1"),
        ("chi2", "samples are distributed as the density says, delta events and failures included"),
        ("jacobian", "the density is the inverse of the sampler's stretching, point by point"),
        ("consistency", "what is sampled can be evaluated: unit, on its side, positive density, repeatable"),
        ("weight", "no sample weighs more than its lobe promises"),
        ("reciprocity", "light paths may be walked either way"),
        ("delta", "a mirror sends all its light where the law of reflection says, and nothing elsewhere"),
        ("precision", "f32 differs from f64 by no more than its inputs' rounding explains"),
        ("lanes", "each of eight lanes equals the scalar bit for bit"),
        ("totality", "finite and non-negative inside the domain without a guard, exactly zero outside with it"),
        ("reference", "the kernel agrees with an independent textbook implementation"),
        ("mitsuba", "the kernel agrees with values computed by Mitsuba 3"),
        (
            "walk",
            "what single scattering loses, and what is added for it, is what a random walk on the microsurface finds",
        ),
        (
            "layering",
            "a coat over a white base returns all light and no more, and over others no less than the random walk on the slab",
        ),
        ("frames", "local frames are orthonormal, right-handed and faithful to normal and tangent"),
        ("normal-map", "a tilted frame loses what it sends into the surface, and no more: its rows are the losses"),
        ("elementary", "elementary functions keep their stated error"),
        ("warps", "warps distribute points as their densities say"),
        ("planted-faults", "each instrument catches the faults that are planted for it"),
    ]
}

/// Runs every instrument over the catalog and hands each check to `sink`, in an order that never depends on timing.
pub fn validate_kernel(options: &Options, sink: &mut dyn FnMut(Check)) {
    let rows = rows();
    let under_test: Vec<UnderTest> = rows.iter().map(|row| UnderTest::of(&row.name, &row.surface)).collect();
    let warps = warps::under_test();
    let mut tasks = Vec::new();
    for (row, under_test) in rows.iter().zip(&under_test) {
        let asked = |task: &Task| !row.except.contains(&task.instrument);
        tasks.extend(tasks_of(under_test).into_iter().filter(asked));
    }
    tasks.extend(rows.iter().filter(|row| row.is_layered).map(|Row { name, surface, .. }| {
        Task::new("lanes", name.clone(), 0, move |run| lanes::measure(surface, true, run))
    }));
    tasks.extend(kernel_tasks());
    for warp in &warps {
        for view in warp.views() {
            let name = |what| format!("{} {}: {what}", warp.name, view.precision());
            tasks.push(Task::new("warps", name("χ²"), VIEWS, move |run| chi2::measure(view, run)));
            tasks.push(Task::new("warps", name("∫pdf"), VIEWS, move |run| normalisation::measure(view, run)));
            if !view.probe.single() {
                tasks
                    .push(Task::new("warps", name("jacobian"), 0, move |run| consistency::measure_jacobian(view, run)));
            }
        }
    }
    tasks.extend(faults::tasks());
    execute(tasks, options, sink);
}

/// Tests of the integral instruments: one p-value per view.
const VIEWS: usize = crate::directions::VIEWS.len();

/// What can be measured of any lobe, the user's included.
pub(crate) fn tasks_of<'a>(under_test: &'a UnderTest) -> Vec<Task<'a>> {
    let mut tasks = Vec::new();
    for view in under_test.views() {
        let name = format!("{} {}", under_test.name, view.precision());
        let mut add = |instrument, tests, measure: fn(View, &Run) -> Finding| {
            tasks.push(Task::new(instrument, name.clone(), tests, move |run| measure(view, run)));
        };
        // That a law is broken by design shows in the most precise form; a coarser one may hide it in its rounding.
        let shows_design = view.probe.single() == view.reference.single();
        let Properties { reciprocal, conserving, .. } = view.claims.properties;
        add("furnace", VIEWS, furnace::measure);
        if conserving || shows_design {
            add("energy", 0, furnace::measure_bound);
        }
        add("consistency", 0, consistency::measure);
        add("weight", 0, weight::measure);
        if view.claims.properties.all_delta {
            add("normalisation", VIEWS, normalisation::measure);
            if !view.claims.empty {
                add("delta", 0, delta::measure);
            }
            continue;
        }
        add("normalisation", VIEWS, normalisation::measure);
        add("chi2", VIEWS, chi2::measure);
        if reciprocal || shows_design {
            add("reciprocity", 0, reciprocity::measure);
        }
        if view.claims.properties.one_to_one && !view.probe.single() {
            add("jacobian", 0, consistency::measure_jacobian);
        }
        if view.probe.single() && !view.reference.single() {
            add("precision", 0, precision::measure);
        }
    }
    tasks
}

/// What is measured of every variant of the kernel's models, and of what they are built of.
fn kernel_tasks() -> Vec<Task<'static>> {
    let mut tasks = Vec::new();
    let all = variants();
    for (i, one) in all.iter().enumerate() {
        let (surface, other) = (one.surface(), &all[(i + 1) % all.len()]);
        if let Ok(mixture) = Surface::of(one.lobe).with(1.0, other.lobe) {
            let name = format!("{} with {}", one.name, other.name);
            tasks.push(Task::new("lanes", name, 0, move |run| lanes::measure(&mixture, false, run)));
        }
        let (inside, special) = (format!("{} inside its domain", one.name), format!("{} at special numbers", one.name));
        tasks.push(Task::new("totality", inside, 0, move |run| totality::measure_inside(&surface, run)));
        tasks.push(Task::new("totality", special, 0, move |run| totality::measure_special(&surface, run)));
        if reference::exists(one) {
            let one = one.clone();
            tasks.push(Task::new("reference", one.name.clone(), 0, move |run| {
                reference::measure(&one, reference::kernel, run)
            }));
        }
    }
    tasks.push(Task::new("lanes", "mathematics, warps, frames, Fresnel", 0, lanes::measure_parts));
    tasks.push(Task::new("reference", "Fresnel, roughness, photometry", 0, reference::measure_conventions));
    for model in &mitsuba::MODELS {
        tasks.push(Task::new("mitsuba", model.name, 0, |run| mitsuba::measure(model, mitsuba::kernel, run)));
    }
    tasks.push(Task::new("mitsuba", "Fresnel", 0, mitsuba::measure_fresnel));
    tasks.push(Task::new("walk", "GGX", walk::TESTS, |run| walk::measure(walk::KERNEL, run)));
    for layering in [Layering::Reciprocal, Layering::FurnacePreserving] {
        let name = format!("dielectric over Lambert, {}", layering.word());
        tasks
            .push(Task::new("layering", name, 0, move |run| layering::measure_energy(layering::kernel, layering, run)));
    }
    tasks.push(Task::new("layering", "beside the slab", layering::TESTS, |run| {
        layering::measure_slab(layering::kernel, run)
    }));
    tasks.push(Task::new("frames", "from normal and tangent", 0, |run| frames::measure(frames::kernel, run)));
    tasks.push(Task::new("frames", "tilted by a normal map", 0, |run| frames::measure_tilted(frames::tilted, run)));
    tasks.push(Task::new("frames", "turned to face the viewer", 0, |run| frames::measure_facing(frames::facing, run)));
    tasks.extend(normal_map::tasks());
    tasks.push(Task::new("elementary", "sin_cos_turns f32", 0, |run| {
        elementary::measure(elementary::single, true, run)
    }));
    tasks.push(Task::new("elementary", "sin_cos_turns f64", 0, |run| {
        elementary::measure(elementary::double, false, run)
    }));
    for function in &elementary::FUNCTIONS {
        let name = format!("{} f32", function.name);
        tasks.push(Task::new("elementary", name, 0, |run| {
            elementary::measure_function(function, elementary::stride(run))
        }));
    }
    tasks.push(Task::new("elementary", "pow f32", 0, |run| elementary::measure_pow(gonio_kernel::math::pow, run)));
    tasks.push(Task::new("warps", "uniform triangle f32", 1, |run| {
        warps::measure_triangle(warps::triangle_single, run)
    }));
    tasks
}

/// Runs the wanted tasks on all threads and hands on the checks in order.
pub(crate) fn execute(tasks: Vec<Task>, options: &Options, sink: &mut dyn FnMut(Check)) {
    let tasks: Vec<Task> = tasks.into_iter().filter(|task| task.wanted(options)).collect();
    let level = sidak(options.significance, tasks.iter().map(|task| task.tests).sum());
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(tasks.len().max(1));
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        let (send, receive) = mpsc::channel();
        for _ in 0..threads {
            let (send, next, tasks) = (send.clone(), &next, &tasks);
            scope.spawn(move || {
                while let Some((index, task)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|i| Some((i, tasks.get(i)?)))
                {
                    if send.send((index, task.run(options, level))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        let mut early: Vec<Option<Check>> = tasks.iter().map(|_| None).collect();
        let mut done = 0;
        for (index, check) in receive {
            early[index] = Some(check);
            while let Some(check) = early.get_mut(done).and_then(Option::take) {
                sink(check);
                done += 1;
            }
        }
    });
}
