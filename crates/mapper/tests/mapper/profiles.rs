//! Profiles of known channels, and profiles estimated from the log.

use sextant_channel::{ChannelConfig, ChannelLaw, Db, Dbm, Environment, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, ChannelProfileConfig, EstimateKind, Fit, FittedConfig, FittedMlTm, Mapper, MlTm, MlTmConfig,
    PositionError, ProfileConfig, ReceptionProfile, TopologyMap, TrapezoidConfig,
};

fn suburban() -> ChannelProfileConfig {
    ChannelProfileConfig {
        exponent: Some(2.7),
        sigma_db: Some(9.6),
        tx_power_dbm: Some(-50.0),
        sensitivity_dbm: Some(-90.0),
        max_range_m: Some(10.0),
        floor: 0.0,
        ceiling: 1.0,
        ..ChannelProfileConfig::default()
    }
}

fn profile(config: ChannelProfileConfig, grid_step_m: f64) -> ReceptionProfile {
    ReceptionProfile::for_grid(ProfileConfig::Channel(config), grid_step_m).expect("good settings")
}

#[test]
fn the_channel_profile_is_the_probability_of_the_channel() {
    let config =
        ChannelConfig { environment: Some(Environment::Suburban), max_range_m: Some(10.0), ..Default::default() };
    let channel = ChannelLaw::try_from(config).unwrap();
    let curve = profile(ChannelProfileConfig { cell_average: false, ..suburban() }, 0.25);
    assert!((curve.range_m() - 10.0).abs() < 1e-12);
    for i in 0..=110 {
        let d = 0.1 * f64::from(i) - 1e-9;
        let expected = channel.reception_probability(Dbm(-50.0), Dbm(-90.0), d.max(0.0), Db(0.0));
        let found = curve.probability(d.max(0.0));
        assert!((found - expected).abs() < 1e-5, "S({d}) is {found}, not {expected}");
    }
}

#[test]
fn delivery_and_packets_change_the_channel_profile_as_independent_trials_do() {
    let one = profile(ChannelProfileConfig { cell_average: false, ..suburban() }, 0.0);
    let many =
        ChannelProfileConfig { delivery: 0.8, packets_per_stop: Some(1.25), cell_average: false, ..suburban() };
    let many = profile(many, 0.0);
    for d in [0.5, 4.0, 9.0] {
        let q = 0.8 * one.probability(d);
        let expected = 0.75 * q + 0.25 * (1.0 - (1.0 - q) * (1.0 - q));
        assert!((many.probability(d) - expected).abs() < 1e-9);
    }
}

#[test]
fn the_mean_over_a_cell_is_that_of_a_fine_sum() {
    let sharp = profile(ChannelProfileConfig { cell_average: false, ..suburban() }, 0.0);
    let smooth = profile(suburban(), 0.5);
    assert!(smooth.range_m() > 10.43 && smooth.range_m() < 10.44);
    for d in [0.0, 5.0, 9.6, 9.9, 10.1, 10.3] {
        let (mut sum, mut count) = (0.0, 0.0);
        for direction in 0..24 {
            let angle = std::f64::consts::TAU * (f64::from(direction) + 0.37) / 24.0;
            for i in 0..40 {
                for j in 0..40 {
                    let along = |i: i32| 0.5 * ((f64::from(i) + 0.5) / 40.0 - 0.5);
                    sum += sharp.probability(f64::hypot(d * angle.cos() + along(i), d * angle.sin() + along(j)));
                    count += 1.0;
                }
            }
        }
        let found = smooth.probability(d);
        assert!((found - sum / count).abs() < 0.02, "S({d}) is {found}, not {}", sum / count);
    }
    assert!(smooth.probability(smooth.range_m()) <= 0.0);
}

#[test]
fn a_channel_profile_without_a_hard_radius_ends_where_nothing_arrives() {
    let endless = ChannelProfileConfig { max_range_m: None, exponent: Some(4.0), sigma_db: Some(4.0), ..suburban() };
    let curve = profile(endless, 0.25);
    // 40 dB and 3.09 standard deviations: 10 m · 10^(12.36 / 40).
    assert!((curve.range_m() - 20.37 - 0.2165).abs() < 0.05, "{}", curve.range_m());
}

#[test]
fn errors_of_a_channel_profile_name_the_key() {
    for (config, key) in [
        (ChannelProfileConfig::default(), "channel.tx_power_dbm"),
        (ChannelProfileConfig { exponent: None, ..suburban() }, "channel.exponent"),
        (ChannelProfileConfig { sigma_db: Some(-1.0), ..suburban() }, "channel.sigma_db"),
        (ChannelProfileConfig { delivery: 1.5, ..suburban() }, "channel.delivery"),
        (ChannelProfileConfig { packets_per_stop: Some(0.0), ..suburban() }, "channel.packets_per_stop"),
        (ChannelProfileConfig { max_range_m: Some(-1.0), ..suburban() }, "channel.max_range_m"),
        (ChannelProfileConfig { tx_power_dbm: Some(-300.0), ..suburban() }, "channel.tx_power_dbm"),
        (ChannelProfileConfig { floor: -1.0, ..suburban() }, "channel.floor"),
    ] {
        let error = ReceptionProfile::for_grid(ProfileConfig::Channel(config), 0.25).unwrap_err();
        assert_eq!(error.key, key);
    }
    let config = FittedConfig { max_rounds: 0, ..FittedConfig::default() };
    let error = FittedMlTm::new(ml_tm(0.25), config).unwrap_err();
    assert_eq!(error.key, "profile.fitted.max_rounds");
}

