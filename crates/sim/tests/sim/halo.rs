//! Simulations of what is near a listener, against simulations of all nodes.

mod counts;

use std::time::Duration;

use sextant_channel::{HeardAtStop, Position, Stop};
use sextant_kernel::SimTime;
use sextant_sim::{
    AllSimulated, DeathsConfig, FaultsConfig, NetworkId, Observer, OnceConfig, PeriodicConfig, PoissonConfig,
    Progress, RadioConfig, Reach, ReceptionModel, SaturatedConfig, Setup, SimulatedPart, SimulatedRegion, Simulation,
    Sink, Survey, Team, TrafficConfig, Unobserved,
};

use crate::network;

/// Radius of communication of all networks here (m).
const RANGE_M: f64 = 10.0;

const LISTENERS: SimulatedRegion = SimulatedRegion::Listeners { halo_m: None };

fn periodic() -> TrafficConfig {
    let config = PeriodicConfig::each(20, 0.5, 0.1);
    TrafficConfig::Periodic(config)
}

fn poisson() -> TrafficConfig {
    TrafficConfig::Poisson(PoissonConfig { mpdu_octets: 20, rate_per_s: 2.0, acknowledged: false, to: None })
}

/// `side` times `side` nodes one metre apart, from `corner` on.
fn field(side: usize, corner: [f64; 2]) -> Vec<Position> {
    network::grid(side, side).into_iter().map(|place| place + Position::new(corner[0], corner[1], 0.0)).collect()
}

/// Nodes at `places`, and a robot that listens at each of `stops`.
fn setup(places: &[Position], stops: Vec<Position>, traffic: TrafficConfig, seed: u64) -> Setup {
    let setup = network::setup(places, -50.0, network::suburb(RANGE_M), traffic, seed);
    let setup =
        network::with(setup, |network| network::receive_by(network, ReceptionModel::SinrThreshold { least: 2.0 }));
    Setup { robots: vec![network::tour(stops, 0.25, Duration::from_secs(1))], ..setup }
}

fn simulate(setup: Setup, region: SimulatedRegion) -> Survey {
    let simulation = Simulation::new(setup).expect("good settings").with_region(region).expect("a good region");
    simulation.run(&mut Unobserved)
}

/// Two fields of nodes, with 40 m between them: no signal passes from one to the other. The robot visits one, the other, and
/// the first one again.
fn two_fields(traffic: TrafficConfig, seed: u64) -> Setup {
    let places: Vec<Position> = field(7, [0.0, 0.0]).into_iter().chain(field(7, [46.0, 0.0])).collect();
    let stops = [2.0, 5.0, 48.0, 51.0, 3.0].map(|x_m| Position::new(x_m, 2.5, 0.0)).to_vec();
    setup(&places, stops, traffic, seed)
}

/// What robots heard, as text.
fn heard(survey: &Survey) -> String {
    format!("{:?} {:?} {:?}", survey.log().stops(), survey.log().receptions(), survey.end)
}

#[test]
fn where_no_chain_of_carrier_sense_crosses_the_halo_all_receptions_are_those_of_all_nodes() {
    let once = OnceConfig { mpdu_octets: 20, at_s: 51.5, acknowledged: false, to: None };
    let kinds = [periodic(), poisson(), TrafficConfig::Once(once)];
    for (seed, traffic) in (1..).zip(kinds) {
        let all = simulate(two_fields(traffic.clone(), seed), SimulatedRegion::All);
        let near = simulate(two_fields(traffic.clone(), seed), LISTENERS);
        assert_eq!(heard(&near), heard(&all), "{traffic:?}");
        assert!(all.log().receptions().iter().next().is_some(), "{traffic:?}");
        assert!(matches!(near.simulated, SimulatedPart::NearListeners { .. }), "{traffic:?}: {:?}", near.simulated);
        assert!(near.events < all.events, "{traffic:?}");
    }
}

#[test]
fn clocks_that_drift_change_nothing() {
    let setup = |seed| {
        let radio = RadioConfig { clock_ppm: 40.0, ..network::radio(-50.0) };
        network::with(two_fields(periodic(), seed), |network| {
            network::ieee802154(network).radio =
                network::radios(radio).with_reception(ReceptionModel::SinrThreshold { least: 2.0 });
        })
    };
    assert_eq!(heard(&simulate(setup(5), LISTENERS)), heard(&simulate(setup(5), SimulatedRegion::All)));
}

