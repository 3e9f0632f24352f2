//! A robot as coordinator of a beacon-enabled PAN, over the medium: instants, references of slotted CSMA-CA,
//! guaranteed slots, lost beacons, energy.

use std::time::Duration;

use sextant_channel::{ChannelConfig, Position};
use sextant_kernel::{SettingError, SimTime};
use sextant_mac::frame::{Frame as MacFrame, FrameBody};
use sextant_mac::superframe::{BeaconEnabled, BeaconEnabledConfig, GtsConfig};
use sextant_mac::{CustomRadioConfig, EnergyConfig, RadioStates};
use sextant_sim::{
    FrameOnAir, FrameOutcome, Mac, Observer, OnceConfig, PeriodicConfig, ReceptionModel, Robot, Setup, Simulation,
    Survey, TrafficConfig,
};

use crate::network;

/// A frame as an observer sees it (us).
#[derive(Clone, Copy, Debug)]
struct Seen {
    source: usize,
    start: u64,
    end: u64,
    /// Frame type: 0 beacon, 1 data, 2 acknowledgement.
    kind: u8,
    outcome: FrameOutcome,
}

#[derive(Default)]
struct Log(Vec<Seen>);

impl Observer for Log {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        let us = |at: SimTime| u64::try_from((at - SimTime::ZERO).as_micros()).expect("a short run");
        let parsed = MacFrame::parse(frame.bytes).expect("good octets");
        let kind = match parsed.body {
            FrameBody::Beacon(_) => 0,
            FrameBody::Data(_) => 1,
            FrameBody::Acknowledgement => 2,
            FrameBody::Command { .. } => 3,
        };
        let (start, end) = (us(frame.start), us(frame.start + frame.airtime));
        self.0.push(Seen { source: frame.source.index(), start, end, kind, outcome: frame.outcome });
    }
}

fn query(mpdu_octets: u8, acknowledged: bool) -> TrafficConfig {
    TrafficConfig::Query(OnceConfig { mpdu_octets, at_s: 0.0, acknowledged, to: None })
}

fn periodic(interval_s: f64) -> TrafficConfig {
    TrafficConfig::Beacon(PeriodicConfig::each(20, interval_s, 0.1))
}

/// Nodes near the origin that all hear each other and a robot that listens once there.
fn setup(nodes: usize, mac: BeaconEnabledConfig, traffic: TrafficConfig, seed: u64) -> Setup {
    let setup = network::setup(&network::cluster(nodes), -20.0, ChannelConfig::default(), traffic, seed);
    let mac = Mac::BeaconEnabled(BeaconEnabled::try_from(mac).expect("good settings"));
    let setup = network::with(setup, |network| network::ieee802154(network).mac = mac);
    Setup { robots: vec![robot(vec![Position::ORIGIN], Duration::from_millis(250))], ..setup }
}

fn robot(places: Vec<Position>, listen: Duration) -> Robot {
    network::tour(places, 0.1, listen)
}

fn orders(beacon_order: u8, superframe_order: u8) -> BeaconEnabledConfig {
    BeaconEnabledConfig { beacon_order, superframe_order, ..BeaconEnabledConfig::default() }
}

fn run(setup: Setup) -> (Survey, Vec<Seen>) {
    let mut log = Log::default();
    let survey = Simulation::new(setup).expect("good settings").run(&mut log);
    (survey, log.0)
}

/// A turnaround after the robot has arrived, its first beacon starts (us).
const FIRST_BEACON: u64 = 192;

#[test]
fn beacons_come_once_an_interval_while_the_robot_listens_and_a_superframe_is_finished() {
    // 61.44 ms between beacons, 15.36 ms active, 200 ms of listening: the fourth superframe starts at 184.5 ms.
    let mut setup = setup(0, orders(2, 0), query(44, false), 1);
    setup.robots = vec![robot(vec![Position::ORIGIN], Duration::from_millis(185))];
    let (survey, frames) = run(setup);
    let starts: Vec<u64> = frames.iter().map(|frame| frame.start).collect();
    assert_eq!(starts, [0, 1, 2, 3].map(|k| FIRST_BEACON + k * 61_440));
    assert!(frames.iter().all(|frame| frame.kind == 0 && frame.end - frame.start == (6 + 13) * 32));
    assert_eq!(survey.end, SimTime::ZERO + Duration::from_micros(FIRST_BEACON + 3 * 61_440 + 15_360));
}

