//! The document of a report holds what its input holds, and its page is a sound file.

mod names;
mod page;
mod recording;
mod tables;

use std::io::Read as _;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use serde_json::Value;
use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::{FileRecorder, Origin, PlacedNode};
use tempfile::TempDir;

/// Names of nodes that would break a page that does not escape them.
const HOSTILE: [&str; 3] = ["</script><script>alert(1)</script>", "a\u{0}\u{7}\u{1b}b", "<!-- \" ' & \u{2028} -->"];

/// Where the nodes are (m).
const TRUTH_M: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 1.5]];

/// The summary of the recording: a number that a reader of floats may round.
const SUMMARY: &str = "{\"maps\": [{\"algorithm\": \"ml-tm\", \"mapped\": 2, \"grid_step_m\": 0.48911114622737917}]}";

fn seconds(seconds: u64) -> SimTime {
    SimTime::from_nanos(seconds * 1_000_000_000)
}

fn node(node: u32, [x_m, y_m, z_m]: [f64; 3], error_m: Option<f64>) -> PlacedNode {
    PlacedNode { node: NodeId(node), position: Position::new(x_m, y_m, z_m), error_m }
}

/// A recording of two stops, with a map that is written twice.
fn recorded(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("run.mcap");
    let mut recorder = FileRecorder::create(&path).expect("a folder");
    recorder.origin(Origin { scenario: "</title><b>", seed: 3, version: "1.2.3" }).expect("room");
    let truth: Vec<_> = (0..).zip(TRUTH_M).map(|(i, place)| node(i, place, None)).collect();
    recorder.world_nodes(SimTime::ZERO, &truth).expect("room");
    let stop = |i: u32| Stop { time: seconds(u64::from(i) * 5), ..Stop::at(Position::new(f64::from(i), 1.0, 0.0)) };
    let heard =
        |node: u32, stop: u32| Reception { rssi_dbm: Some(-70.5), ..Reception::heard(NodeId(node), stop, 2, 3) };
    let names = HOSTILE.map(str::to_owned).to_vec();
    let log =
        ReceptionLog::new(names, vec![stop(0), stop(1)], vec![heard(0, 0), heard(0, 1), heard(2, 1)], Vec::new());
    recorder.log(&log.expect("a sound log")).expect("room");
    for (time, x_m) in [(0, 0.0), (5, 1.0)] {
        recorder.robot(seconds(time), "surveyor", Position::new(x_m, 1.0, 0.0), 0.0).expect("room");
    }
    recorder.map(seconds(2), "ml-tm", &[node(0, [1.0, 0.0, 0.0], Some(1.0))]).expect("room");
    let last = [node(0, [0.5, 0.0, 0.0], Some(0.5)), node(2, [0.0, 3.0, 0.0], Some(1.5))];
    recorder.map(seconds(5), "ml-tm", &last).expect("room");
    recorder.scenario("name = \"</script>\"\n").expect("room");
    recorder.summary(SUMMARY).expect("room");
    recorder.finish().expect("room");
    path
}

/// The document in a page.
fn document(html: &str) -> Value {
    let (_, rest) = html.split_once("id=\"data\">").expect("a page has data");
    let (data, _) = rest.split_once("</script>").expect("the data end");
    let packed = base64::engine::general_purpose::STANDARD.decode(data).expect("the data are base64");
    let mut json = Vec::new();
    flate2::read::GzDecoder::new(&packed[..]).read_to_end(&mut json).expect("the data are gzip");
    serde_json::from_slice(&json).expect("the data are JSON")
}

/// The numbers of a column of floats.
fn floats(column: &Value) -> Vec<f64> {
    let text = column["f32"].as_str().expect("a column of floats");
    let octets = base64::engine::general_purpose::STANDARD.decode(text).expect("a column is base64");
    octets.as_chunks::<4>().0.iter().map(|octets| f64::from(f32::from_le_bytes(*octets))).collect()
}

/// A file in `folder`.
fn file(folder: &TempDir, name: &str, content: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, content).expect("room");
    path
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// The root of the tree.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
