//! Complete surveys: counts of packets, hidden nodes, obstacles, blocked robots, reproducibility.

use std::time::Duration;

use sextant_channel::{
    BoxConfig, ChannelConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig, Stop,
};
use sextant_kernel::{Files, NodeId, SimTime};
use sextant_sim::{
    Ending, NetworkId, Observer, OnceConfig, PeriodicConfig, Progress, ReceptionModel, Robot, Setup, Simulation,
    Survey, TrafficConfig, Unobserved,
};

use crate::network;
use crate::on_air::Frames;

/// A robot that listens at each of `places`.
fn tour(places: Vec<Position>, listen: Duration) -> Robot {
    network::tour(places, 0.25, listen)
}

fn setup(places: &[Position], robot: Robot, seed: u64) -> Setup {
    let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 0.5, 0.1));
    let setup = network::setup(places, -50.0, network::suburb(10.0), traffic, seed);
    let setup =
        network::with(setup, |network| network::receive_by(network, ReceptionModel::SinrThreshold { least: 2.0 }));
    Setup { robots: vec![robot], ..setup }
}

fn field_of(count: i32) -> Vec<Position> {
    (0..count * count).map(|i| Position::new(f64::from(i % count), f64::from(i / count), 0.0)).collect()
}

fn survey(seed: u64) -> Survey {
    let stops = (0..12).map(|i| Position::new(f64::from(i), 0.5 * f64::from(i), 0.0)).collect();
    Simulation::new(setup(&field_of(12), tour(stops, Duration::from_secs(1)), seed))
        .expect("good settings")
        .run(&mut Unobserved)
}

#[test]
fn every_packet_is_counted_once() {
    for model in [ReceptionModel::Overlap, ReceptionModel::SinrThreshold { least: 2.0 }, ReceptionModel::Ber] {
        let stops = (0..12).map(|i| Position::new(f64::from(i), 0.5 * f64::from(i), 0.0)).collect();
        let robot = tour(stops, Duration::from_secs(1));
        let setup = network::with(setup(&field_of(12), robot, 5), |network| network::receive_by(network, model));
        let survey = Simulation::new(setup).unwrap().run(&mut Unobserved);
        let p = survey.packets;
        assert_eq!(network::ended(&p), p.offered, "{p:?}");
        assert!(p.received > 0 && p.lost_collision > 0 && p.lost_signal > 0 && p.not_listened > 0, "{p:?}");
        let heard: u64 = survey.robots[0].packets.iter().map(|&packets| u64::from(packets)).sum();
        assert_eq!(heard, p.received);
    }
}

#[test]
fn the_same_seed_gives_the_same_survey_and_another_seed_a_different_one() {
    let (first, again, other) = (survey(1), survey(1), survey(2));
    assert_eq!(first.log(), again.log());
    assert_eq!((first.packets, first.events, first.end), (again.packets, again.events, again.end));
    assert_ne!(first.log(), other.log());
}

#[test]
fn hidden_nodes_collide_at_the_rate_that_their_backoffs_imply() {
    // Of two hidden nodes that contend at once with 8 backoff slots each, the frames of 20 octets (832 us) overlap if
    // the slots differ by at most 2: (8 + 14 + 12) of 64; those of 45 octets (1632 us) by at most 5: 58 of 64.
    for (mpdu_octets, overlap) in [(20, 34.0 / 64.0), (45, 58.0 / 64.0)] {
        const ROUNDS: u32 = 4000;
        let mut collided = 0;
        for seed in 0..ROUNDS {
            let places = [Position::new(-8.0, 0.0, 0.0), Position::new(8.0, 0.0, 0.0)];
            let robot = tour(vec![Position::ORIGIN], Duration::from_millis(100));
            let query = OnceConfig { mpdu_octets, at_s: 0.0, acknowledged: false, to: None };
            let channel = ChannelConfig { max_range_m: Some(10.0), ..ChannelConfig::default() };
            let traffic = TrafficConfig::Query(query);
            let survey = Simulation::new(Setup {
                robots: vec![robot],
                ..network::setup(&places, -20.0, channel, traffic, seed.into())
            })
            .unwrap()
            .run(&mut Unobserved);
            collided += u32::from(survey.packets.lost_collision == 2);
        }
        let share = f64::from(collided) / f64::from(ROUNDS);
        // Five standard errors: a false alarm in 1.7 million.
        let allowed = 5.0 * (overlap * (1.0 - overlap) / f64::from(ROUNDS)).sqrt();
        assert!((share - overlap).abs() < allowed, "{mpdu_octets} octets: {share}, not {overlap}");
    }
}