/// A simulated survey and the true places of its nodes.
struct Survey {
    log: ReceptionLog,
    truth: Vec<Position>,
}

fn uniform(seed: u64, address: [u64; 3]) -> f64 {
    Seed(seed).uniform(Purpose::new(8), address)
}

/// Lanes 2.5 m apart with a stop each metre over a square of 16 m, at the heights `heights_m` in turn, and `nodes` nodes
/// in a box of 12 m in its middle with heights up to `tall_m`; each stop hears `sent` packets of each node with the
/// probability `s` of their distance.
fn survey(seed: u64, nodes: u32, sent: u32, heights_m: &[f64], tall_m: f64, s: impl Fn(f64) -> f64) -> Survey {
    let mut stops = Vec::new();
    for lane in 0..7_u32 {
        for step in 0..17_u32 {
            let height_m = heights_m[lane as usize % heights_m.len()];
            stops.push(Position::new(f64::from(step) - 8.0, 2.5 * f64::from(lane) - 7.5, height_m));
        }
    }
    let truth: Vec<Position> = (0..u64::from(nodes))
        .map(|node| {
            let along = |axis| 12.0 * uniform(seed, [node, axis, 1]) - 6.0;
            Position::new(along(0), along(1), tall_m * uniform(seed, [node, 2, 1]))
        })
        .collect();
    let mut receptions = Vec::new();
    for (node, place) in (0..nodes).zip(&truth) {
        for (stop, at) in (0..).zip(&stops) {
            let p = s(place.distance_m(*at));
            let draw =
                |packet: u32| u32::from(uniform(seed, [u64::from(node), u64::from(stop), 2 + u64::from(packet)]) < p);
            let received = (0..sent).map(draw).sum();
            if received > 0 || sent > 1 {
                receptions.push(Reception::heard(NodeId(node), stop, received, sent));
            }
        }
    }
    let stops = stops.into_iter().map(Stop::at).collect();
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    Survey { log: ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log"), truth }
}

/// 0.9 at the node, 0.5 at 5 m, nothing from 6 m on.
fn known(d: f64) -> f64 {
    if d < 6.0 { 0.9 - 0.08 * d } else { 0.0 }
}

fn ml_tm(grid_step_m: f64) -> MlTmConfig {
    let profile = ProfileConfig::Fitted(FittedConfig::default());
    MlTmConfig { estimate: EstimateKind::PosteriorMean, ..MlTmConfig::new(grid_step_m, profile) }
}

/// The map under a fitted profile, the profile, and the mean error (m).
fn mapped(config: &MlTmConfig, survey: &Survey) -> (TopologyMap, Fit, f64) {
    let mapper = FittedMlTm::new(config.clone(), FittedConfig::default()).expect("good settings");
    let (map, fit) = mapper.map(&survey.log, &Unwatched).expect("a small grid");
    let error_m = PositionError::between(&survey.truth, &map.positions()).expect("nodes are mapped").mean;
    (map, fit.expect("nodes were heard"), error_m)
}

/// Root mean square difference between a fitted curve and the known one over the distances that matter.
fn curve_error(fit: &Fit) -> f64 {
    let squares = (2..28).map(|i| 0.2 * f64::from(i)).map(|d| (fit.curve.probability(d) - known(d)).powi(2));
    (squares.sum::<f64>() / 26.0).sqrt()
}

#[test]
fn a_known_curve_is_recovered_from_the_log_alone() {
    let survey = survey(1, 120, 1, &[0.0], 0.0, known);
    let (_, fit, fitted_m) = mapped(&ml_tm(0.25), &survey);
    assert!(fit.converged, "{} rounds", fit.rounds);
    assert!(curve_error(&fit) < 0.05, "{}: {fit:?}", curve_error(&fit));
    assert!((fit.curve.range_m() - 6.0).abs() < 0.6, "{}", fit.curve.range_m());
    assert_eq!((fit.dead_stops.len(), fit.outliers.len()), (0, 0));
    // The mapper does not know the curve, yet its map is nearly as good as with the known curve.
    let told = ProfileConfig::Trapezoid(TrapezoidConfig::new(0.9, 0.0, 11.25));
    let told =
        MlTm::try_from(MlTmConfig { profile: told, ..ml_tm(0.25) }).unwrap().map(&survey.log, &Unwatched).unwrap();
    let told_m = PositionError::between(&survey.truth, &told.positions()).unwrap().mean;
    assert!(fitted_m < told_m, "{fitted_m} m against {told_m} m without the cut");
}

#[test]
fn more_packets_a_stop_make_a_better_map() {
    let (one, five) = (survey(2, 60, 1, &[0.0], 0.0, known), survey(2, 60, 5, &[0.0], 0.0, known));
    let (one_m, five_m) = (mapped(&ml_tm(0.2), &one).2, mapped(&ml_tm(0.2), &five).2);
    assert!(five_m < 0.75 * one_m, "{five_m} m is not much less than {one_m} m");
}

#[test]
fn a_log_in_space_is_fitted_as_well() {
    let survey = survey(3, 50, 1, &[0.0, 3.0], 3.0, known);
    let (_, fit, error_m) = mapped(&MlTmConfig { z_range_m: Some([0.0, 3.0]), ..ml_tm(0.5) }, &survey);
    assert!(curve_error(&fit) < 0.08, "{}", curve_error(&fit));
    assert!(error_m < 0.9, "{error_m}");
}

/// The log with entries changed.
fn changed(
    log: &ReceptionLog,
    change: impl FnMut(Reception) -> Option<Reception>,
    more: &[(u32, u32)],
) -> ReceptionLog {
    let mut receptions: Vec<Reception> = log.receptions().iter().filter_map(change).collect();
    for &(node, stop) in more {
        receptions.push(Reception::heard(NodeId(node), stop, 1, 1));
    }
    ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions, Vec::new()).expect("a log")
}

