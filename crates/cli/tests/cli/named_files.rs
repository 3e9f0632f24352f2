//! Recordings carry the files that their scenario names: a map of the recording needs nothing else, and is that of the run.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sextant_channel::{Position, Reception, Stop};
use sextant_kernel::NodeId;
use sextant_recording::{FILES_ATTACHMENTS, read_log};
use tempfile::TempDir;

use crate::program::{self, Said, call, folder, sextant};

/// A network of IEEE 802.15.4 with a map that knows channel and obstacles; nodes, obstacles and traffic are missing.
const SURVEY: &str = "name = \"named\"\nseed = 3\nradio = { tx_power_dbm = -50, sensitivity_dbm = -90 }\n\
    channel = { environment = \"light-tree\", max_range_m = 6.0, path_loss.log_distance.reference_loss_db = 0.0 }\nmac.csma_unslotted = {}\n\
    [[robots]]\nname = \"r\"\nstart_m = [-1, -1]\nlisten_s = 1.5\n\
    controller.waypoints.places_m = [[0, 0], [3, 0], [6, 0], [6, 3], [3, 3], [0, 3], [0, 6], [3, 6], [6, 6]]\n\
    [[maps]]\nalgorithm.ml_tm = { grid_step_m = 0.5, estimate = \"posterior_mean\", \
    profile.channel = { obstacles = \"known\" } }\n";

/// A network of IEEE 802.11ad whose robot has the antenna of a file, with a map by its channel.
const SWEEPS: &str = "name = \"named\"\nseed = 3\nradio = { tx_power_dbm = 20, sensitivity_dbm = -60 }\n\
    channel = { environment = \"mmtm-warehouse\", max_range_m = 7, path_loss.close_in = { carrier_ghz = 73.0 } }\n\
    mac.sector_sweep = {}\nantenna.nodes.sectors = { azimuth_sectors = 8, boresight_gain_dbi = 4.1 }\n\
    antenna.robots.code_book.file = \"files/book.csv\"\n\
    world.nodes.csv.file = \"nodes.csv\"\n\
    [[robots]]\nname = \"r\"\nstart_m = [-1, -1]\nlisten_s = 0.2\n\
    controller.waypoints.places_m = [[0, 0], [3, 0], [6, 0], [6, 3], [3, 3], [0, 3]]\n\
    [[maps]]\nalgorithm.mmtm = { grid_step_m = 0.5, profile.channel = {} }\n";

const NODES: &str = "node,x_m,y_m\na,1,1\nb,4,1.5\nc,2,4\nd,5,5\ne,0.5,5.5\n";
/// A closed tetrahedron round (3, 2, 0).
const MESH: &str = "v 2.5 1.5 -1\nv 3.5 1.5 -1\nv 3 2.5 -1\nv 3 2 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// A code book of four sectors, a quarter turn apart.
fn book() -> String {
    let mut text = "sector,azimuth_deg,elevation_deg,gain_dbi\n".to_owned();
    for sector in 0..4 {
        for azimuth_deg in (-180..180).step_by(30) {
            let gain_dbi = 8.0 * f64::from(azimuth_deg - 90 * sector).to_radians().cos();
            writeln!(text, "{sector},{azimuth_deg},0,{gain_dbi}").expect("there is room");
        }
    }
    text
}

fn json(folder: &Path, words: &[&str]) -> Value {
    call(folder, &[words, &["--quiet"]].concat()).printed();
    program::summary(&folder.join("summary.json"))
}

/// Runs a scenario beside its `files`, maps the recording in another folder, and compares what was recorded and mapped.
fn check(scenario: &str, files: &[(&str, &str)]) {
    let home = folder(&[&[("named.toml", scenario)], files].concat());
    let away = folder(&[]);
    let run = json(home.path(), &["run", "named.toml", "--out", "run.mcap", "--summary", "summary.json"]);
    fs::copy(home.path().join("run.mcap"), away.path().join("run.mcap")).expect("there is room");
    home.close().expect("there is room");
    let recorded = read_log(&away.path().join("run.mcap")).expect("a recording");
    for (name, text) in files {
        let attachment = recorded.attachment(&format!("{FILES_ATTACHMENTS}{name}")).expect("a file");
        assert_eq!(String::from_utf8_lossy(&attachment.data), *text, "{name}");
    }
    let map = json(away.path(), &["map", "run.mcap", "--summary", "summary.json"]);
    let error = |summary: &Value| summary["maps"][0]["position_error_m"].clone();
    assert!(error(&run)["mean"].is_number(), "{run}");
    assert_eq!(error(&map), error(&run));
    assert_eq!(map["maps"][0]["vertices_evaluated"], run["maps"][0]["vertices_evaluated"]);
}

/// A survey of the nodes of a table among a pile, which is a mesh of a file.
fn among_pile() -> String {
    let mesh =
        "[[world.obstacles]]\nname = \"pile\"\nmaterial = \"concrete\"\nshape.mesh.file = \"files/pile.obj\"\n";
    format!("traffic.beacon = {{ interval_s = 0.5 }}\nworld.nodes.csv.file = \"nodes.csv\"\n{SURVEY}{mesh}")
}

