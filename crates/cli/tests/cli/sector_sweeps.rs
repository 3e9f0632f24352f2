//! Surveys by sector sweeps, from a scenario to the recording, the map, the summary and the capture.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::path::Path;

use serde_json::Value;
use sextant_logs as robot_log;
use sextant_recording::{inspect, read_log, recover};
use tempfile::TempDir;

use crate::pcap::tshark::{dissect, tshark};
use crate::program::{Said, call, run_text, sextant, summary};

const WORLD: &str = r#"
name = "sweeps"
seed = 3
[world.nodes.lattice]
spacing_m = 1.2
jitter_m = 0.1
count = 20
[world.nodes.lattice.region.box]
min_m = [0.0, 0.0, 1.0]
max_m = [6.0, 6.0, 3.0]
"#;

const ROBOT: &str = r#"
[[robots]]
name = "rover"
start_m = [0.0, 0.0, 0.0]
listen_s = 1
sweeps_per_stop = 3
controller.waypoints.places_m = [
    [1.0, 1.0, 0.0], [3.0, 1.0, 0.0], [5.0, 1.0, 0.0], [5.0, 3.0, 0.0], [3.0, 3.0, 0.0], [1.0, 3.0, 0.0],
    [1.0, 5.0, 0.0], [3.0, 5.0, 0.0], [5.0, 5.0, 0.0],
]
"#;

/// The tables of a network with sector sweeps, with names that begin with `prefix`.
fn sweeps(prefix: &str) -> String {
    format!(
        r#"
[{prefix}mac.sector_sweep]
[{prefix}antenna.nodes.sectors]
azimuth_sectors = 8
[{prefix}antenna.robots.sectors]
azimuth_sectors = 16
elevations_deg = [25, 75]
vertical_width_deg = 50
[{prefix}radio]
tx_power_dbm = 20
sensitivity_dbm = -60
[{prefix}channel]
max_range_m = 7
[{prefix}channel.path_loss.close_in]
carrier_ghz = 73
exponent = 1.7
[{prefix}channel.shadowing]
sigma_db = 3.2
correlation = "per_link"
[{prefix}energy.custom]
supply_v = 1.0
tx_ma = 1000.0
rx_ma = 500.0
idle_ma = 100.0
sleep_ma = 0.0
"#
    )
}

const MMTM: &str = r#"
[[maps]]
algorithm.mmtm = { grid_step_m = 0.5, z_range_m = [1.0, 3.0], profile.channel = {} }
"#;

/// One network with sector sweeps.
fn one() -> String {
    [WORLD, &sweeps(""), ROBOT, MMTM].concat()
}

/// A short survey by sector sweeps, without a map.
pub(crate) fn small_survey() -> String {
    [WORLD, &sweeps(""), ROBOT].concat()
}

/// Two networks, of which the second has packets of IEEE 802.15.4.
fn two() -> String {
    let zigbee = r#"
[networks.zigbee]
radio = { tx_power_dbm = -50.0, sensitivity_dbm = -90.0 }
channel = { environment = "light-tree", max_range_m = 6.0, path_loss.log_distance.reference_loss_db = 0.0 }
mac.csma_unslotted = {}
traffic.beacon = { mpdu_octets = 20, interval_s = 0.5, jitter = 0.1 }
"#;
    let robot = ROBOT.replace("listen_s", "networks = [\"zigbee\", \"mm\"]\nlisten_s");
    let maps = r#"
[[maps]]
network = "zigbee"
algorithm.ml_tm = { grid_step_m = 0.5, z_range_m = [1.0, 3.0], profile.channel = {} }
[[maps]]
[maps.algorithm.joint]
grid_step_m = 0.5
z_range_m = [1.0, 3.0]
networks = [{ network = "mm", profile.channel = {} }, { network = "zigbee" }]
"#;
    [WORLD, &sweeps("networks.mm."), zigbee, &robot, MMTM, maps].concat()
}

/// Maps a log in `folder`; the summary, or the error.
fn map(folder: &Path, log: &str, words: &[&str]) -> Result<Value, String> {
    let mut command = sextant();
    command.current_dir(folder).args(["map", log, "--summary", "map.json", "--quiet"]);
    let output = command.args(words).output().unwrap();
    match output.status.code() {
        Some(0) => Ok(summary(&folder.join("map.json"))),
        // Lines of an error begin with a bar.
        _ => Err(String::from_utf8_lossy(&output.stderr).replace("\n  │ ", "")),
    }
}

