//! Maps that are computed in the nodes, over simulated links.

use std::sync::Arc;

use sextant_apps::distributed::{
    BearingSource, Category, DistributedMapping, DistributedMappingConfig, MappingNode, MappingRecord, MappingRole,
    MobileAnchor, NodeAntenna, PatternBearings, Patterns,
};
use sextant_apps::{Surroundings, WaypointsConfig};
use sextant_channel::{AntennaConfig, ChannelConfig, ObstacleField, Position};
use sextant_kernel::{Files, Seed};
use sextant_mac::RadioStates;
use sextant_mac::csma::CsmaSettings;
use sextant_mac::dmg::SweepConfig;
use sextant_mapper::BearingTable;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Antennas, AntennasConfig, Applications, DmgRadio, Ieee80211ad, Ieee802154, Mac, Network, NetworkId, Observer,
    PacketTrace, Radio, ReceptionModel, Robot, RobotBody, RobotConfig, RobotTask, Setup, Simulation, Technology,
    TrafficPlan, Unobserved, World,
};

/// Reach of the radios (m).
const REACH_M: f64 = 7.0;
const HEIGHT_M: f64 = 1.0;

/// Nodes in the plane on a lattice of 2 m, moved a little; each `anchor_every`th is an anchor.
struct Scene {
    side: usize,
    anchor_every: usize,
    /// Whether the nodes have eight sectors, or radios of IEEE 802.15.4.
    has_sectors: bool,
    /// Nodes far away from all others, none of them an anchor.
    island: usize,
    /// Each so manyth anchor believes to be 5 m north of its place; none if 0.
    liar_every: usize,
    /// Stops of a mobile anchor.
    mobile: Vec<Position>,
    /// Pattern of the sectors.
    pattern: &'static str,
    settings: String,
    seed: u64,
}

impl Scene {
    fn new(settings: &str) -> Self {
        let settings = format!(
            "range_m = {REACH_M}\nplace.grid_step_m = 0.25\n\
             place.profile.trapezoid = {{ p0 = 0.95, plateau_m = 5.0, range_m = {REACH_M} }}\n{settings}"
        );
        Self {
            side: 8,
            anchor_every: 5,
            has_sectors: true,
            island: 0,
            liar_every: 0,
            mobile: Vec::new(),
            pattern: "flat_top",
            settings,
            seed: 1,
        }
    }

    fn places(&self) -> Vec<Position> {
        let seed = Seed(self.seed);
        let purpose = sextant_kernel::Purpose::new(1000);
        let place = |i: usize| {
            let jitter = |axis: u64| 0.8 * (seed.uniform(purpose, [i as u64, axis, 0]) - 0.5);
            let (column, row) = ((i % self.side) as f64, (i / self.side) as f64);
            Position::new(2.0 * column + jitter(0), 2.0 * row + jitter(1), HEIGHT_M)
        };
        let island = (0..self.island).map(|i| Position::new(100.0 + i as f64, 0.0, HEIGHT_M));
        (0..self.side * self.side).map(place).chain(island).collect()
    }

    fn antennas(&self) -> Antennas {
        let antenna: AntennaConfig = toml::from_str(&format!(
            "sectors = {{ azimuth_sectors = 8, boresight_gain_dbi = 0.0, pattern.{} = {{}} }}",
            self.pattern
        ))
        .expect("an antenna");
        let text = "nodes.omnidirectional = {}\nrobots.omnidirectional = {}";
        let config =
            AntennasConfig { nodes: antenna.clone(), robots: antenna, ..toml::from_str(text).expect("antennas") };
        Antennas::read(&config, &Files::default()).expect("good antennas")
    }

    fn technology(&self) -> Technology {
        // Free space, with the loss of 1 m in the power of the transmitter.
        let power_dbm = -60.0 + 20.0 * libm::log10(REACH_M);
        let text = format!("tx_power_dbm = {power_dbm}\nsensitivity_dbm = -60.0");
        let radio: sextant_sim::RadioConfig = toml::from_str(&text).expect("a radio");
        if self.has_sectors {
            let radio = DmgRadio::try_from(radio).expect("good levels");
            let sweep = SweepConfig::default().try_into().expect("good settings");
            let reception = ReceptionModel::SirThreshold { least: 2.0 };
            let links = Ieee80211ad::new(radio, reception, sweep, self.antennas()).expect("sectors that fit");
            Technology::Ieee80211ad(Box::new(links))
        } else {
            Technology::Ieee802154(Ieee802154 {
                radio: Radio::try_from(radio).expect("good levels").with_reception(ReceptionModel::Overlap),
                mac: Mac::CsmaUnslotted(CsmaSettings::default().with_receiver_on()),
            })
        }
    }

