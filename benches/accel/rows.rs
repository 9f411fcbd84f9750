//! Criterion's rows: every scene, kind of ray and backend, robust.

use super::contenders::Builder;
use crate::scenes::{Character, rays};
use criterion::{Criterion, Throughput};
use gonio_accel::{Accel, Hit8, Intersect};
use gonio_kernel::Mask8;

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
            let mut hits = vec![Hit8::miss(); set.packets.len()];
            let mut blocked = vec![Mask8::first(0); set.packets.len()];
            for contender in &built {
                let accel: &dyn Accel = contender.as_a_renderer_does();
                group.bench_function(contender.builder.name(), |bencher| {
                    if set.any_hit {
                        bencher.iter(|| accel.occluded(set.kind, &set.packets, None, &mut blocked));
                    } else {
                        bencher.iter(|| accel.closest(set.kind, &set.packets, &mut hits));
                    }
                });
            }
            group.finish();
        }
    }
    criterion.final_summary();
}
