//! Maps that nodes compute themselves, from a scenario to the summary, the recording, the figures and a sweep.

use serde_json::Value;
use sextant_recording::{NodeRole, inspect, read_world};
use tempfile::TempDir;

use crate::program::{Said, call, check_text, number, run_text, table};

/// 60 nodes in a greenhouse, of which nine know their place.
const NODES: &str = r#"
name = "in-nodes"
seed = 3
anchors.share = 0.15
[world.nodes.lattice]
spacing_m = 1.0
jitter_m = 0.1
count = 60
region.box = { min_m = [0.0, 0.0, 0.0], max_m = [6.0, 6.0, 2.0] }
[radio]
tx_power_dbm = 20.0
sensitivity_dbm = -60.0
"#;

const MILLIMETRE_WAVES: &str = r#"
[channel]
environment = "dmmtm-greenhouse"
max_range_m = 5.0
path_loss.close_in.carrier_ghz = 73.0
shadowing.correlation = "per_link"
[mac.sector_sweep]
[antenna.nodes.sectors]
azimuth_sectors = 8
boresight_gain_dbi = 10.0
vertical_width_deg = 50.0
pattern.flat_top = {}
[antenna.robots.sectors]
azimuth_sectors = 16
elevations_deg = [-75.0, -25.0]
vertical_width_deg = 50.0
boresight_gain_dbi = 10.0
pattern.flat_top = {}
"#;

const MAPPING: &str = r#"
[distributed_mapping]
range_m = 5.0
[distributed_mapping.place]
grid_step_m = 0.5
z_range_m = [0.0, 2.0]
profile.trapezoid = { p0 = 0.95, plateau_m = 0.7, range_m = 5.0 }
"#;

const ROBOT: &str = r#"
[[robots]]
name = "rover"
role = "anchor"
start_m = [1.0, 1.0, 4.0]
listen_s = 0.1
controller.waypoints.places_m = [[1.0, 1.0, 4.0], [5.0, 1.0, 4.0], [5.0, 5.0, 4.0]]
"#;

fn static_anchors() -> String {
    [NODES, MILLIMETRE_WAVES, MAPPING].concat()
}

fn mobile_anchor() -> String {
    let mapping = MAPPING.replace("range_m = 5.0\n[", "range_m = 5.0\nmobile_phase_s = 12.0\n[");
    [NODES, MILLIMETRE_WAVES, &mapping, ROBOT].concat()
}

#[test]
fn nodes_with_static_anchors_place_themselves() {
    let (folder, summary) = run_text(&static_anchors(), &[]);
    let map = &summary["maps"][0];
    assert_eq!((&map["algorithm"], &map["mapped"]), (&"dmmtm-ss".into(), &60.into()));
    // A guess in the middle of the box would be 2.4 m off on average.
    let error_m = number(&map["position_error_m"]["mean"]);
    assert!(error_m > 0.0 && error_m < 1.6, "{error_m} m");
    assert!(number(&map["message_energy_j"]) > 0.0 && map["sector_displacement"].is_array());
    let work = &map["distributed"];
    assert_eq!(work["anchors"]["initial"], 9);
    assert!(work["mobile"].is_null() && summary["gathering"].is_null());
    let messages = &work["messages"];
    // Each initial anchor tells its place once, and all 51 other nodes their coordinates at least once.
    assert!(number(&messages["place"]) >= 9.0 && number(&messages["coordinates"]) >= 51.0, "{messages}");
    assert!(number(&work["orientation_error_deg"]["mean"]) < 22.5, "better than any direction within a sector");
    let sum: f64 = work["scattering"].as_array().unwrap().iter().map(|bin| number(&bin[1])).sum();
    assert!((sum - 51.0).abs() < 1e-9, "each node that computed a place is in a bin: {sum}");

    let recording = folder.path().join("run.mcap");
    let topics = inspect(&recording).unwrap().topics;
    let count = |name: &str| topics.iter().find(|topic| topic.topic == name).map(|topic| topic.messages);
    assert_eq!(
        (count("/distributed/nodes"), count("/map/dmmtm-ss"), count("/anchors")),
        (Some(60), Some(1), Some(9))
    );
    let drawn = read_world(&recording).unwrap();
    let of = |role| drawn.mapped_nodes.iter().filter(|node| node.role == role).count();
    let new = usize::try_from(work["anchors"]["new"].as_u64().unwrap()).unwrap();
    assert_eq!((of(NodeRole::InitialAnchor), of(NodeRole::NewAnchor)), (9, new));

    call(folder.path(), &["figure", "run.mcap", "--out", "f"]).printed();
    let figure = |name: &str| std::fs::read_to_string(folder.path().join("f").join(name)).unwrap();
    assert!(figure("map-dmmtm-ss.svg").contains("anchor from the beginning"));
    assert!(figure("neighbour-scattering.svg").contains("error of neighbour scattering"));
}

