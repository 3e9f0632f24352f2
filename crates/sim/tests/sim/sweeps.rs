//! Sector sweeps over the air: exact instants of one answer, the sectors that nodes name, contention.

use std::time::Duration;

use sextant_channel::{
    AntennaConfig, ChannelConfig, Obstacle, ObstacleConfig, ObstacleField, OrientationConfig, Position, Reception,
};
use sextant_kernel::{Files, NodeId, Seed, StationId, Unwatched};
use sextant_mac::RadioStates;
use sextant_mac::dmg::{ContentionConfig, MacAddress, SweepBody, SweepConfig, SweepFrame};
use sextant_sim::{
    Antennas, AntennasConfig, DeathsConfig, DiscoveryConfig, DmgRadio, FaultsConfig, FrameOnAir, FrameOutcome,
    HeadingsConfig, Ieee80211ad, Network, Observer, ReceptionModel, RobotHeadingsConfig, Round, Setup, Simulation,
    Survey, Technology, TrafficPlan, Unobserved, World, discover,
};

use crate::network;

/// Nodes with `node_sectors` sectors and a robot with `robot_sectors` in one ring that sweeps `sweeps` times at the
/// origin. Without shadowing; 0 dBi at the boresights reach 7 m.
pub(crate) struct Scene {
    pub(crate) places: Vec<Position>,
    pub(crate) node_sectors: u8,
    pub(crate) robot_sectors: u8,
    pub(crate) sweeps: u32,
    pub(crate) contention: ContentionConfig,
    pub(crate) reception: ReceptionModel,
    pub(crate) seed: u64,
}

impl Scene {
    pub(crate) fn of(places: Vec<Position>) -> Self {
        let reception = ReceptionModel::SirThreshold { least: 2.0 };
        Self {
            places,
            node_sectors: 8,
            robot_sectors: 16,
            sweeps: 1,
            contention: ContentionConfig::Csma,
            reception,
            seed: 1,
        }
    }

    pub(crate) fn setup(&self) -> Setup {
        let sectors = |count: u8| -> AntennaConfig {
            let text = format!("sectors = {{ azimuth_sectors = {count}, boresight_gain_dbi = 0.0 }}");
            toml::from_str(&text).expect("an antenna")
        };
        let antennas = AntennasConfig {
            nodes: sectors(self.node_sectors),
            robots: sectors(self.robot_sectors),
            node_headings: HeadingsConfig::Random,
            robot_headings: RobotHeadingsConfig::Compass,
            robot_mount: OrientationConfig::default(),
            node_tilts_deg: vec![0.0],
            misalignment_loss: 0.0,
        };
        let network = Network::of(
            network::free_space().try_into().expect("a good channel"),
            self.technology(&antennas),
            RadioStates::mmwave_60_ghz(),
            TrafficPlan::silent(self.places.len()),
        );
        let mut robot = network::tour(vec![Position::ORIGIN], 0.1, Duration::from_millis(100));
        robot.body.sweeps_per_stop = self.sweeps;
        Setup {
            robots: vec![robot],
            ..Setup::of(World { nodes: network::nodes(&self.places), ..World::default() }, network, Seed(self.seed))
        }
    }

    /// Sector sweeps with these antennas.
    pub(crate) fn technology(&self, antennas: &AntennasConfig) -> Technology {
        let sweep = SweepConfig { contention: self.contention, ..SweepConfig::default() };
        let radio =
            sextant_sim::RadioConfig { sensitivity_dbm: -60.0, ..network::radio(-60.0 + 20.0 * libm::log10(7.0)) };
        let radio = DmgRadio::try_from(radio).expect("good levels");
        let antennas = Antennas::read(antennas, &Files::default()).expect("good antennas");
        let sweep = sweep.try_into().expect("good settings");
        let links = Ieee80211ad::new(radio, self.reception, sweep, antennas).expect("sectors that fit");
        Technology::Ieee80211ad(Box::new(links))
    }

    fn run(&self, observer: &mut impl Observer) -> Survey {
        Simulation::new(self.setup()).expect("a good setup").run(observer)
    }
}

/// A frame: start and end (ns), and what it says.
pub(crate) type Sent = (u64, u64, StationId, SweepFrame, FrameOutcome);

#[derive(Default)]
pub(crate) struct OnAir(pub(crate) Vec<Sent>);

impl Observer for OnAir {
    fn wants_frames(&self) -> bool {
        true
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        let read = SweepFrame::parse(frame.bytes).expect("a frame of a sweep");
        let end = frame.start + frame.airtime;
        self.0.push((frame.start.as_nanos(), end.as_nanos(), frame.source, read, frame.outcome));
    }
}

