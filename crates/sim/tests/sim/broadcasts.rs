//! Broadcasts by sector sweeps: exact instants, sectors, contention, the queue, counts and energy.

use std::time::Duration;

use sextant_channel::{Db, Position};
use sextant_kernel::{Files, SimTime, StationId};
use sextant_mac::RadioStates;
use sextant_mac::dmg::{SweepBody, SweepConfig, SweepFrame, beacon_payload};
use sextant_sim::{
    Antennas, Application, Delivery, Destination, DmgRadio, FrameId, FrameOnAir, FrameOutcome, Ieee80211ad, Network,
    Observer, Packets, Payload, Port, RadioConfig, ReceptionModel, SendError, SendOutcome, SendReport, Setup, Sink,
    SweepAnswer, SweepError, SweepKind, Technology, Timer, TrafficPlan,
};

use crate::network::{self, Ended};
use crate::scripted::NETWORK;

/// AIFS of best effort (ns).
const AIFS: u64 = 18_000;
/// A slot of the backoff (ns).
const SLOT: u64 = 5_000;
/// A beacon with 20 octets of payload: 61 octets are 440 bits beyond the first codeword, so 4 codewords; 38400 chips of 1200 bits
/// and 7552 chips of preamble at 1.76 GHz (ns).
const BEACON: u64 = 26_109;
/// Eight of them, 1 us apart (ns).
const SWEEP: u64 = 8 * BEACON + 7 * 1_000;

/// Eight sectors that point along known directions.
pub(crate) const EIGHT: &str = "nodes.sectors = { azimuth_sectors = 8, boresight_gain_dbi = 0.0 }\n\
                     robots.sectors = { azimuth_sectors = 8, boresight_gain_dbi = 0.0 }\nnode_headings = 'aligned'";
const OMNIDIRECTIONAL: &str = "nodes.omnidirectional = {}\nrobots.omnidirectional = {}";

/// A network in which 0 dBi reach 7 m, without shadowing; overlapping frames are lost.
pub(crate) fn link(antennas: &str) -> Network {
    let radio = RadioConfig { sensitivity_dbm: -60.0, ..network::radio(-60.0 + 20.0 * libm::log10(7.0)) };
    let radio = DmgRadio::try_from(radio).expect("good levels");
    let sweep = SweepConfig::default().try_into().expect("good settings");
    let antennas =
        Antennas::read(&toml::from_str(antennas).expect("antennas"), &Files::default()).expect("good antennas");
    let links = Ieee80211ad::new(radio, ReceptionModel::Overlap, sweep, antennas).expect("sectors that fit");
    Network::of(
        network::free_space().try_into().expect("a good channel"),
        Technology::Ieee80211ad(Box::new(links)),
        RadioStates::mmwave_60_ghz(),
        TrafficPlan::silent(0),
    )
}

/// What an application does at an instant.
#[derive(Clone, Debug)]
enum Deed {
    Send(Destination, Vec<u8>),
    SendFiller(u8),
    Sweep,
}

/// A frame that was delivered: when, from whom, from which sector, sequence number, SNR.
type Heard = (u64, StationId, Option<u8>, u8, Option<Db>);

/// A station that does what a script says, and writes down what it is told.
#[derive(Default)]
struct Speaker {
    deeds: Vec<(Duration, Deed)>,
    /// What it broadcasts as soon as it has heard the first frame.
    reply: Option<Vec<u8>>,
    sent: Vec<Result<FrameId, SendError>>,
    asked: Vec<Result<(), SweepError>>,
    reports: Vec<(SimTime, SendReport)>,
    heard: Vec<Heard>,
    payloads: Vec<Vec<u8>>,
    sectors: Option<u8>,
    swept: Vec<(SimTime, Vec<SweepAnswer>)>,
}

impl Speaker {
    fn and(mut self, at_us: u64, deed: Deed) -> Self {
        self.deeds.push((Duration::from_micros(at_us), deed));
        self
    }

    fn and_broadcasts(self, at_us: u64, payload: &[u8]) -> Self {
        self.and(at_us, Deed::Send(Destination::All, payload.to_vec()))
    }