#[test]
fn a_stop_that_ends_between_superframes_ends_at_once() {
    let mut setup = setup(0, orders(2, 0), query(44, false), 1);
    setup.robots = vec![robot(vec![Position::ORIGIN], Duration::from_millis(170))];
    let (survey, frames) = run(setup);
    assert_eq!((frames.len(), survey.end), (3, SimTime::ZERO + Duration::from_millis(170)));
}

#[test]
fn one_frame_each_after_a_beacon_agrees_with_the_reference() {
    // Nodes; received, collided, channel access failure, mean end after the first boundary [ms]; frames of five
    // backoff periods. From a slot simulation independent of this one.
    for (nodes, received, collided, failed, end_ms) in [
        (2, 0.8755, 0.1245, 0.0000, 5.188),
        (3, 0.8382, 0.1617, 0.0001, 6.845),
        (5, 0.7631, 0.2329, 0.0040, 9.296),
        (10, 0.5712, 0.3718, 0.0570, 13.323),
        (20, 0.3286, 0.4947, 0.1768, 17.060),
        (50, 0.1130, 0.5720, 0.3151, 21.533),
    ] {
        let rounds = 30_000 / nodes as u64;
        let mut shares: [Vec<f64>; 3] = Default::default();
        let (mut sum_ms, mut count) = (0.0, 0.0);
        for round in 0..rounds {
            let (survey, frames) = run(setup(nodes, orders(4, 4), query(44, false), round));
            let packets = survey.packets;
            assert_eq!(packets.received + packets.lost_collision + packets.lost_channel_access, nodes as u64);
            let parts = [packets.received, packets.lost_collision, packets.lost_channel_access];
            for (share, part) in shares.iter_mut().zip(parts) {
                share.push(part as f64 / nodes as f64);
            }
            for frame in frames.iter().filter(|frame| frame.kind == 1 && frame.outcome == FrameOutcome::Received) {
                // The beacon takes 608 us: the first boundary is the second.
                sum_ms += 1e-3 * (frame.end - FIRST_BEACON - 640) as f64;
                count += 1.0;
            }
        }
        for (share, reference) in shares.iter().zip([received, collided, failed]) {
            let mean = share.iter().sum::<f64>() / rounds as f64;
            let variance = share.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / rounds as f64;
            // 4.5 standard errors of both sides (one false alarm in 150 000), plus half of the last digit.
            let allowed = 4.5 * (variance / rounds as f64).sqrt().hypot(7e-4) + 5e-5;
            assert!(
                (mean - reference).abs() <= allowed,
                "{nodes} nodes: {mean:.4}, not {reference} within {allowed:.4}"
            );
        }
        let mean_ms = sum_ms / count;
        assert!((mean_ms / end_ms - 1.0).abs() < 0.02, "{nodes} nodes: mean end {mean_ms} ms, not {end_ms}");
    }
}

#[test]
fn every_frame_is_on_the_backoff_grid_and_inside_a_superframe() {
    let gts = vec![GtsConfig { node: "n3".into(), slots: 2 }, GtsConfig { node: "n5".into(), slots: 1 }];
    let mac = BeaconEnabledConfig { gts, ..orders(3, 1) };
    let mut setup = setup(12, mac, periodic(0.05), 3);
    let places = (0..6).map(|i| Position::new(0.2 * f64::from(i), 0.0, 0.0)).collect();
    setup.robots = vec![robot(places, Duration::from_millis(600))];
    let (survey, frames) = run(setup);
    assert_eq!(survey.log().stops().len(), 6);
    let slot = 1920;
    let mut seen = [0; 2];
    for frame in frames.iter().filter(|frame| frame.kind == 1) {
        let beacon = frames.iter().filter(|b| b.kind == 0 && b.end <= frame.start).map(|b| b.start).max();
        let start = frame.start - beacon.expect("nobody sends before the first beacon");
        let end = frame.end - beacon.expect("as above") + 640;
        match frame.source {
            // The last two slots, and the one before them.
            3 => assert!(start == 14 * slot && end <= 16 * slot, "{frame:?}"),
            5 => assert!(start == 13 * slot && end <= 14 * slot, "{frame:?}"),
            _ => {
                // 20 octets of beacon end before boundary 3; two assessments come first.
                assert!(start % 320 == 0 && start >= 5 * 320 && end <= 13 * slot, "{frame:?}");
            }
        }
        seen[usize::from(matches!(frame.source, 3 | 5))] += 1;
    }
    assert!(seen[0] > 100 && seen[1] > 30, "{seen:?}");
    // There are no collisions in a guaranteed slot.
    let owners = frames.iter().filter(|frame| frame.kind == 1 && matches!(frame.source, 3 | 5));
    assert!(owners.into_iter().all(|frame| frame.outcome == FrameOutcome::Received));
}