#[test]
fn a_mobile_anchor_is_heard_and_helps() {
    let (_, alone) = run_text(&static_anchors(), &[]);
    let (folder, summary) = run_text(&mobile_anchor(), &[]);
    let map = &summary["maps"][0];
    assert_eq!(map["algorithm"], "dmmtm-hs");
    let mobile = &map["distributed"]["mobile"];
    assert_eq!(mobile["stops"], 3);
    assert!((number(&mobile["path_length_m"]) - 8.0).abs() < 1e-9, "{mobile}");
    let share = number(&mobile["heard_share"]);
    assert!(share > 0.2 && share <= 1.0, "{share}");
    let error_m = |summary: &Value| number(&summary["maps"][0]["position_error_m"]["mean"]);
    assert!(error_m(&summary) < error_m(&alone), "{} and {} m", error_m(&summary), error_m(&alone));
    // A mobile anchor surveys nothing.
    assert!(summary["gathering"].is_null());
    let topics = inspect(&folder.path().join("run.mcap")).unwrap().topics;
    assert!(topics.iter().all(|topic| topic.topic != "/stops"));
}

#[test]
fn a_robot_surveys_while_nodes_map_themselves() {
    let survey = "
[[robots]]
name = \"surveyor\"
start_m = [1.0, 1.0, 4.0]
listen_s = 0.1
controller.waypoints.places_m = [[1.0, 1.0, 4.0], [5.0, 1.0, 4.0], [5.0, 5.0, 4.0], [1.0, 5.0, 4.0]]
[[maps]]
algorithm.mmtm = { grid_step_m = 0.5, z_range_m = [0.0, 2.0], profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 5.0 } }
";
    // The robot drives above the nodes, whose beams are high enough to answer it.
    let nodes = static_anchors().replacen("vertical_width_deg = 50.0\n", "vertical_width_deg = 170.0\n", 1);
    let (_folder, summary) = run_text(&[&nodes, survey].concat(), &[]);
    let maps = summary["maps"].as_array().unwrap();
    let names: Vec<_> = maps.iter().map(|map| map["algorithm"].as_str().unwrap()).collect();
    assert_eq!(names, ["dmmtm-ss", "mmtm"]);
    assert!(number(&maps[0]["mapped"]) > 50.0 && number(&maps[1]["mapped"]) > 20.0, "{maps:?}");
    assert_eq!(summary["gathering"]["stops"], 4);
    // No map of what robots hear is made without a robot that surveys.
    let map = survey.split("[[maps]]").nth(1).unwrap();
    let without = check_text(&[&static_anchors(), "[[maps]]", map].concat(), &[]);
    assert!(without.contains("no surveying robot"), "{without}");
}