    /// The sector of which a frame was heard best.
    fn best_sector(&self) -> Option<u8> {
        let snr = |heard: &&Heard| heard.4.expect("sweeps have an SNR");
        self.heard.iter().max_by(|a, b| snr(a).0.total_cmp(&snr(b).0))?.2
    }
}

impl Application for Speaker {
    fn hears(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.sectors = port.sectors(NETWORK);
        for ((at, _), number) in self.deeds.iter().zip(0..) {
            port.after(*at, Timer(number));
        }
    }

    fn timed(&mut self, Timer(number): Timer, port: &mut Port<'_>) {
        match &self.deeds[usize::from(number)].1 {
            Deed::Send(to, payload) => self.sent.push(port.send(NETWORK, *to, Payload::Octets(payload))),
            Deed::SendFiller(octets) => {
                self.sent.push(port.send(NETWORK, Destination::All, Payload::Filler(*octets)));
            }
            Deed::Sweep => self.asked.push(port.sweep(NETWORK, SweepKind::Gather)),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let &Delivery { from, sector, sequence, snr, payload, .. } = delivery;
        self.heard.push((port.now().as_nanos(), from, sector, sequence, snr));
        self.payloads.push(payload.to_vec());
        if let Some(payload) = self.reply.take() {
            self.sent.push(port.send(NETWORK, Destination::All, Payload::Octets(&payload)));
        }
    }

    fn sent(&mut self, _: sextant_sim::NetworkId, report: &SendReport, port: &mut Port<'_>) {
        self.reports.push((port.now(), *report));
    }

    fn swept(&mut self, _: sextant_sim::NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        self.swept.push((port.now(), answers.to_vec()));
    }
}

/// A frame: start and end (ns), sender, what it says, its payload, its outcome.
struct Sent {
    start: u64,
    end: u64,
    from: StationId,
    frame: SweepFrame,
    payload: Vec<u8>,
    outcome: FrameOutcome,
}

#[derive(Default)]
struct OnAir(Vec<Sent>);

impl OnAir {
    fn of(&self, station: u32) -> Vec<&Sent> {
        self.0.iter().filter(|sent| sent.from == StationId(station)).collect()
    }

    fn beacons_of(&self, station: u32) -> Vec<&Sent> {
        let is_beacon = |sent: &&Sent| matches!(sent.frame.body, SweepBody::Beacon { .. });
        self.of(station).into_iter().filter(is_beacon).collect()
    }
}

impl Observer for OnAir {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        self.0.push(Sent {
            start: frame.start.as_nanos(),
            end: (frame.start + frame.airtime).as_nanos(),
            from: frame.source,
            frame: SweepFrame::parse(frame.bytes).expect("a frame of a sweep"),
            payload: beacon_payload(frame.bytes).expect("a frame of a sweep"),
            outcome: frame.outcome,
        });
    }
}

fn run(setup: Setup, speakers: Vec<Speaker>) -> (Ended<Speaker>, OnAir) {
    let mut on_air = OnAir::default();
    let ended = network::run_watched(setup, speakers, &mut on_air);
    (ended, on_air)
}

/// Nodes at these places (m).
fn nodes(antennas: &str, places: &[[f64; 3]], seed: u64) -> Setup {
    let places: Vec<Position> = places.iter().copied().map(Position::from).collect();
    network::engine(&places, link(antennas), seed)
}

fn at_azimuth(range_m: f64, azimuth_deg: f64) -> [f64; 3] {
    let azimuth_rad = azimuth_deg.to_radians();
    [range_m * azimuth_rad.cos(), range_m * azimuth_rad.sin(), 0.0]
}

/// The number of slots between `ready` and a transmission that starts at `start` (ns).
#[track_caller]
fn slots(ready: u64, start: u64) -> u64 {
    let waited = start - ready - AIFS;
    assert_eq!((waited % SLOT, waited / SLOT <= 15), (0, true), "{waited} ns after AIFS");
    waited / SLOT
}

