//! Searches for targets, over simulated links.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_apps::MissionTeam;
use sextant_apps::navigation::{MapFrame, NavigationMap};
use sextant_apps::target_search::{
    Doubt, MessageCounts, RobotSearchRecord, SearchRecord, SearchStation, TargetSearch,
};
use sextant_channel::{ChannelConfig, Position};
use sextant_kernel::{Files, NodeId, Purpose, Seed, SimTime, StationId};
use sextant_mac::RadioStates;
use sextant_mac::csma::CsmaSettings;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Estimate, Ieee802154, Mac, Network, NetworkId, Observer, Radio, RadioConfig, ReceptionModel, Robot, RobotBody,
    RobotConfig, RobotTask, Sensors, SensorsConfig, Setup, Simulation, Sink, TargetConfig, TargetId, Technology,
    TrafficPlan, World, WorldConfig,
};

/// Nodes on a lattice of 1 m, each moved a little, and a sink at the corner.
struct Scene {
    columns: usize,
    rows: usize,
    /// Reach of the radios (m).
    reach_m: f64,
    obstacles: &'static str,
    targets: Vec<&'static str>,
    robots: Vec<&'static str>,
    settings: &'static str,
    /// What sensors do wrong.
    errors: &'static str,
    is_pseudo_gradient: bool,
    /// The places of nodes on the map, from their true ones.
    map: fn(Position) -> Position,
    frame: MapFrame,
    seconds: u64,
    seed: u64,
}

/// What became of a search.
struct Outcome {
    robots: Vec<RobotSearchRecord>,
    nodes: MessageCounts,
    sinks: MessageCounts,
    captured: BTreeMap<TargetId, (usize, SimTime)>,
    /// Predicted places.
    predicted: Vec<(SimTime, Position)>,
}

#[derive(Default)]
struct Watch {
    captured: BTreeMap<TargetId, (usize, SimTime)>,
    predicted: Vec<(SimTime, Position)>,
}

impl Observer for Watch {
    fn captured(&mut self, robot: usize, target: TargetId, time: SimTime) {
        assert!(self.captured.insert(target, (robot, time)).is_none(), "a target is captured once");
    }

    fn estimated(&mut self, _station: StationId, time: SimTime, estimate: &Estimate) {
        if let Estimate::TargetPlace { place, .. } = *estimate {
            self.predicted.push((time, place));
        }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            columns: 20,
            rows: 16,
            reach_m: 6.0,
            obstacles: "",
            targets: vec!["places_m = [[0.0, 12.0], [19.0, 12.0]]\nspeed_m_per_s = 0.8"],
            robots: vec!["start_m = [18.0, 1.0]\nspeed_m_per_s = 1.5"],
            settings: "start_delay_s = 3.0",
            errors: "",
            is_pseudo_gradient: false,
            map: |place| place,
            frame: MapFrame::Robot,
            seconds: 60,
            seed: 1,
        }
    }
}

impl Scene {
    fn world(&self) -> World {
        let text = format!(
            "nodes.lattice = {{ spacing_m = 1.0, region.rectangle = {{ min_m = [0.0, 0.0], max_m = [1.0, 1.0] }} }}\n{}",
            self.obstacles
        );
        let config: WorldConfig = toml::from_str(&text).expect("a world");
        let obstacles = config.build(Seed(1), &Files::default()).expect("a good world").obstacles;
        let seed = Seed(self.seed);
        let jitter = |node: usize, axis| 0.4 * (seed.uniform(Purpose::new(1001), [node as u64, axis, 0]) - 0.5);
        let place = |node: usize| {
            let (column, row) = ((node % self.columns) as f64, (node / self.columns) as f64);
            Position::new(column + jitter(node, 0), row + jitter(node, 1), 0.0)
        };
        let places = (0..self.columns * self.rows).map(place).filter(|&place| obstacles.fault(place).is_none());
        let nodes = places.enumerate().map(|(i, position)| PlacedNode { name: format!("n{i}"), position }).collect();
        let target = |(i, text): (usize, &&str)| {
            let config: TargetConfig =
                toml::from_str(&format!("name = \"t{i}\"\n[motion.waypoints]\n{text}")).expect("a target");
            config.build(i as u64, &obstacles, Seed(1)).expect("a good target")
        };
        let targets = self.targets.iter().enumerate().map(target).collect();
        let sensors: SensorsConfig =
            toml::from_str(&format!("[targets]\nradius_m = 1.5\n{}", self.errors)).expect("sensors");
        let sensors = Sensors::try_from(sensors).expect("good sensors");
        World { nodes, obstacles, targets, fields: Vec::new(), sensors, ..World::default() }
    }

