//! Frames to one station: acknowledged, sent again, reported, and delivered once, at instants that are known.
//!
//! All payloads have one octet, so that a frame is 576 us on air. Nothing is drawn: carrier sense and turnaround take
//! 320 us, the wait for an acknowledgement 864 us, so that an attempt without answer takes 1760 us.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::csma::CsmaConfig;
use sextant_sim::{
    Application, Deafness, Delivery, Destination, FrameId, FrameOutcome, NetworkId, Packets, Payload, Port,
    RadioConfig, ReceptionConfig, SendOutcome, SendReport, Setup, ThresholdConfig, Timer,
};

use crate::network::{self, Ended};
use crate::on_air::OnAir;
use crate::scripted::{NETWORK, Scripted};

const ATTEMPT_US: u64 = 320 + 576 + 864;

fn at(micros: u64) -> SimTime {
    SimTime::ZERO + Duration::from_micros(micros)
}

fn to(station: u32) -> Destination {
    Destination::Station(StationId(station))
}

/// The end of the first frame of a station, which it got at time zero.
fn report(to: Destination, outcome: SendOutcome, transmissions: u32) -> SendReport {
    SendReport { frame: FrameId(0), to, outcome, attempts: transmissions, transmissions, offered: SimTime::ZERO }
}

/// Nodes on a line, one metre apart, that reach their neighbours only.
fn line(applications: Vec<Scripted>, csma: CsmaConfig) -> (Ended<Scripted>, OnAir) {
    let places = network::grid(applications.len(), 1);
    let mut on_air = OnAir::default();
    let setup = network::engine(&places, network::link(1.0, csma), 3);
    (network::run_watched(setup, applications, &mut on_air), on_air)
}

#[test]
fn a_frame_in_range_is_delivered_at_its_end_and_acknowledged_544_us_later() {
    let sender = Scripted::listener().and_sends(Duration::ZERO, to(1), &[7]);
    let (ended, on_air) = line(vec![sender, Scripted::listener()], network::prompt());
    let [sender, listener] = &ended.applications[..] else { panic!("two stations") };
    assert_eq!(sender.reports, [(at(1440), report(to(1), SendOutcome::Acknowledged, 1))]);
    let [received] = &listener.received[..] else { panic!("one frame, not {:?}", listener.received) };
    assert_eq!((received.at, received.from, &received.payload[..]), (at(896), StationId(0), &[7][..]));
    assert_eq!(on_air.frames(false), [(0, 320, 896, FrameOutcome::Received)]);
    assert_eq!(on_air.frames(true), [(1, 1088, 1440, FrameOutcome::Received)]);
    let expected = Packets {
        offered: 1,
        sent: 1,
        received: 1,
        transmissions: 1,
        assessments: 1,
        octets_received: 1,
        ..Packets::default()
    };
    assert_eq!(ended.networks[0].packets, [expected, Packets::default()]);
}

#[test]
fn a_clock_that_is_fast_or_slow_costs_no_acknowledgement() {
    for clock_ppm in [1.0, 40.0, 1000.0] {
        for seed in 0..8 {
            let mut link = network::link(1.0, network::prompt());
            network::ieee802154(&mut link).radio = network::radios(RadioConfig { clock_ppm, ..network::radio(0.0) });
            let setup = network::engine(&network::grid(2, 1), link, seed);
            let sender = Scripted::listener().and_sends(Duration::ZERO, to(1), &[7]);
            let ended = network::run(setup, vec![sender, Scripted::listener()]);
            let reports = &ended.applications[0].reports;
            assert_eq!(
                (reports[0].1.outcome, reports[0].1.transmissions),
                (SendOutcome::Acknowledged, 1),
                "{clock_ppm}"
            );
        }
    }
}

#[test]
fn a_frame_that_nobody_answers_is_sent_again_as_often_as_allowed_and_then_reported() {
    for max_retries in 0..=7 {
        let csma = CsmaConfig { max_retries, ..network::prompt() };
        let attempts = 1 + u64::from(max_retries);
        // Station 1 does not look at frames, so that it does not answer; station 2 is out of range.
        for (destination, outcome) in [(1, FrameOutcome::NotListened(Deafness::Off)), (2, FrameOutcome::OutOfRange)] {
            let sender = Scripted::listener().and_sends(Duration::ZERO, to(destination), &[7]);
            let (ended, on_air) = line(vec![sender, Scripted::deaf(), Scripted::listener()], csma);
            let transmissions = u32::try_from(attempts).unwrap();
            let expected = report(to(destination), SendOutcome::NoAcknowledgement, transmissions);
            assert_eq!(ended.applications[0].reports, [(at(attempts * ATTEMPT_US), expected)]);
            assert!(ended.applications[2].received.is_empty());
            let starts = (0..attempts).map(|attempt| 320 + attempt * ATTEMPT_US);
            assert!(on_air.frames(false).into_iter().eq(starts.map(|from| (0, from, from + 576, outcome))));
            assert_eq!(on_air.frames(true), []);
            let packets = ended.networks[0].packets[0];
            assert_eq!((packets.offered, packets.sent, packets.unacknowledged), (1, 1, 1));
            assert_eq!((packets.transmissions, packets.assessments), (attempts, attempts));
            let lost = (packets.not_listened, packets.out_of_range);
            assert_eq!(lost, if destination == 1 { (1, 0) } else { (0, 1) });
        }
    }
}