#[test]
fn a_broadcast_is_one_frame_from_each_sector_after_the_backoff_and_the_best_points_at_the_neighbour() {
    let payload: Vec<u8> = (0..20).collect();
    let sender = Speaker::default().and_broadcasts(1000, &payload);
    let (ended, on_air) = run(nodes(EIGHT, &[[0.0; 3], at_azimuth(2.0, 100.0)], 1), vec![sender, Speaker::default()]);
    let frames = on_air.of(0);
    let first = frames[0].start;
    slots(1_000_000, first);
    let expected: Vec<(u64, u64, u16)> =
        (0..8).zip((0..8).rev()).map(|(i, cdown)| (first + i * (BEACON + 1_000), BEACON, cdown)).collect();
    let cdown = |sent: &Sent| match sent.frame.body {
        SweepBody::Beacon { cdown, .. } => cdown,
        _ => panic!("{:?}", sent.frame),
    };
    let found: Vec<_> = frames.iter().map(|sent| (sent.start, sent.end - sent.start, cdown(sent))).collect();
    assert_eq!(found, expected);
    for sent in &frames {
        assert_eq!(u64::from(sent.frame.duration_us), (first + SWEEP - sent.end).div_ceil(1000));
        assert_eq!(sent.payload, payload);
    }
    // At 2 m, 10.88 dB above the sensitivity: sectors 2 and 3, 10 and 35 degrees off, lose 0.59 and 7.28 dB; others more.
    let heard = &ended.applications[1].heard;
    let instant = |sector: u64| first + sector * (BEACON + 1_000) + BEACON;
    assert_eq!(
        heard.iter().map(|heard| (heard.0, heard.2)).collect::<Vec<_>>(),
        [(instant(2), Some(2)), (instant(3), Some(3))]
    );
    let power_dbm = -60.0 + 20.0 * (7.0_f64 / 2.0).log10() - 3.01 * (2.0_f64 * 10.0 / 45.0).powi(2);
    let snr_db = heard[0].4.expect("an SNR").0;
    assert!((snr_db - (power_dbm + 71.5)).abs() < 0.01, "{snr_db} dB, not {}", power_dbm + 71.5);
    assert_eq!(ended.applications[1].payloads, [payload.clone(), payload]);
    assert_eq!(ended.applications[0].sectors, Some(8));
    // One packet, one delivery, one transmission of eight frames.
    let sent =
        Packets { offered: 1, sent: 1, received: 1, transmissions: 1, octets_received: 20, ..Packets::default() };
    assert_eq!(ended.networks[0].packets, [sent, Packets::default()]);
    assert_eq!(ended.networks[0].deliveries, [0, 1]);
    let [(end, report)] = ended.applications[0].reports[..] else { panic!("one report") };
    assert_eq!((end.as_nanos(), report.outcome, report.transmissions), (first + SWEEP, SendOutcome::Sent, 8));
}

#[test]
fn the_energy_of_a_broadcast_is_that_of_its_frames_its_gaps_and_the_rest_of_the_time() {
    let sender = Speaker::default().and_broadcasts(0, &[7; 20]);
    let (ended, on_air) = run(nodes(EIGHT, &[[0.0; 3]], 1), vec![sender]);
    let total_s = ended.end.as_secs_f64();
    let (tx_s, idle_s) = (8.0 * BEACON as f64 * 1e-9, 7.0e-6);
    let expected_j = 0.6 * tx_s + 0.05 * idle_s + 0.4 * (total_s - tx_s - idle_s);
    let found_j = ended.networks[0].energy[0].total_j();
    assert!((found_j - expected_j).abs() < 1e-12, "{found_j} J, not {expected_j}");
    assert!(ended.end.as_nanos() >= on_air.of(0)[7].end);
    // Nobody else is there.
    assert_eq!((ended.networks[0].packets[0].not_listened, ended.networks[0].packets[0].received), (1, 0));
}

#[test]
fn two_contending_broadcasters_both_get_through_unless_their_backoffs_are_equal() {
    let mut equal = 0;
    for seed in 0..40 {
        let speaker = || Speaker::default().and_broadcasts(1000, &[1; 20]);
        let places = [[0.0; 3], [0.2, 0.0, 0.0], [0.1, 0.1, 0.0]];
        let (ended, on_air) = run(nodes(EIGHT, &places, seed), vec![speaker(), speaker(), Speaker::default()]);
        let [first, second] = [0, 1].map(|station| (on_air.of(station)[0].start, on_air.of(station)[7].end));
        let received = [0, 1].map(|station| ended.networks[0].packets[station].received);
        if first.0 == second.0 {
            equal += 1;
            assert_eq!(received, [0, 0], "overlapping frames are lost");
            continue;
        }
        assert_eq!(received, [1, 1]);
        assert_eq!(ended.networks[0].deliveries, [1, 1, 2]);
        let (earlier, later) = (first.min(second), first.max(second));
        // The rest of the backoff counts after AIFS from the end of the time that the frames claim, a multiple of 1 us.
        assert!(later.0 >= earlier.1 + AIFS, "{first:?} {second:?}");
    }
    assert!((1..=6).contains(&equal), "{equal} of 40, not about 2.5");
}

