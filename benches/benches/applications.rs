//! Whole applications on the true places of 1400 or 2800 nodes, on one thread: searches of a target, and seekers of the
//! source of a field.

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant::run::run;
use sextant::scenario::Scenario;
use sextant_kernel::Unwatched;

fn applications(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("applications");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(10));
    for file in ["target/case-1", "target/case-2", "target/case-3", "seek/one-source"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/{file}.toml"));
        let scenario = Scenario::load(&path).expect("scenarios of the repository are good");
        group.throughput(Throughput::Elements(scenario.world().nodes.len() as u64));
        let run = || run(&scenario, &mut (), &Unwatched).expect("a scenario that was checked");
        group.bench_function(file, |bencher| bencher.iter(|| black_box(run())));
    }
    group.finish();
}

criterion_group!(benches, applications);
criterion_main!(benches);
