//! Frames that are lost, nodes that die, anchors that lie.

use std::time::Duration;

use sextant_channel::{Anchor, Position};
use sextant_kernel::{NodeId, Seed, SimTime};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Application, AtEnd, Death, DeathsConfig, Delivery, Destination, Faults, FaultsConfig, LyingAnchorsConfig,
    Network, NetworkId, Payload, Port, Sensed, Sensors, SensorsConfig, Setup, TargetConfig, TargetMotionConfig,
    TargetSensorConfig, Timer, WaypointsConfig, World,
};

use crate::broadcasts;
use crate::network::{self, Ended};

/// Sends a frame to all each `interval`, or answers each frame, or only listens.
#[derive(Default)]
struct Station {
    interval: Option<Duration>,
    answers: bool,
    has_task: bool,
    frames_left: u32,
    octets: usize,
    heard: Vec<SimTime>,
    sensed: Vec<SimTime>,
}

impl Station {
    fn sender(frames: u32, interval: Duration, octets: usize) -> Self {
        Self { interval: Some(interval), frames_left: frames, octets, ..Self::default() }
    }

    fn send(&mut self, port: &mut Port<'_>) {
        let payload = vec![7; self.octets];
        port.send(NetworkId(0), Destination::All, Payload::Octets(&payload)).expect("a free link");
    }
}

impl Application for Station {
    fn hears(&self) -> bool {
        true
    }

    fn senses(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        self.has_task
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if self.interval.is_some() {
            port.after(Duration::ZERO, Timer(0));
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        if let Some(left) = self.frames_left.checked_sub(1) {
            self.frames_left = left;
            self.send(port);
            port.after(self.interval.expect("only senders have timers"), Timer(0));
        }
    }

    fn delivered(&mut self, _delivery: &Delivery<'_>, port: &mut Port<'_>) {
        self.heard.push(port.now());
        if self.answers {
            self.send(port);
        }
    }

    fn sensed(&mut self, _sensed: &Sensed, port: &mut Port<'_>) {
        self.sensed.push(port.now());
    }
}

fn nodes(count: usize) -> Vec<PlacedNode> {
    network::nodes(&network::cluster(count))
}

fn names(names: &[&str]) -> Option<Vec<String>> {
    Some(names.iter().map(|&name| name.to_owned()).collect())
}

/// Node `n1` dies at `at_s`.
fn death_of_n1(at_s: f64) -> FaultsConfig {
    let deaths = DeathsConfig { share: None, names: names(&["n1"]), from_s: at_s, to_s: at_s };
    FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() }
}

fn run(faults: &FaultsConfig, duration_s: Option<f64>, stations: Vec<Station>) -> Ended<Station> {
    let csma = CsmaConfig { queue_frames: 1, ..network::prompt() };
    run_in(network::link(10.0, csma), faults, duration_s, stations)
}

fn run_in(link: Network, faults: &FaultsConfig, duration_s: Option<f64>, stations: Vec<Station>) -> Ended<Station> {
    let nodes = nodes(stations.len());
    let faults = faults.build(&nodes, Seed(3)).expect("good faults");
    let duration = duration_s.map(Duration::from_secs_f64);
    let setup = Setup { faults, duration, ..network::engine(&network::cluster(nodes.len()), link, 3) };
    network::run(setup, stations)
}

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

#[test]
fn each_receiver_loses_its_own_share_of_the_frames() {
    const FRAMES: u32 = 4000;
    let heard = |message_loss| {
        let faults = FaultsConfig { message_loss, ..FaultsConfig::default() };
        let stations = vec![Station::sender(FRAMES, ms(10), 5), Station::default(), Station::default()];
        let ended = run(&faults, None, stations);
        let packets = ended.networks[0].packets[0];
        assert_eq!((packets.offered, packets.received + packets.lost_signal), (FRAMES.into(), FRAMES.into()));
        let [_, one, other] = &ended.applications[..] else { panic!("three stations") };
        let both = one.heard.iter().filter(|time| other.heard.contains(time)).count();
        [one.heard.len(), other.heard.len(), both, usize::try_from(packets.received).unwrap()]
    };
    let all = usize::try_from(FRAMES).unwrap();
    assert_eq!(heard(0.0), [all; 4]);
    assert_eq!(heard(1.0), [0; 4]);
    // Binomial shares of 0.5, 0.5, 0.25 (independent) and 0.75 (at least one); five standard errors each.
    for (found, share) in heard(0.5).into_iter().zip([0.5, 0.5, 0.25, 0.75]) {
        let n = f64::from(FRAMES);
        let error = (found as f64 - share * n).abs();
        assert!(error < 5.0 * (n * share * (1.0 - share)).sqrt(), "{found} of {FRAMES}, not {share}");
    }
}

