//! Link budgets against closed forms.

use proptest::prelude::*;
use sextant_channel::{
    Channel, ChannelConfig, CorrelationConfig, Db, Dbm, Environment, LogDistanceConfig, Obstacle, ObstacleConfig,
    ObstacleField, PathLossConfig, Position, ReflectionsConfig, ShadowingConfig,
};
use sextant_kernel::{Seed, StationId};

use crate::solids::{at, cylinder, obstacle, upright_box};

fn channel(config: ChannelConfig, obstacles: Vec<Obstacle>) -> Channel {
    Channel::new(config.try_into().expect("a good channel"), ObstacleField::new(obstacles), Seed(3))
}

fn suburban() -> ChannelConfig {
    ChannelConfig::default()
}

#[test]
fn half_of_the_packets_arrive_over_the_median_range_of_the_thesis() {
    // 40 dB between -50 dBm at 1 m and the sensitivity of -90 dBm: 10^(40 / (10 ε)).
    for (environment, range_m) in [
        (Environment::Suburban, 30.302_711),
        (Environment::HeavyTrees, 7.405_685),
        (Environment::LightTrees, 12.915_497),
    ] {
        let channel = channel(ChannelConfig { environment: Some(environment), ..suburban() }, vec![]);
        let mean = channel.mean_power(Dbm(-50.0), at(1.0, 2.0, 0.0), at(1.0, 2.0 + range_m, 0.0)).unwrap();
        assert!((mean.0 + 90.0).abs() < 1e-3, "{mean:?}");
        let share = channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), range_m, Db(0.0));
        assert!((share - 0.5).abs() < 1e-4);
    }
}

#[test]
fn reception_is_the_upper_tail_of_a_normal_distribution() {
    let channel = channel(suburban(), vec![]);
    // Suburban at the radius of 10 m: margin 40 - 27 = 13 dB, 13 / 9.6 = 1.354 sigma.
    let share = channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), 10.0, Db(0.0));
    assert!((share - 0.912_17).abs() < 2e-4, "{share}");
    let margin_db = 40.0 - 27.0;
    for (sigmas, tail) in [(0.0, 0.5), (1.0, 0.158_655_253_9), (1.96, 0.024_997_895_1), (4.0, 3.167_124e-5)] {
        let loss = Db(margin_db + 9.6 * sigmas);
        let share = channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), 10.0, loss);
        assert!((share / tail - 1.0).abs() < 1e-6, "{share}, not {tail}");
    }
}

#[test]
fn a_metre_of_concrete_takes_twenty_decibels() {
    let config = |absorption_per_m, material: Option<&str>| ObstacleConfig {
        name: Some("wall".into()),
        material: material.map(Into::into),
        absorption_per_m,
        ..ObstacleConfig::absorbing(upright_box(at(5.0, 0.0, 0.0), [1.0, 9.0, 3.0], 0.0), 1.0)
    };
    let walls = [config(Some(4.6), None), config(None, Some("concrete"))];
    for wall in walls.map(|config| Obstacle::try_from(config).unwrap()) {
        let (from, to) = (at(0.0, 0.0, 0.0), at(10.0, 0.0, 0.0));
        let channel = channel(suburban(), vec![wall.clone(), obstacle(cylinder(at(8.0, 0.0, -1.0), 0.25, 2.0), 2.0)]);
        let loss = channel.obstacles().loss(from, to);
        let decibels_per_neper = 10.0 * std::f64::consts::E.log10();
        assert!((loss.0 - (4.6 + 2.0 * 0.5) * decibels_per_neper).abs() < 1e-9);
        let mean = channel.mean_power(Dbm(-50.0), from, to).unwrap();
        assert!((mean.0 - (-50.0 - 27.0 - loss.0)).abs() < 1e-12);
        assert_eq!(wall.name(), Some("wall"));
    }
    let clear = ChannelConfig { obstacles_attenuate: false, ..suburban() };
    let clear = channel(clear, vec![obstacle(upright_box(at(5.0, 0.0, 0.0), [1.0, 9.0, 3.0], 0.0), 4.6)]);
    assert!((clear.mean_power(Dbm(-50.0), at(0.0, 0.0, 0.0), at(10.0, 0.0, 0.0)).unwrap().0 + 77.0).abs() < 1e-12);
    assert_eq!(clear.obstacles().len(), 1);
}

