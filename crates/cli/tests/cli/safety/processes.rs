//! Two processes and one output, and processes that are killed.

use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

use sextant_recording::inspect;

use super::Bench;
use crate::program::sextant;

/// Starts a run that takes the longer, the shorter the interval of its beacons is.
fn start(bench: &Bench, seed: u32, interval_s: f64) -> Child {
    let (seed, beacons) = (seed.to_string(), format!("traffic.beacon.interval_s={interval_s}"));
    let slow = ["--set", &beacons, "--set", "recording.frames=true"];
    let words = ["run", "a.toml", "--out", "a.mcap", "--summary", "a.json", "--quiet", "--seed", &seed];
    sextant().args(words).args(slow).current_dir(bench.folder()).spawn().expect("the program starts")
}

#[test]
fn of_two_runs_with_one_output_each_is_whole_or_is_told() {
    let bench = Bench::new();
    let (mut told, mut wrote) = (0, 0);
    for pair in 0..2 {
        let children = [2 * pair, 2 * pair + 1].map(|seed| start(&bench, seed, 0.05));
        for child in children {
            let output = child.wait_with_output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            match output.status.code() {
                Some(0) => wrote += 1,
                Some(1 | 2) => {
                    assert!(said.contains("is being written by another process"), "{said}");
                    told += 1;
                }
                code => panic!("{code:?}: {said}"),
            }
        }
        let inspected = bench.run("inspect a.mcap");
        let text = String::from_utf8(inspected.stdout).unwrap();
        assert!(inspected.status.success() && !text.contains("broken"), "{text}");
        assert!(serde_json::from_slice::<serde_json::Value>(&bench.read("a.json")).is_ok());
    }
    assert_eq!(told + wrote, 4);
    assert!(wrote >= 2, "one of each pair at least");
    let left = std::fs::read_dir(bench.folder()).unwrap().map(|file| file.unwrap().file_name());
    let left: Vec<_> = left.filter(|name| name.to_string_lossy().contains(".part")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(unix)]
#[test]
fn what_a_killed_run_left_is_kept_and_can_be_recovered() {
    let bench = Bench::new();
    for number in 1..=2 {
        let mut child = start(&bench, number, 0.005);
        while std::fs::metadata(bench.path("a.mcap.part")).map_or(0, |part| part.len()) < 500_000 {
            assert!(child.try_wait().unwrap().is_none(), "the run is too short to be killed");
            thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(number > 1 || !bench.path("a.mcap").exists(), "a killed run must not look finished");
        let left = bench.read("a.mcap.part");
        let kept = format!("a.mcap.part.{number}");
        let said = bench.done("run a.toml --out a.mcap");
        assert!(said.contains(&format!("it is kept as `{kept}`")), "{said}");
        assert_eq!(bench.read(&kept), left);
        let good = format!("recovered-{number}.mcap");
        bench.done(&format!("recover {kept} --out {good}"));
        let inspection = inspect(&bench.path(&good)).unwrap();
        assert!(inspection.damage.is_none() && inspection.to_string().contains("/mac/frames"), "{inspection}");
        assert!(!bench.path("a.mcap.part").exists());
    }
}

#[test]
fn of_two_sweeps_with_one_table_one_is_told() {
    let bench = Bench::new();
    let sweep = || {
        let words = ["sweep", "a.toml", "--runs", "40", "--out", "t.csv", "--resume", "--quiet", "--threads", "1"];
        sextant().args(words).current_dir(bench.folder()).spawn().expect("the program starts")
    };
    let first = sweep();
    while !bench.path("t.csv.parts/000000000-000000040.unfinished-001.csv").exists() {
        thread::sleep(Duration::from_millis(1));
    }
    let said = bench.refused("sweep a.toml --runs 40 --out t.csv --resume");
    assert!(said.contains("another process does this sweep"), "{said}");
    assert!(first.wait_with_output().unwrap().status.success());
    assert_eq!(String::from_utf8(bench.read("t.csv")).unwrap().lines().count(), 41);
}

#[test]
fn of_plans_in_one_folder_one_is_whole_and_the_others_are_told() {
    let bench = Bench::new();
    for round in 0..6 {
        let folder = format!("plan-{round}");
        let words = ["sweep", "a.toml", "--runs", "2", "--no-trial", "--quiet", "--plan", &folder];
        let start = |_| {
            let mut command = sextant();
            let piped = command.args(words).current_dir(bench.folder()).stderr(Stdio::piped()).stdout(Stdio::null());
            piped.spawn().expect("the program starts")
        };
        let children: Vec<Child> = (0..4).map(start).collect();
        let mut wrote = 0;
        for child in children {
            let output = child.wait_with_output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            let is_told = ["another process writes a plan there", "there is a plan in", "it has `unfinished`"];
            match output.status.code() {
                Some(0) => wrote += 1,
                Some(1 | 2) => assert!(is_told.iter().any(|told| said.contains(told)), "{said}"),
                code => panic!("{code:?}: {said}"),
            }
        }
        assert_eq!(wrote, 1);
        bench.done(&format!("sweep {folder} --cells 0..2 --quiet"));
        bench.done(&format!("sweep {folder} --collect --out table.csv --force --quiet"));
        assert!(!bench.path(&folder).join("unfinished").exists());
    }
}
