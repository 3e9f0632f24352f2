//! Events per second of whole simulations, without recording and mapping.

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant::scenario::Scenario;
use sextant_sim::{Simulation, Survey, Unobserved};

fn run(scenario: &Scenario) -> Survey {
    Simulation::new(scenario.setup()).expect("a scenario that was checked").run(&mut Unobserved)
}

fn simulation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    for name in ["smoke", "ml-tm/circular", "ml-tm/sparse", "ml-tm/concave"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/{name}.toml"));
        let scenario = Scenario::load(&path).expect("scenarios of the repository are good");
        group.throughput(Throughput::Elements(run(&scenario).events));
        group.bench_function(name, |bencher| bencher.iter(|| black_box(run(&scenario))));
    }
    group.finish();
}

criterion_group!(benches, simulation);
criterion_main!(benches);