pub(crate) fn receptions(survey: &Survey, node: u32) -> Vec<Reception> {
    survey.log().of(NodeId(node)).to_vec()
}

#[test]
fn a_lone_node_answers_after_its_backoff_with_the_sector_that_points_at_it() {
    let azimuth_rad = 100.0_f64.to_radians();
    let place = Position::new(4.0 * azimuth_rad.cos(), 4.0 * azimuth_rad.sin(), 0.0);
    let mut on_air = OnAir::default();
    let survey = Scene::of(vec![place]).run(&mut on_air);
    let (iss, rss): (Vec<&Sent>, Vec<&Sent>) =
        on_air.0.iter().partition(|(_, _, _, frame, _)| matches!(frame.body, SweepBody::Iss { .. }));
    assert_eq!((iss.len(), rss.len()), (16, 8));
    // 16 frames of 14 909 ns, 1 us apart.
    assert_eq!(iss[15].1 - iss[0].0, 253_544);
    // MBIFS, AIFS and whole slots after the end of the sweep.
    let waited = rss[0].0 - iss[15].1 - 9_000 - 18_000;
    assert_eq!((waited % 5_000, waited / 5_000 <= 15), (0, true), "{waited} ns");
    assert_eq!(rss[7].1 - rss[0].0, 126_272);
    assert_eq!(rss[0].3.to, MacAddress::of(StationId(1)));
    // 100 degrees is in the sector from 78.75 to 101.25 degrees.
    let [Reception { received: 1, sent: 1, sector: Some(4), snr_db: Some(snr_db), rssi_dbm: Some(_), .. }] =
        receptions(&survey, 0)[..]
    else {
        panic!("{:?}", receptions(&survey, 0))
    };
    // The power at 4 m, 10 degrees off the boresight of a beam of 22.5 degrees, over a noise of -71.5 dBm.
    let power_dbm = -60.0 + 20.0 * (7.0_f64 / 4.0).log10() - 3.01 * (2.0_f64 * 10.0 / 22.5).powi(2);
    assert!((snr_db - (power_dbm + 71.5)).abs() <= 0.13, "{snr_db} dB, not {}", power_dbm + 71.5);
    assert_eq!(survey.networks[0].packets[0].received, 1);
    assert!(survey.log().sectors().is_some_and(|table| table.len() == 16));
}

#[test]
fn every_sweep_of_a_stop_is_answered_by_a_lone_node() {
    let scene = Scene { sweeps: 7, ..Scene::of(vec![Position::new(3.0, 0.0, 0.0)]) };
    let survey = scene.run(&mut Unobserved);
    let [Reception { received: 7, sent: 7, sector: Some(0), .. }] = receptions(&survey, 0)[..] else {
        panic!("{:?}", receptions(&survey, 0))
    };
    assert_eq!((survey.log().stops().len(), survey.networks[0].packets[1].sent), (1, 7));
    // The stop lasts as long as it should.
    assert_eq!(survey.end.as_nanos(), 100_000_000);
}

#[test]
fn nodes_beyond_the_reach_of_every_sector_do_not_answer() {
    // On a boresight and on an edge between two sectors, where 3 dB are missing: a factor of 0.707 in distance.
    let at = |range_m: f64, azimuth_deg: f64| {
        Position::new(range_m * azimuth_deg.to_radians().cos(), range_m * azimuth_deg.to_radians().sin(), 0.0)
    };
    let heard = |place| {
        let scene = Scene { node_sectors: 1, ..Scene::of(vec![place]) };
        let survey = scene.run(&mut Unobserved);
        survey.networks[0].packets[0].offered
    };
    assert_eq!([heard(at(6.99, 45.0)), heard(at(7.01, 45.0))], [1, 0]);
    assert_eq!([heard(at(4.93, 56.25)), heard(at(4.97, 56.25))], [1, 0]);
}

