//! `sextant export`: the tables of a recording.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::program::{Said, scenario, sextant};

fn succeeds(command: &mut Command) -> String {
    command.output().expect("the program starts").printed()
}

/// A recording of a short survey.
fn record(path: &Path) {
    succeeds(sextant().args(["run", "--quiet"]).arg(scenario("smoke.toml")).arg("--out").arg(path));
}

fn export(recording: &Path, folder: &Path, more: &[&str]) -> Output {
    let mut command = sextant();
    command.arg("export").arg(recording).arg("--out").arg(folder).args(more);
    command.output().expect("the program starts")
}

#[test]
fn the_tables_of_a_survey_map_as_the_recording_does() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    record(&path("run.mcap"));
    let output = export(&path("run.mcap"), &path("tables"), &[]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["stops", "receptions", "nodes", "stations", "robot_paths", "robot_poses"] {
        assert!(said.lines().any(|line| line.starts_with(&format!("{name} "))), "{name} in {said}");
        assert!(path("tables").join(format!("{name}.csv")).is_file());
    }
    let map = |log: &Path, out: &Path| {
        let mut command = sextant();
        command.args(["map", "--algorithm", "ml-tm"]).arg(log).arg("--out").arg(out);
        let output = command.output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && !said.contains("ignored columns") && !said.contains("`sent`"), "{said}");
        let is_by_stops = String::from_utf8_lossy(&output.stdout).contains("straight from stop to stop");
        assert_eq!(is_by_stops, log.is_dir(), "tables have no path");
        fs::read_to_string(out).expect("a map")
    };
    let (first, second) = (map(&path("run.mcap"), &path("a.csv")), map(&path("tables"), &path("b.csv")));
    assert!(first.lines().count() > 5);
    assert_eq!(first, second);
    let toml = fs::read_to_string(path("tables/scenario.toml")).expect("the scenario");
    assert!(toml.contains("smoke") && path("tables/summary.json").is_file());
}

#[test]
fn a_folder_with_files_is_refused_unless_forced() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    record(&path("run.mcap"));
    fs::create_dir(path("tables")).expect("there is room");
    fs::write(path("tables/mine.txt"), "mine").expect("there is room");
    let said = export(&path("run.mcap"), &path("tables"), &[]).refusal();
    assert!(said.contains("has files") && said.contains("--force"), "{said}");
    let forced = export(&path("run.mcap"), &path("tables"), &["--force"]);
    let said = String::from_utf8_lossy(&forced.stderr).into_owned();
    assert!(forced.status.success() && said.contains("were there before") && said.contains("mine.txt"), "{said}");
    assert!(!said.contains("stops.csv"), "{said}");
    assert_eq!(fs::read_to_string(path("tables/mine.txt")).expect("it stays"), "mine");
    let parts = fs::read_dir(path("tables")).expect("a folder").flatten();
    assert!(parts.map(|file| file.file_name()).all(|name| !name.to_string_lossy().ends_with(".part")));
}

#[test]
fn a_broken_recording_leaves_no_table() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    record(&path("run.mcap"));
    let bytes = fs::read(path("run.mcap")).expect("a recording");
    fs::write(path("cut.mcap"), &bytes[..bytes.len() / 2]).expect("there is room");
    let message = export(&path("cut.mcap"), &path("tables"), &[]).refusal();
    assert!(message.contains("sextant recover"), "{message}");
    assert!(!path("tables").exists());
    // Files of an earlier export stay as they are.
    assert!(export(&path("run.mcap"), &path("tables"), &[]).status.success());
    let contents = || -> Vec<_> {
        let files = fs::read_dir(path("tables")).expect("a folder").flatten().map(|file| file.path());
        let mut files: Vec<_> =
            files.filter(|file| file.is_file()).map(|file| (fs::read(&file).ok(), file)).collect();
        files.sort();
        files
    };
    let before = contents();
    assert_eq!(export(&path("cut.mcap"), &path("tables"), &["--force"]).status.code(), Some(2));
    assert_eq!(contents(), before);
}

/// A recording of a survey with a damaged chunk, which was recovered.
fn record_with_losses(folder: &Path) -> std::path::PathBuf {
    let path = |name: &str| folder.join(name);
    let mut run = sextant();
    run.args(["run", "--quiet", "--set", "recording.frames=true"]).arg(scenario("smoke.toml"));
    succeeds(run.arg("--out").arg(path("run.mcap")));
    let mut octets = fs::read(path("run.mcap")).expect("a recording");
    let middle = octets.len() / 2;
    octets[middle] ^= 1;
    fs::write(path("broken.mcap"), &octets).expect("there is room");
    succeeds(sextant().arg("recover").arg(path("broken.mcap")).arg("--out").arg(path("good.mcap")));
    path("good.mcap")
}

#[test]
fn whatever_reads_a_recovered_recording_says_that_it_is_incomplete() {
    let folder = tempfile::tempdir().expect("there is room");
    let good = record_with_losses(folder.path());
    let tables = folder.path().join("tables");
    let exported = export(&good, &tables, &[]);
    let is_told = |output: &Output| {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains("note: ") && said.contains("recovered"), "{said}");
    };
    is_told(&exported);
    let text = fs::read_to_string(tables.join("incomplete.txt")).expect("a file that says so");
    assert!(text.contains("recovered"), "{text}");
    let mut map = sextant();
    is_told(&map.arg("map").arg(&tables).args(["--algorithm", "packet-centroid"]).output().expect("it starts"));
    let figures = folder.path().join("figures");
    is_told(&sextant().arg("figure").arg(&good).arg("--out").arg(&figures).output().expect("it starts"));
    // A whole recording has no such file.
    let whole = folder.path().join("whole");
    assert!(export(&folder.path().join("run.mcap"), &whole, &[]).status.success());
    assert!(!whole.join("incomplete.txt").exists());
}

#[test]
fn python_reads_every_table() {
    let python = std::env::var("SEXTANT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    record(&path("run.mcap"));
    assert!(export(&path("run.mcap"), &path("tables"), &[]).status.success());
    const SCRIPT: &str = "import csv, glob, sys\n\
        for name in glob.glob(sys.argv[1] + '/*.csv'):\n\
        \x20   rows = list(csv.reader(open(name, newline='')))\n\
        \x20   assert len(rows) > 1 and all(len(row) == len(rows[0]) for row in rows), name\n\
        print('read')\n";
    let mut command = Command::new(python);
    match command.args(["-c", SCRIPT]).arg(path("tables")).output() {
        Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stdout), "read\n", "{output:?}"),
        Err(_) => assert!(std::env::var_os("SEXTANT_PYTHON").is_none(), "SEXTANT_PYTHON does not start"),
    }
}

#[test]
fn parquet_is_written_or_the_missing_feature_is_named() {
    let folder = tempfile::tempdir().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    record(&path("run.mcap"));
    let output = export(&path("run.mcap"), &path("tables"), &["--format", "parquet"]);
    if output.status.success() {
        let bytes = fs::read(path("tables/stops.parquet")).expect("a table");
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    } else {
        assert!(String::from_utf8_lossy(&output.stderr).contains("--features parquet"));
    }
}
