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

fn scenario(name: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenarios/{name}.toml"));
    Scenario::load(&path).expect("scenarios of the repository are good")
}

/// The survey of `ml-tm/circular` in a disc with so many nodes, all of which are simulated for a few seconds.
fn large(nodes: u32) -> Scenario {
    let radius_m = 1.05 * (f64::from(nodes) / std::f64::consts::PI).sqrt();
    let settings = [
        ("world.nodes.lattice.count", nodes.to_string()),
        ("world.nodes.lattice.region.disc.radius_m", radius_m.to_string()),
        ("simulation.region", "\"all\"".to_owned()),
        ("duration_s", "20.0".to_owned()),
    ];
    (settings.into_iter())
        .fold(scenario("ml-tm/circular"), |large, (key, value)| large.with(key, value).expect("good settings"))
}

fn simulation(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("simulation");
    group.sample_size(10).warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    let names = [
        "smoke",
        "ml-tm/circular",
        "ml-tm/sparse",
        "ml-tm/concave",
        "mac/saturated-star",
        "mac/poisson-star",
        "mac/acknowledged-star",
        "tsch/saturated-cell",
        // Sector sweeps among 591 nodes.
        "mmtm/warehouse-vaa",
    ];
    let cases = names.map(|name| (name.to_owned(), scenario(name)));
    for (name, scenario) in cases.into_iter().chain([("16000 nodes".to_owned(), large(16_000))]) {
        group.throughput(Throughput::Elements(run(&scenario).events));
        group.bench_function(name, |bencher| bencher.iter(|| black_box(run(&scenario))));
    }
    group.finish();
}

criterion_group!(benches, simulation);
criterion_main!(benches);
