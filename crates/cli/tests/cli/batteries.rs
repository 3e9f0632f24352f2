//! Batteries on the command line: what a recording, its tables and a sweep say of them, and what they are refused with.

use std::fs;
use std::process::Command;

use crate::program::{Said, scenario, sets, sextant, summary, table};

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
    let mut command = sextant();
    command.arg("run").arg(scenario("batteries/slots-tree.toml")).args(sets(&settings)).arg("--quiet");
    runs(command.arg("--out").arg(path("a.mcap")).arg("--summary").arg(path("summary.json")));
    let summary = summary(&path("summary.json"));
    runs(sextant().arg("export").arg(path("a.mcap")).arg("--out").arg(path("tables")));
    let batteries = table(&path("tables/batteries.csv"));
    let nodes = summary["battery"]["nodes"].as_array().expect("nodes");
    assert_eq!(batteries.len(), nodes.len());
    let mut deaths = 0;
    for (row, node) in batteries.iter().zip(nodes) {
        assert_eq!(row["node"], node["name"]);
        for key in ["left_j", "mean_power_w", "lifetime_d", "depleted_s"] {
            // An absent number is an empty cell.
            let (found, expected) = (row[key].parse::<f64>().ok(), node[key].as_f64());
            let differs = found.unwrap_or(-1.0) - expected.unwrap_or(-1.0);
            assert!(differs.abs() < 1e-9, "{key}: {found:?}, not {expected:?}");
        }
        deaths += u64::from(!row["depleted_s"].is_empty());
    }
    assert_eq!(Some(deaths), summary["battery"]["depleted"].as_u64());
    assert!(deaths > 1, "{deaths}");
    let log = fs::read_to_string(path("tables/log.csv")).expect("a table");
    assert_eq!(log.matches("its battery is empty").count() as u64, deaths);
    // What waited in nodes that died is in the trace as it is in the summary.
    let packets = table(&path("tables/mac_packets.csv"));
    let died = packets.iter().filter(|row| row["fate"] == "died").count() as u64;
    assert!(died > 0 && packets.iter().all(|row| row["fate"] != "died" || row["end"] == "died"));
    assert_eq!(summary["mac"]["died"].as_u64(), Some(died));
}

#[test]
fn a_sweep_has_lifetimes_and_deaths() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table.csv");
    let mut command = sextant();
    command.arg("sweep").arg(scenario("batteries/dying-tree.toml")).args(["--runs", "1", "--quiet", "--out"]);
    runs(command.arg(&path).args(["--set", "battery.capacity_mah=2.0", "--set", "duration_s=600"]));
    let found = table(&path);
    let cell = |row: usize, name: &str| found[row][name].parse::<f64>().unwrap_or_else(|_| panic!("{name}: {row}"));
    // 2 mAh at 18.8 mA: 383 s. Without a spread, all die then.
    assert_eq!(found.len(), 3);
    for name in ["battery.first_death_s", "battery.half_death_s"] {
        assert!((cell(0, name) - 383.0).abs() < 1.0, "{name}");
    }
    assert!(cell(2, "battery.first_death_s") < cell(1, "battery.first_death_s"));
    assert!((cell(0, "battery.lifetime_d.median") - 383.0 / 86_400.0).abs() < 1e-5);
    assert!((cell(0, "battery.depleted") - 50.0).abs() < 0.5);
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