/// Sequence numbers go round after 256 frames: a frame with the number of an earlier one is no copy of it.
#[test]
fn a_frame_with_the_number_of_an_earlier_one_is_delivered() {
    let nth = |frame: u64| Duration::from_millis(2 * frame);
    let first = Scripted::listener().and_sends(nth(0), to(0), &[1]);
    let others = (1..256).fold(first, |sender, frame| sender.and_sends(nth(frame), to(2), &[2]));
    let sender = others.and_sends(nth(256), to(0), &[3]);
    let (ended, _) = line(vec![Scripted::listener(), sender, Scripted::listener()], network::prompt());
    let payloads: Vec<&[u8]> = ended.applications[0].received.iter().map(|received| &received.payload[..]).collect();
    assert_eq!(payloads, [&[1][..], &[3]]);
    assert_eq!(ended.networks[0].deliveries, [2, 0, 255]);
}

/// Station 0 answers station 1; station 2 disturbs the answer at station 1, and station 0 does not hear it. Its
/// carrier sense begins when the frame ends, and its frame of 544 us without payload is on air from 320 to 864 us
/// after that; the answer from 192 to 544 us.
fn hidden_station(disturbed: &[u64]) -> (Ended<Scripted>, OnAir) {
    let sender = Scripted::listener().and_sends(Duration::ZERO, to(0), &[7]);
    let disturber = disturbed.iter().fold(Scripted::listener(), |disturber, attempt| {
        disturber.and_sends(Duration::from_micros(896 + attempt * ATTEMPT_US), Destination::All, &[])
    });
    line(vec![Scripted::listener(), sender, disturber], network::prompt())
}

#[test]
fn a_frame_whose_acknowledgement_is_lost_is_sent_again_and_delivered_once() {
    let (ended, on_air) = hidden_station(&[0]);
    let [listener, sender, disturber] = &ended.applications[..] else { panic!("three stations") };
    assert_eq!(sender.reports, [(at(ATTEMPT_US + 1440), report(to(0), SendOutcome::Acknowledged, 2))]);
    let [received] = &listener.received[..] else { panic!("one frame, not {:?}", listener.received) };
    assert_eq!(received.at, at(896));
    assert_eq!(
        on_air.frames(false),
        [
            (1, 320, 896, FrameOutcome::Received),
            (2, 1216, 1760, FrameOutcome::Collided),
            (1, 2080, 2656, FrameOutcome::Received),
        ]
    );
    assert_eq!(
        on_air.frames(true),
        [(0, 1088, 1440, FrameOutcome::Collided), (0, 2848, 3200, FrameOutcome::Received)]
    );
    assert_eq!(disturber.reports.len(), 1);
    let expected = Packets {
        offered: 1,
        sent: 1,
        received: 1,
        transmissions: 2,
        assessments: 2,
        octets_received: 1,
        ..Packets::default()
    };
    assert_eq!(ended.networks[0].packets[1], expected);
    assert_eq!(ended.networks[0].packets[2].lost_collision, 1);
}

#[test]
fn a_frame_whose_acknowledgements_are_all_lost_is_reported_as_unanswered_although_it_was_delivered() {
    let (ended, on_air) = hidden_station(&[0, 1, 2, 3]);
    let [listener, sender, _] = &ended.applications[..] else { panic!("three stations") };
    assert_eq!(sender.reports, [(at(4 * ATTEMPT_US), report(to(0), SendOutcome::NoAcknowledgement, 4))]);
    assert_eq!(listener.payloads(), [[7]]);
    assert_eq!(on_air.frames(true).len(), 4);
    let packets = ended.networks[0].packets[1];
    assert_eq!((packets.received, packets.unacknowledged, packets.transmissions), (1, 1, 4));
}

#[test]
fn an_acknowledgement_has_no_address_so_that_only_its_sequence_number_tells_for_whom_it_is() {
    // Both others send to the first station at the same instant; it receives the nearer one, and the farther one hears
    // the acknowledgement while it waits for its own.
    let places = [0.0, 0.5, -1.0].map(|x_m| Position::new(x_m, 0.0, 0.0));
    let capture = ReceptionConfig::SinrThreshold(ThresholdConfig { threshold_db: 3.0 });
    let mut link = network::link(2.0, network::prompt());
    network::receive_by(&mut link, capture.try_into().expect("a good threshold"));
    let mut confused = 0;
    for seed in 0..1000 {
        let sender = |payload| Scripted::listener().and_sends(Duration::ZERO, to(0), payload);
        let stations = vec![Scripted::listener(), sender(b"n"), sender(b"f")];
        let mut on_air = OnAir::default();
        let setup = network::engine(&places, link.clone(), seed);
        let ended = network::run_watched(setup, stations, &mut on_air);
        let [listener, near, far] = &ended.applications[..] else { panic!("three stations") };
        assert_eq!(near.reports, [(at(1440), report(to(0), SendOutcome::Acknowledged, 1))]);
        let [first, second, ..] = on_air.0[..] else { panic!("two frames") };
        if first.sequence == second.sequence {
            confused += 1;
            assert_eq!(far.reports, [(at(1440), report(to(0), SendOutcome::Acknowledged, 1))]);
            assert_eq!(listener.payloads(), [b"n"]);
        } else {
            // The acknowledgement of the other frame ends the wait after 544 us instead of 864.
            let second_us = ATTEMPT_US - 864 + 544;
            assert_eq!(far.reports, [(at(second_us + 1440), report(to(0), SendOutcome::Acknowledged, 2))]);
            assert_eq!(listener.payloads(), [b"n", b"f"]);
        }
    }
    // One in 256 is expected.
    assert_eq!(confused, 4);
}

