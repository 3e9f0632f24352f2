//! Source seeking over simulated links.

use std::sync::Arc;
use std::time::Duration;

use sextant_apps::MissionTeam;
use sextant_apps::navigation::{MapFrame, NavigationMap};
use sextant_apps::source_seeking::{
    GradientConfig, LevelSetConfig, RobotSeekRecord, SeekRecord, SeekState, SourceSeeking,
};
use sextant_channel::{ChannelConfig, ObstacleField, Position};
use sextant_kernel::{Purpose, Seed, SimTime};
use sextant_mac::RadioStates;
use sextant_mac::csma::CsmaSettings;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{
    Estimate, Field, FieldConfig, FieldSensorConfig, Ieee802154, Listening, Mac, Network, NetworkId, Observer,
    Odometry, OwnFrame, Radio, ReceptionModel, Robot, RobotBody, RobotTask, Sensors, SensorsConfig, Setup,
    Simulation, Technology, TrafficPlan, World,
};

use crate::world;

/// Nodes at random places in a box, and a robot among them.
struct Scene {
    nodes: usize,
    size_m: [f64; 3],
    field: &'static str,
    start: Position,
    obstacles: ObstacleField,
    /// Ratio of signal and offset of sensors (dB).
    snr_db: Option<f64>,
    frame: MapFrame,
    duration_s: f64,
    seed: u64,
}

/// A single source with a peak of 10 that falls to 9 at 4.6 m.
const ONE: &str = "name = \"gas\"\ngaussians = [{ center_m = [15, 15], peak = 10, sigma_m = 10 }]";

/// What a robot left behind, and where it truly was.
struct Found {
    record: RobotSeekRecord,
    field: Field,
    path: Vec<(SimTime, Position)>,
    removed: usize,
    /// The values of the field that it believed in.
    told: Vec<(SimTime, f64)>,
}

#[derive(Default)]
struct Watch {
    path: Vec<(SimTime, Position)>,
    removed: usize,
    told: Vec<(SimTime, f64)>,
}

impl Observer for Watch {
    fn moved(&mut self, _robot: usize, time: SimTime, position: Position) {
        self.path.push((time, position));
    }

    fn source_removed(&mut self, _field: sextant_sim::FieldId, _source: usize, _time: SimTime) {
        self.removed += 1;
    }

    fn estimated(&mut self, _station: sextant_kernel::StationId, time: SimTime, estimate: &Estimate) {
        if let Estimate::FieldValue { value, .. } = *estimate {
            self.told.push((time, value));
        }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            nodes: 400,
            size_m: [20.0, 20.0, 0.0],
            field: ONE,
            start: Position::new(3.0, 4.0, 0.0),
            obstacles: ObstacleField::default(),
            snr_db: None,
            frame: MapFrame::Robot,
            duration_s: 150.0,
            seed: 1,
        }
    }
}

/// Where a place is on a map that is turned, mirrored and twice as large.
fn on_unknown_map(place: Position) -> Position {
    let (sin, cos) = (2.0 * 0.6, 2.0 * 0.8);
    Position::new(cos * place.x_m + sin * place.y_m + 5.0, sin * place.x_m - cos * place.y_m - 7.0, place.z_m)
}

impl Scene {
    fn places(&self) -> Vec<Position> {
        let seed = Seed(self.seed);
        let place = |i: usize| {
            let [x, y, z] = [0, 1, 2]
                .map(|axis| self.size_m[axis] * seed.uniform(Purpose::new(1000), [i as u64, axis as u64, 0]));
            Position::new(x, y, z)
        };
        (0..).map(place).filter(|&place| self.obstacles.distance_m(place) > 0.0).take(self.nodes).collect()
    }

