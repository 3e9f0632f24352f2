//! Two networks in one engine: apart on different radio channels, in each other's way on the same one.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::StationId;
use sextant_mac::csma::CsmaConfig;
use sextant_mac::superframe::BeaconEnabledConfig;
use sextant_sim::{
    Application, Delivery, Destination, FrameOutcome, MacConfig, NetworkId, Packets, Payload, Port, RadioConfig,
    RobotBody, SendOutcome, SendReport, Setup, Sink, Timer,
};

use crate::network::{self, Ended};
use crate::on_air::OnAir;
use crate::scripted::Scripted;

const FIRST: NetworkId = NetworkId(0);
const SECOND: NetworkId = NetworkId(1);

/// Two networks of the same stations, with this range and on these radio channels.
fn two_networks(places: &[Position], range_m: f64, csma: CsmaConfig, channels: [u8; 2], seed: u64) -> Setup {
    let link = network::link(range_m, csma);
    let on = |channel| {
        let mut link = link.clone();
        let config = RadioConfig { channel: Some(channel), ..network::radio(0.0) };
        network::ieee802154(&mut link).radio = network::radios(config);
        link
    };
    Setup { networks: channels.map(on).into(), ..network::engine(places, link.clone(), seed) }
}

/// Sends to one station through one network at random times, and notes what it receives.
#[derive(Clone, Debug, PartialEq)]
struct Pair {
    network: NetworkId,
    to: Option<StationId>,
    outcomes: Vec<SendOutcome>,
    received: Vec<(NetworkId, StationId, u8)>,
}

impl Application for Pair {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        for number in 0..20 {
            port.after(Duration::from_millis(400).mul_f64(port.uniform(number.into())), Timer(number));
        }
    }

    fn timed(&mut self, Timer(number): Timer, port: &mut Port<'_>) {
        let Some(to) = self.to else { return };
        let number = u8::try_from(number).expect("20 frames");
        // Those that find the queue full are counted by the link.
        let _ = port.send(self.network, Destination::Station(to), Payload::Octets(&[self.network.0, number]));
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, _port: &mut Port<'_>) {
        let [network, number] = *delivery.payload else { panic!("two octets") };
        assert_eq!(network, delivery.network.0, "a frame of the other network");
        self.received.push((delivery.network, delivery.from, number));
    }

    fn sent(&mut self, network: NetworkId, report: &SendReport, _port: &mut Port<'_>) {
        assert_eq!(network, self.network);
        self.outcomes.push(report.outcome);
    }
}

/// Eight nodes in a row, all in range of each other. The even ones send to the next even one through the first
/// network, the odd ones to the next odd one through the second; only those of the `active` networks send.
fn pairs(channels: [u8; 2], active: [bool; 2], seed: u64) -> Ended<Pair> {
    let csma = CsmaConfig { rx_on_when_idle: true, queue_frames: 1, ..CsmaConfig::default() };
    let pair = |node: u32| {
        let network = NetworkId((node % 2) as u8);
        let to = active[network.index()].then_some(StationId((node + 2) % 8));
        Pair { network, to, outcomes: Vec::new(), received: Vec::new() }
    };
    network::run(two_networks(&network::grid(8, 1), 10.0, csma, channels, seed), (0..8).map(pair).collect())
}

fn of_network(ended: &Ended<Pair>, network: NetworkId) -> (&[Packets], Vec<&Pair>) {
    let of_it = ended.applications.iter().filter(|pair| pair.network == network);
    (&ended.networks[network.index()].packets, of_it.collect())
}

#[test]
fn networks_on_different_channels_do_not_change_each_other() {
    for seed in 0..10 {
        let both = pairs([11, 12], [true, true], seed);
        for (network, active) in [(FIRST, [true, false]), (SECOND, [false, true])] {
            let alone = pairs([11, 12], active, seed);
            assert_eq!(of_network(&both, network), of_network(&alone, network));
            let sum: Packets = both.networks[network.index()].packets.iter().copied().sum();
            assert_eq!((sum.offered, network::ended(&sum)), (80, 80));
        }
    }
}

