//! The drive that all bags in `bags` and captures in `captures` hold; the scripts beside them wrote them.
//!
//! For 6 s a robot drives along y = 2 m at 0.5 m/s from x = 0. In second k, node n is heard at 0.25 s and 0.75 s with a level
//! of -50 - 5 n - k dBm: node 0 in each second, node 1 in seconds 1 to 4, node 2 in second 2.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use sextant_logs::{ReadOptions, RobotLog, StopRule};

use super::program::sextant;

/// The seconds in which each node is heard, two times each.
const HEARD: [&[u32]; 3] = [&[0, 1, 2, 3, 4, 5], &[1, 2, 3, 4], &[2]];

/// A file that is kept beside the tests.
pub(crate) fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli").join(name)
}

/// Stops of a second each, in which each node sends two packets.
pub(crate) fn options() -> ReadOptions {
    ReadOptions {
        stop_every: StopRule::Time(Duration::from_secs(1)),
        packet_interval_s: Some(0.5),
        ..ReadOptions::default()
    }
}

/// Checks that `log` holds the drive, with the `names` of the nodes and their RSSI if `has_rssi` says so.
pub(crate) fn assert_holds(log: &RobotLog, names: [&str; 3], has_rssi: [bool; 3]) {
    let log = &log.log;
    assert_eq!(log.stops().len(), 6);
    for (second, stop) in (0..).zip(log.stops()) {
        // The mean place in this second.
        let expected_m = 0.5 * f64::from(second) + 0.25;
        let found = stop.position;
        let distance_m = f64::hypot(found.x_m - expected_m, found.y_m - 2.0).max(found.z_m.abs());
        assert!(distance_m < 1e-6, "stop {second} is at {found}");
    }
    assert_eq!(log.names(), names);
    for (node, seconds) in (0..).zip(HEARD) {
        for stop in 0..6 {
            let heard = log.receptions().iter().find(|at| at.node.0 == node && at.stop == stop);
            let received = heard.map_or(0, |at| at.received);
            assert_eq!(received, if seconds.contains(&stop) { 2 } else { 0 }, "node {node}, stop {stop}");
            let level = heard.and_then(|at| at.rssi_dbm);
            let expected =
                (received > 0 && has_rssi[node as usize]).then(|| -50.0 - 5.0 * f64::from(node) - f64::from(stop));
            assert_eq!(level, expected, "node {node}, stop {stop}");
        }
    }
}

/// The path of the robot as CSV, 2 poses a second, from 1.7e9 s and `start_ns` on.
pub(crate) fn path_csv(start_ns: u32) -> String {
    let row = |half: u32| {
        let whole = 1_700_000_000 + u64::from(half / 2);
        let nanos = start_ns + 500_000_000 * (half % 2);
        format!("{whole}.{nanos:09},{},2\n", 0.25 * f64::from(half))
    };
    let rows: String = (0..=12).map(row).collect();
    format!("t_s,x_m,y_m\n{rows}")
}

/// Runs `sextant map LOG WORDS`; returns exit code, standard output and standard error.
pub(crate) fn map(log: &Path, words: &[&str]) -> Output {
    sextant().arg("map").arg(log).args(words).output().unwrap()
}