/// A robot that listens once, or a node that sends to it.
enum Role {
    Node { reports: Vec<(SimTime, SendReport)> },
    Robot { listens_from: Duration, listens_for: Duration, delivered: Vec<SimTime>, listened: Vec<SimTime> },
}

impl Application for Role {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Node { .. } => {
                port.send(NETWORK, to(1), Payload::Octets(&[7])).expect("the queue is empty");
            }
            Self::Robot { listens_from, listens_for, .. } if listens_from.is_zero() => {
                port.listen(NETWORK, *listens_for);
            }
            Self::Robot { listens_from, .. } => {
                port.after(*listens_from, Timer(0));
            }
        }
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        if let Self::Robot { listens_for, .. } = self {
            port.listen(NETWORK, *listens_for);
        }
    }

    fn delivered(&mut self, _delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Self::Robot { delivered, .. } = self {
            delivered.push(port.now());
        }
    }

    fn sent(&mut self, _network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        if let Self::Node { reports } = self {
            reports.push((port.now(), *report));
        }
    }

    fn listened(&mut self, _network: NetworkId, port: &mut Port<'_>) {
        if let Self::Robot { listened, .. } = self {
            listened.push(port.now());
        }
    }
}

/// Report of a node that sends to a robot beside it, which listens in this window (us); when the robot got the frame,
/// and when it was told that its time to listen was over (us).
fn to_a_robot(from_us: u64, to_us: u64) -> (SendReport, u64, Vec<u64>, Vec<u64>) {
    let setup = Setup {
        robots: network::own_robots([network::body("robot", Position::new(1.0, 0.0, 0.0))]),
        ..network::engine(&[Position::ORIGIN], network::link(1.0, network::prompt()), 3)
    };
    let robot = Role::Robot {
        listens_from: Duration::from_micros(from_us),
        listens_for: Duration::from_micros(to_us - from_us),
        delivered: Vec::new(),
        listened: Vec::new(),
    };
    let ended = network::run(setup, vec![Role::Node { reports: Vec::new() }, robot]);
    let [Role::Node { reports }, Role::Robot { delivered, listened, .. }] = &ended.applications[..] else {
        panic!("a node and a robot")
    };
    let [(reported, report)] = reports[..] else { panic!("one report, not {reports:?}") };
    let micros = |instant: &SimTime| instant.as_nanos() / 1000;
    (report, micros(&reported), delivered.iter().map(micros).collect(), listened.iter().map(micros).collect())
}

#[test]
fn a_robot_that_listens_from_the_start_receives_and_finishes_its_acknowledgement_before_it_closes_its_receiver() {
    // The frame ends at 896 us and its acknowledgement at 1440 us.
    let acknowledged = report(to(1), SendOutcome::Acknowledged, 1);
    assert_eq!(to_a_robot(0, 5000), (acknowledged, 1440, vec![896], vec![5000]));
    assert_eq!(to_a_robot(0, 900), (acknowledged, 1440, vec![896], vec![1440]));
    // The frame is received if the receiver closes at its very end.
    assert_eq!(to_a_robot(0, 896), (acknowledged, 1440, vec![896], vec![1440]));
}

#[test]
fn a_robot_receives_the_transmission_that_falls_in_its_window_and_none_that_began_before() {
    // The receiver opens at the first bit of the second transmission, or one microsecond later.
    let second = (report(to(1), SendOutcome::Acknowledged, 2), ATTEMPT_US + 1440, vec![ATTEMPT_US + 896], vec![9000]);
    assert_eq!(to_a_robot(321, 9000), second);
    assert_eq!(to_a_robot(ATTEMPT_US + 319, 9000), second);
    let third =
        (report(to(1), SendOutcome::Acknowledged, 3), 2 * ATTEMPT_US + 1440, vec![2 * ATTEMPT_US + 896], vec![9000]);
    assert_eq!(to_a_robot(ATTEMPT_US + 321, 9000), third);
    // A receiver that closes one microsecond too early, for all transmissions.
    let none = (report(to(1), SendOutcome::NoAcknowledgement, 4), 4 * ATTEMPT_US, vec![], vec![895]);
    assert_eq!(to_a_robot(0, 895), none);
}