    fn run(&self) -> Outcome {
        let world = self.world();
        // Free space, with the loss of 1 m in the power of the transmitter.
        let power_dbm = -90.0 + 20.0 * libm::log10(self.reach_m);
        let radio: RadioConfig =
            toml::from_str(&format!("tx_power_dbm = {power_dbm}\nsensitivity_dbm = -90.0")).expect("a radio");
        let radio = Radio::try_from(radio).expect("good levels").with_reception(ReceptionModel::Overlap);
        let search = if self.is_pseudo_gradient {
            TargetSearch::pseudo_gradient(&toml::from_str(self.settings).expect("settings"), &radio)
        } else {
            let places = world.nodes.iter().map(|node| node.position);
            let doubt = world.sensors.targets.and_then(|sensor| Doubt::new(&sensor, places));
            TargetSearch::detarsk(&toml::from_str(self.settings).expect("settings"))
                .and_then(|search| search.among(doubt))
        };
        let search = Arc::new(search.expect("good settings"));
        let channel: ChannelConfig =
            toml::from_str("path_loss.log_distance = { exponent = 2.0 }").expect("a channel");
        let network = Network::of(
            channel.try_into().expect("a good channel"),
            Technology::Ieee802154(Ieee802154 {
                radio: radio.clone(),
                mac: Mac::CsmaUnslotted(CsmaSettings::default().with_receiver_on()),
            }),
            RadioStates::cc2420(),
            TrafficPlan::silent(world.nodes.len()),
        );
        let body = |(i, text): (usize, &&str)| {
            let config: RobotConfig<u8> = toml::from_str(&format!("name = \"r{i}\"\ncontroller = 0\n{text}"))
                .unwrap_or_else(|error| panic!("a robot: {error}"));
            RobotBody::try_from(&config).expect("a good robot")
        };
        let bodies: Vec<_> = self.robots.iter().enumerate().map(body).collect();
        let places = world.nodes.iter().map(|node| Some((self.map)(node.position))).collect();
        let map = Arc::new(NavigationMap::new(places, self.frame).expect("a map"));
        let duration = Duration::from_secs(self.seconds);
        let own = search.stations(
            &map,
            MissionTeam {
                nodes: world.nodes.len(),
                robots: &bodies,
                sinks: 1,
                targets: world.targets.len(),
                network: NetworkId(0),
                radio: Some(&radio),
                duration,
            },
        );
        let robot = |body| Robot { body, task: RobotTask::Own };
        let setup = Setup {
            robots: bodies.into_iter().map(robot).collect(),
            sinks: vec![Sink { name: "sink".into(), position: Position::new(-0.5, -0.5, 0.0), networks: None }],
            duration: Some(duration),
            ..Setup::of(world, network, Seed(self.seed))
        };
        let mut watch = Watch::default();
        let (_, own) = Simulation::with(setup, own).expect("a good setup").run_own(&mut watch);
        let (mut robots, mut nodes, mut sinks) = (Vec::new(), MessageCounts::default(), MessageCounts::default());
        let stations = own.nodes.into_iter().chain(own.robots).chain(own.sinks);
        for record in stations.map(SearchStation::into_record) {
            match record {
                SearchRecord::Node(node) => nodes += node.sent,
                SearchRecord::Robot(robot) => robots.push(*robot),
                SearchRecord::Sink(sent) => sinks += sent,
            }
        }
        Outcome { robots, nodes, sinks, captured: watch.captured, predicted: watch.predicted }
    }
}

/// Where the only target of the default scene is.
fn target_at(time: SimTime) -> Position {
    Position::new((0.8 * time.as_secs_f64()).min(19.0), 12.0, 0.0)
}

#[test]
fn a_robot_predicts_and_captures_a_target_that_goes_straight() {
    let outcome = Scene::default().run();
    let &(_, time) = &outcome.captured[&TargetId(0)];
    // It starts 3 s after the first detection, 20 m away, and they approach each other.
    assert!((8.0..25.0).contains(&time.as_secs_f64()), "captured after {time}");
    let [robot] = outcome.robots.as_slice() else { panic!("one robot") };
    assert_eq!(robot.captured, [(TargetId(0), time)]);
    // Once it hears the nodes around the target, it knows the way.
    let late = outcome.predicted.iter().filter(|(at, _)| time.saturating_since(*at) < Duration::from_secs(3));
    for &(at, place) in late {
        assert!(place.distance_m(target_at(at)) < 2.0, "{place:?} at {at}");
    }
}