#[test]
fn receptions_from_far_beyond_the_range_are_found_and_do_no_harm() {
    let mut survey = survey(4, 70, 1, &[0.0], 0.0, known);
    let (_, _, clean_m) = mapped(&ml_tm(0.25), &survey);
    // Each tenth node is heard once from 10 m or more away.
    let far = |node: u32| {
        let place = survey.truth[node as usize];
        let stop = survey.log.stops().iter().position(|stop| stop.position.distance_m(place) > 10.0);
        (node, u32::try_from(stop.expect("the survey is wide")).unwrap())
    };
    let strange: Vec<(u32, u32)> = (0..70).step_by(10).map(far).collect();
    survey.log = changed(&survey.log, Some, &strange);
    let (map, fit, error_m) = mapped(&ml_tm(0.25), &survey);
    let found: Vec<(u32, u32)> = fit.outliers.iter().map(|(node, stop)| (node.0, *stop)).collect();
    assert_eq!(found, strange);
    assert!(error_m < 1.1 * clean_m, "{error_m} m with outliers, {clean_m} m without");
    assert!(map.infeasible() <= 2, "{} nodes are infeasible", map.infeasible());
}

#[test]
fn dead_stops_are_found_and_left_out() {
    let mut survey = survey(5, 70, 1, &[0.0], 0.0, known);
    let (_, _, clean_m) = mapped(&ml_tm(0.25), &survey);
    let dead = [40, 41, 58, 77];
    survey.log = changed(&survey.log, |r| (!dead.contains(&r.stop)).then_some(r), &[]);
    let (_, fit, error_m) = mapped(&ml_tm(0.25), &survey);
    assert_eq!(fit.dead_stops, dead);
    let evidence = fit.evidence(&survey.log);
    assert_eq!(evidence.stops().len(), survey.log.stops().len() - 4);
    let place = |log: &ReceptionLog, r: Reception| (r.node, log.stops()[r.stop as usize].position);
    let before: Vec<_> = survey.log.receptions().iter().map(|r| place(&survey.log, r)).collect();
    let after: Vec<_> = evidence.receptions().iter().map(|r| place(&evidence, r)).collect();
    assert_eq!(before, after);
    assert!(error_m < 1.15 * clean_m, "{error_m} m with dead stops, {clean_m} m without");
}

#[test]
fn the_number_of_threads_does_not_change_the_fit() {
    let survey = survey(6, 40, 1, &[0.0], 0.0, known);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| mapped(&ml_tm(0.5), &survey))
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_log_with_little_evidence_does_not_fail() {
    let stop = |x_m: f64| Stop::at(Position::new(x_m, 0.0, 0.0));
    let heard = |node, stop| Reception::heard(NodeId(node), stop, 1, 1);
    let names = || vec!["a".to_owned(), "b".to_owned()];
    let mapper = Mapper::try_from(AlgorithmConfig::MlTm(ml_tm(0.5))).unwrap();
    for (stops, receptions, mapped) in [
        (vec![], vec![], 0),
        (vec![stop(0.0)], vec![], 0),
        (vec![stop(0.0)], vec![heard(0, 0)], 1),
        (vec![stop(0.0), stop(0.0), stop(0.0)], vec![heard(0, 0), heard(0, 2), heard(1, 1)], 2),
        (vec![stop(0.0), stop(40.0)], vec![heard(0, 0), heard(0, 1), heard(1, 0)], 2),
        (vec![stop(0.0), stop(4.0)], vec![Reception { received: 0, ..heard(0, 0) }], 0),
    ] {
        let log = ReceptionLog::new(names(), stops, receptions, Vec::new()).unwrap();
        let (map, _) = mapper.map_and_learn(&log, &Unwatched).unwrap();
        assert_eq!(map.mapped(), mapped, "{log:?}");
    }
}