#[test]
fn acknowledgements_start_on_the_first_boundary_that_is_a_turnaround_away() {
    let (survey, frames) = run(setup(4, orders(4, 4), query(20, true), 5));
    assert_eq!(survey.packets.received, 4);
    let acks: Vec<_> = frames.iter().filter(|frame| frame.kind == 2).collect();
    assert!(acks.len() >= 4);
    for ack in acks {
        let before =
            frames.iter().filter(|frame| frame.kind == 1 && frame.end <= ack.start).map(|frame| frame.end).max();
        let gap = ack.start - before.expect("a frame is acknowledged");
        assert_eq!((ack.start - FIRST_BEACON) % 320, 0);
        // 26 octets are 832 us: 2.6 periods, and 0.4 periods are less than a turnaround.
        assert_eq!(gap, 128 + 320);
        assert!(ack.end - ack.start == 352 && ack.source == 4);
    }
    // Outside contention: one turnaround.
    let gts = vec![GtsConfig { node: "n0".into(), slots: 1 }];
    let (_, frames) = run(setup(1, BeaconEnabledConfig { gts, ..orders(4, 4) }, query(20, true), 5));
    let [beacon, data, ack] = &frames[..3] else { panic!("{frames:?}") };
    assert_eq!((data.start - beacon.start, ack.start - data.end), (15 * 960 * 16, 192));
}

#[test]
fn nodes_that_hear_no_beacon_stay_silent() {
    let mut setup = setup(3, orders(3, 2), periodic(0.1), 1);
    setup.networks[0].channel = setup.networks[0].channel.within_m(5.0);
    setup.world.nodes[2].position = Position::new(-30.0, 0.0, 0.0);
    // Node 2 hears at most the neighbour of node 1; the robot goes to node 2 last.
    let places = vec![Position::ORIGIN, Position::new(-29.0, 0.0, 0.0)];
    setup.robots = vec![robot(places, Duration::from_millis(500))];
    let (survey, frames) = run(setup);
    let of = |source: usize| frames.iter().filter(move |frame| frame.source == source);
    let drive = SimTime::ZERO + Duration::from_secs(29);
    assert!(of(2).all(|frame| frame.start > 29_000_000) && of(2).count() >= 3, "{frames:?}");
    for node in [0, 1] {
        assert!(of(node).count() >= 3 && of(node).all(|frame| frame.end < 700_000));
    }
    assert!(survey.end > drive && survey.packets.pending > 0);
    let heard: Vec<_> = survey.log().receptions().iter().map(|r| (r.node.0, r.stop)).collect();
    assert_eq!(heard, [(0, 0), (1, 0), (2, 1)]);
}

#[test]
fn a_node_follows_beacons_through_a_short_drive_and_searches_after_a_long_one() {
    // Beacons 0 to 4 at the first stop, one every 122.88 ms. During a drive of 0.3 s beacons 5 to 7 are missed; 8 to
    // 11 are heard. During a drive of 0.9 s beacons 5 to 12 are missed: after the fourth of them the node searches
    // until beacon 13, and 14 to 16 are heard.
    let (heard_us, missed_us) = (192 + 608, 192 + 4256);
    let searched_us = (13 - 8) * 122_880 + heard_us;
    for (metres, receiving_us) in
        [(0.3, 9 * heard_us + 3 * missed_us), (0.9, 8 * heard_us + 3 * missed_us + searched_us)]
    {
        let mut setup = setup(1, orders(3, 3), query(20, false), 1);
        let places = vec![Position::ORIGIN, Position::new(-metres, 0.0, 0.0)];
        setup.robots = vec![robot(places, Duration::from_millis(500))];
        // One watt while receiving, nothing else: joules are seconds.
        let watt = CustomRadioConfig { supply_v: 1.0, tx_ma: 0.0, rx_ma: 1000.0, idle_ma: 0.0, sleep_ma: 0.0 };
        setup.networks[0].radio_states = RadioStates::try_from(EnergyConfig::Custom(watt)).expect("good currents");
        let (survey, _) = run(setup);
        // Also the turnaround and two backoff periods for its frame, and the wake-up for the beacon at which the robot has
        // finished.
        let expected_us = receiving_us + 192 + 640 + 192;
        let found_us = 1e6 * survey.energy.rx_j;
        assert!((found_us - f64::from(expected_us)).abs() < 0.1, "{metres} m: {found_us} us, not {expected_us}");
    }
}

