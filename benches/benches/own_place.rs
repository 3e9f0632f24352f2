//! A node's own place from twelve anchors in space, on a grid of 0.25 m within 7 m of range.
//!
//! `wedge_argmax` is the likelihood of the thesis, `soft_mean` the posterior mean that knows how uncertain anchors are;
//! throughput is in nodes per second. `contradicted` has sectors that no place satisfies: the whole neighbourhood is
//! searched for the fewest broken conditions.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use sextant_channel::{Position, Wedge};
use sextant_kernel::{Purpose, Seed};
use sextant_mapper::{
    EstimateKind, HeardAnchor, HeardSector, OwnPlace, OwnPlaceConfig, PlaceModel, ProfileConfig, TrapezoidConfig,
};

const RANGE_M: f64 = 7.0;
const ANCHORS: u64 = 12;
const NODES: u64 = 50;

/// What each node heard: anchors within its range in a hall 3 m high, whose sectors are turned by errors of
/// `azimuth_sigma_rad`.
fn evidence(azimuth_sigma_rad: f64) -> Vec<Vec<HeardAnchor>> {
    let seed = Seed(5);
    let of_node = |node: u64| {
        let draw = |k: u64, axis: u64| seed.uniform(Purpose::new(1), [node, k, axis]);
        let truth = Position::new(0.0, 0.0, 3.0 * draw(0, 0));
        let anchors =
            (1..).map(|k| Position::new(14.0 * draw(k, 0) - 7.0, 14.0 * draw(k, 1) - 7.0, 3.0 * draw(k, 2)));
        let near = anchors
            .filter(|place| place.distance_m(truth) < 0.95 * RANGE_M)
            .take(usize::try_from(ANCHORS).expect("few anchors"));
        let variance = 0.3 * 0.3;
        let heard = |(k, place): (u64, Position)| {
            let width = TAU / 8.0;
            let off = (draw(k, 7) - 0.5) * width + azimuth_sigma_rad * seed.normal(Purpose::new(2), [node, k, 0]);
            let apart = truth - place;
            let middle = libm::atan2(apart.y_m, apart.x_m) + off;
            let wedge = Wedge {
                azimuth_from_rad: middle - 0.5 * width,
                azimuth_width_rad: width,
                elevation_rad: [-FRAC_PI_2, FRAC_PI_2],
            };
            let covariance = Some([[variance, 0.0, 0.0], [0.0, variance, 0.0], [0.0, 0.0, variance]]);
            HeardAnchor { place, sector: Some(HeardSector { wedge, azimuth_sigma_rad }), covariance, packets: 1 }
        };
        (0..).zip(near).map(heard).collect()
    };
    (0..NODES).map(of_node).collect()
}

fn own_place(criterion: &mut Criterion) {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.95, 2.0, RANGE_M));
    let config = OwnPlaceConfig { z_range_m: Some([0.0, 3.0]), ..OwnPlaceConfig::new(0.25, profile) };
    let soft = OwnPlaceConfig { model: PlaceModel::Soft, ..config.clone() };
    let mean = OwnPlaceConfig { estimate: EstimateKind::PosteriorMean, ..soft.clone() };
    let mut group = criterion.benchmark_group("own_place");
    group.throughput(Throughput::Elements(NODES)).sample_size(10);
    let cases = [
        ("wedge_argmax", config.clone(), 0.0),
        ("wedge_argmax_contradicted", config, 0.3),
        ("soft_argmax", soft, 0.3),
        ("soft_mean", mean, 0.3),
    ];
    for (name, config, sigma) in cases {
        let own_place = OwnPlace::try_from(config).expect("good settings");
        let nodes = evidence(sigma);
        let estimates: Vec<_> = nodes.iter().filter_map(|heard| own_place.estimate(heard, &[])).collect();
        let vertices: u64 = estimates.iter().map(|estimate| estimate.vertices).sum();
        let contradicted = estimates.iter().filter(|estimate| estimate.violations > 0).count();
        let octets = estimates.iter().map(|estimate| estimate.peak_octets).max();
        eprintln!(
            "{name}: {} nodes, {contradicted} contradicted, {vertices} vertices, {octets:?} octets",
            estimates.len()
        );
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let estimate = |heard: &Vec<HeardAnchor>| own_place.estimate(black_box(heard), &[]);
                nodes.iter().filter_map(estimate).map(|found| found.vertices).sum::<u64>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, own_place);
criterion_main!(benches);