#[test]
fn a_node_answers_until_it_dies_and_then_draws_nothing() {
    let stations = || {
        let answers = Station { answers: true, octets: 4, ..Station::default() };
        vec![Station::sender(20, ms(100), 5), answers]
    };
    let alive = run(&FaultsConfig::default(), Some(4.0), stations());
    assert_eq!((alive.applications[0].heard.len(), alive.deaths.len()), (20, 0));
    let ended = run(&death_of_n1(1.05), Some(4.0), stations());
    let at = SimTime::ZERO + ms(1050);
    assert_eq!(ended.deaths, [Death { node: NodeId(1), time: at }]);
    // Frames at 0, 0.1, .. 1.0 s are answered.
    let [asks, answers] = &ended.applications[..] else { panic!("two stations") };
    assert_eq!((asks.heard.len(), answers.heard.len()), (11, 11));
    assert!(asks.heard.iter().all(|&time| time < at));
    // CC2420: 3 V, 18.8 mA to receive; 17.4 mA to send 11 answers of 4 + 11 + 6 octets at 4 us a
    // symbol and 2 symbols an octet, 16 us each.
    let spent = ended.networks[0].energy[1];
    let sending_s = 11.0 * 21.0 * 32e-6;
    assert!((spent.tx_j - 3.0 * 17.4e-3 * sending_s).abs() < 1e-12, "{spent:?}");
    assert!((spent.rx_j - 3.0 * 18.8e-3 * (1.05 - sending_s)).abs() < 1e-9, "{spent:?}");
    assert!((spent.idle_j + spent.sleep_j).abs() < 1e-12, "{spent:?}");
}

#[test]
fn a_frame_on_air_ends_and_the_one_behind_it_is_never_sent() {
    // After 128 us of carrier sense and 192 us of turnaround, a frame of 11 + 100 + 6 octets takes 3.744 ms.
    let sends_two = || {
        let mut stations = vec![Station::default(), Station::sender(2, ms(1), 100), Station::default()];
        stations[1].frames_left = 2;
        stations
    };
    let on_air_until = Duration::from_micros(128 + 192 + 117 * 32);
    for (at_s, heard) in [(0.000_3, 0), (0.002, 1), (0.004, 1)] {
        let ended = run(&death_of_n1(at_s), Some(1.0), sends_two());
        let expected = vec![SimTime::ZERO + on_air_until; heard];
        assert_eq!(ended.applications[0].heard, expected, "dead at {at_s} s");
        assert_eq!(ended.applications[2].heard, expected);
        let packets = ended.networks[0].packets[1];
        assert_eq!((packets.received, packets.offered), (heard as u64, packets.received + packets.died));
        let sent_s = if heard > 0 { 117.0 * 32e-6 } else { 0.0 };
        let spent = ended.networks[0].energy[1];
        assert!((spent.tx_j - 3.0 * 17.4e-3 * sent_s).abs() < 1e-12, "{spent:?}");
    }
}

/// Six broadcasts a millisecond from eight sectors each take longer than a millisecond.
#[test]
fn broadcasts_that_wait_in_a_node_when_it_dies_end_with_it() {
    let stations = vec![Station::default(), Station::sender(60, Duration::from_micros(150), 100)];
    let ended = run_in(broadcasts::link(broadcasts::EIGHT), &death_of_n1(0.005), Some(1.0), stations);
    let packets = ended.networks[0].packets[1];
    assert!(packets.received > 0 && packets.died > 5 && packets.pending == 0, "{packets:?}");
    assert_eq!(packets.offered, packets.received + packets.not_listened + packets.lost_collision + packets.died);
    assert_eq!(packets.transmissions, packets.sent);
}

