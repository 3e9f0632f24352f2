//! No place is known better than the grid on which it was found.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, EstimateKind, Mapper, MlTmConfig, ProfileConfig, RangingConfig, Region, RssGridConfig,
    TrapezoidConfig,
};

use crate::estimators::of_receptions;

/// The height at which stops are.
fn level(_: usize) -> f64 {
    0.0
}

/// A lattice of 9 by 9 stops, a metre apart, which heard a node so sharply that hardly any place is left: a thousand packets a
/// stop, of which the share 1 − d / 6 m arrives, with strengths that follow a law exactly.
fn sharp(height_m: fn(usize) -> f64) -> ReceptionLog {
    let node = Position::new(4.3, 3.6, 0.8 * height_m(1));
    let stops: Vec<Stop> =
        (0..81).map(|i: usize| Position::new((i % 9) as f64, (i / 9) as f64, height_m(i))).map(Stop::at).collect();
    let heard = |(number, stop): (u32, &Stop)| {
        let distance_m = stop.position.distance_m(node);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1000 packets")]
        let received = (1000.0 * (1.0 - distance_m / 6.0)).max(0.0) as u32;
        Reception {
            rssi_dbm: (received > 0).then(|| -50.0 - 25.0 * distance_m.max(0.1).log10()),
            ..Reception::heard(NodeId(0), number, received, 1000)
        }
    };
    let receptions = (0..).zip(&stops).map(heard).collect();
    ReceptionLog::new(vec!["n".to_owned()], stops, receptions, Vec::new()).expect("a log")
}

/// The variances along each axis of the node of `log`.
fn variances(config: AlgorithmConfig, log: &ReceptionLog) -> (Option<[f64; 3]>, Option<f64>) {
    let mapper = Mapper::try_from(config).expect("good settings");
    let (map, _) = mapper.map_and_learn(log, &Unwatched).expect("a map");
    let estimate = map.estimates[0].as_ref().expect("the node was heard");
    let regions = (estimate.covariance.is_some(), Region::of_95(estimate).is_some());
    assert_eq!(regions.0, regions.1, "{}: what has a covariance has a region", mapper.name());
    (estimate.covariance.map(|c| [0, 1, 2].map(|axis| c[axis][axis])), map.grid_step_m)
}

fn ml_tm(grid_step_m: f64) -> AlgorithmConfig {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig { floor: 1e-6, ..TrapezoidConfig::new(1.0, 0.0, 6.0) });
    AlgorithmConfig::MlTm(MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        ..MlTmConfig::new(grid_step_m, profile)
    })
}

fn rss_grid(grid_step_m: f64) -> AlgorithmConfig {
    AlgorithmConfig::RssGrid(RssGridConfig {
        grid_step_m: Some(grid_step_m),
        ranging: RangingConfig {
            exponent: Some(2.5),
            tx_power_dbm: Some(-50.0),
            sigma_db: Some(0.05),
            ..RangingConfig::default()
        },
        sensitivity_dbm: Some(-71.0),
        max_range_m: Some(6.0),
        estimate: EstimateKind::PosteriorMean,
        z_range_m: None,
    })
}

#[test]
fn a_node_that_one_vertex_explains_has_the_variance_of_its_cell() {
    let log = sharp(level);
    for grid_step_m in [0.25, 0.5] {
        for config in [ml_tm(grid_step_m), rss_grid(grid_step_m)] {
            let what = format!("{config:?}");
            let (variances, _) = variances(config, &log);
            let [x, y, z] = variances.expect("a covariance");
            let of_cell = grid_step_m * grid_step_m / 12.0;
            for variance in [x, y] {
                // Vertices beside the best one have next to no weight.
                assert!(variance >= of_cell && variance < 1.2 * of_cell, "{what}: {variance} m², {of_cell} m²");
            }
            assert!(z.abs() < 1e-12, "{what}: in a plane the height is given, {z} m²");
        }
    }
}

#[test]
fn in_space_the_height_is_in_a_cell_too() {
    let log = sharp(|i| if i.is_multiple_of(2) { 0.0 } else { 2.5 });
    let (variances, _) = variances(ml_tm(0.5), &log);
    for variance in variances.expect("a covariance") {
        assert!(variance >= 0.25 / 12.0, "{variance} m²");
    }
}

#[test]
fn no_estimator_claims_a_variance_below_that_of_its_grid() {
    for height_m in [level, |i: usize| if i.is_multiple_of(2) { 0.0 } else { 2.5 }] {
        let log = sharp(height_m);
        let is_level = log.stops().iter().all(|stop| stop.position.z_m.abs() < 1e-9);
        for any_log in of_receptions() {
            let text = format!("{} = {}", any_log.key(), any_log.settings);
            let config: AlgorithmConfig = toml::from_str(&text).expect("good settings");
            let (Some(variances), grid_step_m) = variances(config, &log) else { continue };
            let [x, y, z] = variances;
            // Grids that zoom in have finer cells in the end than the step they were asked for.
            let is_zoom = ["rss-grid"].contains(&any_log.name);
            let least = grid_step_m.filter(|_| !is_zoom).map_or(1e-9, |step_m| 0.25 * step_m * step_m / 12.0);
            assert!(x >= least && y >= least, "{}: {variances:?} m², at least {least} m²", any_log.name);
            assert!(is_level || z >= 1e-9, "{}: {variances:?} m²", any_log.name);
        }
    }
}