#[test]
fn answers_that_the_window_ends_are_not_said_to_be_lost_to_a_busy_channel() {
    let folder = TempDir::new().unwrap();
    // Answers with a backoff of one slot at most end in it.
    let text = small_survey().replace("mac.sector_sweep]", "mac.sector_sweep]\nwindow_ms = 0.15");
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    let output = call(folder.path(), &["run", "a.toml", "--quiet"]);
    let table = String::from_utf8_lossy(&output.stdout);
    let row = table.lines().find(|line| line.contains("lost before sending")).unwrap_or_default();
    assert!(row.contains("the window for answers ended") && !table.contains("busy channel"), "{table}");
    let lost: u64 = row.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    assert!(lost > 0, "{table}");
}

#[test]
fn a_recording_of_sector_sweeps_is_mapped_as_in_the_run() {
    let (folder, found) = run_text(&one(), &[]);
    let path = folder.path().join("run.mcap");
    let count = |topic: &str| inspect(&path).unwrap().topics.iter().find(|t| t.topic == topic).map(|t| t.messages);
    assert_eq!((count("/sectors"), count("/networks")), (Some(2 * 16), None));
    let log = read_log(&path).unwrap().logs.first().clone();
    let sectors = log.sectors().unwrap();
    assert_eq!(sectors.identities(), "0 to 31");
    let low = sectors.iter().next().unwrap();
    // 50 degrees round the elevation of 25; 360/16 degrees round x.
    let angles =
        [low.azimuth_from_deg, low.azimuth_to_deg, low.elevation_from_deg, low.elevation_to_deg].map(f64::round);
    assert_eq!(angles.map(|deg| format!("{deg}")), ["-11", "11", "0", "50"]);

    let again = map(folder.path(), "run.mcap", &[]).unwrap();
    for key in ["mapped", "position_error_m", "infeasible", "vertices_evaluated"] {
        assert_eq!(again["maps"][0][key], found["maps"][0][key], "{key}");
    }
    assert_eq!(found["maps"][0]["mapped"], 20);

    // The folder of CSV files has the same sectors.
    robot_log::write(&folder.path().join("log"), &log).unwrap();
    let of = |log| map(folder.path(), log, &["--profile", "p0=0.9,plateau_m=2,range_m=7", "--algorithm", "ml-tm"]);
    let [recorded, written] = ["run.mcap", "log"].map(|log| of(log).unwrap());
    assert_eq!(recorded["maps"][0]["vertices_evaluated"], written["maps"][0]["vertices_evaluated"]);
    assert_eq!(recorded["maps"][0]["infeasible"], written["maps"][0]["infeasible"]);
}

#[test]
fn an_antenna_that_turns_with_the_robot_is_mapped_alike_from_the_run_its_recording_and_its_tables() {
    let held = "[antenna]\nrobot_headings = \"body\"\nrobot_mount.yaw_deg = 90\n[antenna.nodes.sectors]";
    let maps = MMTM.replace("profile.channel", "profile.fitted");
    let scenario = [WORLD, &sweeps("").replace("[antenna.nodes.sectors]", held), ROBOT, &maps].concat();
    let (folder, found) = run_text(
        &scenario,
        &[
            "--set",
            "antenna.robots.sectors.elevations_deg=[40]",
            "--set",
            "antenna.robots.sectors.vertical_width_deg=90",
            "--set",
            "recording.map_snapshots=0",
        ],
    );
    let log = read_log(&folder.path().join("run.mcap")).unwrap().logs.first().clone();
    let headings: Vec<f64> = log.stops().iter().map(|stop| stop.heading_rad.unwrap().to_degrees().round()).collect();
    assert_eq!(headings[1..], [0.0, 0.0, 90.0, 180.0, 180.0, 90.0, 0.0, 0.0]);
    robot_log::write(&folder.path().join("log"), &log).unwrap();
    let places = |log: &str, words: &[&str]| {
        let again = map(folder.path(), log, &[&["--out", "places.csv"], words].concat()).unwrap();
        (std::fs::read_to_string(folder.path().join("places.csv")).unwrap(), again)
    };
    let (recorded, again) = places("run.mcap", &[]);
    // Tables have no settings: these are those of the recording.
    let algorithm = "maps.0.algorithm={ mmtm = { grid_step_m = 0.5, z_range_m = [1.0, 3.0], profile.fitted = {} } }";
    let (written, _) = places("log", &["--set", algorithm]);
    assert!(recorded == written && recorded.lines().count() == 21, "{recorded}\n{written}");
    assert_eq!(again["maps"][0]["position_error_m"], found["maps"][0]["position_error_m"]);
    let error_m = found["maps"][0]["position_error_m"]["mean"].as_f64().unwrap();
    assert!(error_m < 0.9, "{error_m} m");
}

