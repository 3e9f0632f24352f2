//! Plans of sweeps: parts done anywhere give the table of a local sweep, and nothing foreign gets in.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{self, Said, sextant, signal};
use crate::sweep::SWEEP;

/// A folder with a scenario, which extends another one that names a table of nodes, and its plan in `plan`.
struct Study {
    folder: TempDir,
}

impl Study {
    fn new(sweep: &str) -> Self {
        let folder = TempDir::new().expect("there is room");
        let study = folder.path().join("study");
        fs::create_dir_all(study.join("own")).expect("there is room");
        let smoke = fs::read_to_string(program::scenario("smoke.toml")).expect("the smoke scenario is there");
        let (before, rest) = smoke.split_once("[world.nodes.").expect("it has nodes");
        let (_, after) = rest.split_once("[[world.obstacles]]").expect("obstacles follow");
        let nodes: String =
            (1..=12).map(|i| format!("n{i},{},{},0\n", 2.0 + f64::from(i), 3.0 + f64::from(i % 4))).collect();
        fs::write(study.join("nodes.csv"), format!("node,x_m,y_m,z_m\n{nodes}")).expect("there is room");
        fs::write(
            study.join("base.toml"),
            format!("{before}[world.nodes.csv]\nfile = \"nodes.csv\"\n\n[[world.obstacles]]{after}"),
        )
        .expect("there is room");
        fs::write(study.join("own/s.toml"), format!("extends = \"../base.toml\"\n{sweep}")).expect("there is room");
        Self { folder }
    }