#[test]
fn a_block_of_concrete_silences_the_node_behind_it() {
    let block = ObstacleConfig {
        name: Some("block".into()),
        ..ObstacleConfig::of(
            ShapeConfig::Box(BoxConfig::new(Position::new(0.0, 3.0, 0.0), [4.0, 2.0, 4.0])),
            "concrete",
        )
    };
    let places = [Position::new(0.0, 5.0, 0.0), Position::new(0.0, -5.0, 0.0)];
    let robot = tour(vec![Position::new(0.0, 0.1, 0.0)], Duration::from_secs(60));
    let mut setup = setup(&places, robot, 1);
    setup.world.obstacles = ObstacleField::new(vec![Obstacle::read(block, &Files::default()).expect("a good block")]);
    let survey = Simulation::new(setup).unwrap().run(&mut Unobserved);
    let [behind, free] = survey.robots[0].packets[..] else { panic!("two nodes") };
    // 40 dB more loss: the mean is 19.6 dB below the sensitivity, 2 of its standard deviations of 9.6 dB.
    assert!(free > 100 && behind < 10, "{free} and {behind} packets of 120");
}

#[test]
fn a_robot_stops_in_front_of_an_obstacle_and_reports_the_contact() {
    let wall = ObstacleConfig::absorbing(
        ShapeConfig::Box(BoxConfig::new(Position::new(5.0, 0.0, 0.0), [2.0, 8.0, 4.0])),
        1.0,
    );
    let robot = tour(vec![Position::new(9.0, 0.0, 0.0)], Duration::from_secs(1));
    let mut setup = setup(&[Position::new(1.0, 1.0, 0.0)], robot, 1);
    setup.world.obstacles = ObstacleField::new(vec![Obstacle::read(wall, &Files::default()).expect("a good wall")]);
    let survey = Simulation::new(setup).unwrap().run(&mut Unobserved);
    let [contact] = survey.log().contacts() else { panic!("one contact, not {:?}", survey.log().contacts()) };
    assert!(contact.position.distance_m(Position::new(4.0, 0.0, 0.0)) < 1e-6, "{contact:?}");
    let [stop] = survey.log().stops() else { panic!("one stop") };
    assert!((stop.position.x_m - 3.75).abs() < 2e-3, "{stop:?}");
    assert!((survey.robots[0].path_length_m - 3.75).abs() < 2e-3);
    assert_eq!(survey.robots[0].ending, Some(Ending::Complete));
}

/// Ends the simulation at the third stop.
struct Impatient(Vec<SimTime>);

impl Observer for Impatient {
    fn stopped(
        &mut self,
        _network: NetworkId,
        index: u32,
        _stop: &Stop,
        end: SimTime,
        heard: sextant_channel::HeardAtStop<'_>,
    ) {
        assert!(heard.receptions.iter().all(|reception| reception.stop == index));
        self.0.push(end);
    }

    fn goes_on(&mut self, progress: Progress) -> bool {
        progress.stops < 3
    }
}

#[test]
fn an_observer_can_end_a_simulation_and_the_log_is_kept() {
    let stops = (0..12).map(|i| Position::new(f64::from(i), 0.0, 0.0)).collect();
    let mut observer = Impatient(Vec::new());
    let robot = tour(stops, Duration::from_secs(1));
    let survey = Simulation::new(setup(&field_of(4), robot, 1)).unwrap().run(&mut observer);
    assert!(survey.interrupted);
    assert_eq!(survey.log().stops().len(), 3);
    // Stops at 0, 1 and 2 m, one second of listening each and one of driving between them.
    assert_eq!(observer.0, [1, 3, 5].map(|s| SimTime::ZERO + Duration::from_secs(s)));
    assert_eq!(survey.robots[0].ending, None);
}

/// Two robots that listen at the same time; the second starts later by `late`.
fn two_tours(late: Duration, listen: Duration) -> [Robot; 2] {
    let stops = |y_m: f64| (1..9).map(|i| Position::new(f64::from(i), y_m, 0.0)).collect::<Vec<_>>();
    let mut second = tour(stops(6.0), listen);
    second.body.name = "second".into();
    second.body.start = Position::new(-late.as_secs_f64(), 6.0, 0.0);
    [tour(stops(1.0), Duration::from_secs(1)), second]
}