#[test]
fn a_node_that_dies_within_a_frame_does_not_receive_it() {
    let stations = || vec![Station::sender(1, ms(1), 100), Station::default(), Station::default()];
    let ended = run(&death_of_n1(0.003), None, stations());
    let heard: Vec<usize> = ended.applications.iter().map(|station| station.heard.len()).collect();
    assert_eq!(heard, [0, 0, 1]);
}

#[test]
fn the_task_of_a_dead_node_is_done_and_its_timers_do_not_hold_up_the_end() {
    let stations = || {
        let worker = Station { has_task: true, ..Station::sender(1000, ms(50), 5) };
        vec![Station::default(), worker]
    };
    assert_eq!(run(&death_of_n1(2.5), None, stations()).end, SimTime::ZERO + ms(2500));
    // Without tasks, the engine ends when nothing is left to happen: that is the death, and no timer after it.
    let idle = || vec![Station::default(), Station::sender(1, Duration::from_secs(9), 5)];
    assert_eq!(run(&FaultsConfig::default(), None, idle()).end, SimTime::ZERO + Duration::from_secs(9));
    assert_eq!(run(&death_of_n1(2.5), None, idle()).end, SimTime::ZERO + ms(2500));
}

#[test]
fn the_sensors_of_a_dead_node_are_silent() {
    // The target passes both nodes at 5 s, and is within 1 m of each for 2 s.
    let places_m = vec![Position::new(-4.0, 0.0, 0.0), Position::new(9.0, 0.0, 0.0)];
    let motion = WaypointsConfig { places_m, speed_m_per_s: 1.0, at_end: AtEnd::Stay };
    let target = TargetConfig { name: "t".into(), motion: TargetMotionConfig::Waypoints(motion), screen: None };
    let sensors = SensorsConfig { targets: Some(TargetSensorConfig::perfect(1.0)), fields: None };
    let nodes = nodes(2);
    let world = World {
        targets: vec![target.build(0, &sextant_channel::ObstacleField::default(), Seed(1)).expect("a good target")],
        sensors: Sensors::try_from(sensors).expect("good sensors"),
        nodes: nodes.clone(),
        ..World::default()
    };
    let setup = Setup {
        world,
        faults: death_of_n1(5.0).build(&nodes, Seed(1)).expect("good faults"),
        duration: Some(Duration::from_secs(10)),
        ..network::engine(&network::cluster(2), network::link(10.0, network::prompt()), 1)
    };
    let ended = network::run(setup, vec![Station::default(), Station::default()]);
    let sensed: Vec<usize> = ended.applications.iter().map(|station| station.sensed.len()).collect();
    assert_eq!(sensed, [2, 1]);
}

#[test]
fn a_share_of_the_nodes_dies_within_the_interval_by_the_seed() {
    let deaths = |share, count, seed| -> Vec<Death> {
        let deaths = DeathsConfig { share: Some(share), names: None, from_s: 10.0, to_s: 20.0 };
        let config = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
        config.build(&nodes(count), Seed(seed)).expect("good faults").deaths().to_vec()
    };
    let some = deaths(0.3, 41, 5);
    assert_eq!(some.len(), 13);
    assert!(some.iter().all(|death| (10.0..=20.0).contains(&death.time.as_secs_f64())));
    assert!(some.windows(2).all(|pair| pair[0].node < pair[1].node));
    assert_eq!(deaths(0.3, 41, 5), some);
    assert_ne!(deaths(0.3, 41, 6), some);
    assert!(some.iter().all(|death| deaths(0.9, 41, 5).contains(death)));
    let mean_s = deaths(1.0, 2000, 1).iter().map(|death| death.time.as_secs_f64()).sum::<f64>() / 2000.0;
    // Uniform over 10 s: five standard errors of the mean.
    assert!((mean_s - 15.0).abs() < 5.0 * 10.0 / (12.0_f64 * 2000.0).sqrt(), "{mean_s}");
}

