//! Neighbour discovery over medium and channel access.

use std::collections::BTreeSet;

use sextant_channel::{BoxConfig, ChannelConfig, CorrelationConfig, NeighbourLog, Obstacle, ObstacleConfig};
use sextant_channel::{ObstacleField, Position, ShadowingConfig, ShapeConfig};
use sextant_kernel::{NodeId, Unwatched};
use sextant_sim::{
    Discovered, Discovery, DiscoveryConfig, OnceConfig, ReceptionConfig, ReceptionModel, Round, Setup, TrafficConfig,
    World, discover,
};

use crate::network;

fn setup(places: &[Position], sigma_db: f64, obstacles: Vec<Obstacle>, seed: u64) -> Setup {
    let query = OnceConfig { mpdu_octets: 20, at_s: 0.0, acknowledged: false, to: None };
    let channel = ChannelConfig {
        shadowing: Some(ShadowingConfig { sigma_db: Some(sigma_db), correlation: CorrelationConfig::PerPacket }),
        max_range_m: Some(10.0),
        ..ChannelConfig::default()
    };
    let setup = network::setup(places, -50.0, channel, TrafficConfig::Query(query), seed);
    let reception = ReceptionModel::try_from(ReceptionConfig::default()).expect("good settings");
    let setup = network::with(setup, |network| network::receive_by(network, reception));
    Setup { world: World { obstacles: ObstacleField::new(obstacles), ..setup.world }, ..setup }
}

fn grid(side: u32) -> Vec<Position> {
    (0..side * side).map(|i| Position::new(f64::from(i % side), f64::from(i / side), 0.0)).collect()
}

fn discovery(packets: u32, range_m: Option<f64>) -> Discovery {
    Discovery::try_from(DiscoveryConfig { packets, range_m, ..DiscoveryConfig::default() }).expect("good settings")
}

fn run(setup: &Setup, discovery: &Discovery, round: Round<'_>) -> Discovered {
    discover(setup, discovery, round, &Unwatched).expect("good settings")
}

fn pairs(log: &NeighbourLog) -> BTreeSet<(u32, u32)> {
    log.links().iter().map(|link| (link.listener.0, link.sender.0)).collect()
}

#[test]
fn without_shadowing_links_are_the_pairs_within_the_hop_radius() {
    let places = grid(6);
    let found = run(&setup(&places, 0.0, Vec::new(), 1), &discovery(20, Some(1.5)), Round::Neighbours);
    let near = |i: usize, j: usize| i != j && places[i].distance_m(places[j]) <= 1.5;
    let expected: BTreeSet<(u32, u32)> = (0..36_u32)
        .flat_map(|i| (0..36).map(move |j| (i, j)))
        .filter(|&(i, j)| near(i as usize, j as usize))
        .collect();
    assert_eq!(pairs(&found.log), expected);
    for link in found.log.links() {
        let distance_m = places[link.listener.index()].distance_m(places[link.sender.index()]);
        let expected_dbm = -50.0 - 27.0 * distance_m.log10();
        assert!((link.rssi_dbm.expect("measured") - expected_dbm).abs() < 1e-9);
        assert!(link.sent <= 20);
    }
    assert_eq!(found.sent + found.unsent, 36 * 20);
}

#[test]
fn two_nodes_alone_lose_only_overlaps_and_listen_all_the_time() {
    let places = [Position::ORIGIN, Position::new(3.0, 0.0, 0.0)];
    let found = run(&setup(&places, 0.0, Vec::new(), 2), &discovery(50, None), Round::Neighbours);
    assert_eq!(found.log.links().len(), 2);
    // Two packets of 0.8 ms with a backoff of at most 2.2 ms meet within a second with a probability of about 1 %.
    assert!(found.log.links().iter().all(|link| link.received >= 45 && link.sent == 50));
    // Two receivers at 56.4 mW, except during the time on air.
    let seconds = found.duration().as_secs_f64();
    assert!((found.energy.rx_j / (2.0 * seconds * 0.0564) - 1.0).abs() < 0.01, "{:?}", found.energy);
}

#[test]
fn only_the_senders_of_beacons_are_heard_and_beyond_the_hop_radius() {
    let places = grid(5);
    let anchors = [NodeId(0), NodeId(24)];
    let found = run(&setup(&places, 0.0, Vec::new(), 3), &discovery(10, Some(1.1)), Round::Beacons(&anchors));
    let senders: BTreeSet<NodeId> = found.log.links().iter().map(|link| link.sender).collect();
    assert_eq!(senders.into_iter().collect::<Vec<_>>(), anchors);
    // The whole grid is within 10 m of both.
    assert_eq!(found.log.links().len(), 2 * 24);
    assert_eq!(found.sent, 20);
}

#[test]
fn neighbours_behind_an_obstacle_do_not_hear_each_other() {
    let wall = Obstacle::try_from(ObstacleConfig::of(
        ShapeConfig::Box(BoxConfig::new(Position::new(1.5, 0.0, 0.0), [2.0, 4.0, 2.0])),
        "concrete",
    ))
    .expect("a box");
    let places = [Position::ORIGIN, Position::new(3.0, 0.0, 0.0), Position::new(0.0, 3.0, 0.0)];
    let found = run(&setup(&places, 0.0, vec![wall], 4), &discovery(10, None), Round::Neighbours);
    assert_eq!(pairs(&found.log), BTreeSet::from([(0, 2), (2, 0)]));
}

#[test]
fn the_mean_strength_of_many_packets_is_that_of_the_path_loss() {
    // At 2 m the median is 32 dB above the sensitivity, so no packet is too weak. Standard error of the mean of two
    // links of 400 packets: 9.6 dB / sqrt(800) = 0.34 dB; five of them: a false alarm in 1.7 million seeds.
    let places = [Position::ORIGIN, Position::new(2.0, 0.0, 0.0)];
    let found = run(&setup(&places, 9.6, Vec::new(), 5), &discovery(400, None), Round::Neighbours);
    let sum_dbm: f64 = found.log.links().iter().filter_map(|link| link.rssi_dbm).sum();
    let expected_dbm = -50.0 - 27.0 * 2.0_f64.log10();
    assert!((0.5 * sum_dbm - expected_dbm).abs() < 1.7, "{sum_dbm}");
}

#[test]
fn the_same_seed_gives_the_same_links_and_another_seed_different_ones() {
    let discovered = |seed| run(&setup(&grid(8), 9.6, Vec::new(), seed), &discovery(5, Some(3.0)), Round::Neighbours);
    let (first, again, other) = (discovered(6), discovered(6), discovered(7));
    assert_eq!(first.log, again.log);
    assert_eq!(first.end, again.end);
    assert_ne!(first.log, other.log);
}