#[test]
fn a_second_robot_does_not_change_what_the_first_hears() {
    let [first, _] = two_tours(Duration::ZERO, Duration::from_secs(1));
    let alone = Simulation::new(setup(&field_of(9), first, 4)).unwrap().run(&mut Unobserved);
    // At the same times as the first, half a slot later, and with slots of another length.
    for (late_ms, listen_ms) in [(0, 1000), (500, 1000), (300, 1700)] {
        let [first, second] = two_tours(Duration::from_millis(late_ms), Duration::from_millis(listen_ms));
        let mut setup = setup(&field_of(9), first, 4);
        setup.robots.push(second);
        let both = Simulation::new(setup).unwrap().run(&mut Unobserved);
        assert_eq!(both.robots[0], alone.robots[0]);
        assert_eq!(both.log().stops().len(), 16);
        let of_first: Vec<u32> =
            (0..16).filter(|&stop| both.log().stops()[stop as usize].position.y_m < 2.0).collect();
        let receptions = |survey: &Survey, stops: &[u32]| -> Vec<_> {
            let at = |stop: u32| stops.iter().position(|&other| other == stop);
            let log = survey.log().receptions().iter();
            let mut found: Vec<_> =
                log.filter_map(|r| Some((at(r.stop)?, r.node, r.received, r.sent, r.rssi_dbm))).collect();
            found.sort_by_key(|&(stop, node, ..)| (stop, node));
            found
        };
        let all: Vec<u32> = (0..8).collect();
        assert_eq!(receptions(&both, &of_first), receptions(&alone, &all));
        // The log is the union: each stop belongs to one robot, at the place where it listened.
        let heard: u64 = both.robots.iter().flat_map(|robot| &robot.packets).map(|&n| u64::from(n)).sum();
        assert!(heard >= both.log().receptions().len() as u64 && both.robots[1].packets.iter().sum::<u32>() > 0);
        for reception in both.log().receptions().iter() {
            let stop = both.log().stops()[reception.stop as usize].position;
            let node = Position::new(f64::from(reception.node.0 % 9), f64::from(reception.node.0 / 9), 0.0);
            assert!(stop.distance_m(node) <= 10.0);
            // At most five packets, 0.4 s apart, in a slot of 1.7 s.
            assert!(1 <= reception.received && reception.received <= reception.sent && reception.sent <= 5);
        }
        let length_m: f64 = both.robots.iter().map(|robot| robot.path_length_m).sum();
        let late = late_ms as f64 / 1000.0;
        assert!((length_m - (alone.robots[0].path_length_m + 8.0 + late)).abs() < 1e-9, "{length_m}");
        let last = both.robots.iter().filter_map(|robot| robot.end).max();
        assert_eq!(last, Some(both.end));
    }
}

#[test]
fn several_robots_are_rejected_if_nodes_send_to_one() {
    let [first, second] = two_tours(Duration::ZERO, Duration::from_secs(1));
    let mut setup = setup(&field_of(2), first, 1);
    setup.robots.push(second);
    let query = OnceConfig { mpdu_octets: 20, at_s: 0.0, acknowledged: true, to: None };
    setup.networks[0].traffic = network::plan(TrafficConfig::Query(query), 4);
    assert_eq!(Simulation::new(setup).err().expect("refused").key, "robots");
}

#[test]
fn a_reception_counts_the_packets_received_and_those_sent_from_the_first_to_the_last_of_them() {
    let listen = Duration::from_secs(6);
    let places = (0..4).map(|i| Position::new(2.0 * f64::from(i), 1.0, 0.0)).collect();
    let mut setup = setup(&field_of(3), tour(places, listen), 9);
    // Shadowing takes about one packet in six at the longest distances.
    network::ieee802154(&mut setup.networks[0]).radio = network::radios(network::radio(-65.0));
    // Its source, its end, and whether the robot received it.
    let mut air =
        Frames::kept(|frame| (NodeId(frame.source.0), frame.start + frame.airtime, !frame.heard.is_empty()));
    let survey = Simulation::new(setup).unwrap().run(&mut air);
    assert_eq!(survey.packets.lost_channel_access, 0, "each sequence number was on air");
    let mut with_gaps = 0;
    for reception in &survey.log().receptions() {
        let from = survey.log().stops()[reception.stop as usize].time;
        let of_slot =
            air.0.iter().filter(|(source, end, _)| *source == reception.node && *end > from && *end <= from + listen);
        let heard: Vec<bool> = of_slot.map(|&(_, _, heard)| heard).collect();
        let first = heard.iter().position(|&heard| heard).expect("a packet was received");
        let last = heard.iter().rposition(|&heard| heard).expect("a packet was received");
        let received = heard.iter().filter(|&&heard| heard).count();
        assert_eq!((reception.received as usize, reception.sent as usize), (received, last - first + 1));
        with_gaps += usize::from(reception.received < reception.sent);
    }
    assert!(with_gaps > 5, "{with_gaps}");
}
