//! Maps of a log of 350 nodes and 350 stops, all pairs listed with 10 packets, on one thread. Links have static shadowing,
//! so the log chooses the link model.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{Auto, AutoConfig, LinkModel, LinkModelConfig, SelfCalibrated, SelfCalibratedConfig};

const COUNT: u32 = 350;
const PACKETS: u32 = 10;
const SEED: Seed = Seed(5);
const WORLD: Purpose = Purpose::new(9001);

/// Nodes and stops anywhere in a hall of 100 by 100 m, in the plane or with stops at 1 and 15 m of height.
fn log(is_spatial: bool) -> ReceptionLog {
    let place = |kind: u64, number: u32, heights: &[f64]| {
        let [x_m, y_m] = [0, 1].map(|axis| 100.0 * SEED.uniform(WORLD, [kind, number.into(), axis]));
        Position::new(x_m, y_m, heights[number as usize % heights.len()])
    };
    let heights: [&[f64]; 2] = if is_spatial { [&[0.0, 1.5, 3.0], &[1.0, 15.0]] } else { [&[0.0], &[0.0]] };
    let nodes: Vec<Position> = (0..COUNT).map(|number| place(0, number, heights[0])).collect();
    let stops: Vec<Position> = (0..COUNT).map(|number| place(1, number, heights[1])).collect();
    let mut receptions = Vec::new();
    for (node, place) in (0..).zip(&nodes) {
        let normal = |kind: u64, stop: u32| SEED.normal(WORLD, [kind, u64::from(node), stop.into()]);
        let offset = 0.4 * normal(2, 0);
        for (stop, other) in (0..).zip(&stops) {
            let margin = 3.2 - 2.0 * libm::log(place.distance_m(*other).max(0.3) / 10.0) + offset + normal(3, stop);
            let received = (0..PACKETS).filter(|packet| margin + normal(4 + u64::from(*packet), stop) > 0.0).count();
            receptions.push(Reception::heard(
                NodeId(node),
                stop,
                u32::try_from(received).expect("at most ten"),
                PACKETS,
            ));
        }
    }
    let stop = |position| Stop::at(position);
    let names = (0..COUNT).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, stops.into_iter().map(stop).collect(), receptions, Vec::new()).expect("a valid log")
}

fn real_links(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    let auto = Auto::try_from(AutoConfig::default()).expect("good settings");
    let links = LinkModel::try_from(LinkModelConfig::default()).expect("good settings");
    let calibrated = SelfCalibrated::try_from(SelfCalibratedConfig::default()).expect("good settings");
    for (place, is_spatial) in [("plane", false), ("space", true)] {
        let log = log(is_spatial);
        let mut group = criterion.benchmark_group(format!("real_links/{place}"));
        group.sample_size(10);
        group.bench_function("auto", |bencher| {
            bencher.iter(|| pool.install(|| black_box(auto.map(&log, None, &Unwatched)).is_ok()));
        });
        group.bench_function("link-model", |bencher| {
            bencher.iter(|| pool.install(|| black_box(links.map(&log, None, &Unwatched)).is_ok()));
        });
        group.bench_function("self-calibrated", |bencher| {
            bencher.iter(|| pool.install(|| black_box(calibrated.map(&log, &Unwatched)).is_ok()));
        });
        group.finish();
    }
}

criterion_group!(benches, real_links);
criterion_main!(benches);