#[test]
fn figures_show_the_sectors_of_a_stop_and_the_displacement_of_each_map() {
    let (folder, _) = run_text(&two(), &[]);
    call(folder.path(), &["figure", "run.mcap"]).printed();
    let svg = |name: &str| std::fs::read_to_string(folder.path().join("run.figures").join(name)).unwrap();
    let sectors = svg("sectors.svg");
    assert!(sectors.contains("sectors at a stop") && sectors.contains("of rover"), "a title and a note");
    let displacement = svg("sector-displacement.svg");
    assert!(displacement.contains("joint-ml-tm: ") && !displacement.contains("\nml-tm: "), "maps with sectors only");
}

#[test]
fn the_summary_counts_sweeps_and_answers_and_their_energy() {
    let (_folder, found) = run_text(&one(), &[]);
    let gathering = &found["gathering"];
    assert_eq!((&gathering["stops"], &gathering["sweeps"]), (&9.into(), &27.into()));
    let answers = gathering["packets_offered"].as_f64().unwrap();
    assert!(answers > 20.0 && answers <= 27.0 * 20.0, "{answers} answers");
    // Each answered sweep is received once (0.5 W) and answered from eight sectors (1 W), 14.909 us a frame.
    let expected_j = answers * 14.909e-6 * (0.5 + 8.0);
    let energy_j = found["maps"][0]["message_energy_j"].as_f64().unwrap();
    assert!((energy_j / expected_j - 1.0).abs() < 1e-9, "{energy_j} J, not {expected_j} J");
    for key in ["sector_displacement", "sector_displacement_of_pairs"] {
        let shares: Vec<f64> = serde_json::from_value(found["maps"][0][key].clone()).unwrap();
        assert_eq!(shares.len(), 8 / 2 + 1);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{shares:?}");
    }
    // Where no two nodes are neighbours, no node has a displacement.
    let (_folder, alone) = run_text(&one(), &["--set", "metrics.sector_neighbourhood_m=0.01"]);
    assert_eq!(alone["maps"][0]["sector_displacement"], serde_json::json!([0.0, 0.0, 0.0, 0.0, 0.0]));
}

#[test]
fn the_logs_of_two_networks_are_recorded_and_mapped_by_name() {
    let (folder, found) = run_text(&two(), &[]);
    let path = folder.path().join("run.mcap");
    let recorded = read_log(&path).unwrap();
    assert_eq!(recorded.logs.names().collect::<Vec<_>>(), ["mm", "zigbee"]);
    let zigbee = recorded.logs.named("zigbee").unwrap();
    assert_eq!((zigbee.sectors(), zigbee.stops().len()), (None, 9));
    assert!(recorded.log().sectors().is_some() && zigbee.names() == recorded.log().names());
    assert_eq!(found["gathering"]["stops"], 9);
    let pairs = |log: &sextant_channel::ReceptionLog| log.receptions().iter().filter(|r| r.received > 0).count();
    assert_eq!(found["gathering"]["receptions"], pairs(recorded.log()) + pairs(zigbee));

    let again = map(folder.path(), "run.mcap", &[]).unwrap();
    let names = ["mmtm", "ml-tm", "joint-ml-tm"];
    for (i, name) in names.iter().enumerate() {
        assert_eq!(found["maps"][i]["algorithm"], *name);
        for key in ["networks", "mapped", "position_error_m", "vertices_evaluated", "fitted_profiles"] {
            assert_eq!(again["maps"][i][key], found["maps"][i][key], "{name}: {key}");
        }
    }
    assert_eq!(found["maps"][2]["networks"], serde_json::json!(["mm", "zigbee"]));
    let fitted = found["maps"][2]["fitted_profiles"].as_array().unwrap();
    assert_eq!((fitted.len(), &fitted[0]["network"]), (1, &"zigbee".into()));
    assert!(found["maps"][1].get("sector_displacement").is_none(), "this network has no sectors");

    let refused = map(folder.path(), "run.mcap", &["--network", "nobody"]).unwrap_err();
    assert!(refused.contains("`nobody`") && refused.contains("`mm`, `zigbee`"), "{refused}");
    let of = |network| {
        let words = ["--network", network, "--algorithm", "ml-tm"];
        map(folder.path(), "run.mcap", &words).unwrap()["gathering"]["receptions"].clone()
    };
    assert_eq!(of("mm"), pairs(recorded.log()));
    assert_eq!(of("zigbee"), pairs(zigbee));

    let copy = folder.path().join("copy.mcap");
    recover(&path, &copy, &sextant_kernel::Unwatched).unwrap();
    assert_eq!(read_log(&copy).unwrap().logs, recorded.logs);
}

