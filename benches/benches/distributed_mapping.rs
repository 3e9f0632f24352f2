//! Whole simulations of maps that are computed in the nodes: 871 and 881 nodes, 15 % anchors, on one thread.

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant::run::Simulator;
use sextant::scenario::Scenario;
use sextant_sim::Unobserved;

fn distributed_mapping(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("distributed_mapping");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(20));
    for name in ["ss-greenhouse", "ss-warehouse", "hs-greenhouse", "improved-greenhouse", "improved-warehouse"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/dmtm/{name}.toml"));
        let scenario = Scenario::load(&path).expect("scenarios of the repository are good");
        group.throughput(Throughput::Elements(scenario.world().nodes.len() as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let simulator = Simulator::new(&scenario).expect("a scenario that was checked");
                black_box(simulator.run(&mut Unobserved))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, distributed_mapping);
criterion_main!(benches);
