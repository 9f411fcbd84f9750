//! Criterion's rows: every scene, kind of ray and backend, robust.

use super::contenders::Builder;
use crate::scenes::Character;
use crate::scenes::rays::{self, Answers};
use criterion::{Criterion, Throughput};
use gonio_accel::Intersect;

/// Camera rays of a row.
const RAYS: usize = 1 << 16;

pub(crate) fn run() {
    let mut criterion = Criterion::default().sample_size(10).configure_from_args();
    for character in Character::ALL {
        let scene = character.full_scene();
        let built: Vec<_> = Builder::compared()
            .into_iter()
            .map(|builder| builder.build(&scene.geometry, Intersect::Robust).expect("generated scenes can be built"))
            .collect();
        for set in rays::sets(&scene, built[0].as_a_renderer_does(), RAYS) {
            let mut group = criterion.benchmark_group(format!("{}/{}", scene.name, set.name));
            group.throughput(Throughput::Elements(set.count as u64));
            let mut answers = Answers::of(&set);
            for contender in &built {
                group.bench_function(contender.builder.name(), |bencher| {
                    bencher.iter(|| answers.ask(contender.as_a_renderer_does(), set.kind, &set));
                });
            }
            group.finish();
        }
    }
    criterion.final_summary();
}
