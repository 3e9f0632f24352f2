//! Whether grids fit the memory: what is said of stops beforehand is what happens with a log of these stops.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, EstimateKind, JointConfig, JointNetworkConfig, MapError, Mapper, MlTmConfig, ProfileConfig,
    RangingConfig, RssGridConfig, StitchConfig, Stitched, TopologyMap, TrapezoidConfig,
};

/// A log of one node that is heard at each stop. Every second stop is of another robot if there are two.
fn log(stops: &[Position], robots: u32) -> ReceptionLog {
    let entry = |stop| Reception { rssi_dbm: Some(-60.0), ..Reception::heard(NodeId(0), stop, 1, 1) };
    let stop = |(i, &position): (u32, &Position)| Stop { robot: RobotId(i % robots), ..Stop::at(position) };
    let receptions = (0..).zip(stops).map(|(stop, _)| entry(stop)).collect();
    let names = (0..robots).map(|robot| format!("r{robot}")).collect();
    let log = ReceptionLog::new(vec!["n0".into()], (0..).zip(stops).map(stop).collect(), receptions, Vec::new());
    log.and_then(|log| log.with_robots(names)).expect("a log")
}

fn bayesian(grid_step_m: Option<f64>) -> Mapper {
    let ranging = RangingConfig {
        exponent: Some(3.0),
        tx_power_dbm: Some(-40.0),
        sigma_db: Some(4.0),
        ..RangingConfig::default()
    };
    let config = RssGridConfig {
        grid_step_m,
        ranging,
        sensitivity_dbm: Some(-90.0),
        max_range_m: Some(40.0),
        estimate: EstimateKind::PosteriorMean,
        z_range_m: None,
    };
    Mapper::try_from(AlgorithmConfig::RssGrid(config)).expect("good settings")
}

fn mapped(mapper: &Mapper, log: &ReceptionLog) -> Result<TopologyMap, MapError> {
    let checked = mapper.check_grid(log.stops());
    let made = mapper.map_and_learn(log, &Unwatched).map(|(map, _)| map);
    assert_eq!(checked.clone().err(), made.clone().err(), "what was said beforehand");
    made
}

#[test]
fn a_bayesian_grid_with_a_set_step_is_refused_over_a_long_path_and_one_without_is_coarser() {
    let far = Position::new(9000.0, 9000.0, 0.0);
    let (short, long) = (log(&[Position::ORIGIN], 1), log(&[Position::ORIGIN, far], 1));
    let step_m = |map: TopologyMap| map.grid_step_m.expect("it has a grid");
    let usual_m = step_m(mapped(&bayesian(None), &short).expect("a small grid"));
    assert!((usual_m - 40.0 / 60.0).abs() < 1e-9, "{usual_m}");
    let coarse_m = step_m(mapped(&bayesian(None), &long).expect("a coarse grid"));
    assert!(coarse_m > usual_m && coarse_m < 2.0 * usual_m, "{coarse_m}");
    let refused = mapped(&bayesian(Some(usual_m)), &long).expect_err("its step is set");
    let MapError::GridTooLarge { suggested_step_m, .. } = refused else { panic!("another error: {refused}") };
    assert!(!refused.to_string().contains("max_memory_mb"), "{refused}");
    assert!(mapped(&bayesian(Some(suggested_step_m)), &long).is_ok());
}

#[test]
fn the_grid_of_a_joint_map_is_that_of_the_longest_range() {
    let member = |network: &str, range_m| JointNetworkConfig {
        network: network.into(),
        profile: ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, range_m)),
        counts: None,
        sectors: None,
    };
    let joint = |longest_m| JointConfig {
        networks: vec![member("a", 2.0), member("b", longest_m)],
        grid_step_m: 0.01,
        estimate: EstimateKind::Argmax,
        ties: Default::default(),
        z_range_m: None,
        max_memory_mb: Some(4),
    };
    let mapper = |longest_m| Mapper::try_from(AlgorithmConfig::Joint(joint(longest_m))).expect("good settings");
    let log = log(&[Position::ORIGIN], 1);
    // 401² and 801² vertices of 8 octets.
    assert_eq!(mapper(2.0).check_grid(log.stops()), Ok(()));
    assert!(matches!(mapper(4.0).check_grid(log.stops()), Err(MapError::GridTooLarge { .. })));
}

#[test]
fn the_grid_of_a_stitched_map_is_that_of_the_first_robot_until_the_frames_are_known() {
    let profile = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 1.0, 4.0));
    let config = MlTmConfig { max_memory_mb: Some(4), ..MlTmConfig::new(0.05, profile) };
    let alone = Mapper::try_from(AlgorithmConfig::MlTm(config)).expect("good settings");
    let log = log(&[Position::ORIGIN, Position::new(0.0, 0.0, 9.0)], 2);
    assert!(matches!(alone.check_grid(log.stops()), Err(MapError::GridTooLarge { .. })));
    let stitched = Stitched::mapper(alone, StitchConfig::default()).expect("it can be stitched");
    assert_eq!(stitched.check_grid(log.stops()), Ok(()));
}