#[test]
fn the_first_detection_reaches_the_sink_hop_by_hop_and_the_robot_from_there() {
    let outcome = Scene::default().run();
    // The entry is 12.5 m away from the sink, which is more than two hops of 6 m.
    assert!(outcome.nodes.detections >= 3, "{:?}", outcome.nodes);
    assert!(outcome.sinks.alarms >= 1 && outcome.nodes.alarms >= 3, "{:?} {:?}", outcome.sinks, outcome.nodes);
    let [robot] = outcome.robots.as_slice() else { panic!("one robot") };
    let alarmed = robot.alarmed.expect("the robot is alarmed").as_secs_f64();
    assert!((0.5..3.0).contains(&alarmed), "alarmed after {alarmed} s");
    let first = robot.steps.first().expect("the robot decides");
    assert!(robot.started.expect("it starts").as_secs_f64() >= 3.0);
    assert!(first.predicted.distance_m(Position::new(0.3, 12.0, 0.0)) < 2.5, "the alarm says where: {first:?}");
}

#[test]
fn false_alarms_mislead_a_search_that_trusts_them_and_not_one_that_doubts() {
    // Mean error of the predictions of five searches (m), and how many captured the target.
    let searches = |settings| {
        let outcomes = (1..=5).map(|seed| {
            Scene { settings, errors: "false_alarms_per_h = 60.0\nmiss_probability = 0.2", seed, ..Scene::default() }
                .run()
        });
        let (mut errors_m, mut captured) = (Vec::new(), 0);
        for outcome in outcomes {
            captured += outcome.captured.len();
            errors_m.extend(outcome.predicted.iter().map(|&(at, place)| place.distance_m(target_at(at))));
        }
        (errors_m.iter().sum::<f64>() / errors_m.len() as f64, captured)
    };
    let (doubted_m, captured) = searches("start_delay_s = 3.0");
    let (trusted_m, _) = searches("start_delay_s = 3.0\ndetections = \"trusted\"");
    assert_eq!(captured, 5);
    assert!(doubted_m < 0.5 * trusted_m, "{doubted_m} m and {trusted_m} m");
}

#[test]
fn robots_that_patrol_share_the_map_and_capture_what_no_node_detects() {
    // Four lanes go along each half of the map; each target stands on one.
    let scene = |before| Scene {
        targets: vec![
            "places_m = [[5.9, 8.0]]\nspeed_m_per_s = 0.5",
            "places_m = [[13.3, 8.0]]\nspeed_m_per_s = 0.5",
        ],
        robots: vec!["start_m = [8.0, 1.0]\nspeed_m_per_s = 1.5", "start_m = [11.0, 1.0]\nspeed_m_per_s = 1.5"],
        errors: "miss_probability = 0.9999999",
        settings: before,
        seconds: 180,
        ..Scene::default()
    };
    let captured = scene("before_detection = \"patrol\"").run().captured;
    let by: Vec<usize> = captured.values().map(|&(robot, _)| robot).collect();
    assert_eq!(by, [0, 1], "{captured:?}");
    assert!(scene("").run().captured.is_empty());
}

#[test]
fn a_fast_robot_captures_what_it_drives_past() {
    // A lane goes 0.3 m past each target, and in 0.1 s the robot drives 4 m: twice the way within reach.
    let scene = Scene {
        targets: vec![
            "places_m = [[5.9, 3.0]]\nspeed_m_per_s = 0.5",
            "places_m = [[5.9, 5.0]]\nspeed_m_per_s = 0.5",
            "places_m = [[5.9, 7.5]]\nspeed_m_per_s = 0.5",
            "places_m = [[5.9, 9.5]]\nspeed_m_per_s = 0.5",
        ],
        robots: vec!["start_m = [8.0, 1.0]\nspeed_m_per_s = 40.0", "start_m = [11.0, 1.0]\nspeed_m_per_s = 40.0"],
        errors: "miss_probability = 0.9999999",
        settings: "before_detection = \"patrol\"",
        seconds: 60,
        ..Scene::default()
    };
    assert_eq!(scene.run().captured.len(), 4);
}

#[test]
fn a_map_that_is_turned_mirrored_and_scaled_will_do() {
    // Its unit is 4 m.
    let map = |place: Position| Position::new(0.25 * place.y_m + 3.0, 0.25 * place.x_m - 7.0, 0.0);
    let outcome = Scene { map, frame: MapFrame::Unknown, seconds: 120, ..Scene::default() }.run();
    assert_eq!(outcome.captured.len(), 1);
}