#[test]
fn a_dead_node_does_not_wake_and_its_packets_end_with_it() {
    let setup = || {
        let setup = two_fields(periodic(), 2);
        let deaths = DeathsConfig { share: None, names: Some(vec!["n60".into()]), from_s: 20.0, to_s: 20.0 };
        let config = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
        Setup { faults: config.build(&setup.world.nodes, setup.seed).expect("good faults"), ..setup }
    };
    let (all, near) = (simulate(setup(), SimulatedRegion::All), simulate(setup(), LISTENERS));
    assert_eq!(heard(&near), heard(&all));
    let (all, near) = (all.networks[0].packets[60], near.networks[0].packets[60]);
    assert_eq!(near.offered, all.offered);
}

#[test]
fn several_robots_have_halos_of_their_own() {
    let robots = |seed| {
        let first = two_fields(periodic(), seed);
        let mut second = network::tour(vec![Position::new(50.0, 1.0, 0.0)], 0.25, Duration::from_secs(5));
        second.body.name = "second".into();
        second.body.start = Position::new(50.0, 0.0, 0.0);
        Setup { robots: first.robots.into_iter().chain([second]).collect(), ..first }
    };
    assert_eq!(heard(&simulate(robots(8), LISTENERS)), heard(&simulate(robots(8), SimulatedRegion::All)));
}

#[test]
fn in_one_field_wider_than_the_halo_the_receptions_differ_by_less_than_their_spread() {
    // The robot drives along one side of a strip of 70 m; chains of carrier sense cross its halo.
    let places: Vec<Position> =
        (0..70 * 9).map(|i| Position::new(f64::from(i % 70), f64::from(i / 70), 0.0)).collect();
    let stops: Vec<Position> = (0..14).map(|i| Position::new(5.0 * f64::from(i), -1.0, 0.0)).collect();
    let count = |region, seed| {
        let survey = simulate(setup(&places, stops.clone(), periodic(), seed), region);
        let packets: u32 = survey.log().receptions().iter().map(|reception| reception.received).sum();
        (f64::from(packets), survey.packets.lost_collision as f64)
    };
    for seed in 0..4 {
        let (all, near) = (count(SimulatedRegion::All, seed), count(LISTENERS, seed));
        assert!((all.0 - near.0).abs() <= 2e-3 * all.0, "{all:?} {near:?}");
        assert!((all.1 - near.1).abs() <= 0.02 * all.1, "{all:?} {near:?}");
    }
}

#[test]
fn a_halo_smaller_than_the_reach_of_a_frame_is_rejected() {
    let simulation = || Simulation::new(two_fields(periodic(), 1)).expect("good settings");
    assert_eq!(
        two_fields(periodic(), 1).reach(),
        Reach { reception_m: RANGE_M, interference_m: RANGE_M, carrier_sense_m: RANGE_M }
    );
    let halo_m = |halo_m| SimulatedRegion::Listeners { halo_m: Some(halo_m) };
    for bad in [9.99, 0.0, -3.0, f64::NAN] {
        let error = simulation().with_region(halo_m(bad)).err().expect("a bad halo");
        assert_eq!((&*error.key, error.allowed().contains("at least 10.0")), ("halo_m", true), "{bad}: {error}");
    }
    assert!(simulation().with_region(halo_m(10.0)).is_ok());
}

#[test]
fn all_nodes_are_simulated_where_they_cannot_rest() {
    let why = |setup: Setup| match simulate(setup, LISTENERS).simulated {
        SimulatedPart::AllBecause(reason) => reason,
        other => panic!("{other:?}"),
    };
    let short = |setup: Setup| Setup { duration: Some(Duration::from_millis(50)), ..setup };
    let saturated = SaturatedConfig { mpdu_octets: 20, acknowledged: false, to: None, start_spread_s: 0.01 };
    assert_eq!(why(short(two_fields(TrafficConfig::Saturated(saturated), 1))), AllSimulated::Saturated);
    let nobody = Setup { robots: Vec::new(), ..short(two_fields(periodic(), 1)) };
    assert_eq!(why(nobody), AllSimulated::NoListener);
    let silent = TrafficConfig::Silent(sextant_sim::SilentConfig {});
    assert_eq!(why(short(two_fields(silent, 1))), AllSimulated::OnlyAnswers);
    let acknowledged = PeriodicConfig { acknowledged: true, ..PeriodicConfig::each(40, 0.3, 0.4) };
    let retried = short(two_fields(TrafficConfig::Periodic(acknowledged), 1));
    assert_eq!(why(retried), AllSimulated::Acknowledged);
    let sink = Sink { name: "sink".into(), position: Position::new(48.0, 3.0, 0.0), networks: None };
    assert_eq!(why(Setup { sinks: vec![sink], ..short(two_fields(periodic(), 1)) }), AllSimulated::Sinks);
    let small = setup(&field(4, [0.0, 0.0]), vec![Position::ORIGIN], periodic(), 1);
    assert_eq!(why(small), AllSimulated::AllWithin);
}