#[test]
fn a_station_that_heard_one_frame_of_a_sweep_waits_for_its_end() {
    // At 5 m only sector 2 is heard. Its neighbour wants to broadcast at once, while the other frames point elsewhere.
    let sender = Speaker::default().and_broadcasts(1000, &[1; 20]);
    let replier = Speaker { reply: Some(vec![2; 20]), ..Speaker::default() };
    let (ended, on_air) = run(nodes(EIGHT, &[[0.0; 3], [0.0, 5.0, 0.0]], 1), vec![sender, replier]);
    let (first, reply) = (on_air.of(0), on_air.of(1));
    assert_eq!(ended.applications[1].heard.len(), 1);
    let claimed = first[2].end + 1000 * u64::from(first[2].frame.duration_us);
    assert!((0..1000).contains(&(claimed - first[7].end)));
    slots(claimed, reply[0].start);
    assert_eq!(ended.applications[0].best_sector(), Some(6));
}

#[test]
fn broadcasts_leave_in_order_and_one_more_than_the_queue_holds_is_refused() {
    let sender = (0..70).fold(Speaker::default(), |sender, number| sender.and_broadcasts(0, &[number]));
    let (ended, on_air) =
        run(nodes(OMNIDIRECTIONAL, &[[0.0; 3], [1.0, 0.0, 0.0]], 1), vec![sender, Speaker::default()]);
    let [sender, listener] = &ended.applications[..] else { panic!("two stations") };
    let taken = (0..65).map(|number| Ok(FrameId(number)));
    assert_eq!(sender.sent, taken.chain([Err(SendError::QueueFull(64)); 5]).collect::<Vec<_>>());
    assert_eq!(listener.payloads, (0..65).map(|number| vec![number]).collect::<Vec<_>>());
    assert!(listener.heard.iter().map(|heard| heard.3).eq(0..65));
    assert!(sender.reports.iter().map(|(_, report)| report.frame.0).eq(0..65));
    let expected = Packets {
        offered: 70,
        sent: 65,
        received: 65,
        lost_queue: 5,
        transmissions: 65,
        octets_received: 65,
        ..Packets::default()
    };
    assert_eq!(ended.networks[0].packets[0], expected);
    assert_eq!(on_air.0.len(), 65);
    // Without sectors there is nothing to name.
    assert_eq!((listener.heard[0].2, listener.sectors), (None, None));
}

#[test]
fn what_does_not_fit_in_a_beacon_is_refused() {
    let sender = Speaker::default()
        .and(0, Deed::Send(Destination::All, vec![1; 965]))
        .and(0, Deed::Send(Destination::Station(StationId(1)), vec![1]))
        .and(0, Deed::SendFiller(40))
        .and(0, Deed::Send(Destination::All, vec![9; 964]))
        .and(0, Deed::SendFiller(41))
        .and(0, Deed::SendFiller(255));
    let (ended, on_air) =
        run(nodes(OMNIDIRECTIONAL, &[[0.0; 3], [1.0, 0.0, 0.0]], 1), vec![sender, Speaker::default()]);
    let [sender, listener] = &ended.applications[..] else { panic!("two stations") };
    assert_eq!(
        sender.sent,
        [
            Err(SendError::Oversized { found: 965, allowed: 964 }),
            Err(SendError::BroadcastsOnly(StationId(1))),
            Err(SendError::Undersized { found: 40, allowed: 41 }),
            Ok(FrameId(0)),
            Ok(FrameId(1)),
            Ok(FrameId(2)),
        ]
    );
    assert!(on_air.of(0).iter().map(|sent| sent.frame.octets()).eq([1023, 41, 255]));
    // 8136 bits beyond the first codeword in 49 more: 16624 bits of 32 chips, and the preamble.
    assert_eq!(on_air.of(0)[0].end - on_air.of(0)[0].start, 306_545);
    assert!(listener.payloads[0].iter().all(|&octet| octet == 9));
    assert!(listener.payloads.iter().map(Vec::len).eq([964, 0, 214]));
    assert_eq!(ended.networks[0].packets[0].offered, 3, "what is refused is not offered");
}

