//! `sextant run` from end to end: its outputs, also after an interrupt or a failure.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use sextant_recording as recording;
use sha2::{Digest, Sha256};
use tempfile::TempDir;

#[cfg(unix)]
use crate::program::signal;
use crate::program::{Said, scenario, sextant, summary};

fn run(arguments: &[&str], out: &Path) -> std::process::Output {
    sextant()
        .arg("run")
        .arg(scenario("smoke.toml"))
        .arg("--out")
        .arg(out)
        .args(arguments)
        .output()
        .expect("it starts")
}

#[test]
fn the_same_scenario_and_seed_give_the_same_bytes_at_any_number_of_threads() {
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name);
    let mut summaries = Vec::new();
    for (threads, name) in [("1", "one.mcap"), ("2", "two.mcap")] {
        let json = file(&format!("{name}.json"));
        run(&["--threads", threads, "--summary", json.to_str().unwrap()], &file(name)).printed();
        let mut summary = summary(&json);
        assert!(summary.as_object_mut().unwrap().remove("timing").is_some());
        summaries.push(summary);
    }
    assert_eq!(summaries[0], summaries[1]);
    let bytes = |name| std::fs::read(file(name)).unwrap();
    assert!(bytes("one.mcap") == bytes("two.mcap"), "the recordings differ");
    let other = run(&["--seed", "2"], &file("other.mcap"));
    assert!(other.status.success());
    assert!(bytes("one.mcap") != bytes("other.mcap"), "another seed gave the same recording");
}

#[test]
fn the_hash_of_a_scenario_is_that_of_the_text_in_its_recording() {
    let folder = TempDir::new().unwrap();
    let digest = |bytes: &[u8]| Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let file = std::fs::read(scenario("smoke.toml")).unwrap();
    let mut hashes = Vec::new();
    for (name, arguments) in [("plain", &[][..]), ("seeded", &["--seed", "5"]), ("set", &["--set", "seed=5"])] {
        let (mcap, json) = (folder.path().join(format!("{name}.mcap")), folder.path().join(format!("{name}.json")));
        run(&[arguments, &["--summary", json.to_str().unwrap()]].concat(), &mcap).printed();
        let recorded = recording::read_log(&mcap).unwrap();
        let attached = recorded.attachment("scenario.toml").expect("the scenario");
        let hash = summary(&json)["scenario"]["sha256"].as_str().unwrap().to_owned();
        assert_eq!(hash, digest(&attached.data), "{name}");
        hashes.push(hash);
    }
    assert_eq!(hashes[0], digest(&file));
    assert_eq!(hashes[1], hashes[0]);
    assert_ne!(hashes[2], hashes[0]);
}

#[test]
fn the_summary_has_the_keys_that_scripts_rely_on_and_its_packets_add_up() {
    let folder = TempDir::new().unwrap();
    let output = run(&["--format", "json"], &folder.path().join("smoke.mcap"));
    let json: Value = serde_json::from_slice(&output.stdout).expect("one JSON object on standard output");
    for (table, keys) in [
        ("scenario", &["name", "file", "sha256", "seed", "version"][..]),
        ("simulation", &["sim_time_s", "events", "nodes", "obstacles"]),
        (
            "gathering",
            &[
                "stops",
                "path_length_m",
                "duration_s",
                "packets_offered",
                "packets_sent",
                "packets_received",
                "receptions",
                "lost_collision",
                "lost_channel_access",
                "lost_signal",
                "energy_j",
            ],
        ),
        ("timing", &["wall_s", "gather_s", "map_s", "events_per_s", "peak_rss_bytes"]),
    ] {
        for key in keys {
            assert!(!json[table][key].is_null(), "{table}.{key} is missing: {json:#}");
        }
    }
    let map = &json["maps"][0];
    for key in ["algorithm", "mapped", "unmapped", "connectivity_error", "false_neighbour_rate", "grid_step_m"] {
        assert!(!map[key].is_null(), "maps[0].{key} is missing: {map:#}");
    }
    for key in ["mean", "median", "p90", "p95", "max"] {
        assert!(map["position_error_m"][key].is_f64() && map["aligned_error_m"][key].is_f64(), "{key}: {map:#}");
    }
    let count = |key: &str| json["gathering"][key].as_u64().unwrap_or_default();
    let ends = [
        "packets_received",
        "lost_collision",
        "lost_channel_access",
        "lost_signal",
        "lost_queue",
        "out_of_range",
        "not_listened",
        "pending",
    ];
    assert_eq!(ends.iter().map(|key| count(key)).sum::<u64>(), count("packets_offered"));
}