#[test]
fn nodes_use_the_network_that_the_table_names() {
    let networks = "
[networks.rf.radio]
tx_power_dbm = -50.0
sensitivity_dbm = -90.0
[networks.rf.channel]
environment = \"suburban\"
path_loss.log_distance.reference_loss_db = 0.0
max_range_m = 5.0
[networks.rf.mac.csma_unslotted]
rx_on_when_idle = true
[networks.mmwave.radio]
tx_power_dbm = 20.0
sensitivity_dbm = -60.0
";
    let waves: String = MILLIMETRE_WAVES
        .lines()
        .map(|line| {
            format!(
                "{}\n",
                line.replace("[channel]", "[networks.mmwave.channel]")
                    .replace("[mac.", "[networks.mmwave.mac.")
                    .replace("[antenna.", "[networks.mmwave.antenna.")
            )
        })
        .collect();
    let nodes = NODES.split("[radio]").next().unwrap();
    let of = |network: &str| {
        let mapping = MAPPING.replace("range_m = 5.0\n[", &format!("range_m = 5.0\nnetwork = \"{network}\"\n["));
        let (_folder, summary) = run_text(&[nodes, networks, &waves, &mapping].concat(), &[]);
        summary["maps"][0].clone()
    };
    let (rf, mmwave) = (of("rf"), of("mmwave"));
    assert_eq!((&rf["networks"][0], &mmwave["networks"][0]), (&"rf".into(), &"mmwave".into()));
    // Only nodes with sectors ask for reports.
    let reports = |map: &Value| number(&map["distributed"]["messages"]["report"]);
    assert!(reports(&rf) <= 0.0 && reports(&mmwave) > 0.0);
}

#[test]
fn anchors_that_give_up_wrong_places_are_counted() {
    let doubting =
        MAPPING.replace("range_m = 5.0\n[", "range_m = 5.0\ndirections = \"intervals\"\ndoubt_below = 0.75\n[");
    let scenario =
        [NODES, MILLIMETRE_WAVES, &doubting].concat().replace("anchors.share = 0.15", "anchors.share = 0.5");
    let lies = "[faults.lying_anchors]\nshare = 0.1\ndistance_m = 4.0\n";
    let (_folder, honest) = run_text(&scenario, &[]);
    let (_folder, lying) = run_text(&[&scenario, lies].concat(), &[]);
    let gave_up = |summary: &Value| number(&summary["maps"][0]["distributed"]["anchors"]["gave_up"]);
    assert_eq!(lying["faults"]["lying_anchors"].as_array().unwrap().len(), 3);
    assert!(
        gave_up(&honest) <= 1.0 && gave_up(&lying) >= gave_up(&honest) + 2.0,
        "{} {}",
        gave_up(&honest),
        gave_up(&lying)
    );
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bytes =
        |threads| std::fs::read(run_text(&mobile_anchor(), &["--threads", threads]).0.path().join("run.mcap"));
    assert!(bytes("1").unwrap() == bytes("2").unwrap());
}

#[test]
fn packets_without_sectors_are_evidence_of_distance_alone() {
    let packets = "channel = { environment = \"light-tree\", max_range_m = 5.0, path_loss.log_distance.reference_loss_db = 0.0 }\nmac.csma_unslotted.rx_on_when_idle = true\n";
    let scenario = [packets, NODES, MAPPING].concat().replace("20.0\nsens", "-50.0\nsens").replace("-60.0", "-90.0");
    let (_, summary) = run_text(&scenario, &[]);
    let work = &summary["maps"][0]["distributed"];
    assert_eq!((&work["messages"]["place"], &work["messages"]["report"]), (&0.into(), &0.into()));
    assert!(work["orientation_error_deg"].is_null() && number(&work["frames_received_mean"]) > 5.0, "{work}");
    let deaf = check_text(&scenario.replace("rx_on_when_idle = true", "rx_on_when_idle = false"), &[]);
    assert!(deaf.contains("`mac.csma_unslotted.rx_on_when_idle` is false"), "{deaf}");
}