#[test]
fn contention_of_nodes_that_hear_each_other_loses_only_equal_backoffs() {
    // Overlapping frames are lost, and two of all nodes collide only if they draw the same of 16 slots.
    let (rounds, nodes) = (400, 4);
    let places: Vec<Position> = (0..nodes).map(|i| Position::new(0.2, 0.05 * f64::from(i), 0.0)).collect();
    let mut received = 0;
    for seed in 0..rounds {
        let reception = ReceptionModel::Overlap;
        let scene = Scene { reception, node_sectors: 1, seed, ..Scene::of(places.clone()) };
        let survey = scene.run(&mut Unobserved);
        received += survey.networks[0].packets[..4].iter().map(|packets| packets.received).sum::<u64>();
        assert!(survey.networks[0].packets[..4].iter().all(|packets| packets.offered == 1 && packets.pending == 0));
    }
    let share = received as f64 / (rounds as f64 * f64::from(nodes));
    let expected = (15.0_f64 / 16.0).powi(3);
    // Four standard errors; the nodes of a round are not independent, so of whole rounds.
    assert!((share - expected).abs() < 4.0 * (expected * (1.0 - expected) / rounds as f64).sqrt(), "{share}");
}

#[test]
fn the_same_scene_gives_the_same_survey() {
    let places: Vec<Position> =
        (0..30).map(|i| Position::new(1.0 + 0.15 * f64::from(i), 0.3 * f64::from(i % 7), 0.0)).collect();
    let scene = Scene { sweeps: 3, ..Scene::of(places) };
    let (first, second) = (scene.run(&mut Unobserved), scene.run(&mut OnAir::default()));
    assert_eq!(first.log(), second.log());
    assert_eq!(first.packets, second.packets);
    assert!(first.packets.received > 30, "{:?}", first.packets);
}

#[test]
fn nodes_discover_each_other_by_sweeps_of_which_the_best_frame_counts() {
    let scene =
        Scene { node_sectors: 64, ..Scene::of([0.0, 3.0, 30.0].map(|x_m| Position::new(x_m, 1.0, 0.0)).into()) };
    let discovery = DiscoveryConfig { packets: 5, ..DiscoveryConfig::default() }.try_into().expect("good settings");
    let found = discover(&scene.setup(), &discovery, Round::Neighbours, &Unwatched).expect("a discovery");
    let pairs: Vec<(u32, u32, u32, u32)> =
        found.log.links().iter().map(|link| (link.listener.0, link.sender.0, link.received, link.sent)).collect();
    assert_eq!((found.sent, pairs), (15, vec![(0, 1, 5, 5), (1, 0, 5, 5)]));
    // The best sector points at most half its half-power width aside, which takes 3 dB.
    let power_dbm = -60.0 + 20.0 * (7.0_f64 / 3.0).log10();
    for link in found.log.links() {
        let loss_db = power_dbm - link.rssi_dbm.expect("it was measured");
        assert!((-1e-9..3.011).contains(&loss_db), "{loss_db} dB");
    }
}

#[test]
fn behind_a_screen_the_best_sector_points_at_the_wall_that_reflects() {
    let scene = Scene::of(vec![Position::new(2.0, 0.0, 0.0)]);
    let obstacle = |name: &str, center_m: Position, size_m: [f64; 3]| {
        let text = format!(
            "name = '{name}'\nmaterial = 'metal'\nshape.box = {{ center_m = [{}, {}, 0], size_m = {size_m:?} }}",
            center_m.x_m, center_m.y_m
        );
        let config: ObstacleConfig = toml::from_str(&text).expect("an obstacle");
        Obstacle::try_from(config).expect("a good obstacle")
    };
    let screen = obstacle("screen", Position::new(1.0, 0.0, 0.0), [0.2, 0.6, 3.0]);
    let wall = obstacle("wall", Position::new(1.0, 1.5, 0.0), [20.0, 1.0, 3.0]);
    let sector = |obstacles: Vec<Obstacle>| {
        let mut setup = scene.setup();
        setup.world.obstacles = ObstacleField::new(obstacles);
        let channel: ChannelConfig = toml::from_str(
            "path_loss.log_distance.exponent = 2.0\nreflections.loss_db = 1.0\nshadowing.sigma_db = 0.0",
        )
        .expect("a channel");
        setup.networks[0].channel = channel.try_into().expect("a good channel");
        let survey = Simulation::new(setup).expect("a good setup").run(&mut Unobserved);
        receptions(&survey, 0).first().map(|reception| reception.sector)
    };
    // Straight on; nothing behind the screen; by the wall, at 45 degrees.
    assert_eq!(sector(vec![wall.clone()]), Some(Some(0)));
    assert_eq!(sector(vec![screen.clone()]), None);
    assert_eq!(sector(vec![screen, wall]), Some(Some(2)));
}

