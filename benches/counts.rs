//! Work of fixed size for `cargo xtask bench --gate`, which has callgrind count its instructions and compares them with
//! `benches/limits.toml`: counts repeat exactly, where times on a shared machine do not.
//!
//! ```text
//! counts --list       the names of all rows, GROUP/ROW
//! counts GROUP        does every row of the group once, in order, and prints their names
//! counts GROUP/ROW    does one
//! ```
//!
//! Where the instructions of a row are:
//!
//! ```text
//! valgrind --tool=callgrind '--toggle-collect=*counted_by_the_gate*' target/debug/deps/counts-HASH GROUP/ROW
//! callgrind_annotate callgrind.out.PID
//! ```
//!
//! Input is made from fixed seeds, everything runs in one thread, and nothing that the clock or the system decides takes part.

mod lobes;
#[allow(dead_code, reason = "only small scenes are counted")]
mod scenes;

use gonio_accel::{Intersect, Obvhs};
use gonio_kernel::lobe::*;
use gonio_kernel::{F32x8, Parameters, for_each_lobe};
use lobes::{Lanes, Scalars, beckmann_normal, ggx_normal};
use scenes::rays::{Answers, sets};
use scenes::{Character, Random, Scene, room};
use std::hint::black_box;
use std::process::ExitCode;

/// Its name, and what declares its rows, over one input for all of them.
type Group = (&'static str, fn(&mut Rows));

const GROUPS: [Group; 6] = [
    ("kernel", kernel),
    ("room", |rows| rays(rows, &room::scene())),
    ("atrium", |rows| rays(rows, &Character::Atrium.scene(TRIANGLES))),
    ("terrain", |rows| rays(rows, &Character::Terrain.scene(TRIANGLES))),
    ("hair", |rows| rays(rows, &Character::Hair.scene(TRIANGLES))),
    ("scans", |rows| rays(rows, &Character::Scans.scene(TRIANGLES))),
];
/// Triangles of a scene, about: callgrind takes four seconds for all of its rows, most of them for three trees.
const TRIANGLES: usize = 20_000;
/// Camera rays of a scene, about.
const RAYS: usize = 2048;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let wanted = match &arguments[..] {
        [list] if list == "--list" => None,
        [wanted] if !wanted.starts_with('-') => Some(wanted.as_str()),
        // `cargo bench` starts every benchmark, with `--bench`.
        _ => {
            println!("counts: rows for `cargo xtask bench --gate`: counts --list | GROUP | GROUP/ROW");
            return ExitCode::SUCCESS;
        }
    };
    // Everything in this thread: callgrind does not follow work into another.
    if let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global() {
        eprintln!("counts: no pool of one thread: {error}");
        return ExitCode::FAILURE;
    }
    let mut done = 0;
    for (group, rows) in GROUPS {
        if wanted.is_none_or(|wanted| wanted.split('/').next() == Some(group)) {
            let mut counter = Rows { group, wanted, done: 0 };
            rows(&mut counter);
            done += counter.done;
        }
    }
    if done == 0 {
        eprintln!("counts: no such row: {}", wanted.unwrap_or_default());
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// The rows of a group as they are declared: each is listed, done or left out.
struct Rows<'a> {
    group: &'a str,
    /// A group or a row; `None` if rows are only listed.
    wanted: Option<&'a str>,
    done: usize,
}

impl Rows<'_> {
    fn row(&mut self, name: &str, mut work: impl FnMut()) {
        let name = format!("{}/{name}", self.group);
        if self.wanted.is_some_and(|wanted| wanted != self.group && wanted != name) {
            return;
        }
        println!("{name}");
        self.done += 1;
        if self.wanted.is_some() {
            dumped_by_the_gate(&mut work);
        }
    }
}

/// When this function is left, callgrind writes down what it has counted, and begins anew. It knows this function and the next
/// by name, so no other function's name may contain theirs.
#[inline(never)]
fn dumped_by_the_gate(work: &mut dyn FnMut()) {
    counted_by_the_gate(work);
    black_box(()); // keeps the call from becoming a jump, with which this function would end too early
}

/// Callgrind counts from the entry to the exit of this function.
#[inline(never)]
fn counted_by_the_gate(work: &mut dyn FnMut()) {
    work();
    black_box(());
}

macro_rules! lobe_rows {
    ($($file:ident::$lobe:ident),* $(,)?) => {
        /// Value and density, value alone, and sampling of every lobe: 4096 directions.
        fn kernel(rows: &mut Rows) {
            let (one, eight) = (Scalars::new(), Lanes::new());
            $(
                let scalar = black_box(<$lobe<f32>>::typical().expect("typical values"));
                let lanes = black_box(scalar.to::<F32x8>());
                rows.row(concat!(stringify!($lobe), "/eval/f32"), || one.eval(&scalar));
                rows.row(concat!(stringify!($lobe), "/eval/F32x8"), || eight.eval(&lanes));
                rows.row(concat!(stringify!($lobe), "/value/f32"), || one.value(&scalar));
                rows.row(concat!(stringify!($lobe), "/value/F32x8"), || eight.value(&lanes));
                rows.row(concat!(stringify!($lobe), "/sample/f32"), || one.sample(&scalar));
                rows.row(concat!(stringify!($lobe), "/sample/F32x8"), || eight.sample(&lanes));
                rows.row(concat!(stringify!($lobe), "/closure-sample/f32"), || one.closure_sample(&scalar));
                rows.row(concat!(stringify!($lobe), "/closure-sample/F32x8"), || eight.closure_sample(&lanes));
            )*
            rows.row("visible-normal/beckmann/f32", || one.normals(beckmann_normal));
            rows.row("visible-normal/beckmann/F32x8", || eight.normals(beckmann_normal));
            rows.row("visible-normal/ggx/f32", || one.normals(ggx_normal));
            rows.row("visible-normal/ggx/F32x8", || eight.normals(ggx_normal));
        }
    };
}
for_each_lobe!(lobe_rows);

/// Building the tree (for the room, the list) of a scene, and casting rays of three kinds, by either test.
fn rays(rows: &mut Rows, scene: &Scene) {
    rows.row("build", || {
        black_box(Obvhs::new(&scene.geometry, Intersect::Robust));
    });
    let robust = Obvhs::new(&scene.geometry, Intersect::Robust);
    let fast = Obvhs::new(&scene.geometry, Intersect::Fast);
    let [primary, diffuse, _, shadow, _] = sets(scene, &robust, RAYS);
    for (test, accel) in [("robust", robust), ("fast", fast)] {
        for set in [&primary, &diffuse, &shadow] {
            let mut answers = Answers::of(set);
            rows.row(&format!("{}/{test}", set.name), || answers.ask(&accel, set.kind, set));
        }
    }
}