#[test]
fn hidden_stations_collide_at_the_one_between_them() {
    let speaker = || Speaker::default().and_broadcasts(1000, &[1; 900]);
    let alone = |distance_m: f64| {
        let places = [[-distance_m, 0.0, 0.0], [distance_m, 0.0, 0.0], [0.0; 3]];
        let (ended, _) = run(nodes(OMNIDIRECTIONAL, &places, 3), vec![speaker(), speaker(), Speaker::default()]);
        let packets = &ended.networks[0].packets;
        (packets[0].lost_collision + packets[1].lost_collision, packets[0].received + packets[1].received)
    };
    // A frame takes much longer than the largest backoff. Stations 10 m apart do not hear each other, 6 m apart they do.
    assert_eq!(alone(5.0), (2, 0));
    assert_eq!(alone(3.0), (0, 2));
}

#[test]
fn deliveries_name_the_sector_among_those_of_all_rings() {
    // Five rings are three DMG antennas: two, two and one. The node is in the highest ring, on azimuth 0.
    let rings = "nodes.sectors = { azimuth_sectors = 4, elevations_deg = [-80, -40, 0, 40, 80], boresight_gain_dbi = 9 }\n\
                 robots.omnidirectional = {}\nnode_headings = 'aligned'";
    let sender = Speaker::default().and_broadcasts(0, &[1; 20]);
    let (ended, on_air) = run(nodes(rings, &[[0.0; 3], [1.0, 0.0, 2.0]], 1), vec![sender, Speaker::default()]);
    assert_eq!(ended.applications[1].best_sector(), Some(16));
    assert_eq!(ended.applications[1].sectors, Some(20));
    // 18 us where the antenna changes, 1 us elsewhere, and the first frame announces all of it.
    let frames = on_air.of(0);
    let gaps: Vec<u64> = frames.windows(2).map(|pair| pair[1].start - pair[0].end).collect();
    assert!((0..19).all(|i| gaps[i] == if i == 7 || i == 15 { 18_000 } else { 1_000 }), "{gaps:?}");
    let rest_ns = 19 * BEACON + 17 * 1_000 + 2 * 18_000;
    assert_eq!(frames[19].end - frames[0].end, rest_ns);
    assert_eq!(u64::from(frames[0].frame.duration_us), rest_ns.div_ceil(1000));
}

#[test]
fn a_node_that_answers_a_sweep_puts_its_broadcast_off() {
    let (mut robot_first, mut node_first) = (0, 0);
    for (seed, at_us) in (0..30).flat_map(|seed| [(seed, 900), (seed, 1000), (seed, 1100)]) {
        // So near that each hears the other from every sector.
        let mut setup = nodes(EIGHT, &[[0.2, 0.0, 0.0]], seed);
        setup.robots = network::own_robots([network::body("robot", Position::ORIGIN)]);
        let node = Speaker::default().and_broadcasts(at_us, &[5; 20]);
        let (ended, on_air) = run(setup, vec![node, Speaker::default().and(1000, Deed::Sweep)]);
        let [node, robot] = &ended.applications[..] else { panic!("two stations") };
        let [(_, answers)] = &robot.swept[..] else { panic!("one sweep: {:?}", robot.asked) };
        let beacons = on_air.beacons_of(0);
        if on_air.of(1)[0].start == beacons[0].start {
            continue;
        }
        assert!(!robot.payloads.is_empty() && node.reports.len() == 1, "seed {seed}");
        let answer: Vec<&Sent> =
            on_air.of(0).into_iter().filter(|sent| matches!(sent.frame.body, SweepBody::Rss { .. })).collect();
        assert_eq!(beacons.len(), 8);
        let sweep = on_air.of(1);
        if sweep[0].start < beacons[0].start {
            robot_first += 1;
            assert_eq!((answers.len(), answer.len()), (1, 8), "seed {seed}");
            // The answer is not interrupted, and the broadcast comes after it.
            assert_eq!(answer[7].end - answer[0].start, 126_272);
            slots(answer[7].end, beacons[0].start);
        } else {
            node_first += 1;
            // The robot waits for the end of the broadcast.
            assert!(sweep[0].start >= beacons[7].end + AIFS, "seed {seed}");
        }
        assert_eq!(ended.networks[0].packets.iter().map(|packets| packets.pending).sum::<u64>(), 0);
    }
    assert!(robot_first > 10 && node_first > 10, "{robot_first} and {node_first}");
}