#[test]
fn a_synchronised_node_uses_the_energy_of_its_duty_cycle() {
    // Beacon interval 245.76 ms, active 30.72 ms, nothing to send. Four beacons at 0.192 + k * 245.76 ms; the node
    // searches for the first, then wakes up 192 us before each of the others; the end is after four active parts.
    let mut setup = setup(
        1,
        orders(4, 1),
        TrafficConfig::Query(OnceConfig { mpdu_octets: 20, at_s: 999.0, acknowledged: false, to: None }),
        1,
    );
    setup.robots = vec![robot(vec![Position::ORIGIN], Duration::from_micros(3 * 245_760 + 10_000))];
    let (survey, frames) = run(setup);
    assert_eq!(frames.len(), 4);
    let beacon_us = 608.0;
    let rx_us = (192.0 + beacon_us) * 4.0;
    let idle_us = (30_720.0 - beacon_us) * 4.0;
    let end_us = 1e6 * survey.end.as_secs_f64();
    assert!((end_us - (192.0 + 3.0 * 245_760.0 + 30_720.0)).abs() < 1e-6);
    let sleep_us = end_us - rx_us - idle_us;
    let joules = |ma: f64, us: f64| 3.0 * ma * 1e-3 * us * 1e-6;
    assert!((survey.energy.rx_j - joules(18.8, rx_us)).abs() < 1e-9, "{:?}", survey.energy);
    assert!((survey.energy.idle_j - joules(0.426, idle_us)).abs() < 1e-9, "{:?}", survey.energy);
    assert!((survey.energy.sleep_j - joules(0.020, sleep_us)).abs() < 1e-12, "{:?}", survey.energy);
    assert!(survey.energy.tx_j.abs() < 1e-15);
}

#[test]
fn every_packet_is_counted_once_and_the_same_seed_gives_the_same_survey() {
    let survey = |seed| {
        let mut setup = setup(30, orders(3, 2), periodic(0.15), seed);
        for (i, node) in setup.world.nodes.iter_mut().enumerate() {
            node.position = Position::new((i % 6) as f64, (i / 6) as f64, 0.0);
        }
        setup.networks[0].channel = setup.networks[0].channel.within_m(3.0);
        network::receive_by(&mut setup.networks[0], ReceptionModel::SinrThreshold { least: 2.0 });
        let places = (0..6).map(|i| Position::new(f64::from(i), 2.5, 0.0)).collect();
        setup.robots = vec![robot(places, Duration::from_secs(1))];
        run(setup).0
    };
    let (first, again, other) = (survey(1), survey(1), survey(2));
    assert_eq!((first.log(), first.packets, first.events), (again.log(), again.packets, again.events));
    assert_ne!(first.log(), other.log());
    let p = first.packets;
    assert_eq!(network::ended(&p), p.offered, "{p:?}");
    assert!(p.received > 100 && p.lost_queue > 0, "{p:?}");
    // No node sends while the robot is away.
    assert_eq!(p.not_listened, 0, "{p:?}");
}

fn refusal(change: impl FnOnce(&mut Setup), mac: BeaconEnabledConfig, octets: u8) -> Option<SettingError> {
    let mut setup = setup(3, mac, query(octets, true), 1);
    change(&mut setup);
    Simulation::new(setup).err()
}

#[test]
fn superframes_that_do_not_fit_world_traffic_or_robot_are_rejected_with_their_key() {
    let with = |gts: &[(&str, u8)], order| {
        let gts = gts.iter().map(|&(node, slots)| GtsConfig { node: node.into(), slots }).collect();
        BeaconEnabledConfig { gts, ..orders(order, order) }
    };
    let key = |error: Option<SettingError>| error.map(|error| error.key);
    let keep = |_: &mut Setup| ();
    assert_eq!(key(refusal(keep, with(&[("n0", 3)], 1), 20)), None);
    assert_eq!(
        key(refusal(keep, with(&[("n0", 1), ("x", 1)], 1), 20)).as_deref(),
        Some("mac.beacon_enabled.gts[1].node")
    );
    assert_eq!(key(refusal(keep, with(&[("n0", 1)], 1), 20)).as_deref(), Some("mac.beacon_enabled.gts[0].slots"));
    assert_eq!(key(refusal(keep, with(&[("n0", 8)], 0), 20)).as_deref(), Some("mac.beacon_enabled.gts"));
    let hasty = |setup: &mut Setup| setup.robots[0].body.listen = Duration::from_millis(245);
    assert_eq!(key(refusal(hasty, with(&[], 4), 20)).as_deref(), Some("robots[0].listen_s"));
}