    fn network(nodes: usize) -> Network {
        let channel: ChannelConfig =
            toml::from_str("environment = \"suburban\"\nmax_range_m = 10.0").expect("a channel");
        let radio: sextant_sim::RadioConfig =
            toml::from_str("tx_power_dbm = -50.0\nsensitivity_dbm = -90.0").expect("a radio");
        Network::of(
            channel.try_into().expect("a good channel"),
            Technology::Ieee802154(Ieee802154 {
                radio: Radio::try_from(radio).expect("good levels").with_reception(ReceptionModel::Overlap),
                mac: Mac::CsmaUnslotted(CsmaSettings::default().with_receiver_on()),
            }),
            RadioStates::cc2420(),
            TrafficPlan::silent(nodes),
        )
    }

    fn level_set(&self, settings: &str) -> Found {
        let config: LevelSetConfig = toml::from_str(settings).expect("settings");
        self.seek(|fields| SourceSeeking::level_set(&config, fields).expect("good settings"))
    }

    fn gradient(&self, settings: &str) -> Found {
        let config: GradientConfig = toml::from_str(settings).expect("settings");
        self.seek(|fields| SourceSeeking::gradient(&config, fields).expect("good settings"))
    }

    fn seek(&self, settings: impl Fn(&[Field]) -> SourceSeeking) -> Found {
        let config: FieldConfig = toml::from_str(self.field).expect("a field");
        let field = Field::try_from(&config).expect("a good field");
        let fields = vec![field.clone()];
        let places = self.places();
        let on_map = |&place: &Position| match self.frame {
            MapFrame::Robot => Some(place),
            MapFrame::Unknown => Some(on_unknown_map(place)),
        };
        let map = NavigationMap::new(places.iter().map(on_map).collect(), self.frame).expect("a map");
        let sensors = FieldSensorConfig { interval_s: 1.0, offset_snr_db: self.snr_db, noise_snr_db: None };
        let sensors = SensorsConfig { targets: None, fields: Some(sensors) };
        let body = RobotBody {
            name: "seeker".into(),
            start: self.start,
            believed_start: None,
            speed_m_per_s: 0.5,
            radius_m: 0.2,
            listen: Duration::from_secs(1),
            listening: Listening::AtStops,
            odometry: Odometry::default(),
            frame: OwnFrame::default(),
            networks: vec![NetworkId::default()],
            sweeps_per_stop: 1,
        };
        let network = Self::network(self.nodes);
        let duration = Duration::from_secs_f64(self.duration_s);
        let team = MissionTeam {
            nodes: places.len(),
            robots: std::slice::from_ref(&body),
            sinks: 0,
            targets: 0,
            network: NetworkId(0),
            radio: Some(&network.technology.ieee802154().expect("a radio of this technology").radio),
            duration,
        };
        let own = Arc::new(settings(&fields)).stations(&Arc::new(map), team);
        let node = |(i, position): (usize, Position)| PlacedNode { name: format!("n{i}"), position };
        let setup = Setup {
            robots: vec![Robot { body, task: RobotTask::Own }],
            duration: Some(duration),
            ..Setup::of(
                World {
                    nodes: places.into_iter().enumerate().map(node).collect(),
                    obstacles: self.obstacles.clone(),
                    fields,
                    sensors: Sensors::try_from(sensors).expect("good sensors"),
                    ..World::default()
                },
                network,
                Seed(self.seed),
            )
        };
        let mut watch = Watch::default();
        let (_, mut own) = Simulation::with(setup, own).expect("a good setup").run_own(&mut watch);
        let Some(SeekRecord::Robot(record)) = own.robots.pop().map(|robot| robot.into_record()) else {
            panic!("a robot")
        };
        let Watch { path, removed, told } = watch;
        Found { record: *record, field, path, removed, told }
    }
}

impl Found {
    /// Where the robot was at the end.
    fn end(&self) -> Position {
        self.path.last().expect("it has started").1
    }

    /// The true value of the field where it arrived, without removals.
    fn true_value(&self) -> f64 {
        self.field.full_value(self.record.arrivals[0].odometry)
    }

    fn arrival_s(&self) -> f64 {
        self.record.arrivals[0].time.as_secs_f64()
    }
}