#[test]
fn nodes_that_hear_nobody_are_named() {
    // All but the nodes of one corner are beyond the range of its anchors.
    let scenario = static_anchors()
        .replace("anchors.share = 0.15", "anchors.names = [\"n0\", \"n1\", \"n2\", \"n3\"]")
        .replace("max_range_m = 5.0", "max_range_m = 1.2")
        .replace("[distributed_mapping]", "[distributed_mapping]\nmax_iterations = 1");
    let (folder, summary) = run_text(&scenario, &["--format", "text"]);
    let map = &summary["maps"][0];
    let unplaced = map["distributed"]["unplaced"].as_array().unwrap();
    assert_eq!(Some(unplaced.len() as u64), map["unmapped"].as_u64());
    assert!(unplaced.len() > 10, "{unplaced:?}");
    let topics = inspect(&folder.path().join("run.mcap")).unwrap().topics;
    assert!(topics.iter().any(|topic| topic.topic == "/log"), "a warning names them");
}

#[test]
fn a_sweep_has_columns_of_the_nodes_work() {
    let folder = TempDir::new().unwrap();
    let sweep = "\n[sweep]\nruns = 1\nproduct.anchors.share = [0.1, 0.3]\n";
    std::fs::write(folder.path().join("a.toml"), static_anchors() + sweep).unwrap();
    call(folder.path(), &["sweep", "a.toml", "--out", "t.csv", "--quiet"]).printed();
    let rows = table(&folder.path().join("t.csv"));
    let initial = "distributed.anchors.initial";
    assert_eq!([&*rows[0][initial], &*rows[1][initial]], ["6", "18"]);
    assert_eq!(rows[0]["map"], "dmmtm-ss", "a map that nodes compute is one like others");
    let messages = &rows[0]["distributed.messages.mean_per_node"];
    assert!(messages.parse::<f64>().unwrap() > 1.0 && messages.contains('.'), "{messages}");
}

#[test]
fn invalid_tables_are_refused_at_their_key() {
    let good = static_anchors();
    let mobile = mobile_anchor();
    for (scenario, key, allowed) in [
        (
            good.replace("range_m = 5.0\n[", "range_m = 5.0\nnetwork = \"x\"\n["),
            "`distributed_mapping.network` is `x`",
            "no name",
        ),
        (
            good.replace("range_m = 5.0\n[", "range_m = 5.0\nmobile_phase_s = 3\n["),
            "`distributed_mapping.mobile_phase_s` conflicts with",
            "none has `role",
        ),
        (mobile.replace("mobile_phase_s = 12.0\n", ""), "`distributed_mapping.mobile_phase_s` is missing", "a time"),
        (
            mobile.replace(&MAPPING.replace("range_m = 5.0\n[", "range_m = 5.0\nmobile_phase_s = 12.0\n["), ""),
            "`robots[0].role` is \"anchor\"",
            "[distributed_mapping]",
        ),
        (
            good.replace("anchors.share = 0.15", "anchors.share = 0.0"),
            "`anchors` is 0 of the 60 nodes",
            "that knows its place",
        ),
        (
            good.replace("azimuth_sectors = 8", "azimuth_sectors = 8\nelevations_deg = [-25, 25]"),
            "`antenna.nodes.sectors.elevations_deg` is 2 rings",
            "one ring",
        ),
        (
            good.replace("bad_above", "")
                + "\n[[maps]]\nname = \"dmmtm-ss\"\nalgorithm.mmtm = { grid_step_m = 0.5, profile.channel = {} }\n",
            "`distributed_mapping.name` is `dmmtm-ss`",
            "a unique name",
        ),
        (
            good.replace("grid_step_m = 0.5", "grid_step_m = 0.0"),
            "`distributed_mapping.place.grid_step_m` is 0",
            "above 0",
        ),
        (
            mobile.replace(
                "azimuth_sectors = 16\nelevations_deg = [-75.0, -25.0]",
                &format!("azimuth_sectors = 1\nelevations_deg = {:?}", (-64..64).collect::<Vec<i32>>()),
            ),
            "`antenna.robots.sectors.elevations_deg` is 128 rings: a mobile anchor tells their directions",
            "fewer rings, so that the message has at most 964 octets",
        ),
    ] {
        let said = check_text(&scenario, &[]);
        let said: Vec<_> = said.split_whitespace().filter(|word| *word != "│").collect();
        let said = said.join(" ");
        assert!(said.contains(key) && said.contains(allowed), "{key}: {said}");
    }
}