#[test]
fn networks_on_one_channel_share_it_and_lose_more() {
    let mut lost = [0, 0];
    for seed in 0..10 {
        for (lost, channels) in lost.iter_mut().zip([[11, 12], [11, 11]]) {
            let ended = pairs(channels, [true, true], seed);
            let sum: Packets = ended.networks.iter().flat_map(|network| network.packets.iter().copied()).sum();
            assert_eq!((sum.offered, network::ended(&sum)), (160, 160));
            *lost += sum.offered - sum.received;
        }
    }
    let [apart, shared] = lost;
    // Packets of 1600.
    assert_eq!((apart, shared), (47, 240));
}

/// What becomes of a frame of each network, sent at the same instant without backoff by stations that both others
/// hear: station 0 to station 1 in the first network, station 3 to station 2 in the second.
fn at_once(channels: [u8; 2]) -> (Ended<Scripted>, OnAir) {
    let csma = CsmaConfig { max_retries: 0, ..network::prompt() };
    let setup = two_networks(&network::grid(4, 1), 10.0, csma, channels, 1);
    let to = |station| Destination::Station(StationId(station));
    let stations = vec![
        Scripted::listener().and_sends(Duration::ZERO, to(1), b"1"),
        Scripted::listener(),
        Scripted::listener(),
        Scripted::listener().and_sends(Duration::ZERO, to(2), b"2").through(SECOND),
    ];
    let mut on_air = OnAir::default();
    let ended = network::run_watched(setup, stations, &mut on_air);
    (ended, on_air)
}

#[test]
fn frames_at_the_same_instant_collide_on_one_channel_and_not_on_two() {
    let (ended, on_air) = at_once([11, 12]);
    assert_eq!(on_air.frames(false), [(0, 320, 896, FrameOutcome::Received), (3, 320, 896, FrameOutcome::Received)]);
    assert_eq!(ended.applications[1].payloads(), [b"1"]);
    assert_eq!(ended.applications[2].payloads(), [b"2"]);
    assert_eq!(ended.applications[2].received[0].network, SECOND);
    let (ended, on_air) = at_once([11, 11]);
    assert_eq!(on_air.frames(false), [(0, 320, 896, FrameOutcome::Collided), (3, 320, 896, FrameOutcome::Collided)]);
    for station in &ended.applications {
        assert_eq!(station.received, []);
    }
    for (network, sender) in [(FIRST, 0), (SECOND, 3)] {
        let packets = ended.networks[network.index()].packets[sender];
        assert_eq!((packets.lost_collision, packets.unacknowledged), (1, 1));
    }
}

#[test]
fn two_radios_of_one_station_are_in_each_others_way_on_one_channel() {
    // The first station sends to all in the first network while the other one sends to it in the second.
    let received = |channels| {
        let setup = two_networks(&network::grid(2, 1), 10.0, network::prompt(), channels, 1);
        let first = Scripted::listener().and_sends(Duration::ZERO, Destination::All, b"1");
        let second = Scripted::listener().and_sends(Duration::ZERO, Destination::All, b"2").through(SECOND);
        let ended = network::run(setup, vec![first, second]);
        ended.applications.iter().map(|station| station.received.len()).collect::<Vec<_>>()
    };
    assert_eq!(received([11, 12]), [1, 1]);
    assert_eq!(received([11, 11]), [0, 0]);
    // The second frame is offered while the first one is on air.
    let outcomes = |channels| {
        let csma = CsmaConfig { max_backoffs: 0, ..network::prompt() };
        let both = Scripted::listener().and_sends(Duration::ZERO, Destination::All, b"1");
        let both = both.and_sends(Duration::from_micros(500), Destination::All, b"2").through(SECOND);
        let setup = two_networks(&[Position::ORIGIN], 10.0, csma, channels, 1);
        let ended = network::run(setup, vec![both]);
        let mut outcomes: Vec<_> = ended.applications[0].reports.iter().map(|(_, report)| report.outcome).collect();
        outcomes.sort_by_key(|&outcome| outcome == SendOutcome::ChannelAccessFailure);
        outcomes
    };
    assert_eq!(outcomes([11, 12]), [SendOutcome::Sent, SendOutcome::Sent]);
    assert_eq!(outcomes([11, 11]), [SendOutcome::Sent, SendOutcome::ChannelAccessFailure]);
}