#[test]
fn a_sector_of_any_ring_of_an_array_has_its_number_in_the_log() {
    // Five rings are three DMG antennas: two, two and one. The node is in the highest ring, on azimuth 0.
    let scene = Scene::of(vec![Position::new(1.0, 0.0, 2.0)]);
    let mut setup = scene.setup();
    let antennas: AntennasConfig = toml::from_str(
        "nodes.omnidirectional = {}\n\
         robots.sectors = { azimuth_sectors = 4, elevations_deg = [-80, -40, 0, 40, 80], boresight_gain_dbi = 9 }",
    )
    .expect("antennas");
    setup.networks[0].technology = scene.technology(&antennas);
    let survey = Simulation::new(setup).expect("a good setup").run(&mut Unobserved);
    assert_eq!(receptions(&survey, 0).first().map(|reception| reception.sector), Some(Some(16)));
}

/// The survey of four sweeps, 25 ms apart, of one node that dies at `at_s`, and what was on air.
fn dying(at_s: f64) -> (Survey, OnAir) {
    let scene = Scene { sweeps: 4, ..Scene::of(vec![Position::new(3.0, 0.0, 0.0)]) };
    let mut setup = scene.setup();
    let deaths = DeathsConfig { share: Some(1.0), names: None, from_s: at_s, to_s: at_s };
    let faults = FaultsConfig { deaths: Some(deaths), ..FaultsConfig::default() };
    setup.faults = faults.build(&setup.world.nodes, Seed(1)).expect("good faults");
    let mut on_air = OnAir::default();
    let survey = Simulation::new(setup).expect("a good setup").run(&mut on_air);
    (survey, on_air)
}

#[test]
fn a_dead_node_answers_no_sweep() {
    let (survey, _) = dying(0.06);
    let [reception] = receptions(&survey, 0)[..] else { panic!("one stop") };
    assert_eq!((reception.received, reception.sent), (3, 4));
    assert_eq!(survey.deaths.len(), 1);
    // It draws nothing in the last 40 ms.
    let spent = survey.networks[0].energy[0];
    assert!(spent.sleep_j == 0.0 && spent.rx_j > 0.0, "{spent:?}");
}

#[test]
fn the_frame_of_an_answer_that_is_on_air_when_the_node_dies_is_its_last() {
    let of_node = |on_air: &OnAir| -> Vec<(u64, u64)> {
        on_air.0.iter().filter(|sent| sent.2 == StationId(0)).map(|&(start, end, ..)| (start, end)).collect()
    };
    let alive = of_node(&dying(1.0).1);
    assert_eq!(alive.len(), 4 * 8);
    let (start, end) = alive[10];
    let (survey, on_air) = dying((start + (end - start) / 2) as f64 * 1e-9);
    assert_eq!(of_node(&on_air), alive[..11]);
    // A frame of it was received, so that it counts so.
    let p = survey.packets;
    assert_eq!((p.offered, p.received, p.died, p.pending), (2, 2, 0, 0));
}

#[test]
fn the_answer_of_a_raised_antenna_is_heard_with_its_gain_in_that_direction() {
    // The robot stands 0.7 m above the node, 2 m away.
    let place = Position::new(2.0, 0.0, -0.7);
    let rssi_dbm = |tilt_deg: f64| {
        let scene = Scene::of(vec![place]);
        let mut setup = scene.setup();
        let text = format!(
            "nodes.sectors = {{ azimuth_sectors = 8, vertical_width_deg = 40, pattern.elliptical = {{}} }}\n\
             robots.sectors = {{ azimuth_sectors = 16, boresight_gain_dbi = 0.0 }}\n\
             node_headings = \"aligned\"\nnode_tilts_deg = [{tilt_deg}]"
        );
        let technology = scene.technology(&toml::from_str(&text).expect("antennas"));
        let antenna = technology.antennas().expect("sectors").nodes().clone();
        setup.networks[0].technology = technology;
        let survey = Simulation::new(setup).expect("a good setup").run(&mut Unobserved);
        let length = place.distance_m(Position::ORIGIN);
        let direction = Position::new(-2.0 / length, 0.0, 0.7 / length);
        let gain_dbi = antenna.gain(antenna.best_sector(direction), direction).0;
        (receptions(&survey, 0)[0].rssi_dbm.expect("a power"), gain_dbi)
    };
    let ((level_dbm, level_dbi), (raised_dbm, raised_dbi)) = (rssi_dbm(0.0), rssi_dbm(20.0));
    assert!(raised_dbi > level_dbi + 1.0, "{raised_dbi} and {level_dbi} dBi");
    assert!((raised_dbm - level_dbm - (raised_dbi - level_dbi)).abs() < 1e-9, "{raised_dbm} and {level_dbm} dBm");
}
