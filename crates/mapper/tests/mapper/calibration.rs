//! Whether the accuracy that the mapper states is correct.

use sextant_channel::{
    Channel, ChannelConfig, CorrelationConfig, Dbm, LogDistanceConfig, ObstacleField, PathLossConfig, Position,
    Reception, ReceptionLog, ShadowingConfig, Stop,
};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    ChannelProfileConfig, EstimateKind, MlTm, MlTmConfig, ProfileConfig, ReceptionProfile, Region, TrueModel,
    posterior_bound_m,
};

const NODES: u32 = 60;

/// The channel from which [`survey`] draws.
fn true_channel() -> Channel {
    let law = ChannelConfig {
        path_loss: Some(PathLossConfig::LogDistance(LogDistanceConfig {
            exponent: Some(3.6),
            ..LogDistanceConfig::default()
        })),
        shadowing: Some(ShadowingConfig { sigma_db: Some(8.2), correlation: CorrelationConfig::PerPacket }),
        max_range_m: Some(8.0),
        obstacles_attenuate: false,
        ..ChannelConfig::default()
    };
    Channel::new(law.try_into().expect("good settings"), ObstacleField::default(), Seed(1))
}

/// The true model of nodes up to `tall_m` high.
fn true_model<'a>(channel: &'a Channel, near: &'a [Position], tall_m: f64) -> TrueModel<'a> {
    let (tx, sensitivity) = (Dbm(-50.0), Dbm(-84.0));
    TrueModel { channel, tx, sensitivity, delivery: 1.0, packets_per_stop: 1.0, near, z_range_m: [0.0, tall_m] }
}

fn channel(cell_average: bool) -> ProfileConfig {
    ProfileConfig::Channel(ChannelProfileConfig {
        exponent: Some(3.6),
        sigma_db: Some(8.2),
        tx_power_dbm: Some(-50.0),
        sensitivity_dbm: Some(-84.0),
        max_range_m: Some(8.0),
        cell_average,
        ..ChannelProfileConfig::default()
    })
}

/// A survey of 10 m by 10 m with nodes up to `tall_m` high, every reception drawn from the exact channel.
fn survey(seed: u64, tall_m: f64) -> (ReceptionLog, Vec<Position>) {
    let exact = ReceptionProfile::for_grid(channel(false), 0.0).expect("good settings");
    let draw = |address| Seed(seed).uniform(Purpose::new(8), address);
    let mut stops = Vec::new();
    for lane in 0..6_u32 {
        for step in 0..15_u32 {
            let height_m = if lane % 2 == 0 { 0.0 } else { tall_m };
            let position = Position::new(f64::from(step) - 7.0, 2.5 * f64::from(lane) - 6.25, height_m);
            stops.push(Stop::at(position));
        }
    }
    let truth: Vec<Position> = (0..u64::from(NODES))
        .map(|node| {
            let along = |axis| 10.0 * draw([node, axis, 1]) - 5.0;
            Position::new(along(0), along(1), tall_m * draw([node, 2, 1]))
        })
        .collect();
    let mut receptions = Vec::new();
    for (node, place) in (0..NODES).zip(&truth) {
        for (stop, at) in (0..).zip(&stops) {
            if draw([u64::from(node), u64::from(stop), 2]) < exact.probability(place.distance_m(at.position)) {
                receptions.push(Reception::heard(NodeId(node), stop, 1, 1));
            }
        }
    }
    let names = (0..NODES).map(|node| format!("n{node}")).collect();
    (ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log"), truth)
}

/// Share of the nodes in their 95 % regions, and the mean error (m), over `seeds` surveys.
fn coverage(seeds: u64, tall_m: f64, grid_step_m: f64) -> (f64, f64) {
    let z_range_m = (tall_m > 0.0).then_some([0.0, tall_m]);
    let config = MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        z_range_m,
        ..MlTmConfig::new(grid_step_m, channel(true))
    };
    let mapper = MlTm::try_from(config).expect("good settings");
    let (mut inside, mut count, mut error_m) = (0.0, 0.0, 0.0);
    for seed in 0..seeds {
        let (log, truth) = survey(seed, tall_m);
        let map = mapper.map(&log, &Unwatched).expect("a small grid");
        for (estimate, truth) in map.estimates.iter().zip(truth) {
            let estimate = estimate.as_ref().expect("every node is heard");
            let region = Region::of_95(estimate).expect("a posterior mean has a covariance");
            inside += f64::from(u8::from(region.contains(truth)));
            error_m += estimate.position.distance_m(truth);
            count += 1.0;
        }
    }
    (inside / count, error_m / count)
}

// 40 surveys of 60 nodes (12 in space): the share of nodes in their regions has a standard deviation of 0.0045 (0.008), so
// that a coverage of 0.95 leaves 0.92 .. 0.98 for less than one set of seeds in ten thousand (a thousand).
#[test]
fn the_region_holds_95_percent_of_the_nodes_of_a_plane() {
    for grid_step_m in [0.25, 0.1] {
        let (coverage, _) = coverage(40, 0.0, grid_step_m);
        assert!((coverage - 0.95).abs() < 0.03, "{coverage} at a step of {grid_step_m} m");
    }
}

#[test]
fn the_region_holds_95_percent_of_the_nodes_in_space() {
    let (coverage, _) = coverage(12, 4.0, 0.4);
    assert!((coverage - 0.95).abs() < 0.03, "{coverage}");
}

#[test]
fn the_posterior_bound_is_the_error_of_the_posterior_mean_under_the_true_model() {
    let channel = true_channel();
    for (tall_m, grid_step_m, seeds) in [(0.0, 0.1, 20), (4.0, 0.4, 4)] {
        let mut bound_m = 0.0;
        for seed in 0..seeds {
            let (log, near) = survey(seed, tall_m);
            let model = true_model(&channel, &near, tall_m);
            bound_m += posterior_bound_m(&log, &model, &Unwatched).unwrap().expect("nodes were heard");
        }
        let bound_m = bound_m / seeds as f64;
        let (_, error_m) = coverage(seeds, tall_m, grid_step_m);
        // 1200 (240) nodes, each with a relative spread of the error of about one half: 1.5 % (3.3 %) standard deviation.
        assert!(
            (bound_m / error_m - 1.0).abs() < 0.1,
            "bound {bound_m} m, error {error_m} m, heights up to {tall_m} m"
        );
    }
}

#[test]
fn the_bound_is_the_same_for_any_number_of_threads_and_absent_without_receptions() {
    let (log, near) = survey(0, 0.0);
    let channel = true_channel();
    let bound_m = |log: &ReceptionLog| posterior_bound_m(log, &true_model(&channel, &near, 0.0), &Unwatched).unwrap();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| bound_m(&log).expect("nodes were heard").to_bits())
    };
    assert_eq!(with(1), with(3));
    let silent = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), Vec::new(), Vec::new()).unwrap();
    assert_eq!(bound_m(&silent), None);
}
