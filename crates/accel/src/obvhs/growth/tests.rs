//! Trees in parts and trees that instances share, looked at cell by cell.

use super::*;
use crate::obvhs::pages::Rows;
use crate::{Accel, Brute, Hit8, Mesh, Obvhs, Ray8, RayKind, TreeError};

/// Waves of n × n squares, of which a strip is one point, so that no plane can part it.
fn waves(n: u32) -> Geometry {
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let height = |x: u32, y: u32| ((x * 37 + y * 61) % 17) as f32 * 0.1;
    let position = |x: u32, y: u32| if y < 4 { [0.0; 3] } else { [x as f32, height(x, y), y as f32] };
    let positions = (0..=n).flat_map(|y| (0..=n).map(move |x| position(x, y))).collect();
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles = squares
        .flat_map(|(x, y)| [[at(x, y), at(x + 1, y), at(x + 1, y + 1)], [at(x, y), at(x + 1, y + 1), at(x, y + 1)]])
        .collect();
    Geometry::of_mesh(Mesh { positions, triangles }).unwrap()
}

const PRESETS: [ObvhsPreset; 3] = [ObvhsPreset::Fast, ObvhsPreset::Medium, ObvhsPreset::High];

fn by(preset: ObvhsPreset) -> ObvhsOptions {
    ObvhsOptions { preset, ..ObvhsOptions::default() }
}

fn bits(tree: &Tree) -> Vec<u32> {
    tree.cells.rows().iter().flatten().flat_map(|row| row.to_array().map(f32::to_bits)).collect()
}

#[test]
fn a_tree_in_parts_is_sound_and_finds_what_brute_finds() {
    let geometry = waves(24);
    let brute = Brute::new(&geometry);
    for (most, preset) in [1, 7, 100, 1000, PART].into_iter().flat_map(|most| PRESETS.map(|preset| (most, preset))) {
        let mut told = Vec::new();
        let tree = Tree::in_parts(&geometry, &by(preset), most, &mut |done| told.push(done));
        assert_eq!(told.last(), Some(&geometry.triangle_count()));
        assert!(told.len() >= geometry.triangle_count() / most);
        assert_eq!(tree.check(), Ok(()), "{preset:?} in parts of {most}");
        let tree = Obvhs::of_tree(tree);
        let mut met = 0;
        for i in 0..400 {
            let lane = |l: usize| (i * 8 + l) as f32;
            let origin = Vec3::from_lanes(|l| Vec3::new(lane(l) * 0.618 % 24.0, 5.0, lane(l) * 0.414 % 24.0));
            let dir = Vec3::from_lanes(|l| {
                Vec3::new(lane(l) * 0.732 % 2.0 - 1.0, -0.3, lane(l) * 0.236 % 2.0 - 1.0).normalize()
            });
            let rays = [Ray8::new(origin, dir)];
            let (mut a, mut b) = ([Hit8::miss()], [Hit8::miss()]);
            brute.closest(RayKind::Incoherent, &rays, &mut a);
            tree.closest(RayKind::Incoherent, &rays, &mut b);
            assert_eq!(format!("{a:?}"), format!("{b:?}"));
            met += a[0].t.to_array().iter().filter(|t| t.is_finite()).count();
        }
        assert!(met > 1000, "{met} of 3200 rays meet something");
    }
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    // Enough for several ranges that are worth a thread.
    let geometry = waves(160);
    for preset in PRESETS {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| bits(&Tree::build(&geometry, &by(preset), &mut |_| ())))
        };
        let alone = with(1);
        for threads in [2, 3, 8] {
            assert!(alone == with(threads), "{preset:?} with {threads} threads");
        }
    }
}

#[test]
fn a_broken_tree_is_noticed() {
    let geometry = waves(24);
    let sound = Tree::build(&geometry, &by(ObvhsPreset::Medium), &mut |_| ());
    assert_eq!(sound.check(), Ok(()));
    let broken = |change: &dyn Fn(&mut Rows)| {
        let mut tree = sound.clone();
        let root = tree.root.place();
        let mut rows = tree.cells.rows()[root];
        change(&mut rows);
        tree.cells.set(root, rows);
        tree.check().expect_err("the tree is broken")
    };
    let last = |rows: &Rows, row: usize| rows[row].to_array()[7].to_bits();
    let put = |rows: &mut Rows, row: usize, lane: usize, x: f32| rows[row].as_mut_array()[lane] = x;
    assert!(matches!(broken(&|rows| put(rows, 1, 7, rows[1].to_array()[7].next_down())), TreeError::Box { .. }));
    let first_again = |rows: &mut Rows| put(rows, 6, 7, f32::from_bits(rows[6].to_array()[6].to_bits()));
    assert!(matches!(broken(&first_again), TreeError::Box { .. } | TreeError::NotOnce { .. }));
    let nowhere = |rows: &mut Rows| put(rows, 6, 7, f32::from_bits(last(rows, 6) | 0x00ff_ffff));
    assert!(matches!(broken(&nowhere), TreeError::Box { .. }));
    assert!(matches!(broken(&|rows| put(rows, 7, 3, 0.0)), TreeError::Order { octant: 3, .. }));
    let unused = |rows: &mut Rows| put(rows, 0, 7, f32::INFINITY);
    assert!(matches!(broken(&unused), TreeError::NotOnce { times: 0, .. }));
    let mut shallow = sound.clone();
    shallow.depth = 1;
    assert!(matches!(shallow.check(), Err(TreeError::Stack { .. })));
    let mut other = sound.clone();
    other.order = waves(25).order().clone();
    assert!(matches!(other.check(), Err(TreeError::Triangle { times: 0, .. })));
}
