//! Each packet that is offered has one outcome: in the printed table, in the summary and in the columns of sweeps of every
//! scenario that counts packets.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::program::{self, Said, scenario, sets, sextant};

/// All scenarios in a folder and those below it.
fn scenarios(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            scenarios(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "toml") {
            found.push(path);
        }
    }
}

fn output(arguments: &[&str], file: &Path, out: &Path) -> Output {
    sextant().args(arguments).arg(file).arg("--out").arg(out).output().expect("the program starts")
}

/// The numbers of a printed table by the name of their row, which ends where two spaces follow.
fn printed(table: &str) -> BTreeMap<String, u64> {
    let row = |line: &str| {
        let (name, rest) = line.trim().split_once("  ")?;
        Some((name.to_owned(), rest.split_whitespace().next()?.parse().ok()?))
    };
    table.lines().filter_map(row).collect()
}

/// The labels that stand at two lines of one block of a printed text. A line of columns has its first column as its label,
/// and a sentence itself without its numbers.
fn twice(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for block in text.split("\n\n") {
        let mut labels = Vec::new();
        // Several robots may end in the same way.
        for line in block.lines().map(str::trim).filter(|line| !line.contains(": ended because")) {
            let label = match line.split_once("  ") {
                Some((label, _)) => label.to_owned(),
                None => line.replace(|letter: char| letter.is_ascii_digit(), ""),
            };
            if labels.contains(&label) {
                found.push(label);
            } else {
                labels.push(label);
            }
        }
    }
    found
}

#[test]
fn lines_of_a_survey_and_of_its_traffic_to_sinks_have_different_labels() {
    let folder = tempfile::tempdir().expect("there is room");
    let file = folder.path().join("sink.toml");
    let smoke = scenario("smoke.toml");
    let sink = "[[sinks]]\nname = \"sink\"\nposition_m = [-1.0, 5.0]\n";
    let robot = "[[robots]]\nname = \"second\"\nstart_m = [-2.0, -2.0]\nlisten_s = 1.2\n\
                 [robots.controller.waypoints]\nplaces_m = [[0.0, 0.0], [3.0, 0.0]]\n";
    fs::write(&file, format!("extends = {smoke:?}\n{sink}")).expect("a file");
    let table = output(&["run", "--quiet"], &file, &folder.path().join("a.mcap")).printed();
    assert_eq!(twice(&table), [""; 0], "{table}");
    assert!(table.contains("traffic to sinks\n"), "{table}");
    assert!(table.contains("surveyor: ended at the end of its path, after "), "{table}");
    // A list of robots replaces that of the other file.
    fs::write(&file, format!("extends = {smoke:?}\n{robot}")).expect("a file");
    let json = output(&["run", "--quiet", "--format", "json"], &file, &folder.path().join("b.mcap")).json();
    let robot = &json["gathering"]["robots"][0];
    assert_eq!((&robot["ended"], &robot["ending"]), (&"path-ended".into(), &"complete".into()));
    assert!(robot["unreached"].as_array().is_some_and(|nodes| !nodes.is_empty()), "{robot}");
    assert_eq!(twice("a  1\nb  2\na  3\n"), ["a"]);
}

/// Names of the outcomes in a printed table.
const ROWS: [&str; 8] = [
    "lost to collisions",
    "lost to a busy channel",
    "lost to a full queue",
    "lost to a weak signal",
    "receiver transmitting",
    "receiver asleep",
    "receiver off",
    "pending",
];

/// Names of the outcomes in columns of sweeps and, with their parts as keys, in summaries.
const COLUMNS: [&str; 9] = [
    "lost_collision",
    "lost_channel_access",
    "lost_queue",
    "lost_signal",
    "out_of_range",
    "not_listened_by.transmitting",
    "not_listened_by.asleep",
    "not_listened_by.off",
    "pending",
];

/// The number under a path of keys, joined by dots.
fn at(json: &Value, path: &str) -> u64 {
    let value = path.split('.').fold(json, |value, key| &value[key]);
    value.as_u64().unwrap_or_else(|| panic!("no count {path} in {json}"))
}

