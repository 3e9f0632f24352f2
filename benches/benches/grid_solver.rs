//! The grid solver compared with the literal product, on surveys in the plane and in a ball.
//!
//! `solver` maps all nodes; its throughput is in nodes per second. It runs once with the range of the thesis (R =
//! R_c, at which some nodes have no feasible vertex), and once with a range that is half a cell diagonal larger.
//! `literal` multiplies Z over all stops at all vertices for one node. Both run on one thread.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant_benches::workload::{self, Workload};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{EstimateKind, MlTm, MlTmConfig, ProfileConfig, TrapezoidConfig};

fn ml_tm(workload: &Workload, range_m: f64, estimate: EstimateKind) -> MlTm {
    let profile = TrapezoidConfig::new(0.95, 0.2 * range_m, range_m);
    let config = MlTmConfig::new(workload.grid_step_m, ProfileConfig::Trapezoid(profile));
    MlTm::try_from(MlTmConfig { estimate, ..config }).expect("good settings")
}

fn compare(criterion: &mut Criterion, workload: &Workload) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    let log = &workload.log;
    let nodes = log.node_count() as u64;
    let exact = ml_tm(workload, workload.range_m, EstimateKind::Argmax);
    let lattice = exact.lattice(log).expect("a lattice");
    let wider_m = workload.range_m + lattice.half_diagonal_m();
    let cases = [
        ("solver", exact.clone()),
        ("solver_half_cell_wider", ml_tm(workload, wider_m, EstimateKind::Argmax)),
        ("posterior_mean_half_cell_wider", ml_tm(workload, wider_m, EstimateKind::PosteriorMean)),
    ];
    let mut group = criterion.benchmark_group(format!("grid_solver/{}", workload.name));
    group.sample_size(10);
    for (name, ml_tm) in &cases {
        let map = ml_tm.map(log, &Unwatched).expect("a map");
        eprintln!(
            "{}/{name}: {nodes} nodes, {} stops, {} receptions, {:?} vertices; infeasible {}, unmapped {}, scored {}",
            workload.name,
            log.stops().len(),
            log.receptions().len(),
            lattice.counts(),
            map.infeasible(),
            map.unmapped(),
            map.vertices_evaluated,
        );
        group.throughput(Throughput::Elements(nodes));
        group
            .bench_function(*name, |bencher| pool.install(|| bencher.iter(|| ml_tm.map(black_box(log), &Unwatched))));
    }
    group.throughput(Throughput::Elements(1));
    group.bench_function("literal_one_node", |bencher| {
        bencher.iter(|| workload::likeliest(&lattice, 0..lattice.len(), black_box(log), exact.profile(), NodeId(7)));
    });
    group.finish();
}

fn plane(criterion: &mut Criterion) {
    compare(criterion, &workload::plane());
}

fn ball(criterion: &mut Criterion) {
    compare(criterion, &workload::ball());
}

criterion_group!(benches, plane, ball);
criterion_main!(benches);