#[test]
fn a_sweep_waits_for_the_broadcast_under_way_and_goes_before_those_in_the_queue() {
    let mut setup = nodes(EIGHT, &[[1.0, 0.0, 0.0]], 1);
    setup.robots = network::own_robots([network::body("robot", Position::ORIGIN)]);
    let robot = Speaker::default()
        .and_broadcasts(1000, &[1; 20])
        .and_broadcasts(1000, &[2; 20])
        .and(1000, Deed::Sweep)
        .and(1000, Deed::Sweep);
    let (ended, on_air) = run(setup, vec![Speaker::default(), robot]);
    let robot = &ended.applications[1];
    assert_eq!(robot.asked, [Ok(()), Err(SweepError::Busy)]);
    assert_eq!((robot.swept.len(), robot.swept[0].1.len(), robot.reports.len()), (1, 1, 2));
    let kinds: Vec<u8> = on_air
        .of(1)
        .iter()
        .map(|sent| match sent.frame.body {
            SweepBody::Iss { .. } => 0,
            _ => sent.payload[0],
        })
        .collect();
    assert_eq!(kinds, [[1; 8], [0; 8], [2; 8]].concat());
    let expected =
        Packets { offered: 3, sent: 3, received: 3, transmissions: 3, octets_received: 40, ..Packets::default() };
    assert_eq!(ended.networks[0].packets[1], expected);
    assert!(on_air.of(1).iter().any(|sent| sent.outcome == FrameOutcome::Received));
}

#[test]
fn the_delay_of_a_broadcast_to_a_sink_ends_with_its_first_frame_that_is_received() {
    // The sink is on the boresight of sector 2, where at 5 m it hears no other.
    let mut setup = nodes(EIGHT, &[[0.0; 3]], 1);
    setup.sinks = vec![Sink { name: "sink".into(), position: Position::new(0.0, 5.0, 0.0), networks: None }];
    let node = Speaker::default().and_broadcasts(1000, &[1; 20]);
    let (ended, on_air) = run(setup, vec![node, Speaker::default()]);
    let delay = Duration::from_nanos(on_air.of(0)[2].end - 1_000_000);
    let delays = &ended.networks[0].delays[0];
    assert_eq!((delays.count(), delays.mean_s()), (1, Some(delay.as_secs_f64())));
    assert_eq!(ended.networks[0].deliveries, [0, 1]);
}

#[test]
fn a_steered_antenna_broadcasts_at_each_of_its_tilts() {
    let steered = "nodes.omnidirectional = {}\n\
                   robots.sectors = { azimuth_sectors = 4, elevations_deg = [-60, 0, 60], vertical = 'steered', boresight_gain_dbi = 6 }";
    let mut setup = nodes(steered, &[[1.0, 0.0, 1.7]], 1);
    setup.robots = network::own_robots([network::body("robot", Position::ORIGIN)]);
    let robot = Speaker::default().and_broadcasts(0, &[1; 20]);
    let (ended, on_air) = run(setup, vec![Speaker::default(), robot]);
    assert_eq!(on_air.of(1).len(), 12);
    let [node, robot] = &ended.applications[..] else { panic!("two stations") };
    assert_eq!((node.best_sector(), robot.sectors), (Some(8), Some(12)));
    let [(_, report)] = robot.reports[..] else { panic!("one report") };
    assert_eq!((report.transmissions, ended.networks[0].deliveries[0]), (12, 1));
    // Each tilt contends anew.
    for tilt in [4, 8] {
        slots(on_air.of(1)[tilt - 1].end, on_air.of(1)[tilt].start);
    }
}