#[test]
fn a_table_of_nodes_is_carried() {
    let scenario = format!("traffic.beacon = {{ interval_s = 0.5 }}\nworld.nodes.csv.file = \"nodes.csv\"\n{SURVEY}");
    check(&scenario, &[("nodes.csv", NODES)]);
}

#[test]
fn a_mesh_that_a_map_knows_is_carried() {
    check(&among_pile(), &[("nodes.csv", NODES), ("files/pile.obj", MESH)]);
}

#[test]
fn a_trace_of_traffic_is_carried() {
    let rows = (0..60).flat_map(|i| ["a", "b", "c", "d", "e"].map(|node| (f64::from(i) * 0.5, node)));
    let trace = rows.enumerate().fold("t_s,node,mpdu_octets\n".to_owned(), |mut text, (i, (time_s, node))| {
        writeln!(text, "{:.3},{node},20", time_s + 0.05 * (i % 5) as f64).expect("there is room");
        text
    });
    let scenario =
        format!("traffic.trace.file = \"files/trace.csv\"\nworld.nodes.csv.file = \"nodes.csv\"\n{SURVEY}");
    check(&scenario, &[("nodes.csv", NODES), ("files/trace.csv", &trace)]);
}

#[test]
fn a_code_book_is_carried_and_gives_its_gain_to_the_map() {
    check(SWEEPS, &[("nodes.csv", NODES), ("files/book.csv", &book())]);
}

#[test]
fn a_map_for_an_application_is_carried() {
    let application = "[[applications]]\nname = \"search\"\nrobots = [\"agent\"]\nduration_s = 1\n\
        map.file = \"files/map.csv\"\nalgorithm.detarsk = {}\n";
    let agent = "[[sinks]]\nname = \"s\"\nposition_m = [3, 3]\n[[robots]]\nname = \"agent\"\nrole = \"agent\"\nstart_m = [0, 0]\nspeed_m_per_s = 2\n";
    let target =
        "[[world.targets]]\nname = \"t\"\nmotion.waypoints = { places_m = [[5, 1], [5, 4]], speed_m_per_s = 0.5 }\n";
    let scenario = format!(
        "traffic.beacon = {{ interval_s = 0.5 }}\nworld.nodes.csv.file = \"nodes.csv\"\nsensors.targets.radius_m = 3\n\
         {SURVEY}{agent}{target}{application}"
    )
    .replace("mac.csma_unslotted = {}", "mac.csma_unslotted = { rx_on_when_idle = true }");
    check(&scenario, &[("nodes.csv", NODES), ("files/map.csv", NODES)]);
}

#[test]
fn a_recording_without_its_files_is_refused_by_the_map_that_needs_them() {
    // The file of the working folder is not the one of the run.
    let folder = folder(&[("files/pile.obj", MESH)]);
    let text = among_pile();
    let mut recorder =
        sextant_recording::FileRecorder::create(&folder.path().join("old.mcap")).expect("there is room");
    recorder.scenario(&text).expect("there is room");
    recorder.nodes(&["a".to_owned()]).expect("there is room");
    let stop = Stop::at(Position::ORIGIN);
    let (node, sector, rssi_dbm, snr_db) = (NodeId(0), None, None, None);
    let heard = Reception { node, stop: 0, received: 1, sent: 2, sector, rssi_dbm, snr_db };
    recorder.stop(None, "r", 0, &stop, &[heard]).expect("there is room");
    recorder.finish().expect("there is room");
    let message = call(folder.path(), &["map", "old.mcap"]).refusal();
    assert!(message.contains("pile.obj") && message.contains("attached to the recording"), "{message}");
}

/// A folder may have any name, and a sweep compares the absolute paths of the files that its scenarios name.
#[cfg(target_os = "linux")]
#[test]
fn a_sweep_and_a_check_work_in_a_folder_whose_name_is_no_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let home = TempDir::new().expect("there is room");
    let folder = home.path().join(OsStr::from_bytes(b"f\xff"));
    fs::create_dir_all(folder.join("cells")).expect("there is room");
    let base = format!("{SURVEY}[world.nodes.csv]\nfile = \"nodes.csv\"\n[traffic.periodic]\ninterval_s = 0.5\n");
    let sweep = "extends = \"../base.toml\"\nname = \"swept\"\n[sweep]\nruns = 1\n[sweep.product]\nradio.tx_power_dbm = [-50, -55]\n";
    for (name, text) in [("base.toml", base.as_str()), ("nodes.csv", NODES), ("cells/sweep.toml", sweep)] {
        fs::write(folder.join(name), text).expect("there is room");
    }
    let scenario = folder.join("cells/sweep.toml");
    let program = |words: &[&str], out: &str| {
        let mut command = sextant();
        command.current_dir(home.path()).args(words).arg(&scenario).args(out.split_whitespace());
        let output = command.output().expect("the program starts");
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    program(&["sweep"], "--out table.csv");
    let table = fs::read_to_string(home.path().join("table.csv")).expect("a table");
    assert_eq!(table.lines().count(), 3, "{table}");
    let checked: Value = serde_json::from_slice(&program(&["check"], "--format json")).expect("JSON");
    assert_eq!(checked[0]["cells"], 2);
}