#[test]
fn a_map_of_the_recording_equals_the_map_of_the_run() {
    let folder = TempDir::new().unwrap();
    let (mcap, of_run, of_map) =
        (folder.path().join("smoke.mcap"), folder.path().join("run.json"), folder.path().join("map.json"));
    assert!(run(&["--summary", of_run.to_str().unwrap()], &mcap).status.success());
    sextant().arg("map").arg(&mcap).arg("--summary").arg(&of_map).output().unwrap().printed();
    let (mut of_run, of_map) = (summary(&of_run), summary(&of_map));
    let [bound_m, energy_j] = take_what_only_a_run_knows(&mut of_run["maps"][0]);
    assert!((0.01..1.0).contains(&bound_m), "{bound_m}");
    assert!(energy_j > 0.0);
    assert_eq!(of_run["maps"], of_map["maps"]);
    assert_same_gathering(&of_run["gathering"], &of_map["gathering"]);
}

/// Checks that each key of the `gathering` of a map has the same value as in the run of its log, and that
/// `packets_received` is present if there is one robot, and `packets_received_by_robots` if there are several.
fn assert_same_gathering(of_run: &Value, of_map: &Value) {
    let robots = |gathering: &Value| gathering["robots"].as_array().expect("robots").clone();
    // A log of several robots does not tell which packets were received twice; a run does.
    let by_robots = of_map.get("packets_received_by_robots");
    assert_eq!(by_robots.is_some(), robots(of_map).len() > 1);
    if let Some(by_robots) = by_robots {
        assert!(by_robots.as_u64() >= of_run["packets_received"].as_u64(), "{by_robots}");
    }
    let same = |run: &Value, map: &Value| {
        let others = ["robots", "packets_received_by_robots"];
        for (key, value) in
            map.as_object().expect("a table").iter().filter(|(key, _)| !others.contains(&key.as_str()))
        {
            assert_eq!(run.get(key), Some(value), "{key}");
        }
    };
    let mut shared = of_map.clone();
    let by_robots = shared.as_object_mut().expect("a table").remove("packets_received_by_robots");
    assert_eq!(by_robots.is_some(), robots(of_run).len() > 1);
    same(of_run, &shared);
    assert_eq!(robots(of_run).len(), robots(of_map).len());
    for robot in robots(of_map) {
        let twin = robots(of_run).into_iter().find(|other| other["name"] == robot["name"]);
        same(&twin.expect("a robot of this name"), &robot);
    }
    assert_eq!(of_map.get("packets_received").is_some(), robots(of_run).len() == 1);
}

#[test]
fn the_gathering_of_a_run_and_of_the_map_of_its_recording_are_equal() {
    let folder = TempDir::new().unwrap();
    for (i, (name, setting)) in [
        ("ml-tm/trajectory-s.toml", "robots.0.listen_s=4.7"),
        ("mac/beacon-enabled.toml", "seed=2"),
        ("smoke.toml", "reception={ ber = {} }"),
    ]
    .into_iter()
    .enumerate()
    {
        let file = |kind: &str| folder.path().join(format!("{i}.{kind}"));
        let mut command = sextant();
        command.arg("run").arg(scenario(name)).args(["--set", setting]);
        command.arg("--out").arg(file("mcap")).arg("--summary").arg(file("run")).output().unwrap().printed();
        sextant().arg("map").arg(file("mcap")).arg("--summary").arg(file("map")).output().unwrap().printed();
        let (of_run, of_map) = (summary(&file("run")), summary(&file("map")));
        assert_same_gathering(&of_run["gathering"], &of_map["gathering"]);
        assert!(
            of_run["gathering"]["packets_received"].as_u64() > of_run["gathering"]["receptions"].as_u64(),
            "{name}"
        );
    }
}