    fn run(&self, observer: &mut impl Observer) -> Vec<MappingRecord> {
        let config: DistributedMappingConfig = toml::from_str(&self.settings).expect("settings");
        let settings = Arc::new(DistributedMapping::try_from(&config).expect("good settings"));
        let places = self.places();
        let node = |(i, &position): (usize, &Position)| PlacedNode { name: format!("n{i}"), position };
        let channel: ChannelConfig =
            toml::from_str("path_loss.log_distance = { exponent = 2.0 }").expect("a channel");
        let network = Network::of(
            channel.try_into().expect("a good channel"),
            self.technology(),
            RadioStates::mmwave_60_ghz(),
            TrafficPlan::silent(places.len()),
        );
        let setup = Setup {
            robots: self.robot(&settings).into_iter().collect(),
            ..Setup::of(
                World { nodes: places.iter().enumerate().map(node).collect(), ..World::default() },
                network,
                Seed(self.seed),
            )
        };
        let antenna =
            self.has_sectors.then_some(NodeAntenna { sectors: 8, vertical_width_rad: std::f64::consts::PI });
        let patterns = match settings.bearings() {
            BearingSource::BestSector => Patterns::default(),
            BearingSource::Pattern(PatternBearings { error_db }) => {
                let table = BearingTable::new(self.antennas().nodes(), 8, error_db);
                Patterns { nodes: Some(Arc::new(table)), robots: None }
            }
        };
        let node = |(i, &place): (usize, &Position)| {
            let believed = if self.lies(i) { place + Position::new(0.0, 5.0, 0.0) } else { place };
            let anchor = (i % self.anchor_every == 0 && i < self.side * self.side).then_some(believed);
            MappingNode::new(Arc::clone(&settings), NetworkId(0), antenna, patterns.clone(), anchor)
        };
        let nodes = Applications::of_nodes(places.iter().enumerate().map(node).collect());
        let (_, own) = Simulation::with(setup, nodes).expect("a good setup").run_own(observer);
        own.nodes.into_iter().map(MappingNode::into_record).collect()
    }

    fn robot(&self, settings: &Arc<DistributedMapping>) -> Option<Robot> {
        let &start = self.mobile.first()?;
        let config = RobotConfig {
            start_m: start,
            listen_s: 0.01,
            ..toml::from_str("name = \"mobile\"\nstart_m = [0.0, 0.0]\ncontroller = 0").expect("a robot")
        };
        let _: &RobotConfig<u8> = &config;
        let body = RobotBody::try_from(&config).expect("a body");
        let waypoints: WaypointsConfig = toml::from_str(&format!(
            "places_m = {:?}",
            self.mobile.iter().map(|place| [place.x_m, place.y_m, place.z_m]).collect::<Vec<_>>()
        ))
        .expect("a path");
        let obstacles = ObstacleField::default();
        let surroundings =
            Surroundings { obstacles: &obstacles, start, radius_m: body.radius_m, seed: Seed(1), robot: 0 };
        let controller = sextant_apps::ControllerConfig::Waypoints(waypoints).build(&surroundings).expect("a path");
        let antennas = self.antennas();
        let sectors = self.has_sectors.then_some((antennas.robot_sectors(), 8));
        let broadcast = MobileAnchor::new(Arc::clone(settings), sectors);
        let task = RobotTask::MobileAnchor { controller, broadcast: Box::new(broadcast) };
        Some(Robot { body, task })
    }

    fn lies(&self, node: usize) -> bool {
        self.liar_every > 0
            && node.is_multiple_of(self.anchor_every)
            && (node / self.anchor_every) % self.liar_every == 1
    }

    /// Mean error of the nodes that are no initial anchors (m).
    fn mean_error_m(&self, records: &[MappingRecord]) -> f64 {
        let errors: Vec<f64> = (records.iter().zip(self.places()))
            .filter(|(record, _)| record.role != MappingRole::InitialAnchor)
            .filter_map(|(record, place)| Some(record.place?.distance_m(place)))
            .collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }

    /// Mean distance of nodes that are no anchors from the centroid of the anchors in their reach (m).
    fn centroid_error_m(&self) -> f64 {
        let places = self.places();
        let error_m = |(i, place): (usize, &Position)| {
            let near = places.iter().step_by(self.anchor_every).filter(|anchor| anchor.distance_m(*place) < REACH_M);
            let (count, sum) =
                near.fold((0.0, Position::ORIGIN), |(count, sum), &anchor| (count + 1.0, sum + anchor));
            (i % self.anchor_every != 0).then(|| (sum * (1.0 / count)).distance_m(*place))
        };
        let errors: Vec<f64> = places.iter().enumerate().filter_map(error_m).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }
}

#[test]
fn nodes_place_themselves_by_the_sectors_of_anchors() {
    let scene = Scene::new("");
    let records = scene.run(&mut Unobserved);
    assert!(records.iter().all(|record| record.place.is_some()));
    let error_m = scene.mean_error_m(&records);
    let centroid_m = scene.centroid_error_m();
    assert!(error_m < 0.6 * centroid_m, "{error_m} m, centroids {centroid_m} m");
    // The true directions of all antennas, which no node knows.
    let headings = scene.antennas().node_headings_rad(Seed(1), records.len());
    for (record, heading_rad) in records.iter().zip(headings) {
        if record.role == MappingRole::InitialAnchor {
            let found = record.directions.expect("each anchor has neighbours that are anchors");
            let off_rad = (found.azimuth_rad - heading_rad).rem_euclid(std::f64::consts::TAU);
            let off_rad = off_rad.min(std::f64::consts::TAU - off_rad);
            assert!(off_rad <= found.half_width_rad + 1e-6, "{off_rad} rad, {found:?}");
        }
    }
    assert!(records.iter().any(|record| matches!(record.role, MappingRole::NewAnchor { .. })));
    assert!(records.iter().all(|record| record.frames_unread == 0 && record.unsent == 0));
}

#[test]
fn without_sectors_distances_alone_place_the_nodes_roughly() {
    let scene = Scene { has_sectors: false, ..Scene::new("window_s = 4.0") };
    let records = scene.run(&mut Unobserved);
    let error_m = scene.mean_error_m(&records);
    let with_sectors = Scene::new("");
    let better_m = with_sectors.mean_error_m(&with_sectors.run(&mut Unobserved));
    assert!(
        error_m < 1.2 * scene.centroid_error_m() && better_m < 0.6 * error_m,
        "{error_m} m, with sectors {better_m} m"
    );
    assert!(records.iter().all(|record| record.messages.place + record.messages.report == 0));
}

#[test]
fn anchors_that_a_node_has_not_heard_tell_where_it_is_not() {
    // Without sectors all that a node knows is who is in reach.
    let settings = "window_s = 10.0\nplace.estimate = \"posterior_mean\"\nplace.silence = ";
    let error_m = |silence: &str| {
        let scene = Scene {
            side: 10,
            anchor_every: 4,
            has_sectors: false,
            ..Scene::new(&format!("{settings}\"{silence}\""))
        };
        scene.mean_error_m(&scene.run(&mut Unobserved))
    };
    let (ignored_m, missed_m) = (error_m("ignored"), error_m("missed"));
    assert!(missed_m < 0.8 * ignored_m, "{ignored_m} m, {missed_m} m with those not heard");
}

#[test]
fn a_mobile_anchor_helps() {
    let fixed = Scene { anchor_every: 11, ..Scene::new("") };
    let stops = (0..12).map(|i| Position::new(1.3 * f64::from(i), 15.0 - 1.2 * f64::from(i), HEIGHT_M)).collect();
    let hybrid = Scene { anchor_every: 11, mobile: stops, ..Scene::new("mobile_phase_s = 30.0") };
    let (without, with) = (fixed.run(&mut Unobserved), hybrid.run(&mut Unobserved));
    let (without_m, with_m) = (fixed.mean_error_m(&without), hybrid.mean_error_m(&with));
    assert!(with_m < 0.8 * without_m, "{without_m} m, with a mobile anchor {with_m} m");
    assert!(with.iter().all(|record| record.mobile_stops_heard <= 12));
    assert!(with.iter().filter(|record| record.mobile_stops_heard > 0).count() > 32);
    assert!(without.iter().all(|record| record.mobile_stops_heard == 0));
}

