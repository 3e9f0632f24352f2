//! `sextant sweep` from end to end: the rows do not depend on threads, shards or interruptions.

use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::program::{self, Said, sextant};

/// Two worlds, each mapped twice. The second map needs a grid that is too large for any memory.
pub(super) const SWEEP: &str = "
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
    let [error, mapped, seed] = ["error", "mapped", "seed"].map(|name| column(&out, name));
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
    assert!(text.contains("8 runs, 4 of them failed"), "{text}");
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
    sextant()
        .args(["run", "--seed", "2", "--set", set[0], "--set", set[1]])
        .arg(&scenario)
        .arg("--summary")
        .arg(&json)
        .arg("--out")
        .arg(folder.path().join("alone.mcap"))
        .output()
        .unwrap()
        .printed();
    let summary: serde_json::Value = serde_json::from_slice(&std::fs::read(json).unwrap()).unwrap();
    let row = &table(&out)[2 * 2 + 1];
    for (name, pointer) in [
        ("packets_received", "/gathering/packets_received"),
        ("position_error_m.mean", "/maps/0/position_error_m/mean"),
        ("posterior_bound_m", "/maps/0/posterior_bound_m"),
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
    assert!(plan.contains("2 runs, 1 survey simulated"), "{plan}");
    assert!(sweep(&scenario, &out, &[]).status.success());
    let together = table(&out);
    let errors = ["0.3", "0.6"].map(|share| {
        let alone = folder.path().join(format!("{share}.csv"));
        let set = format!("anchors.share={share}");
        let base = scenario.with_file_name("alone.toml");
        let text = std::fs::read_to_string(&scenario).unwrap();
        std::fs::write(&base, text.split("[sweep]").next().unwrap()).unwrap();
        assert!(sweep(&base, &alone, &["--runs", "1", "--set", &set]).status.success());
        table(&alone)[0][column(&alone, "position_error_m.mean")].to_owned()
    });
    let at = column(&out, "position_error_m.mean");
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
    // Its first line has some hundred octets, a run as many.
    let finished = parts.join("000000000-000000060.unfinished-001.csv");
    while !std::fs::metadata(&finished).is_ok_and(|finished| finished.len() > 200) {
        assert!(child.try_wait().unwrap().is_none(), "the sweep ended before its first run");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out.exists(), "a killed sweep must not look finished");

    let message = sweep(&scenario, &out, &[]).refusal();
    assert!(message.contains("--resume"), "{message}");
    let other = sweep(&scenario, &out, &["--resume", "--seed", "9"]);
    assert_eq!(other.status.code(), Some(2), "parts of different sweeps are not mixed");

    sweep(&scenario, &out, &["--resume"]).printed();
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
        let text = sweep(&scenario, &out, &["--resume"]).refusal();
        assert!(text.contains("a different sweep") && text.contains("a file that it names"), "{name}: {text}");
        assert!(!out.exists(), "{name}");
        std::fs::write(file(name), old).unwrap();
    }
    sweep(&scenario, &out, &["--resume"]).printed();
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
    assert!(text.starts_with("4 cells of 2 runs with the seeds 1 to 2: 8 runs, 4 surveys simulated"), "{text}");
    assert!(text.contains("channel.environment=\"heavy-tree\""), "{text}");
    assert!(!out.exists() && !folder.path().join("t.csv.parts").exists());
}

/// Two maps of each run of two cells.
const TWO_MAPS: &str = "
[[maps]]
[maps.algorithm.ml_tm]
grid_step_m = 0.5
profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 }
[[maps]]
[maps.algorithm.weighted_centroid]
[sweep]
runs = 2
[sweep.product]
anchors.share = [0.3, 0.6]
";