#[test]
fn two_robots_share_one_log_and_each_has_its_row() {
    let folder = TempDir::new().unwrap();
    let (mcap, of_run, of_map) =
        (folder.path().join("two.mcap"), folder.path().join("run.json"), folder.path().join("map.json"));
    let mut command = sextant();
    command.arg("run").arg(scenario("ml-tm/two-robots.toml")).arg("--out").arg(&mcap).arg("--summary").arg(&of_run);
    let text = command.output().unwrap().printed();
    assert!(text.contains("path of west") && text.contains("path of east"), "{text}");
    let mut of_run = summary(&of_run);
    let gathering = &of_run["gathering"];
    let robots = gathering["robots"].as_array().unwrap();
    let of_robots = |key: &str| robots.iter().map(|robot| robot[key].as_f64().unwrap()).collect::<Vec<_>>();
    assert_eq!(robots.len(), 2);
    assert!(robots.iter().all(|robot| robot["ending"] == "complete" && robot.get("unreached").is_none()));
    let sum = |key| of_robots(key).iter().sum::<f64>();
    assert!((sum("path_length_m") - gathering["path_length_m"].as_f64().unwrap()).abs() < 1e-9);
    assert!((sum("stops") - gathering["stops"].as_f64().unwrap()).abs() < 1e-9);
    let longest_s = of_robots("duration_s").into_iter().fold(0.0, f64::max);
    assert!((longest_s - gathering["duration_s"].as_f64().unwrap()).abs() < 1e-9);
    // The interleaved stops of both are read back from the recording.
    sextant().arg("map").arg(&mcap).arg("--summary").arg(&of_map).output().unwrap().printed();
    take_what_only_a_run_knows(&mut of_run["maps"][0]);
    let of_map = summary(&of_map);
    assert_eq!(of_run["maps"], of_map["maps"]);
    assert_same_gathering(&of_run["gathering"], &of_map["gathering"]);
    let paths = ["west", "east"].map(|name| messages_on(&mcap, &format!("/robot/{name}/path")));
    assert_eq!(paths, [1, 1], "each robot has a path");
}

#[test]
fn robots_that_listen_for_different_times_have_a_map_without_a_bound() {
    let folder = TempDir::new().unwrap();
    let json = folder.path().join("run.json");
    let mut command = sextant();
    command.arg("run").arg(scenario("ml-tm/two-robots.toml")).args(["--set", "robots.1.listen_s=2.5", "--summary"]);
    command.arg(&json).arg("--out").arg(folder.path().join("two.mcap")).output().unwrap().printed();
    let map = &summary(&json)["maps"][0];
    assert_eq!((map["mapped"].as_u64(), map.get("posterior_bound_m")), (Some(496), None));
}

/// Removes the keys of a map that only a run knows, from the true channel and the radios (m, J).
fn take_what_only_a_run_knows(map: &mut Value) -> [f64; 2] {
    let map = map.as_object_mut().expect("a map");
    ["posterior_bound_m", "message_energy_j"].map(|key| map.remove(key).and_then(|value| value.as_f64()).expect(key))
}

/// Number of messages on a topic.
fn messages_on(mcap: &Path, topic: &str) -> usize {
    let bytes = std::fs::read(mcap).expect("a recording");
    let messages = mcap::MessageStream::new(&bytes).expect("a recording");
    messages.filter(|message| message.as_ref().expect("a message").channel.topic == topic).count()
}

/// Waits until a recording has more than its first chunks.
fn wait_for_growth(out: &Path) {
    let part = out.with_extension("mcap.part");
    for _ in 0..1200 {
        if std::fs::metadata(&part).is_ok_and(|file| file.len() > 500_000) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("no recording has grown at {}", part.display());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_complete_recording_of_the_finished_stops() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("cut.mcap");
    // Each of the 100 stops has 0.3 MB of frames, so when the signal comes, some are finished, but most are not.
    let child = sextant()
        .arg("run")
        .arg(scenario("smoke.toml"))
        .args(["--set", "robots.0.listen_s=200", "--set", "recording.frames=true", "--out"])
        .arg(&out)
        .spawn()
        .expect("it starts");
    wait_for_growth(&out);
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", String::from_utf8_lossy(&output.stderr));
    let run = recording::read_log(&out).expect("a whole recording");
    assert!(!run.log().stops().is_empty() && run.log().stops().len() < 100, "{} stops", run.log().stops().len());
    assert!(!out.with_extension("mcap.part").exists());
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_an_error_and_the_data_written_before_is_kept() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("full.mcap");
    // A limit on the size of files has the effect of a full disk: the write that exceeds it fails.
    let script = "trap '' XFSZ; ulimit -f 128; exec \"$0\" run \"$1\" --out \"$2\"";
    let output = Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_sextant")])
        .arg(scenario("smoke.toml"))
        .arg(&out)
        .output()
        .expect("bash starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("cannot write") && error.contains("sextant recover"), "{error}");
    assert!(!out.exists() && out.with_extension("mcap.part").exists());
}

#[test]
fn a_grid_that_is_too_large_is_rejected_with_its_size_and_a_suitable_step() {
    let folder = TempDir::new().unwrap();
    let step = ["--set", "maps.0.algorithm.ml_tm.grid_step_m=1e-6"];
    let error = run(&step, &folder.path().join("smoke.mcap")).refusal();
    assert!(error.contains("vertices") && error.contains("grid_step_m of"), "{error}");
}