#[test]
fn scattering_is_what_the_coordinates_say() {
    // In this small scene all coordinates arrive, so that the neighbours of a node are those in its reach.
    let scene = Scene { side: 5, anchor_every: 4, ..Scene::new("max_iterations = 1\nrepeats = 3") };
    let records = scene.run(&mut Unobserved);
    let places = scene.places();
    for (i, record) in records.iter().enumerate().filter(|(_, record)| record.role != MappingRole::InitialAnchor) {
        let near: Vec<usize> =
            (0..places.len()).filter(|&j| j != i && places[i].distance_m(places[j]) < REACH_M).collect();
        let own = record.place.expect("placed");
        let scattered = near.iter().filter(|&&j| records[j].place.expect("placed").distance_m(own) > REACH_M).count();
        let share = scattered as f64 / near.len() as f64;
        assert_eq!((record.scattering.neighbours, record.scattering.scattered), (near.len(), scattered));
        let category = match share {
            share if share <= 0.1 => Category::NewAnchor,
            share if share <= 0.2 => Category::Good,
            _ => Category::Bad,
        };
        assert_eq!(record.category, category, "{share}");
    }
}

#[test]
fn posterior_means_with_weights_are_better_than_the_literal_estimates() {
    let improved = "directions = \"intervals\"\nexchange = \"posterior\"\nrecompute = \"all\"\n\
                    place.estimate = \"posterior_mean\"\nplace.model = \"soft\"";
    let mean = |settings: &str| {
        let error_m = |seed| {
            let scene = Scene { seed, anchor_every: 9, ..Scene::new(settings) };
            scene.mean_error_m(&scene.run(&mut Unobserved))
        };
        (1..=4).map(error_m).sum::<f64>() / 4.0
    };
    let (literal_m, improved_m) = (mean("directions = \"circular_mean\""), mean(improved));
    assert!(improved_m < 0.9 * literal_m, "{literal_m} m, improved {improved_m} m");
}

#[test]
fn strengths_of_all_sectors_tell_directions_and_places_better_than_the_best_sector() {
    let improved = "directions = \"intervals\"\nexchange = \"posterior\"\nrecompute = \"all\"\n\
                    place.estimate = \"posterior_mean\"\nplace.model = \"soft\"";
    let mean = |settings: &str| {
        let of_seed = |seed| {
            let scene = Scene {
                seed,
                anchor_every: 9,
                pattern: "ieee802153c",
                ..Scene::new(&format!("{improved}\n{settings}"))
            };
            let records = scene.run(&mut Unobserved);
            let found = records.iter().filter_map(|record| record.directions);
            let sigma_deg: Vec<f64> = found.map(|found| found.azimuth_sigma_rad().to_degrees()).collect();
            (scene.mean_error_m(&records), sigma_deg.iter().sum::<f64>() / sigma_deg.len() as f64)
        };
        let all: Vec<(f64, f64)> = (1..=4).map(of_seed).collect();
        (all.iter().map(|of| of.0).sum::<f64>() / 4.0, all.iter().map(|of| of.1).sum::<f64>() / 4.0)
    };
    let ((by_sector_m, by_sector_deg), (by_strengths_m, by_strengths_deg)) =
        (mean("bearings = \"best_sector\""), mean("bearings.pattern.error_db = 1"));
    assert!(by_strengths_m < 0.8 * by_sector_m, "{by_sector_m} m, by strengths {by_strengths_m} m");
    assert!(by_strengths_deg < 0.9 * by_sector_deg, "{by_sector_deg} degrees, by strengths {by_strengths_deg}");
}

#[test]
fn nodes_that_know_their_places_best_become_anchors_first() {
    let settings = "exchange = \"posterior\"\nrecompute = \"all\"\nnew_anchor_sigma_m = 0.35\n\
                    place.estimate = \"posterior_mean\"\nplace.model = \"soft\"\nplace.silence = \"missed\"";
    let records = Scene { anchor_every: 9, ..Scene::new(settings) }.run(&mut Unobserved);
    let mut iterations = Vec::new();
    for record in &records {
        let MappingRole::NewAnchor { iteration } = record.role else { continue };
        let covariance = record.estimate.as_ref().and_then(|estimate| estimate.covariance).expect("a posterior mean");
        let sigma_m = (0..3).map(|axis| covariance[axis][axis].sqrt()).fold(0.0, f64::max);
        assert!(sigma_m <= 0.35 * f64::from(iteration).sqrt() + 1e-6, "{sigma_m} m in iteration {iteration}");
        iterations.push(iteration);
    }
    iterations.sort_unstable();
    iterations.dedup();
    assert!(iterations.len() > 2, "{iterations:?}");
}