#[test]
fn lying_anchors_believe_in_places_at_the_given_distance_and_others_in_the_truth() {
    let nodes = nodes(9);
    let anchors: Vec<Anchor> = [1, 3, 4, 8]
        .map(|node: usize| Anchor { node: NodeId::from_index(node), position: nodes[node].position })
        .into();
    let believed = |share, chosen| {
        let lying_anchors = Some(LyingAnchorsConfig { share, names: chosen, distance_m: 7.5 });
        FaultsConfig { lying_anchors, ..FaultsConfig::default() }.believed(&anchors, &nodes, Seed(2))
    };
    let lies = |found: &[Anchor]| -> Vec<NodeId> {
        let pairs = found.iter().zip(&anchors);
        let lying = pairs.filter(|(found, truth)| {
            assert_eq!((found.node, found.position.z_m.to_bits()), (truth.node, truth.position.z_m.to_bits()));
            let error_m = found.position.distance_m(truth.position);
            assert!(error_m == 0.0 || (error_m - 7.5).abs() < 1e-9, "{error_m}");
            error_m > 0.0
        });
        lying.map(|(found, _)| found.node).collect()
    };
    assert_eq!(lies(&believed(Some(0.5), None).unwrap()).len(), 2);
    assert_eq!(lies(&believed(Some(1.0), None).unwrap()).len(), 4);
    assert_eq!(lies(&believed(None, names(&["n8", "n3"])).unwrap()), [NodeId(3), NodeId(8)]);
    assert_eq!(FaultsConfig::default().believed(&anchors, &nodes, Seed(2)).unwrap(), anchors);
    // Node 2 is no anchor.
    assert_eq!(believed(None, names(&["n3", "n2"])).unwrap_err().key, "lying_anchors.names[1]");
    // Each has a direction of its own.
    let all = believed(Some(1.0), None).unwrap();
    let moved = |i: usize| all[i].position - anchors[i].position;
    assert!(moved(0).distance_m(moved(1)) > 1e-3);
}

#[test]
fn invalid_faults_are_rejected_at_their_keys() {
    let good = DeathsConfig { share: Some(0.5), names: None, from_s: 1.0, to_s: 2.0 };
    let refused = |deaths: DeathsConfig| {
        let config = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
        config.build(&nodes(3), Seed(1)).err().map(|error| error.key)
    };
    assert_eq!(refused(good.clone()), None);
    let key = |deaths| refused(deaths).expect("refused");
    assert_eq!(key(DeathsConfig { share: Some(1.5), ..good.clone() }), "deaths.share");
    assert_eq!(key(DeathsConfig { share: Some(f64::NAN), ..good.clone() }), "deaths.share");
    assert_eq!(key(DeathsConfig { share: None, ..good.clone() }), "deaths.share");
    assert_eq!(key(DeathsConfig { names: names(&["n1"]), ..good.clone() }), "deaths.share");
    assert_eq!(key(DeathsConfig { share: None, names: names(&["n1", "n9"]), ..good.clone() }), "deaths.names[1]");
    assert_eq!(key(DeathsConfig { share: None, names: names(&["n1", "n1"]), ..good.clone() }), "deaths.names[1]");
    assert_eq!(key(DeathsConfig { from_s: 3.0, ..good.clone() }), "deaths.to_s");
    assert_eq!(key(DeathsConfig { from_s: -1.0, ..good.clone() }), "deaths.from_s");
    assert_eq!(key(DeathsConfig { to_s: f64::INFINITY, ..good }), "deaths.to_s");
    for message_loss in [-0.1, 1.1, f64::NAN] {
        let config = FaultsConfig { message_loss, ..FaultsConfig::default() };
        assert_eq!(config.build(&nodes(1), Seed(1)).unwrap_err().key, "message_loss");
    }
    for distance_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let lying_anchors = Some(LyingAnchorsConfig { share: Some(0.5), names: None, distance_m });
        let config = FaultsConfig { lying_anchors, ..FaultsConfig::default() };
        assert_eq!(config.believed(&[], &nodes(1), Seed(1)).unwrap_err().key, "lying_anchors.distance_m");
    }
    assert_eq!(FaultsConfig::default().build(&nodes(1), Seed(1)), Ok(Faults::default()));
}
