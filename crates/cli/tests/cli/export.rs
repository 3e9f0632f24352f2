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
        command.args(["map", "--quiet", "--algorithm", "ml-tm"]).arg(log).arg("--out").arg(out);
        succeeds(&mut command);
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
