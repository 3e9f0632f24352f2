//! `sextant sweep` from end to end: the rows do not depend on threads, shards or interruptions.

use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::program::{self, sextant};

/// Two worlds, each mapped twice. The second map needs a grid that is too large for any memory.
const SWEEP: &str = "
[sweep]
runs = 2
[sweep.product]
channel.environment = [\"suburban\", \"heavy-tree\"]
[[sweep.list]]
maps.0.algorithm.ml_tm.profile.trapezoid.p0 = 0.8
[[sweep.list]]
maps.0.algorithm.ml_tm.grid_step_m = 1e-5
";

fn scenario(folder: &TempDir, sweep: &str) -> PathBuf {
    let base = std::fs::canonicalize(program::scenario("smoke.toml")).expect("the smoke scenario is there");
    let path = folder.path().join("swept.toml");
    std::fs::write(&path, format!("extends = '{}'\n{sweep}", base.display())).expect("a scenario is written");
    path
}

fn sweep(scenario: &Path, out: &Path, arguments: &[&str]) -> Output {
    sextant().arg("sweep").arg(scenario).arg("--out").arg(out).args(arguments).output().expect("it starts")
}

fn table(path: &Path) -> Vec<csv::StringRecord> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    reader.records().map(|record| record.expect("a row")).collect()
}

fn column(path: &Path, name: &str) -> usize {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    reader.headers().expect("a header").iter().position(|column| column == name).expect("the column exists")
}

#[test]
fn a_table_has_one_row_per_cell_and_run_and_the_error_of_failed_runs() {
    let folder = TempDir::new().unwrap();
    let (scenario, out) = (scenario(&folder, SWEEP), folder.path().join("t.csv"));
    let output = sweep(&scenario, &out, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = table(&out);
    let [error, mapped, seed] = ["error", "ml-tm.mapped", "seed"].map(|name| column(&out, name));
    assert_eq!(rows.len(), 4 * 2);
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row[0], (i / 2).to_string(), "rows are sorted by cell");
        assert_eq!(row[seed], (1 + i % 2).to_string(), "all cells have the same seeds");
        let fails = (i / 2) % 2 == 1;
        assert_eq!(row[error].is_empty(), !fails, "{row:?}");
        assert_eq!(row[mapped].is_empty(), fails, "{row:?}");
        assert!(!fails || row[error].contains("grid"), "{}", &row[error]);
    }
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("8 rows, 4 of them failed"), "{text}");
    assert!(!out.with_extension("csv.parts").exists());
}

#[test]
fn threads_and_shards_do_not_change_the_rows() {
    let folder = TempDir::new().unwrap();
    let scenario = scenario(&folder, SWEEP);
    let file = |name: &str| folder.path().join(name);
    assert!(sweep(&scenario, &file("one.csv"), &["--threads", "1"]).status.success());
    assert!(sweep(&scenario, &file("two.csv"), &["--threads", "2"]).status.success());
    let whole = table(&file("one.csv"));
    assert_eq!(std::fs::read(file("one.csv")).unwrap(), std::fs::read(file("two.csv")).unwrap());
    let mut rows = Vec::new();
    for shard in ["1/3", "2/3", "3/3"] {
        let out = file(&format!("shard{}.csv", &shard[..1]));
        assert!(sweep(&scenario, &out, &["--shard", shard]).status.success());
        rows.extend(table(&out));
    }
    rows.sort_by_key(|row| (row[0].to_owned(), row[1].to_owned()));
    assert_eq!(rows, whole);
}