#[test]
fn maps_of_networks_that_robots_do_not_survey_are_rejected() {
    for (flag, expected) in [
        ("maps.1.network=\"wifi\"", "`maps[1].network` is `wifi`; allowed: `mm`, `zigbee`"),
        ("maps.2.network=\"mm\"", "`maps[2].network` is `mm`; allowed: no key"),
        ("maps.2.algorithm.joint.networks.1.network=\"lora\"", "joint.networks[1].network` is `lora`"),
    ] {
        let folder = TempDir::new().unwrap();
        std::fs::write(folder.path().join("a.toml"), two()).unwrap();
        let error = call(folder.path(), &["check", "a.toml", "--set", flag]).refusal();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn tshark_decodes_sweeps_and_answers() {
    let Some(program) = tshark() else { return };
    let (folder, found) = run_text(&one(), &["--pcap", "a.pcap", "--set", "maps=[]"]);
    let fields = [
        "wlan.fc.type_subtype",
        "wlan.fcs.status",
        "_ws.malformed",
        "wlan.ssw.direction",
        "wlan.ssw.cdown",
        "wlan.ssw.sector_id",
        "wlan.ssw.dmg_ant_id",
        "radiotap.channel.freq",
    ];
    let rows = dissect(&program, &folder.path().join("a.pcap"), &fields);
    let answers = found["gathering"]["packets_sent"].as_u64().unwrap();
    assert_eq!(rows.len() as u64, 27 * 32 + 8 * answers);
    let mut of_robot = 0;
    for row in &rows {
        let [_, fcs, malformed, direction, cdown, sector, antenna, carrier] = &row[..] else { panic!("{row:?}") };
        assert!(fcs == "1" && malformed.is_empty() && carrier == "60480", "{row:?}");
        let initiates = matches!(direction.as_str(), "0" | "False");
        of_robot += u32::from(initiates);
        let number = |text: &str| {
            let hex = text.strip_prefix("0x");
            hex.map_or_else(|| text.parse::<u32>().unwrap(), |digits| u32::from_str_radix(digits, 16).unwrap())
        };
        // Sectors are swept in their order, those of the two rings of a robot by two DMG antennas.
        let last = if initiates { 31 } else { 7 };
        assert_eq!(number(cdown) + number(sector) + 16 * number(antenna), last, "{row:?}");
    }
    assert_eq!(of_robot, 27 * 32);

    let words = ["--pcap", "a.pcap", "--set", "maps=[]", "--set", "recording.pcap.robot=rover"];
    let (folder, _) = run_text(&one(), &words);
    let heard = dissect(&program, &folder.path().join("a.pcap"), &["wlan.ssw.direction", "radiotap.dbm_antsignal"]);
    assert!(!heard.is_empty() && heard.len() < rows.len());
    for row in &heard {
        assert!(matches!(row[0].as_str(), "1" | "True"), "a robot receives answers only: {row:?}");
        assert!((-61..0).contains(&row[1].parse::<i32>().unwrap()), "{row:?}");
    }

    let (folder, _) = run_text(&two(), &["--pcap", "a.pcap", "--set", "maps=[]"]);
    let both = dissect(&program, &folder.path().join("a.pcap"), &["frame.protocols", "_ws.malformed"]);
    let of = |protocol: &str| both.iter().filter(|row| row[0].contains(protocol)).count();
    assert!(of("wlan") > 0 && of("wpan") > 0 && of("wlan") + of("wpan") == both.len(), "{:?}", &both[..3]);
}