#[test]
fn more_runs_extend_a_table_and_a_finished_one_is_not_replaced() {
    let folder = TempDir::new().unwrap();
    let scenario = scenario(&folder, TWO_MAPS);
    let file = |name: &str| folder.path().join(name);
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).into_owned();
    let names: &[&str] = if cfg!(feature = "parquet") { &["t.csv", "t.parquet"] } else { &["t.csv"] };
    for name in names {
        let (out, whole) = (file(name), file(&format!("whole-{name}")));
        assert!(sweep(&scenario, &out, &["--quiet"]).status.success());
        let two = std::fs::read(&out).unwrap();
        let again = sweep(&scenario, &out, &[]);
        assert_eq!(again.status.code(), Some(2), "a finished table stays");
        assert!(said(&again).contains("all runs of this sweep, 2 of each cell"), "{}", said(&again));
        assert!(said(&again).contains("--force") && said(&again).contains("--runs N"), "{}", said(&again));
        assert!(sweep(&scenario, &out, &["--resume"]).status.success(), "nothing is left to do");
        let fewer = sweep(&scenario, &out, &["--runs", "1"]);
        assert!(fewer.status.code() == Some(2) && said(&fewer).contains("2 runs of each cell"), "{}", said(&fewer));
        let other = sweep(&scenario, &out, &["--runs", "3", "--seed", "9"]);
        assert!(other.status.code() == Some(2) && said(&other).contains("another sweep"), "{}", said(&other));
        let part = sweep(&scenario, &out, &["--shard", "1/2"]);
        assert!(part.status.code() == Some(2) && said(&part).contains("a part of a sweep"), "{}", said(&part));
        assert_eq!(std::fs::read(&out).unwrap(), two, "each refusal left the table as it was");

        let longer = sweep(&scenario, &out, &["--runs", "4"]);
        assert!(longer.status.success(), "{}", said(&longer));
        assert!(said(&longer).contains("has 4 of 8 runs of this sweep"), "{}", said(&longer));
        assert!(sweep(&scenario, &whole, &["--runs", "4", "--quiet"]).status.success());
        assert_eq!(std::fs::read(&out).unwrap(), std::fs::read(&whole).unwrap());
        assert!(sweep(&scenario, &out, &["--force", "--quiet"]).status.success());
        assert_eq!(std::fs::read(&out).unwrap(), two);
    }
    std::fs::write(file("mine.csv"), "a,b\n1,2\n").unwrap();
    let mine = sweep(&scenario, &file("mine.csv"), &[]);
    assert!(mine.status.code() == Some(2) && said(&mine).contains("is not the table of a sweep"), "{}", said(&mine));
}

#[test]
fn an_extension_runs_only_what_is_missing() {
    let folder = TempDir::new().unwrap();
    let (scenario, out) = (scenario(&folder, TWO_MAPS), folder.path().join("t.csv"));
    assert!(sweep(&scenario, &out, &["--quiet"]).status.success());
    // A number that no run gives shows that the rows of the table are kept. The cells of a run without its rows are run.
    let text = std::fs::read_to_string(&out).unwrap();
    let at = column(&out, "stops");
    let mark = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[at] = "123456";
        cells.join(",")
    };
    let (head, rows) = text.split_once('\n').unwrap();
    let kept: Vec<String> = rows.lines().filter(|line| !line.starts_with("1,1,")).map(mark).collect();
    std::fs::write(&out, format!("{head}\n{}\n", kept.join("\n"))).unwrap();
    sweep(&scenario, &out, &["--runs", "3"]).printed();
    let rows = table(&out);
    assert_eq!(rows.len(), 2 * 3 * 2, "two cells, three runs, two maps");
    let (marked, new): (Vec<_>, Vec<_>) = rows.iter().partition(|row| &row[at] == "123456");
    let runs = |rows: &[&csv::StringRecord]| {
        rows.iter().map(|row| [row[0].to_owned(), row[1].to_owned()].concat()).collect::<Vec<_>>()
    };
    assert_eq!(runs(&marked), ["00", "00", "01", "01", "10", "10"]);
    assert_eq!(runs(&new), ["02", "02", "11", "11", "12", "12"]);
}

#[test]
fn columns_are_listed_with_units_and_meanings() {
    let folder = TempDir::new().unwrap();
    let (scenario, out) = (scenario(&folder, TWO_MAPS), folder.path().join("t.csv"));
    let listed = |arguments: &[&str]| {
        let output = sextant().args(["sweep", "--columns", "--format", "json"]).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<Vec<serde_json::Value>>(&output.stdout).unwrap()
    };
    let of_scenario = listed(&[&*scenario.to_string_lossy()]);
    let error = of_scenario.iter().find(|column| column["name"] == "position_error_m.mean").unwrap();
    assert_eq!((&error["unit"], &error["of"]), (&"m".into(), &"map".into()));
    assert!(of_scenario.iter().any(|column| column["name"] == "anchors.share" && column["of"] == "setting"));
    assert!(sweep(&scenario, &out, &["--quiet"]).status.success());
    let mut reader = csv::Reader::from_path(&out).unwrap();
    let written: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let names: Vec<&str> = of_scenario.iter().map(|column| column["name"].as_str().unwrap()).collect();
    let mut rest = names.iter();
    assert!(
        written.iter().all(|column| rest.any(|name| name == column)),
        "{written:?}: not in the order of {names:?}"
    );
    assert!(written.len() + 20 < names.len(), "columns without values are not written");
    let all = listed(&[]);
    assert!(all.len() > 200 && all.iter().any(|column| column["name"] == "applications.NAME.time_s"));
    let text = sextant().args(["sweep", "--columns"]).output().unwrap();
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.lines().any(|line| line.starts_with("mac.delay_s.mean ") && line.contains(" s ")), "{text}");
    let none = sextant().arg("sweep").output().unwrap();
    assert_eq!(none.status.code(), Some(2), "without `--columns` a scenario is needed");
}