#[test]
fn the_hard_radius_has_its_last_link_at_exactly_the_radius() {
    let channel = channel(ChannelConfig { max_range_m: Some(10.0), ..suburban() }, vec![]);
    let power = |d| channel.mean_power(Dbm(-50.0), at(0.0, 0.0, 0.0), at(d, 0.0, 0.0));
    assert!(power(10.0).is_some() && power(10.000_001).is_none());
    let share = |d| channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), d, Db(0.0));
    assert!(share(10.0) > 0.9 && share(10.000_001) <= 0.0);
    assert!((channel.law().reach_m(Dbm(-50.0), Dbm(-90.0)) - 10.0).abs() < 1e-12);
    let (a, b) = (StationId(1), StationId(2));
    assert_eq!(channel.received_power(Dbm(-50.0), a, at(0.0, 0.0, 0.0), b, at(11.0, 0.0, 0.0), 1), None);
}

#[test]
fn beyond_its_reach_a_link_succeeds_once_in_thirty_thousand() {
    let channel = channel(suburban(), vec![]);
    let reach_m = channel.law().reach_m(Dbm(-50.0), Dbm(-90.0));
    // 40 dB and four times 9.6 dB at 27 dB a decade.
    assert!((reach_m - 10_f64.powf(78.4 / 27.0)).abs() < 1e-9);
    let share = channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), reach_m, Db(0.0));
    assert!((share / 3.167_124e-5 - 1.0).abs() < 1e-6);
    assert!(channel.law().reach_m(Dbm(-200.0), Dbm(-90.0)) <= 0.0);
}

#[test]
fn each_written_key_overrides_the_environment() {
    let law =
        |exponent| Some(PathLossConfig::LogDistance(LogDistanceConfig { exponent, ..LogDistanceConfig::default() }));
    let sigma = |sigma_db| Some(ShadowingConfig { sigma_db, correlation: CorrelationConfig::PerLink });
    let bare = ChannelConfig { environment: None, ..suburban() };
    for (config, exponent, sigma_db) in [
        (suburban(), 2.7, 9.6),
        (ChannelConfig { path_loss: law(Some(2.0)), ..suburban() }, 2.0, 9.6),
        (ChannelConfig { path_loss: law(None), ..suburban() }, 2.7, 9.6),
        (ChannelConfig { shadowing: sigma(None), ..suburban() }, 2.7, 9.6),
        (ChannelConfig { shadowing: sigma(Some(0.0)), ..suburban() }, 2.7, 0.0),
        (ChannelConfig { path_loss: law(Some(3.0)), ..bare }, 3.0, 0.0),
        (ChannelConfig { path_loss: law(Some(3.0)), shadowing: sigma(Some(5.0)), ..bare }, 3.0, 5.0),
    ] {
        let channel = channel(config, vec![]);
        assert_eq!(
            (channel.law().path_loss().exponent(), channel.law().shadowing().sigma_db()),
            (exponent, sigma_db),
            "{config:?}"
        );
    }
}

#[test]
fn without_shadowing_reception_is_certain_or_impossible() {
    let quiet = ShadowingConfig { sigma_db: Some(0.0), ..ShadowingConfig::default() };
    let channel = channel(ChannelConfig { shadowing: Some(quiet), ..suburban() }, vec![]);
    let share = |d| channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), d, Db(0.0));
    assert_eq!((share(30.30), share(30.31)), (1.0, 0.0));
    let (a, b) = (StationId(1), StationId(2));
    let (from, to) = (at(0.0, 0.0, 0.0), at(3.0, 4.0, 0.0));
    assert_eq!(channel.received_power(Dbm(0.0), a, from, b, to, 9), channel.mean_power(Dbm(0.0), from, to));
}

fn anywhere() -> impl Strategy<Value = Position> {
    (-20.0..20.0_f64, -20.0..20.0_f64, -2.0..2.0_f64).prop_map(|(x, y, z)| at(x, y, z))
}

proptest! {
    #[test]
    fn a_link_is_the_same_both_ways_bit_for_bit(from in anywhere(), to in anywhere(), packet in any::<u64>(), mode in 0..3) {
        let correlation = match mode {
            0 => CorrelationConfig::PerPacket,
            1 => CorrelationConfig::PerLink,
            _ => CorrelationConfig::Spatial(sextant_channel::SpatialConfig { distance_m: 4.0 }),
        };
        let config = ChannelConfig { shadowing: Some(ShadowingConfig { sigma_db: None, correlation }), ..suburban() };
        let walls = (0..20).map(|i| obstacle(upright_box(at(f64::from(i) - 10.0, 0.0, 0.0), [0.4, 30.0, 2.0], 7.0 * f64::from(i)), 4.6));
        let channel = channel(config, walls.collect());
        let there = channel.received_power(Dbm(0.0), StationId(1), from, StationId(2), to, packet).unwrap();
        let back = channel.received_power(Dbm(0.0), StationId(2), to, StationId(1), from, packet).unwrap();
        prop_assert_eq!(there.0.to_bits(), back.0.to_bits());
        prop_assert!(there.0.is_finite());
    }

    #[test]
    fn power_and_reception_fall_with_distance_and_with_obstacles(d in 0.0..100.0_f64, more in 0.0..10.0_f64, loss in 0.0..50.0_f64) {
        let channel = channel(suburban(), vec![]);
        let power = |d| channel.mean_power(Dbm(0.0), at(0.0, 0.0, 0.0), at(d, 0.0, 0.0)).unwrap();
        prop_assert!(power(d + more) <= power(d));
        let share = |d, loss| channel.law().reception_probability(Dbm(-50.0), Dbm(-90.0), d, Db(loss));
        prop_assert!(share(d + more, 0.0) <= share(d, 0.0) && share(d, loss) <= share(d, 0.0));
        prop_assert!((0.0..=1.0).contains(&share(d, loss)));
    }
}