#[test]
fn a_robot_outside_the_network_drives_there_before_it_hears_of_a_target() {
    let robots = vec!["start_m = [19.0, -12.0]\nspeed_m_per_s = 1.5"];
    let outcome = Scene { robots, ..Scene::default() }.run();
    assert_eq!(outcome.captured.len(), 1);
}

#[test]
fn a_robot_finds_its_way_out_of_a_bay_unless_it_is_greedy() {
    // The robot stands in a bay that opens away from the target.
    let obstacles = "
        [[obstacles]]
        shape.box = { center_m = [9.0, 9.0, 0.0], size_m = [6.0, 0.4, 2.0] }
        material = \"metal\"
        [[obstacles]]
        shape.box = { center_m = [6.0, 7.0, 0.0], size_m = [0.4, 4.4, 2.0] }
        material = \"metal\"
        [[obstacles]]
        shape.box = { center_m = [12.0, 7.0, 0.0], size_m = [0.4, 4.4, 2.0] }
        material = \"metal\"";
    let scene = |settings| Scene {
        obstacles,
        targets: vec!["places_m = [[9.0, 14.0]]\nspeed_m_per_s = 1.0"],
        robots: vec!["start_m = [9.0, 7.5]\nspeed_m_per_s = 1.5"],
        settings,
        ..Scene::default()
    };
    let captured = scene("start_delay_s = 3.0").run().captured;
    assert_eq!(captured.len(), 1, "the way round is about 20 m long");
    assert!(scene("start_delay_s = 3.0\npath = \"greedy\"").run().captured.is_empty());
}

#[test]
fn two_robots_share_two_targets() {
    let outcome = Scene {
        targets: vec![
            "places_m = [[0.0, 13.0], [9.0, 13.0]]\nspeed_m_per_s = 0.5",
            "places_m = [[19.0, 13.0], [10.0, 13.0]]\nspeed_m_per_s = 0.5",
        ],
        robots: vec!["start_m = [16.0, 1.0]\nspeed_m_per_s = 1.5", "start_m = [3.0, 1.0]\nspeed_m_per_s = 1.5"],
        ..Scene::default()
    }
    .run();
    let by = |target| outcome.captured[&TargetId(target)].0;
    assert_eq!([by(0), by(1)], [1, 0], "each captures the one on its side");
    assert!(outcome.nodes.claims > 0, "nodes pass on what the robots tell each other");
}

#[test]
fn a_robot_follows_the_pseudo_gradient_to_a_slow_target() {
    let outcome = Scene {
        targets: vec!["places_m = [[0.0, 12.0], [10.0, 12.0]]\nspeed_m_per_s = 0.3"],
        is_pseudo_gradient: true,
        ..Scene::default()
    }
    .run();
    assert_eq!(outcome.captured.len(), 1);
    let rounds = outcome.captured[&TargetId(0)].1.as_secs_f64() / 2.0;
    // Each node speaks once in each round.
    let most = 320.0 * (rounds + 1.0);
    let sent = outcome.nodes.gradients as f64;
    assert!(sent > 0.5 * most && sent <= most, "{sent} messages in {rounds} rounds");
}

/// The places (m) and times (s) of the decisions of the only robot.
fn decisions(outcome: &Outcome) -> Vec<(Position, f64)> {
    let [robot] = outcome.robots.as_slice() else { panic!("one robot") };
    robot.steps.iter().map(|step| (step.place, step.time.as_secs_f64())).collect()
}

#[test]
fn a_discrete_robot_goes_in_whole_steps_in_eight_directions_and_captures_at_their_ends() {
    let settings = "preset = \"thesis\"\nown_place = \"fused\"\nstart_delay_s = 3.0";
    let outcome = Scene { settings, ..Scene::default() }.run();
    let decisions = decisions(&outcome);
    for pair in decisions.windows(2) {
        let step = pair[1].0 - pair[0].0;
        // Its place is known to a few centimetres.
        let eighths = libm::atan2(step.y_m, step.x_m) / std::f64::consts::FRAC_PI_4;
        assert!((step.length_m() - 1.5).abs() < 0.05, "a step of {step}");
        assert!((eighths - libm::round(eighths)).abs() < 0.05, "a step of {step}");
    }
    assert!(decisions.len() > 5, "{decisions:?}");
    let after_s = outcome.captured[&TargetId(0)].1.as_secs_f64() - decisions[0].1;
    assert!((after_s - libm::round(after_s)).abs() < 1e-6, "{after_s} s after its first decision");
}

