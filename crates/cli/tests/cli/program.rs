//! Helpers: the program as a process, shipped scenarios, and summaries.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The program without arguments. Its output is captured.
pub(crate) fn sextant() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sextant"));
    command.env("NO_COLOR", "1").stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The program in `folder`, when it has ended.
pub(crate) fn call(folder: &Path, words: &[&str]) -> Output {
    sextant().current_dir(folder).args(words).output().expect("the program starts")
}

/// Settings as arguments of the program.
pub(crate) fn sets<'a>(settings: &'a [&str]) -> impl Iterator<Item = &'a str> {
    settings.iter().flat_map(|setting| ["--set", setting])
}

/// A number in a summary.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// What the program said when it has ended.
pub(crate) trait Said {
    /// Exit code, standard output and standard error.
    fn all(&self) -> (i32, String, String);

    /// What it printed. It has succeeded.
    fn printed(&self) -> String;

    /// The same as JSON.
    fn json(&self) -> Value;

    /// Its message as one line. It has refused its input.
    fn refusal(&self) -> String;
}

impl Said for Output {
    fn all(&self) -> (i32, String, String) {
        let text = |octets: &[u8]| String::from_utf8(octets.to_vec()).expect("UTF-8");
        (self.status.code().expect("it ends by itself"), text(&self.stdout), text(&self.stderr))
    }

    #[track_caller]
    fn printed(&self) -> String {
        let (code, printed, message) = self.all();
        assert_eq!(code, 0, "{message}");
        printed
    }

    #[track_caller]
    fn json(&self) -> Value {
        serde_json::from_str(&self.printed()).expect("JSON")
    }

    #[track_caller]
    fn refusal(&self) -> String {
        let (code, printed, message) = self.all();
        assert_eq!(code, 2, "{printed}{message}");
        unwrapped(&message)
    }
}

/// `text` as one line, without the signs that wrap it.
pub(crate) fn unwrapped(text: &str) -> String {
    text.split_whitespace().filter(|word| !["│", "×"].contains(word)).collect::<Vec<_>>().join(" ")
}

/// A folder with these files, which may be in folders of their own.
pub(crate) fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().expect("there is room");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a file is in a folder")).expect("there is room");
        std::fs::write(path, text).expect("there is room");
    }
    folder
}

/// Runs a scenario to `run.mcap` in a new folder: the folder and the summary.
pub(crate) fn run_text(scenario: &str, words: &[&str]) -> (TempDir, Value) {
    let folder = folder(&[("a.toml", scenario)]);
    let run = ["run", "a.toml", "--out", "run.mcap", "--summary", "run.json", "--quiet"];
    call(folder.path(), &[&run, words].concat()).printed();
    let summary = summary(&folder.path().join("run.json"));
    (folder, summary)
}

/// What `check` says of a scenario that it refuses, beside these files.
pub(crate) fn check_text(scenario: &str, files: &[(&str, &str)]) -> String {
    let folder = folder(&[&[("a.toml", scenario)], files].concat());
    call(folder.path(), &["check", "a.toml"]).refusal()
}

/// A table without quoted cells: each row by the names of its columns.
pub(crate) type Table = Vec<BTreeMap<String, String>>;

/// Reads a table; empty if the file is not there.
pub(crate) fn table(path: &Path) -> Table {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let Some(header) = lines.next() else { return Vec::new() };
    let header: Vec<_> = header.collect();
    lines.map(|row| header.iter().cloned().zip(row).collect()).collect()
}

/// The path of a shipped scenario.
pub(crate) fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)
}

/// Reads a summary from a file.
pub(crate) fn summary(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a summary")).expect("JSON")
}

/// Sends a signal, for example `-INT`.
#[cfg(unix)]
pub(crate) fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill starts");
    assert!(status.success());
}