#[test]
fn anchors_at_wrong_places_find_out_and_give_them_up() {
    let settings = "directions = \"intervals\"\nplace.estimate = \"posterior_mean\"\nplace.model = \"soft\"";
    let scene =
        |doubt| Scene { anchor_every: 3, liar_every: 5, ..Scene::new(&format!("{settings}\ndoubt_below = {doubt}")) };
    let (trusting, doubting) = (scene(0.0), scene(0.75));
    let (with_trust, with_doubt) = (trusting.run(&mut Unobserved), doubting.run(&mut Unobserved));
    assert!(with_trust.iter().all(|record| !record.gave_up));
    let gave_up = with_doubt.iter().enumerate().filter(|(_, record)| record.gave_up).map(|(i, _)| i);
    let (liars, honest): (Vec<usize>, Vec<usize>) = gave_up.partition(|&node| doubting.lies(node));
    assert!(liars.len() >= 3 && honest.len() <= 1, "{liars:?} and {honest:?} gave up");
    for &liar in &liars {
        let place = with_doubt[liar].place.expect("it hears other anchors");
        assert!(place.distance_m(doubting.places()[liar]) < 2.5, "{place:?}");
    }
    let (trust_m, doubt_m) = (trusting.mean_error_m(&with_trust), doubting.mean_error_m(&with_doubt));
    assert!(doubt_m < 0.9 * trust_m, "{trust_m} m, with doubt {doubt_m} m");
}

/// Counts the packets of each node that were on air.
struct OnAir(Vec<u64>);

impl Observer for OnAir {
    fn traced(&mut self, packet: &PacketTrace) {
        self.0[packet.source.index()] += u64::from(!packet.transmissions.is_empty());
    }

    fn wants_packets(&self) -> bool {
        true
    }
}

/// When the last node becomes an anchor, all is over, and what the new anchors have made is not sent.
#[test]
fn messages_that_never_go_out_do_not_count() {
    for (has_sectors, repeats) in [(true, 1), (true, 3), (false, 1)] {
        let settings = format!("window_s = 4.0\nmax_iterations = 1\nrepeats = {repeats}");
        let scene = Scene { side: 5, anchor_every: 4, has_sectors, ..Scene::new(&settings) };
        let mut on_air = OnAir(vec![0; 25]);
        let records = scene.run(&mut on_air);
        let is_new = |record: &&MappingRecord| matches!(record.role, MappingRole::NewAnchor { .. });
        assert!(records.iter().any(|record| is_new(&record)));
        if has_sectors {
            // Each of them has made a PLACE.
            assert!(records.iter().filter(is_new).all(|record| record.messages.place == 0));
        }
        for (record, &sent) in records.iter().zip(&on_air.0) {
            assert_eq!(record.sent, sent);
            assert_eq!(record.messages.total() * repeats, sent, "{:?}", record.messages);
        }
    }
}

#[test]
fn nodes_that_hear_no_anchor_are_not_placed_and_say_so() {
    let scene = Scene { side: 4, island: 5, ..Scene::new("max_iterations = 2") };
    let records = scene.run(&mut Unobserved);
    let (near, far) = records.split_at(16);
    assert!(near.iter().all(|record| record.place.is_some()));
    for record in far {
        assert_eq!((record.place, record.category, record.anchors_heard), (None, Category::Bad, 0));
        assert_eq!(record.messages.total(), 0);
    }
}

#[test]
fn the_same_seed_gives_the_same_records() {
    let scene = Scene { side: 5, ..Scene::new("") };
    assert_eq!(scene.run(&mut Unobserved), scene.run(&mut Unobserved));
    let other = Scene { seed: 2, side: 5, ..Scene::new("") };
    assert_ne!(scene.run(&mut Unobserved), other.run(&mut Unobserved));
}
