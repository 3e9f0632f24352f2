//! Batteries on the command line: what a recording, its tables and a sweep say of them, and what they are refused with.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::program::{Said, scenario, sextant};

/// The rows of a table without quoted cells, after its header.
fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

/// Runs a command that must succeed.
fn runs(command: &mut Command) {
    command.output().expect("it starts").printed();
}

#[test]
fn a_recording_has_each_battery_and_each_death() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let settings =
        ["duration_s=3000", "battery.capacity_mah=1.0", "traffic.poisson.rate_per_s=2", "recording.packets=true"];
    let set = settings.iter().flat_map(|setting| ["--set", setting]);
    let mut command = sextant();
    command.arg("run").arg(scenario("batteries/slots-tree.toml")).args(set).arg("--quiet");
    runs(command.arg("--out").arg(path("a.mcap")).arg("--summary").arg(path("summary.json")));
    let text = fs::read_to_string(path("summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&text).expect("JSON");
    runs(sextant().arg("export").arg(path("a.mcap")).arg("--out").arg(path("tables")));
    let read = |name: &str| fs::read_to_string(path("tables").join(name)).expect("a table");
    let batteries = read("batteries.csv");
    assert!(batteries.starts_with("node,capacity_j,left_j,mean_power_w,lifetime_d,depleted_s\n"), "{batteries}");
    let nodes = summary["battery"]["nodes"].as_array().expect("nodes");
    assert_eq!(rows(&batteries).len(), nodes.len());
    let mut deaths = 0;
    for (row, node) in rows(&batteries).into_iter().zip(nodes) {
        assert_eq!(Some(row[0]), node["name"].as_str());
        for (cell, key) in [(2, "left_j"), (3, "mean_power_w"), (4, "lifetime_d"), (5, "depleted_s")] {
            // An absent number is an empty cell.
            let (found, expected) = (row[cell].parse::<f64>().ok(), node[key].as_f64());
            let differs = found.unwrap_or(-1.0) - expected.unwrap_or(-1.0);
            assert!(differs.abs() < 1e-9, "{key}: {found:?}, not {expected:?}");
        }
        deaths += u64::from(!row[5].is_empty());
    }
    assert_eq!(Some(deaths), summary["battery"]["depleted"].as_u64());
    assert!(deaths > 1, "{deaths}");
    assert_eq!(read("log.csv").matches("its battery is empty").count() as u64, deaths);
    // What waited in nodes that died is in the trace as it is in the summary.
    let packets = read("mac_packets.csv");
    let column = |name: &str| packets.lines().next().expect("a header").split(',').position(|cell| cell == name);
    let (end, fate) = (column("end").expect("a column"), column("fate").expect("a column"));
    let died = rows(&packets).iter().filter(|row| row[fate] == "died").count() as u64;
    assert!(died > 0 && rows(&packets).iter().all(|row| row[fate] != "died" || row[end] == "died"));
    assert_eq!(summary["mac"]["died"].as_u64(), Some(died));
}

#[test]
fn a_sweep_has_lifetimes_and_deaths() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    let mut command = sextant();
    command.arg("sweep").arg(scenario("batteries/dying-tree.toml")).args(["--runs", "1", "--quiet", "--out"]);
    runs(command.arg(&path).args(["--set", "battery.capacity_mah=2.0", "--set", "duration_s=600"]));
    let text = fs::read_to_string(&path).expect("a table");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let cell = |row: &[&str], name: &str| {
        let column = header.iter().position(|cell| *cell == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
        row[column].parse::<f64>().unwrap_or_else(|_| panic!("{name}: {row:?}"))
    };
    // 2 mAh at 18.8 mA: 383 s. Without a spread, all die then.
    let found = rows(&text);
    assert_eq!(found.len(), 3);
    for name in ["battery.first_death_s", "battery.half_death_s"] {
        assert!((cell(&found[0], name) - 383.0).abs() < 1.0, "{name}");
    }
    assert!(cell(&found[2], "battery.first_death_s") < cell(&found[1], "battery.first_death_s"));
    assert!((cell(&found[0], "battery.lifetime_d.median") - 383.0 / 86_400.0).abs() < 1e-5);
    assert!((cell(&found[0], "battery.depleted") - 50.0).abs() < 0.5);
}

#[test]
fn batteries_are_refused_where_they_cannot_run_empty() {
    for (name, with) in [
        ("mmtm/two-bands.toml", "mac.sector_sweep"),
        ("dmtm/faults-deaths.toml", "distributed_mapping"),
        ("seek/one-source.toml", "applications"),
    ] {
        let mut command = sextant();
        let output = command.arg("check").arg(scenario(name)).args(["--set", "battery.capacity_mah=1.0"]).output();
        let told = output.expect("it starts").refusal();
        assert!(told.contains("battery") && told.contains(with), "{name}: {told}");
    }
}