#[test]
fn channel_access_by_beacons_is_refused_for_own_applications() {
    let mut setup = two_networks(&[Position::ORIGIN], 10.0, network::prompt(), [11, 12], 1);
    setup.sinks = vec![Sink { name: "sink".into(), position: Position::ORIGIN, networks: None }];
    let beacons = MacConfig::BeaconEnabled(BeaconEnabledConfig::default());
    network::ieee802154(&mut setup.networks[1]).mac = beacons.try_into().expect("good settings");
    let refusal = network::refusal(setup, vec![Scripted::listener(), Scripted::listener()]);
    assert_eq!(refusal.map(|error| error.key).as_deref(), Some("mac.beacon_enabled"));
}

#[test]
fn a_frame_to_all_counts_and_arrives_in_its_own_network_only() {
    // Nobody listens in the first network but the sender; all listen in the second one, on the same channel.
    let setup = two_networks(&network::grid(3, 1), 10.0, network::prompt(), [11, 11], 1);
    let sender = Scripted::listener().and_sends(Duration::ZERO, Destination::All, b"all").through(SECOND);
    let stations = vec![sender, Scripted::listener(), Scripted::deaf()];
    let ended = network::run(setup, stations);
    let [received] = &ended.applications[1].received[..] else { panic!("one frame") };
    assert_eq!((received.network, &received.payload[..]), (SECOND, &b"all"[..]));
    assert_eq!(ended.networks[FIRST.index()].packets, vec![Packets::default(); 3]);
    assert_eq!(ended.networks[SECOND.index()].packets[0].received, 1);
}

#[test]
fn a_robot_that_listens_in_another_network_on_the_channel_does_not_hear_a_frame_to_all() {
    for (listens_in, received) in [(SECOND, 1), (FIRST, 0)] {
        let setup = Setup {
            robots: network::own_robots([RobotBody {
                networks: vec![FIRST, SECOND],
                ..network::body("robot", Position::new(1.0, 0.0, 0.0))
            }]),
            ..two_networks(&[Position::ORIGIN], 10.0, network::prompt(), [11, 11], 1)
        };
        let sender = Scripted::deaf().and_sends(Duration::ZERO, Destination::All, b"all").through(SECOND);
        let ended = network::run(setup, vec![sender, Scripted::listener().and_listens_in(listens_in)]);
        let packets = ended.networks[SECOND.index()].packets[0];
        assert_eq!((packets.received, packets.not_listened), (received, 1 - received));
        assert_eq!(ended.applications[1].received.len() as u64, received);
    }
}

#[test]
fn carrier_sense_hears_the_other_network_on_the_same_channel() {
    // The second frame is offered while the first one is on air, from 320 to 896 us.
    let started = |channels| {
        let csma = CsmaConfig { max_backoffs: 0, ..network::prompt() };
        let setup = two_networks(&network::grid(2, 1), 10.0, csma, channels, 1);
        let late = Scripted::listener().and_sends(Duration::from_micros(500), Destination::All, b"2").through(SECOND);
        let stations = vec![Scripted::listener().and_sends(Duration::ZERO, Destination::All, b"1"), late];
        network::run(setup, stations).applications[1].reports[0].1.outcome
    };
    assert_eq!(started([11, 12]), SendOutcome::Sent);
    assert_eq!(started([11, 11]), SendOutcome::ChannelAccessFailure);
}