#[test]
fn a_run_in_a_sweep_equals_the_same_run_alone() {
    let folder = TempDir::new().unwrap();
    let (scenario, out) = (scenario(&folder, SWEEP), folder.path().join("t.csv"));
    assert!(sweep(&scenario, &out, &[]).status.success());
    let json = folder.path().join("alone.json");
    let set = ["channel.environment=heavy-tree", "maps.0.algorithm.ml_tm.profile.trapezoid.p0=0.8"];
    let alone = sextant()
        .args(["run", "--seed", "2", "--set", set[0], "--set", set[1]])
        .arg(&scenario)
        .arg("--summary")
        .arg(&json)
        .arg("--out")
        .arg(folder.path().join("alone.mcap"))
        .output()
        .unwrap();
    assert!(alone.status.success(), "{}", String::from_utf8_lossy(&alone.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
    let row = &table(&out)[2 * 2 + 1];
    for (name, pointer) in [
        ("packets_received", "/gathering/packets_received"),
        ("ml-tm.position_error_m.mean", "/maps/0/position_error_m/mean"),
        ("ml-tm.posterior_bound_m", "/maps/0/posterior_bound_m"),
    ] {
        assert_eq!(row[column(&out, name)], summary.pointer(pointer).unwrap().to_string(), "{name}");
    }
}

#[test]
fn cells_that_differ_in_their_anchors_share_surveys_and_have_the_same_maps_as_alone() {
    let folder = TempDir::new().unwrap();
    let sweep_of_anchors = "[[maps]]\n[maps.algorithm.weighted_centroid]\n\
                            [sweep]\nruns = 1\nproduct.anchors.share = [0.3, 0.6]\n";
    let (scenario, out) = (scenario(&folder, sweep_of_anchors), folder.path().join("t.csv"));
    let plan = String::from_utf8(sweep(&scenario, &out, &["--dry-run"]).stdout).unwrap();
    assert!(plan.contains("2 rows, 1 survey simulated"), "{plan}");
    assert!(sweep(&scenario, &out, &[]).status.success());
    let together = table(&out);
    let errors = ["0.3", "0.6"].map(|share| {
        let alone = folder.path().join(format!("{share}.csv"));
        let set = format!("anchors.share={share}");
        let base = scenario.with_file_name("alone.toml");
        let text = std::fs::read_to_string(&scenario).unwrap();
        std::fs::write(&base, text.split("[sweep]").next().unwrap()).unwrap();
        assert!(sweep(&base, &alone, &["--runs", "1", "--set", &set]).status.success());
        table(&alone)[0][column(&alone, "weighted-centroid.position_error_m.mean")].to_owned()
    });
    let at = column(&out, "weighted-centroid.position_error_m.mean");
    assert_eq!([&together[0][at], &together[1][at]], [&errors[0], &errors[1]]);
    assert!(errors[0] != errors[1] && !errors[0].is_empty(), "{errors:?}");
}

#[cfg(unix)]
#[test]
fn a_killed_sweep_is_resumed_with_the_same_rows() {
    let folder = TempDir::new().unwrap();
    let scenario = scenario(&folder, "[sweep]\nruns = 60\n");
    let (whole, out) = (folder.path().join("whole.csv"), folder.path().join("killed.csv"));
    assert!(sweep(&scenario, &whole, &[]).status.success());
    let mut child =
        sextant().arg("sweep").arg(&scenario).args(["--threads", "1", "--out"]).arg(&out).spawn().unwrap();
    let parts = folder.path().join("killed.csv.parts");
    while !parts.join("0000000.csv").exists() {
        assert!(child.try_wait().unwrap().is_none(), "the sweep ended before its first part");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out.exists(), "a killed sweep must not look finished");

    let again = sweep(&scenario, &out, &[]);
    assert_eq!(again.status.code(), Some(2), "without --resume, finished parts are not discarded");
    assert!(String::from_utf8_lossy(&again.stderr).contains("--resume"));
    let other = sweep(&scenario, &out, &["--resume", "--seed", "9"]);
    assert_eq!(other.status.code(), Some(2), "parts of different sweeps are not mixed");

    let resumed = sweep(&scenario, &out, &["--resume"]);
    assert!(resumed.status.success(), "{}", String::from_utf8_lossy(&resumed.stderr));
    assert_eq!(std::fs::read(&out).unwrap(), std::fs::read(&whole).unwrap());
    assert!(!parts.exists());
}

#[test]
fn an_interrupted_sweep_is_not_resumed_after_a_file_that_the_scenario_names_has_changed() {
    const NODES: &str = "node,x_m,y_m\na,1,1\nb,9,1\nc,9,8\nd,1,8\n";
    const MESH: &str = "v 5 4 0\nv 7 4 0\nv 6 6 0\nv 6 5 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    const WORLD: &str = "[world.nodes.csv]\nfile = \"nodes.csv\"\n[[world.obstacles]]\nmaterial = \"concrete\"\n\
                         [world.obstacles.shape.mesh]\nfile = \"block.obj\"\n";
    let folder = TempDir::new().unwrap();
    let file = |name: &str| folder.path().join(name);
    let smoke = std::fs::read_to_string(program::scenario("smoke.toml")).unwrap();
    let (start, rest) = smoke.split_once("[world.nodes.lattice]").unwrap();
    let rest = &rest[rest.find("[radio]").unwrap()..rest.find("[recording]").unwrap()];
    let text = format!("{start}{WORLD}{rest}[sweep]\nruns = 2\n");
    for (name, text) in [("swept.toml", &*text), ("nodes.csv", NODES), ("block.obj", MESH)] {
        std::fs::write(file(name), text).unwrap();
    }
    let (scenario, out) = (file("swept.toml"), file("t.csv"));
    // With a folder at the path of the table, all runs finish but the table cannot be written.
    std::fs::create_dir(&out).unwrap();
    assert_eq!(sweep(&scenario, &out, &[]).status.code(), Some(1));
    std::fs::remove_dir(&out).unwrap();

    for (name, old, new) in
        [("nodes.csv", NODES, NODES.replace("9,8", "9,7")), ("block.obj", MESH, MESH.replace('7', "8"))]
    {
        std::fs::write(file(name), new).unwrap();
        let changed = sweep(&scenario, &out, &["--resume"]);
        let text = String::from_utf8_lossy(&changed.stderr).into_owned();
        assert_eq!(changed.status.code(), Some(2), "{name}: {text}");
        assert!(text.contains("a different sweep") && text.contains("a file that it names"), "{name}: {text}");
        assert!(!out.exists(), "{name}");
        std::fs::write(file(name), old).unwrap();
    }
    let resumed = sweep(&scenario, &out, &["--resume"]);
    assert!(resumed.status.success(), "{}", String::from_utf8_lossy(&resumed.stderr));
    assert_eq!(table(&out).len(), 2);
}

#[test]
fn an_invalid_cell_is_rejected_before_anything_runs() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("t.csv");
    let bad = scenario(&folder, "[sweep.product]\nmaps.0.algorithm.ml_tm.grid_step_m = [0.25, -1.0]\n");
    for output in [sweep(&bad, &out, &[]), sextant().arg("check").arg(&bad).output().unwrap()] {
        assert_eq!(output.status.code(), Some(2));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(text.contains("grid_step_m") && text.contains("-1"), "{text}");
    }
    assert!(!out.exists() && !folder.path().join("t.csv.parts").exists());
    let usage = sweep(&scenario(&folder, ""), &folder.path().join("t.xlsx"), &[]);
    assert_eq!(usage.status.code(), Some(2));
}

#[test]
fn a_dry_run_prints_the_plan_and_runs_nothing() {
    let folder = TempDir::new().unwrap();
    let (scenario, out) = (scenario(&folder, SWEEP), folder.path().join("t.csv"));
    let output = sweep(&scenario, &out, &["--dry-run"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("4 cells of 2 runs with the seeds 1 to 2: 8 rows, 4 surveys simulated"), "{text}");
    assert!(text.contains("channel.environment=\"heavy-tree\""), "{text}");
    assert!(!out.exists() && !folder.path().join("t.csv.parts").exists());
}