#[test]
fn a_robot_that_waits_for_a_round_decides_once_in_each() {
    let gaps = |settings| {
        let targets = vec!["places_m = [[0.0, 12.0], [10.0, 12.0]]\nspeed_m_per_s = 0.3"];
        let outcome = Scene { targets, settings, is_pseudo_gradient: true, ..Scene::default() }.run();
        assert_eq!(outcome.captured.len(), 1);
        decisions(&outcome).windows(2).map(|pair| pair[1].1 - pair[0].1).collect::<Vec<_>>()
    };
    assert!(gaps("update_s = 1.5").iter().all(|gap| (gap - 1.0).abs() < 1e-6), "it decides at each step");
    // A step of 1 s ends after the next round has begun only if that one came late: then it waits for the one after it.
    let waits = gaps("update_s = 1.5\nwait_for_round = true");
    assert!(waits.iter().all(|gap| (1.4..3.2).contains(gap)), "{waits:?}");
    assert!(waits.iter().any(|gap| (1.4..1.6).contains(gap)), "{waits:?}");
}

#[test]
fn a_pseudo_gradient_of_all_that_detected_the_target_leads_to_its_trail() {
    // Where the robot is when it comes near the line on which the target went away to the right.
    let meets_at_m = |settings| {
        let robots = vec!["start_m = [2.0, 1.0]\nspeed_m_per_s = 1.5"];
        let outcome = Scene { robots, settings, is_pseudo_gradient: true, ..Scene::default() }.run();
        let decisions = decisions(&outcome);
        decisions.iter().find(|(place, _)| place.y_m > 9.5).map(|(place, _)| place.x_m).expect("it comes to the line")
    };
    let trail_m = meets_at_m("start_delay_s = 12.0\nsources = \"detected\"");
    let target_m = meets_at_m("start_delay_s = 12.0\nsources = \"detecting\"");
    assert!(trail_m < 6.0 && target_m > 9.0, "{trail_m} m and {target_m} m");
}

#[test]
fn a_robot_that_hears_nothing_new_goes_back_to_the_newest_detection_that_it_knows() {
    let steps = |settings| {
        let targets =
            vec!["places_m = [[0.0, 12.0], [6.0, 12.0], [6.0, 4.0], [18.0, 4.0], [18.0, 14.0]]\nspeed_m_per_s = 1.2"];
        let robots = vec!["start_m = [2.0, 18.0]\nspeed_m_per_s = 1.5"];
        let outcome = Scene { targets, robots, settings, ..Scene::default() }.run();
        outcome.robots[0].steps.clone()
    };
    let on = steps("preset = \"thesis\"\nstart_delay_s = 9.0\nwithout_news = \"on\"");
    assert!(on.iter().all(|step| step.goal == step.predicted));
    let back = steps("preset = \"thesis\"\nstart_delay_s = 9.0");
    let turned: Vec<_> = back.windows(2).filter(|pair| pair[1].goal != pair[1].predicted).collect();
    assert!(!turned.is_empty(), "{back:?}");
    for pair in turned {
        assert_eq!(pair[1].latest, pair[0].latest, "it heard of a newer detection");
        assert!(pair[1].goal.distance_m(pair[1].place) > 1.5, "it is there already");
    }
}

#[test]
fn pseudo_gradients_cost_far_more_messages_than_polls() {
    let messages = |is_pseudo_gradient| {
        let outcome = Scene { is_pseudo_gradient, ..Scene::default() }.run();
        outcome.nodes.total() as f64 / outcome.captured.get(&TargetId(0)).map_or(60.0, |(_, at)| at.as_secs_f64())
    };
    assert!(messages(true) > 3.0 * messages(false));
}

#[test]
fn the_same_search_is_the_same_again_and_another_seed_is_another() {
    let predicted = |seed| Scene { seed, ..Scene::default() }.run().predicted;
    assert_eq!(predicted(3), predicted(3));
    assert_ne!(predicted(3), predicted(4));
}

#[test]
fn a_node_that_is_not_on_the_map_never_answers() {
    let map = NavigationMap::new(vec![None, Some(Position::ORIGIN)], MapFrame::Robot);
    assert_eq!(map, None, "two nodes of which one is missing are no map");
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x_m, y_m)| Some(Position::new(x_m, y_m, 0.0)));
    let map = NavigationMap::new([None].into_iter().chain(corners).collect(), MapFrame::Robot).expect("a map");
    assert_eq!((map.place(NodeId(0)), map.place(NodeId(9))), (None, None));
}