    fn planned(sweep: &str) -> Self {
        let study = Self::new(sweep);
        study.plan(&[]);
        study
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn scenario(&self) -> PathBuf {
        self.file("study/own/s.toml")
    }

    fn plan(&self, arguments: &[&str]) -> String {
        let mut command = sextant();
        command.arg("sweep").arg(self.scenario()).arg("--plan").arg(self.file("plan")).args(arguments);
        command.output().expect("it starts").printed()
    }

    /// Calls `sextant sweep PLAN` with these arguments.
    fn on_plan(&self, arguments: &[&str]) -> Output {
        sextant().arg("sweep").arg(self.file("plan")).args(arguments).output().expect("it starts")
    }

    fn status(&self) -> Value {
        let status: Value =
            serde_json::from_str(&self.on_plan(&["--status", "--format", "json"]).printed()).expect("JSON");
        status["plan"].clone()
    }

    /// The table of a local sweep.
    fn local(&self) -> Vec<u8> {
        let out = self.file("local.csv");
        sextant().arg("sweep").arg(self.scenario()).arg("--out").arg(&out).output().expect("it starts").printed();
        fs::read(out).expect("a table")
    }

    fn collected(&self) -> Vec<u8> {
        let out = self.file("collected.csv");
        self.on_plan(&["--collect", "--force", "--out", out.to_str().expect("UTF-8")]).printed();
        fs::read(out).expect("a table")
    }

    /// The names of the parts.
    fn parts(&self) -> Vec<String> {
        let entries = fs::read_dir(self.file("plan/parts")).expect("a plan");
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
        names.sort();
        names
    }
}

#[test]
fn parts_done_elsewhere_give_the_table_of_a_local_sweep() {
    let study = Study::planned(SWEEP);
    let local = study.local();
    let lines = fs::read_to_string(study.file("plan/work.jsonl")).unwrap();
    let lines: Vec<Value> = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 8);
    assert_eq!((&lines[3]["run"], &lines[3]["cell"], &lines[3]["seed"]), (&3.into(), &1.into(), &2.into()));
    assert_eq!(lines[3]["settings"]["channel.environment"], "suburban");
    assert_eq!(lines[2]["survey"], lines[3]["survey"], "they differ in their maps only");
    // The plan goes to another machine, where the scenario is not.
    fs::rename(study.file("plan"), study.file("moved")).unwrap();
    fs::remove_dir_all(study.file("study")).unwrap();
    fs::rename(study.file("moved"), study.file("plan")).unwrap();
    let message = study.on_plan(&["--cells", "0..9"]).refusal();
    assert!(message.contains("there are no runs 0..9; the plan has the runs 0..8"), "{message}");
    assert_eq!(study.on_plan(&["--cells", "5..8"]).printed(), "5..8: 3 runs done now, 0 before\n");
    let missing = study.on_plan(&["--collect"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("5 of 8 runs are missing: 0..5"), "{missing:?}");
    study.on_plan(&["--cells", "0..5", "--threads", "1"]).printed();
    assert_eq!(study.parts(), ["000000000-000000005.csv", "000000005-000000008.csv"]);
    assert_eq!(study.collected(), local);
    let message = study.on_plan(&["--collect", "--out", study.file("collected.csv").to_str().unwrap()]).refusal();
    assert!(message.contains("collected.csv` exists") && message.contains("--force"), "{message}");
    let status = study.status();
    assert_eq!((&status["done"], &status["missing"]), (&4.into(), &0.into()));
    let failed = status["failed"].as_array().unwrap();
    assert_eq!(failed.len(), 4);
    assert!(failed[0]["reason"].as_str().unwrap().contains("grid"), "{status}");
}

#[test]
fn a_part_can_be_done_twice_and_only_what_failed_is_done_again() {
    let study = Study::planned(SWEEP);
    study.on_plan(&["--cells", "0..8"]).printed();
    let first = study.collected();
    let again = study.on_plan(&["--cells", "0..8"]).printed();
    assert_eq!(again, "0..8: 4 runs done now, 4 before\n", "those that failed are done again");
    let overlapping = study.on_plan(&["--cells", "3..7"]).printed();
    assert!(overlapping.ends_with("2 before\n"), "{overlapping}");
    assert_eq!(study.collected(), first);
    assert_eq!(study.parts(), ["000000000-000000008.csv", "000000003-000000007.csv"]);
}

#[test]
fn two_processes_can_do_the_same_part() {
    let study = Study::planned(SWEEP);
    let plan = study.file("plan");
    let start = || sextant().arg("sweep").arg(&plan).args(["--cells", "0..8"]).spawn().expect("it starts");
    let children = [start(), start(), start()];
    for child in children {
        child.wait_with_output().expect("a child").printed();
    }
    assert_eq!(study.parts(), ["000000000-000000008.csv"]);
    assert_eq!(study.collected(), study.local());
}

/// The last of four cells takes minutes.
const SLOW: &str = "
[sweep]
runs = 1
[sweep.product]
robots.0.listen_s = [1.1, 1.2, 1.3, 1000000.0]
";

#[test]
fn a_signal_keeps_what_is_done_and_the_code_says_which() {
    for (name, code) in [("-TERM", 75), ("-INT", 130)] {
        let study = Study::new(SLOW);
        study.plan(&["--no-trial"]);
        let mut command = sextant();
        command.arg("sweep").arg(study.file("plan")).args(["--cells", "0..4", "--threads", "1"]);
        let child = command.spawn().expect("it starts");
        while study.status()["done"] != 3 {
            std::thread::sleep(Duration::from_millis(20));
        }
        signal(&child, name);
        let output = child.wait_with_output().expect("a child");
        assert_eq!(output.status.code(), Some(code), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(study.parts(), ["000000000-000000004.unfinished-001.csv"], "{name}");
        let status = study.status();
        assert_eq!((&status["done"], &status["missing_runs"][0]), (&3.into(), &"3..4".into()), "{name}");
        assert_eq!(study.on_plan(&["--cells", "0..3"]).printed(), "0..3: 0 runs done now, 3 before\n", "{name}");
    }
}

#[test]
fn foreign_and_changed_files_are_refused() {
    let study = Study::planned(SWEEP);
    study.on_plan(&["--cells", "0..2"]).printed();
    let part = study.file("plan/parts/000000000-000000002.csv");
    let good = fs::read_to_string(&part).unwrap();
    let try_part = |text: &str, expected: &str| {
        fs::write(&part, text).unwrap();
        for arguments in [&["--status"][..], &["--collect"], &["--cells", "0..4"]] {
            let message = study.on_plan(arguments).refusal();
            assert!(message.contains(expected), "{arguments:?}: {message}");
        }
    };
    let (first, _) = good.split_once('\n').unwrap();
    try_part("", "is not a part of a plan: its first line");
    let fingerprint = first.split(',').nth(1).unwrap();
    try_part(&good.replace(fingerprint, &"0".repeat(64)), "is a part of another plan");
    fs::write(&part, &good).unwrap();

    let nodes = study.file("plan/files/nodes.csv");
    let kept = fs::read(&nodes).unwrap();
    fs::write(&nodes, "node,x_m,y_m,z_m\n").unwrap();
    let message = study.on_plan(&["--status"]).refusal();
    assert!(message.contains("nodes.csv` was changed since the plan was made"), "{message}");
    fs::write(&nodes, kept).unwrap();

    let plan = study.file("plan/plan.json");
    let text = fs::read_to_string(&plan).unwrap();
    for (key, found) in [("\"surveys\":[0", u64::MAX), ("\"surveys\":[0", 99), ("\"runs\":2", u32::MAX.into())] {
        assert_eq!(text.matches(key).count(), 1, "{key} in {text}");
        let before = &key[..key.len() - 1];
        fs::write(&plan, text.replace(key, &format!("{before}{found}"))).unwrap();
        let message = study.on_plan(&["--status"]).refusal();
        assert!(message.contains("plan.json` was changed since the plan was made"), "{found}: {message}");
    }
    fs::write(
        &plan,
        text.replace(&format!("\"version\":\"{}\"", env!("CARGO_PKG_VERSION")), "\"version\":\"0.0.1\""),
    )
    .unwrap();
    let message = study.on_plan(&["--cells", "0..2"]).refusal();
    assert!(message.contains("is of version 0.0.1; this is version"), "{message}");
    fs::write(&plan, "{").unwrap();
    assert!(study.on_plan(&["--status"]).refusal().contains("has no plan: `plan.json`"));
}

#[test]
fn the_runs_of_a_damaged_part_are_done_again() {
    let study = Study::planned(SWEEP);
    study.on_plan(&["--cells", "0..2"]).printed();
    let part = study.file("plan/parts/000000000-000000002.csv");
    let good = fs::read_to_string(&part).unwrap();
    for damaged in [good[..good.len() - 2].to_owned(), good.replacen(",0.", ",1.", 1)] {
        assert_ne!(damaged, good);
        fs::write(&part, &damaged).unwrap();
        assert_eq!((&study.status()["done"], &study.status()["missing_runs"][0]), (&0.into(), &"0..8".into()));
        assert_eq!(study.on_plan(&["--cells", "0..2"]).printed(), "0..2: 2 runs done now, 0 before\n");
        let rows = |text: &str| text.lines().skip(2).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(rows(&fs::read_to_string(&part).unwrap()), rows(&good));
    }
}

#[test]
fn a_plan_is_made_only_where_nothing_is_lost() {
    let study = Study::planned(SWEEP);
    let again = |folder: &Path, arguments: &[&str]| {
        sextant()
            .arg("sweep")
            .arg(study.scenario())
            .arg("--plan")
            .arg(folder)
            .args(arguments)
            .output()
            .expect("it starts")
    };
    study.on_plan(&["--cells", "0..2"]).printed();
    assert!(again(&study.file("plan"), &[]).refusal().contains("there is a plan in"));
    let message = again(&study.file("study"), &["--force"]).refusal();
    assert!(message.contains("is not empty: it has"), "{message}");
    again(&study.file("plan"), &["--force", "--no-trial"]).printed();
    assert!(study.parts().is_empty());
    fs::write(study.file("plan/mine.txt"), "mine").unwrap();
    assert!(again(&study.file("plan"), &["--force"]).refusal().contains("it has `mine.txt`"));
    assert!(study.file("plan/plan.json").is_file());
}

#[test]
fn wrong_words_are_told_apart() {
    let study = Study::planned(SWEEP);
    let on_file = |arguments: &[&str]| sextant().arg("sweep").arg(study.scenario()).args(arguments).output().unwrap();
    for arguments in [&["--cells", "0..1"][..], &["--status"], &["--collect"], &["--cancel"], &["--submit", "slurm"]]
    {
        let message = on_file(arguments).refusal();
        assert!(message.contains(&format!("`{}` needs that of a plan", arguments[0])), "{message}");
    }
    assert!(study.on_plan(&[]).refusal().contains("is a plan; say what is to be done with it"));
    assert!(study.on_plan(&["--cells", "0..1", "--seed", "4"]).refusal().contains("`--seed` cannot change a plan"));
    assert!(study.on_plan(&["--cells", "4..4"]).refusal().contains("expected A..B with A < B"));
    assert!(study.on_plan(&["--status", "--collect"]).refusal().contains("cannot be used with"));
    assert!(study.on_plan(&["--resume"]).refusal().contains("was never submitted"));
    let folder = study.file("study");
    let output = sextant().arg("sweep").arg(folder).arg("--status").output().unwrap();
    assert!(output.refusal().contains("has no plan: there is no file `plan.json`"));
}

#[test]
fn a_submission_that_was_cut_off_stops_only_other_submissions() {
    let study = Study::planned(SWEEP);
    fs::create_dir_all(study.file("plan/slurm/000001")).unwrap();
    let printed = study.on_plan(&["--status"]).printed();
    assert!(printed.contains("submission 000001: no job yet; if it was cut off, remove slurm/000001"), "{printed}");
    let resumed = study.on_plan(&["--resume"]);
    assert_eq!(resumed.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&resumed.stderr).contains("another submission is under way"), "{resumed:?}");
}

#[test]
fn a_file_that_cannot_move_is_refused() {
    let study = Study::new(SWEEP);
    let nodes = study.file("study/nodes.csv");
    let text = fs::read_to_string(study.file("study/base.toml")).unwrap();
    fs::write(study.file("study/base.toml"), text.replace("\"nodes.csv\"", &format!("'{}'", nodes.display())))
        .unwrap();
    let mut command = sextant();
    command.arg("sweep").arg(study.scenario()).arg("--plan").arg(study.file("plan")).arg("--no-trial");
    let message = command.output().unwrap().refusal();
    assert!(message.contains("allowed in a plan: paths relative to the scenario"), "{message}");
    assert!(!study.file("plan/plan.json").exists());
    fs::write(study.file("study/base.toml"), text).unwrap();
    let base = format!("extends = '{}'", study.file("study/base.toml").display());
    let own = fs::read_to_string(study.scenario()).unwrap();
    fs::write(study.scenario(), own.replace("extends = \"../base.toml\"", &base)).unwrap();
    let message = command.output().unwrap().refusal();
    assert!(message.contains("study/base.toml`; allowed in a plan: paths relative to the scenario"), "{message}");
    assert!(!study.file("plan").exists(), "nothing is begun");
}