#[test]
fn a_robot_arrives_at_the_level_and_stops() {
    for seed in 1..=4 {
        let found = Scene { snr_db: Some(20.0), seed, ..Scene::default() }.level_set("goal.level = 9.0");
        assert_eq!(found.record.state, SeekState::Arrived);
        assert!((found.true_value() - 9.0).abs() < 0.5, "{}", found.true_value());
        // 16.3 m to the centre, less the 4.6 m of the level, at 0.5 m/s: no way is shorter.
        assert!(found.arrival_s() > 2.0 * (16.3 - 4.8), "{} s", found.arrival_s());
        assert!(found.end().distance_m(found.record.arrivals[0].odometry) < 1e-9);
        assert!(found.told.len() > 100 && found.record.answers > 1000);
    }
}

#[test]
fn a_robot_that_circles_stays_on_the_level() {
    let found = Scene::default().level_set("goal.level = 9.0\ngoal.then = \"circle\"");
    assert_eq!(found.record.state, SeekState::Circling);
    let last = found.path.iter().filter(|(time, _)| time.as_secs_f64() > 100.0);
    for (_, place) in last {
        let value = found.field.full_value(*place);
        // The mean over a neighbourhood flattens the peak, so the robot stays a little inside.
        assert!((8.7..9.6).contains(&value), "{value} at {place}");
    }
    // The level set is a circle with a radius of 4.6 m: 25 m in 50 s is most of a turn.
    let angle = |(_, place): &(SimTime, Position)| (place.y_m - 15.0).atan2(place.x_m - 15.0);
    let angles: Vec<f64> = found.path.iter().filter(|(time, _)| time.as_secs_f64() > 100.0).map(angle).collect();
    let wrapped =
        |angle: f64| (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    let turned_rad: f64 = angles.windows(2).map(|two| wrapped(two[1] - two[0])).sum();
    assert!(turned_rad < -3.0, "clockwise, because the higher field is on the right: {turned_rad}");
}

#[test]
fn the_gradient_leads_almost_straight_to_the_level() {
    let found = Scene::default().gradient("goal.level = 9.0");
    assert_eq!(found.record.state, SeekState::Arrived);
    // Two seconds of orientation, and a turn at the start.
    let shortest_s = 2.0 * (16.3 - 4.8);
    assert!((shortest_s..shortest_s + 6.0).contains(&found.arrival_s()), "{} s", found.arrival_s());
}

#[test]
fn a_robot_without_a_level_drives_on_to_the_source() {
    for (seed, snr_db, most_m) in [(1, None, 0.7), (2, None, 0.7), (3, Some(20.0), 2.5), (4, Some(20.0), 2.5)] {
        let found = Scene { snr_db, seed, ..Scene::default() }.gradient("goal = \"source\"\nplane.reach_m = 4.0");
        assert_eq!(found.record.state, SeekState::Arrived, "seed {seed}");
        let apart_m = found.end().distance_m(Position::new(15.0, 15.0, 0.0));
        assert!(apart_m < most_m, "seed {seed}: {apart_m} m from the source");
        // 16.3 m at 0.5 m/s, less the distance at the arrival.
        assert!(found.arrival_s() > 2.0 * (16.2 - apart_m), "{} s", found.arrival_s());
    }
}

#[test]
fn a_field_without_a_peak_in_reach_has_no_source() {
    // It rises to the east everywhere.
    let field = "name = \"gas\"\ngaussians = [{ center_m = [300, 10], peak = 10, sigma_m = 250 }]";
    let found = Scene { field, duration_s: 60.0, ..Scene::default() }.gradient("goal = \"source\"");
    assert!(found.record.arrivals.is_empty(), "{:?}", found.record);
}

#[test]
fn with_ideal_polls_a_robot_knows_the_nodes_in_reach_at_each_step() {
    let thesis = "goal.level = 9.0\npreset = \"thesis\"\nestimate.weights = \"equal\"\nestimate.reach_m = 3.0";
    let scene = || Scene { duration_s: 30.0, ..Scene::default() };
    let found = scene().level_set(thesis);
    // It decides each 0.1 s, but for the first second, in which not all nodes have taken a sample.
    assert!((290..=300).contains(&found.told.len()), "{} decisions", found.told.len());
    assert_eq!((found.record.polls, found.record.answers, found.record.octets), (0, 0, 0), "without frames");
    let places = scene().places();
    let mut off = 0;
    for &(time, value) in &found.told {
        let (_, here) = found.path.iter().rev().find(|(moved, _)| *moved <= time).expect("a place");
        let near = places.iter().filter(|place| place.distance_m(*here) <= 3.0);
        let values: Vec<f64> = near.map(|place| found.field.full_value(*place)).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!((value - mean).abs() < 0.5, "{value} for {mean}");
        off += usize::from((value - mean).abs() > 0.15);
    }
    // The place on the map is a little off, so that a few nodes at the rim differ.
    assert!(off < found.told.len() / 4, "{off} of {}", found.told.len());
    // All nodes in range at once are the same at any channel access: no seed of the MAC matters.
    assert_eq!(scene().level_set(thesis).told, found.told);
}

#[test]
fn the_thesis_preset_reaches_the_level() {
    let mut arrived = 0;
    for seed in 1..=4 {
        let found =
            Scene { seed, ..Scene::default() }.level_set("goal.level = 9.0\npreset = \"thesis\"\ndelta = 0.05");
        arrived += found.record.arrivals.len();
    }
    assert_eq!(arrived, 4);
}

#[test]
fn a_level_that_is_nowhere_is_never_reached() {
    for found in [
        Scene { duration_s: 150.0, ..Scene::default() }.level_set("goal.level = 12.0"),
        Scene { duration_s: 150.0, ..Scene::default() }.gradient("goal.level = 12.0"),
    ] {
        assert!(found.record.arrivals.is_empty() && found.record.state != SeekState::Arrived);
        // It looked elsewhere too.
        assert!(found.record.wandered > 0, "{:?}", found.record);
        let largest = found.record.largest.expect("it heard nodes");
        assert!((9.5..10.5).contains(&largest), "{largest}");
    }
}

#[test]
fn a_robot_goes_round_a_box_to_the_source_behind_it() {
    // A wall of 10 m across the straight way.
    let obstacles = world::field(&[([9.0, 9.5], [10.0, 1.0], 135.0)]);
    for seed in 1..=3 {
        let scene = || Scene { obstacles: obstacles.clone(), seed, duration_s: 250.0, ..Scene::default() };
        for found in [scene().level_set("goal.level = 9.0"), scene().gradient("goal.level = 9.0")] {
            assert_eq!(found.record.state, SeekState::Arrived, "{:?}", found.record);
            assert!(found.record.blocked > 0);
            assert!(found.path.iter().all(|(_, place)| obstacles.distance_m(*place) > 0.2 - 1e-6));
        }
    }
}

#[test]
fn a_robot_removes_one_source_after_the_other() {
    let field = "name = \"gas\"\n\
                 gaussians = [{ center_m = [15, 15], peak = 10, sigma_m = 6, fades.lingers_s = 5.0 },\n\
                 { center_m = [4, 15], peak = 10, sigma_m = 6, fades.lingers_s = 5.0 }]";
    let scene = Scene { field, start: Position::new(12.0, 4.0, 0.0), duration_s: 300.0, ..Scene::default() };
    let found = scene.level_set("goal = { level = 9.0, arrivals = 2, remove_within_m = 6.0 }");
    let record = &found.record;
    assert_eq!((record.state, record.arrivals.len(), record.removed, found.removed), (SeekState::Arrived, 2, 2, 2));
    let [first, second] = [0, 1].map(|i| record.arrivals[i].odometry);
    assert!(first.distance_m(second) > 5.0, "{first} and {second}");
}

#[test]
fn a_map_in_an_unknown_frame_is_enough() {
    for found in [
        Scene { frame: MapFrame::Unknown, ..Scene::default() }.level_set("goal.level = 9.0"),
        Scene { frame: MapFrame::Unknown, ..Scene::default() }.gradient("goal.level = 9.0"),
    ] {
        assert_eq!(found.record.state, SeekState::Arrived, "{:?}", found.record);
        assert!((found.true_value() - 9.0).abs() < 0.8, "{}", found.true_value());
    }
}

#[test]
fn a_robot_in_space_reaches_a_source_above_it() {
    let field = "name = \"gas\"\ngaussians = [{ center_m = [8, 8, 8], peak = 10, sigma_m = 6 }]";
    for seed in 1..=3 {
        let scene = Scene {
            nodes: 700,
            size_m: [12.0, 12.0, 12.0],
            field,
            start: Position::new(2.0, 3.0, 2.0),
            duration_s: 250.0,
            seed,
            ..Scene::default()
        };
        let found = scene.level_set("goal.level = 9.0\nspace = {}");
        assert_eq!(found.record.state, SeekState::Arrived, "{:?}", found.record);
        assert!((found.true_value() - 9.0).abs() < 0.8, "{}", found.true_value());
        assert!(found.end().z_m > 4.0);
    }
}

#[test]
fn the_same_seed_gives_the_same_way() {
    let run = || Scene { snr_db: Some(20.0), ..Scene::default() }.level_set("goal.level = 9.0");
    let (one, two) = (run(), run());
    assert_eq!((one.record, one.path), (two.record, two.path));
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let field: FieldConfig = toml::from_str(ONE).expect("a field");
    let field = Field::try_from(&field).expect("a good field");
    let error = |settings: &str, fields: &[Field]| {
        let config: LevelSetConfig = toml::from_str(settings).expect("settings");
        SourceSeeking::level_set(&config, fields).expect_err("invalid settings")
    };
    let key = |settings: &str| error(settings, std::slice::from_ref(&field)).key;
    assert_eq!(key("goal = { level = 9.0, arrivals = 2 }"), "goal.arrivals");
    assert_eq!(key("goal = { level = 9.0, field = \"smoke\" }"), "goal.field");
    assert_eq!(key("goal = { level = 9.0, tolerance = 0.0, hold_s = 1.0 }"), "goal.tolerance");
    assert_eq!(key("goal.level = 9.0\nclimb_share = 1.5"), "climb_share");
    assert_eq!(key("goal.level = 9.0\nclimb_share = 0.5\ndelta = 0.1"), "delta");
    assert_eq!(key("goal.level = 9.0\nestimate.weights = \"power\""), "climb_share");
    assert_eq!(key("goal.level = 9.0\ndelta = 0.1\nspace = {}\nestimate.weights = \"equal\""), "space");
    assert_eq!(key("goal.level = 9.0\nestimate = { local_fit = {}, weights = \"equal\" }"), "estimate.local_fit");
    assert_eq!(key("goal.level = 9.0\nestimate.reach_m = 4.0"), "estimate.weights");
    assert_eq!(key("goal.level = 9.0\npoll = { ideal = true, interval_s = 1.0 }"), "poll.interval_s");
    assert_eq!(key("goal.level = 9.0\npreset = \"thesis\"\npoll.memory_s = 5.0"), "poll.memory_s");
    assert_eq!(key("goal.level = 9.0\npoll.memory_s = 0.5"), "poll.memory_s");
    assert_eq!(key("goal.level = 9.0\nrate.least_squares.samples = 1"), "rate.least_squares.samples");
    assert_eq!(
        key("goal.level = 9.0\nestimate.local_fit.bandwidth_spacings = 0.0"),
        "estimate.local_fit.bandwidth_spacings"
    );
    let gradient = |settings: &str, fields: &[Field]| {
        let config: GradientConfig = toml::from_str(settings).expect("settings");
        SourceSeeking::gradient(&config, fields).expect_err("invalid settings").to_string()
    };
    let one = std::slice::from_ref(&field);
    assert!(gradient("goal = \"source\"\nplane.reach_m = 0.0", one).starts_with("`plane.reach_m` is 0"));
    assert_eq!(
        gradient("goal = \"source\"", &[field.clone(), field.clone()]),
        "`goal` is \"source\" in a world with 2 fields; allowed: a table with `field` and `level`"
    );
    let absent = error("goal.level = 9.0", &[]);
    assert_eq!(absent.to_string(), "`goal.field` is missing; needed: a field in `[[world.fields]]`");
}
