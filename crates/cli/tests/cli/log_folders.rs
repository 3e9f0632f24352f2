//! Outputs in the folders of logs: none becomes a part of the log.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use crate::program::{Said, call, scenario};

/// A folder with the log of the template in `log`, and a table with a column a node alone in `wide`.
fn logs() -> TempDir {
    let folder = TempDir::new().expect("there is room");
    assert!(call(folder.path(), &["init", "log"]).status.success());
    fs::create_dir(folder.path().join("wide")).expect("there is room");
    let mut wide = "x_m,y_m,a,b\n".to_owned();
    for (x_m, y_m) in (0..25).map(|i| (i % 5, i / 5)) {
        wide += &format!("{x_m},{y_m},{},{}\n", -50 - 3 * x_m - 2 * y_m, -70 + 2 * x_m + 3 * y_m);
    }
    fs::write(folder.path().join("wide/rssi.csv"), wide).expect("there is room");
    folder
}

fn refused(folder: &Path, words: &[&str]) {
    let message = call(folder, words).refusal();
    assert!(
        message.contains("a part of the log in its folder") && message.contains("another name"),
        "{words:?}: {message}"
    );
}

#[test]
fn no_output_becomes_a_part_of_a_log() {
    let logs = logs();
    let folder = logs.path();
    let map = ["map", "log", "--quiet", "--algorithm", "packet-centroid"];
    let before = fs::read_dir(folder.join("log")).expect("a folder").count();
    for name in [
        "contacts.csv",
        "sectors.csv",
        "sector_snrs.csv",
        "names.csv",
        "packets.csv",
        "path.csv",
        "CONTACTS.csv",
        "a.gpx",
    ] {
        refused(folder, &[&map[..], &["--out", &format!("log/{name}")]].concat());
    }
    refused(folder, &[&map[..], &["--out", "log/../log/contacts.csv", "--force"]].concat());
    refused(folder, &[&map[..], &["--summary", "log/contacts.csv"]].concat());
    refused(folder, &["report", "log", "--out", "log/contacts.csv"]);
    refused(folder, &["map", "wide", "--out", "log/contacts.csv"]);
    let smoke = scenario("smoke.toml");
    let smoke = smoke.to_str().expect("UTF-8");
    refused(folder, &["run", smoke, "--out", "run.mcap", "--pcap", "log/run.pcap"]);
    refused(folder, &["sweep", smoke, "--runs", "1", "--out", "log/contacts.csv"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("log", folder.join("link")).expect("there is room");
        refused(folder, &[&map[..], &["--out", "link/contacts.csv"]].concat());
    }
    assert_eq!(fs::read_dir(folder.join("log")).expect("a folder").count(), before, "nothing is left");
    for _ in 0..2 {
        call(folder, &[&map[..], &["--out", "log/map.csv"]].concat()).printed();
    }
}

#[test]
fn a_table_alone_in_its_folder_stays_alone() {
    let logs = logs();
    let folder = logs.path();
    let map = ["map", "wide", "--quiet", "--algorithm", "packet-centroid"];
    refused(folder, &[&map[..], &["--out", "wide/map.csv"]].concat());
    for _ in 0..2 {
        call(folder, &[&map[..], &["--out", "map.csv", "--summary", "wide/summary.json"]].concat()).printed();
    }
}
