//! Nothing that exists is lost, and files of others cannot hurt: outputs, two processes, limits, names.

#[cfg(unix)]
mod kills;
mod limits;
mod names;
mod outputs;
mod processes;
#[cfg(unix)]
mod signals;

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::program::{Said, scenario, sextant};

/// A folder with the smallest scenario, its recording and its summary.
pub(super) struct Bench(tempfile::TempDir);

impl Bench {
    pub(super) fn empty() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    pub(super) fn new() -> Self {
        let bench = Self::empty();
        std::fs::copy(scenario("smoke.toml"), bench.path("a.toml")).expect("there is room");
        bench
    }

    pub(super) fn recorded() -> Self {
        let bench = Self::new();
        bench.done("run a.toml --out a.mcap --summary a.json --quiet");
        bench
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(super) fn folder(&self) -> &Path {
        self.0.path()
    }

    pub(super) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("there is room");
    }

    pub(super) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).expect("a file")
    }

    pub(super) fn run(&self, line: &str) -> Output {
        sextant().args(line.split(' ')).current_dir(self.folder()).output().expect("the program starts")
    }

    /// What a command that succeeds says on standard error.
    pub(super) fn done(&self, line: &str) -> String {
        let output = self.run(line);
        let said = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!(output.status.code(), Some(0), "{line}: {said}");
        said
    }

    /// What a command that is refused says, with line breaks as spaces.
    pub(super) fn refused(&self, line: &str) -> String {
        let said = self.run(line).refusal();
        said.replace("\n  │ ", " ")
    }
}
