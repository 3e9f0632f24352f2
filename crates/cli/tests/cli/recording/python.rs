//! Recordings are readable by independent readers: the Python packages for MCAP and protobuf.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use sextant_channel::{Contact, Reception, ReceptionLog};
use sextant_kernel::RobotId;
use sextant_recording::PlacedNode;

use super::sample;
use crate::program::{self, Said};

const PACKAGES: &str = "mcap mcap-protobuf-support";

/// Runs Python: `$SEXTANT_PYTHON`, or `python3`.
fn python(arguments: &[&str]) -> std::io::Result<Output> {
    let python = std::env::var("SEXTANT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    Command::new(python).args(arguments).output()
}

/// Whether Python has the packages. A Python that `SEXTANT_PYTHON` names must have them.
fn has_packages() -> bool {
    let found =
        python(&["-c", "import mcap.reader, mcap_protobuf.decoder"]).is_ok_and(|output| output.status.success());
    if !found {
        let remedy = format!("`python3 -m pip install {PACKAGES}`, or set SEXTANT_PYTHON to a Python that has them");
        assert!(std::env::var_os("SEXTANT_PYTHON").is_none(), "Python lacks the packages {PACKAGES}: {remedy}");
        // The test harness does not capture this, so a skipped check is visible.
        let _ = writeln!(std::io::stderr(), "skipped: Python lacks the packages {PACKAGES}: {remedy}");
    }
    found
}

/// The expected messages of the log: stops, receptions, and the contacts of each robot.
fn expected(log: &ReceptionLog) -> [Value; 4] {
    let mut receptions = log.receptions().to_vec();
    receptions.sort_by_key(|r| (r.stop, r.node));
    let stops = (0_u32..).zip(log.stops()).map(|(index, stop)| {
        let count = receptions.iter().filter(|r| r.stop == index).count();
        let p = stop.position;
        json!([index, stop.time.as_nanos(), p.x_m, p.y_m, p.z_m, log.robot_name(stop.robot), count])
    });
    let stops = stops.collect();
    let contact = |c: &Contact| json!([c.time.as_nanos(), c.position.x_m, c.position.y_m, c.position.z_m]);
    let reception = |r: &Reception| json!([r.node.0, r.stop, r.received, r.sent, r.sector, r.rssi_dbm]);
    let contacts = |robot| log.contacts().iter().filter(|c| c.robot == RobotId(robot)).map(contact).collect();
    [stops, receptions.iter().map(reception).collect(), contacts(0), contacts(1)]
}

fn topic(schema: &str, messages: impl Into<Value>) -> Value {
    json!({ "schema": schema, "encoding": "protobuf", "messages": messages.into() })
}

#[test]
fn independent_readers_decode_every_message() {
    if !has_packages() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let log = sample::log(21, 6, 120);
    sample::record_file(&path, &log);

    let [stops, receptions, of_surveyor, of_scout] = expected(&log);
    let placed = |n: &PlacedNode| json!([n.node.0, n.position.x_m, n.position.y_m, n.position.z_m, n.error_m]);
    let truth: Value = sample::truth(&log).iter().map(placed).collect();
    let corners = json!([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let half_turn = [std::f64::consts::FRAC_PI_2.sin(), std::f64::consts::FRAC_PI_2.cos()];
    let likelihood = json!([2, 8, [-1.25, -2.25], 0.5, ["-1.0", "-2.0", "-inf", "-4.0"]]);
    let sensed = json!([
        [13, 1, "entered", "intruder", null],
        [14, 1, "sampled", "intruder", -0.5],
        [15, 1, "left", "intruder", null],
    ]);
    let mapped_node = json!({
        "node": 1, "role": "new_anchor", "anchor_since": 2, "category": "good", "x_m": 1.25, "neighbours": 40,
        "scattered": 3, "vertices": 1_u64 << 40, "energy_j": 0.1, "bearings": 0,
    });
    let whole_way =
        json!({ "id": "surveyor", "lifetime_ns": 0, "lines": [[0, corners, []]], "texts": [], "spheres": [] });
    let agents_way =
        json!({ "id": "agent", "lifetime_ns": 0, "lines": [[0, corners, []]], "texts": [], "spheres": [] });
    let leg = json!({
        "id": "surveyor 1", "lifetime_ns": 0, "lines": [[0, [corners[0], corners[1]], []]], "texts": [], "spheres": [],
    });
    let heard = json!({
        "id": "surveyor", "lifetime_ns": 1_000_000_002, "lines": [[2, corners, [0, 1, 0, 2]]], "texts": [], "spheres": [],
    });
    let on_air = json!({
        "id": "air", "lifetime_ns": 1_000, "lines": [[2, [corners[0], corners[2]], []]], "texts": [], "spheres": [],
    });
    let name = json!({
        "id": "names", "lifetime_ns": 0, "lines": [], "texts": [["post", corners[1]]], "spheres": [],
    });
    let all_gone = json!([{ "deleted": 1 }]);
    let drawings = json!({
            "/world/names": topic("foxglove.SceneUpdate", json!([[name]])),
            "/robot/surveyor/way": topic("foxglove.SceneUpdate", json!([[whole_way]])),
            "/robot/surveyor/legs": topic("foxglove.SceneUpdate", json!([[leg], all_gone])),
            "/application/search/way/agent": topic("foxglove.SceneUpdate", json!([[agents_way]])),
            "/application/search/legs/agent": topic("foxglove.SceneUpdate", json!([all_gone])),
            "/robot/surveyor/stops": topic("foxglove.PointCloud", json!([[[0.0, 0.0, 0.0, 2]]])),
            "/robot/surveyor/heard": topic("foxglove.SceneUpdate", json!([[heard]])),
            "/application/search/places/agent/own_place":
                topic("foxglove.PointCloud", json!([[[1.0, 0.0, 0.0, null]]])),
            "/mac/air": topic("foxglove.SceneUpdate", json!([[on_air]])),
    });
    // The script does the comparison, because its JSON reader is exact to the last bit of a number.
    let mut expectation = json!({
        "library": concat!("sextant ", env!("CARGO_PKG_VERSION")),
        "profile": "",
        "compression": ["zstd"],
        "metadata": { "sextant": { "scenario": "sample", "seed": "42", "version": "1.2.3" } },
        "attachments": { "scenario.toml": "name = \"sample\"\n", "summary.json": "{\"maps\": []}" },
        "topics": {
            "/stops": topic("sextant.Stop", stops),
            "/receptions": topic("sextant.Reception", receptions),
            "/robot/surveyor/contacts": topic("sextant.Contact", of_surveyor),
            "/robot/scout/contacts": topic("sextant.Contact", of_scout),
            "/nodes": topic("sextant.Nodes", json!([[0, log.names()]])),
            "/anchors": topic("sextant.Anchor", json!([[0, 7.0, 8.0, 9.0]])),
            "/neighbours": topic("sextant.Link", json!([[5, 0, 4, 5, -66.5]])),
            "/beacons": topic("sextant.Link", json!([[5, 0, 4, 5, -66.5]])),
            "/world/nodes": topic("foxglove.PointCloud", json!([truth])),
            "/map/ml-tm": topic("foxglove.PointCloud", json!([[[1, 4.0, 5.0, 6.0, 0.25]]])),
            "/tf": topic("foxglove.FrameTransform", json!([[5, "world", "surveyor", [1.0, 2.0, 3.0], half_turn]])),
            "/robot/surveyor/path": topic("foxglove.PosesInFrame", json!([["world", corners]])),
            "/world/obstacles": topic("foxglove.SceneUpdate", json!([[["wall", 3, [0, 1, 2]]]])),
            "/mac/frames": topic("sextant.Frame", json!([[9, 1000, 3, "418800", "received", -71.5, "inner"]])),
            "/metrics": topic("sextant.Metric", json!([[7, "path_length_m", 12.5]])),
            "/log": topic("foxglove.Log", json!([[8, 3, "survey", "nobody heard"]])),
            "/likelihood/ml-tm/n12": topic("foxglove.Grid", json!([likelihood])),
            "/distributed/nodes": topic("sextant.MappedNode", json!([mapped_node])),
            "/sensors": topic("sextant.Sensors", json!([[2.5, null, null, null]])),
            "/sensed": topic("sextant.Sensed", sensed),
            "/world/targets/intruder":
                topic("foxglove.FrameTransform", json!([[12, "world", "intruder", [1.5, 2.5, 0.0], [0.0, 1.0]]])),
            "/world/fields/gas": topic("foxglove.Grid", json!([likelihood])),
        },
    });
    let topics = expectation["topics"].as_object_mut().unwrap();
    topics.extend(drawings.as_object().unwrap().clone());
    let expected = folder.path().join("expected.json");
    std::fs::write(&expected, expectation.to_string()).unwrap();

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/python/check_recording.py");
    let found = python(&[&script, &path, &expected].map(|path| path.to_str().unwrap())).unwrap().json();
    assert!(found["chunks"].as_u64().unwrap() >= 120 / 32, "chunks are closed by count");
}

/// Runs the program in `folder`.
fn sextant(folder: &Path, arguments: &[&str]) {
    let status = program::sextant().current_dir(folder).args(arguments).status().unwrap();
    assert!(status.success(), "{arguments:?}");
}

#[test]
fn a_recording_plays_and_its_drawings_say_the_same_as_its_log() {
    if !has_packages() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/smoke.toml");
    let scenario = root.to_str().unwrap();
    let snapshots = ["--set", "recording.map_snapshots=3"];
    sextant(folder.path(), &[&["run", scenario, "--out", "run.mcap", "--quiet"][..], &snapshots].concat());
    sextant(folder.path(), &["figure", "run.mcap", "--layout"]);

    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/python/check_playing.py");
    let [recording, layout, blueprint] =
        ["run.mcap", "run.foxglove.json", "run.rerun.py"].map(|name| folder.path().join(name));
    let counts = python(&[&script, &recording, &layout].map(|path| path.to_str().unwrap())).unwrap().json();
    let is_drawn = |what: &str| counts[what].as_u64().is_some_and(|count| count > 0);
    assert!(["robots", "legs", "heard", "names"].into_iter().all(is_drawn), "{counts}");
    let maps = counts["maps"].as_object().unwrap();
    assert!(!maps.is_empty() && maps.values().all(|count| *count == 4), "{counts}");
    python(&["-m", "py_compile", blueprint.to_str().unwrap()]).unwrap().printed();
}