/// What an observer was told, as text.
#[derive(Default)]
struct Told(Vec<String>);

impl Observer for Told {
    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        self.0.push(format!("moved {robot} {time:?} {position:?}"));
    }

    fn stopped(&mut self, network: NetworkId, index: u32, stop: &Stop, end: SimTime, heard: HeardAtStop<'_>) {
        self.0.push(format!("stopped {network:?} {index} {stop:?} {end:?} {heard:?}"));
    }
}

/// Robots in fields that are `apart_m` apart, which start and stop at the same instants.
fn team(apart_m: f64, traffic: TrafficConfig, seed: u64) -> Setup {
    let corners = [0.0, 1.0, 2.0].map(|field| field * apart_m);
    let places: Vec<Position> = corners.iter().flat_map(|&x_m| field(8, [x_m, 0.0])).collect();
    let robots = corners.iter().enumerate().map(|(i, &x_m)| {
        // The last one is done first.
        let stops = (0..6 - i).map(|stop| Position::new(x_m + 1.0 + stop as f64, 2.0, 0.0)).collect();
        let mut robot = network::tour(stops, 0.25, Duration::from_secs(1));
        robot.body.name = format!("surveyor {i}");
        robot.body.start = Position::new(x_m, 0.0, 0.0);
        robot
    });
    Setup { robots: robots.collect(), ..setup(&places, Vec::new(), traffic, seed) }
}

#[test]
fn robots_that_never_meet_are_simulated_in_parallel_with_the_result_of_one_simulation() {
    // At 75 m nobody meets; at 40 m all do, so that they are simulated as one after all.
    for (apart_m, traffic) in [(75.0, periodic()), (75.0, poisson()), (40.0, periodic())] {
        let (mut one, mut parallel) = (Told::default(), Told::default());
        let simulation = Simulation::new(team(apart_m, traffic.clone(), 9)).expect("good settings");
        let simulation = simulation.with_region(LISTENERS).expect("a good region");
        let expected = simulation.run(&mut one);
        let setup = team(apart_m, traffic.clone(), 9);
        let team = Team::of(&setup, LISTENERS).expect("good settings").expect("robots that may be split");
        let found = team.run(&mut parallel);
        assert_eq!(parallel.0, one.0, "{apart_m} {traffic:?}");
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{apart_m} {traffic:?}");
        assert!(found.packets.not_simulated > 500, "{:?}", found.packets);
    }
}

#[test]
fn a_team_ends_when_its_observer_wants_to() {
    struct Impatient;
    impl Observer for Impatient {
        fn goes_on(&mut self, _progress: Progress) -> bool {
            false
        }
    }
    let mut setup = team(75.0, periodic(), 3);
    for robot in &mut setup.robots {
        robot.body.listen = Duration::from_secs(100_000);
    }
    let team = Team::of(&setup, LISTENERS).expect("good settings").expect("robots that may be split");
    assert!(team.run(&mut Impatient).interrupted);
}

#[test]
fn robots_are_simulated_as_one_where_something_acts_on_all() {
    let is_split = |setup: &Setup, region| Team::of(setup, region).expect("good settings").is_some();
    let setup = team(75.0, periodic(), 3);
    assert!(is_split(&setup, LISTENERS) && !is_split(&setup, SimulatedRegion::All));
    let sink = Sink { name: "sink".into(), position: Position::ORIGIN, networks: None };
    assert!(!is_split(&Setup { sinks: vec![sink], ..setup.clone() }, LISTENERS));
    let alone = Setup { robots: setup.robots[..1].to_vec(), ..setup };
    assert!(!is_split(&alone, LISTENERS));
}