#[test]
fn the_items_of_a_budget_are_those_of_the_closed_form() {
    // 60 dB at 2 m, exponent 3, 10 dB/km; a wall of 1 m that takes 4.343 dB/m by α = 1 and 2 dB however thick it is.
    let config: ChannelConfig = toml::from_str(
        "max_range_m = 25.0\n[path_loss.log_distance]\nexponent = 3.0\nreference_distance_m = 2.0\nreference_loss_db = 60.0\ngas_db_per_km = 10.0",
    )
    .expect("a channel");
    let wall = ObstacleConfig {
        name: Some("wall".into()),
        loss_db: Some(2.0),
        ..ObstacleConfig::absorbing(upright_box(at(5.0, 0.0, 0.0), [1.0, 9.0, 3.0], 0.0), 1.0)
    };
    let channel = channel(config, vec![Obstacle::try_from(wall).unwrap()]);
    let budget = channel.budget(at(0.0, 0.0, 0.0), at(20.0, 0.0, 0.0)).unwrap();
    assert_eq!((budget.distance_m, budget.distance.reference), (20.0, Db(60.0)));
    assert!(
        (budget.distance.spreading.0 - 30.0).abs() < 1e-12 && (budget.distance.gas.unwrap().0 - 0.2).abs() < 1e-12
    );
    let [wall] = budget.obstacles[..] else { panic!("one obstacle is crossed") };
    assert!((wall.length_m - 1.0).abs() < 1e-12 && wall.obstacle == 0 && wall.fixed == Db(2.0));
    assert!((wall.absorption.0 - 10.0 * std::f64::consts::E.log10()).abs() < 1e-9);
    assert!((budget.mean_power(Dbm(0.0)).0 + 96.542_944_819).abs() < 1e-9);
    assert_eq!(channel.budget(at(0.0, 0.0, 0.0), at(25.1, 0.0, 0.0)), None);
}

proptest! {
    #[test]
    fn the_items_of_a_budget_sum_to_the_power_of_the_simulator(
        (ax, ay, bx, by) in (-9.0..9.0, -9.0..9.0, -9.0..9.0, -9.0..9.0),
        gas_db_per_km in prop_oneof![Just(0.0), 0.0..50.0],
        reflects in any::<bool>(),
    ) {
        let law = LogDistanceConfig { gas_db_per_km, ..LogDistanceConfig::default() };
        let reflections = ReflectionsConfig { loss_db: Some(7.0), ground_z_m: Some(-1.0), most: 3, ..ReflectionsConfig::default() };
        let config = ChannelConfig {
            path_loss: Some(PathLossConfig::LogDistance(law)),
            reflections: reflects.then_some(reflections),
            ..suburban()
        };
        let walls = [[-4.0, 1.0], [3.0, -2.0], [3.5, -2.2]];
        let walls = walls.map(|[x, y]| obstacle(upright_box(at(x, y, 0.0), [1.0, 6.0, 3.0], 30.0), 1.5));
        let channel = channel(config, walls.into());
        let (from, to) = (at(ax, ay, 0.0), at(bx, by, 0.5));
        let budget = channel.budget(from, to).unwrap();
        let mean = channel.mean_power(Dbm(-3.0), from, to).unwrap();
        prop_assert_eq!(budget.mean_power(Dbm(-3.0)).0.to_bits(), mean.0.to_bits());
        let obstacles: f64 = budget.obstacles.iter().map(|crossed| crossed.loss().0).sum();
        prop_assert!((obstacles - budget.obstacle_loss.0).abs() < 1e-9);
        let distance = budget.distance;
        let losses = distance.reference.0 + distance.spreading.0 + distance.gas.map_or(0.0, |gas| gas.0) + obstacles;
        prop_assert!((budget.direct_power(Dbm(-3.0)).0 - (-3.0 - losses)).abs() < 1e-9);
        prop_assert_eq!(budget.reflections.is_some(), reflects);
    }
}