/// Checks the packets of a scenario; returns how many were offered, if it counts them.
fn check(file: &Path, folder: &Path, set: &[&str]) -> Option<u64> {
    let name = file.display();
    let set: Vec<&str> = sets(set).collect();
    let json = [&["run", "--quiet", "--format", "json"][..], &set].concat();
    let json = output(&json, file, &folder.join("a.mcap")).json();
    // Where the packets stand in the summary and, behind a prefix, in columns.
    let (key, prefix, received) = if json.get("mac").is_some() {
        ("mac", "mac.", "packets delivered")
    } else if json.get("gathering").is_some() {
        ("gathering", "", "packets received")
    } else {
        return None;
    };
    let (offered_key, received_key) =
        if key == "mac" { ("offered", "delivered") } else { ("packets_offered", "packets_received") };
    let packets = &json[key];
    let offered = at(packets, offered_key);
    let summed = at(packets, received_key) + COLUMNS.iter().map(|column| at(packets, column)).sum::<u64>();
    assert_eq!(summed, offered, "{name}: {packets}");
    let by: u64 = ["transmitting", "asleep", "off"].iter().map(|by| at(&packets["not_listened_by"], by)).sum();
    assert_eq!(by, at(packets, "not_listened"), "{name}");

    let table = output(&[&["run", "--quiet"][..], &set].concat(), file, &folder.join("a.mcap")).printed();
    assert_eq!(twice(&table), [""; 0], "{name}: {table}");
    let table = printed(&table);
    let row = |row: &str| *table.get(row).unwrap_or_else(|| panic!("{name}: no row `{row}` in {table:?}"));
    let out_of_range = if key == "mac" { "out of range" } else { "sent out of range" };
    // With sweeps, what is not sent has another cause than a busy channel.
    let named = |name: &'static str| {
        let of_sweeps = "lost before sending";
        if name == "lost to a busy channel" && table.contains_key(of_sweeps) { of_sweeps } else { name }
    };
    let summed = row(received) + row(out_of_range) + ROWS.iter().map(|name| row(named(name))).sum::<u64>();
    assert_eq!((summed, row("packets offered")), (offered, offered), "{name}: {table:?}");

    // One run of the scenario without its own axes: its columns are those of any sweep.
    let csv = folder.join("sweep.csv");
    let sweep = [&["sweep", "--quiet", "--runs", "1", "--set", "sweep={ runs = 1 }"][..], &set].concat();
    output(&sweep, file, &csv).printed();
    let row = program::table(&csv)[0].clone();
    fs::remove_file(&csv).expect("the next table has the same name");
    let column = |column: &str| {
        let value = row.get(&format!("{prefix}{column}")).unwrap_or_else(|| panic!("{name}: {column} in {row:?}"));
        value.parse::<u64>().unwrap_or_else(|_| panic!("{name}: {column} is `{value}`"))
    };
    let summed = column(received_key) + COLUMNS.iter().map(|name| column(name)).sum::<u64>();
    assert_eq!(summed, column(offered_key), "{name}");
    Some(offered)
}

#[test]
fn each_packet_of_every_scenario_has_one_outcome_in_every_table() {
    let mut files = Vec::new();
    scenarios(&scenario(""), &mut files);
    let folder = tempfile::tempdir().expect("there is room");
    let mut studies = 0;
    for file in files {
        let text = fs::read_to_string(&file).expect("a scenario");
        if !text.contains("[mac.") || text.contains("[mac.sector_sweep]") || !text.contains("[traffic") {
            continue;
        }
        let mut set = vec!["duration_s=0.5", "maps=[]", "applications=[]"];
        set.extend(text.contains("warm_up_s").then_some("warm_up_s=0.0"));
        // Before searches, silent nodes offer nothing.
        studies += u32::from(check(&file, folder.path(), &set).is_some_and(|offered| offered > 0));
    }
    assert!(studies >= 12, "{studies}");
}

#[test]
fn a_sink_that_acknowledges_misses_frames_and_the_table_says_so() {
    let folder = tempfile::tempdir().expect("there is room");
    let file = scenario("mac/saturated-star.toml");
    let set =
        ["--set", "traffic.saturated.acknowledged=true", "--set", "duration_s=5.0", "--format", "json", "--quiet"];
    let json = output(&[&["run"][..], &set].concat(), &file, &folder.path().join("a.mcap")).json();
    let mac = &json["mac"];
    assert!(at(mac, "not_listened_by.transmitting") > 10, "{mac}");
    assert_eq!(at(mac, "not_listened_by.transmitting"), at(mac, "not_listened"), "{mac}");
}
