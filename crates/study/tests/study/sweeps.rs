//! Sweeps that are resumed.

use std::fs;
use std::path::{Path, PathBuf};

use sextant::Unwatched;
use sextant_study::Sweep;
use sextant_study::sweep::{self, Shard};
use tempfile::TempDir;

use crate::trial::{SHORT, goes_on};

/// A sweep of two cells with two runs each. Its scenario is in a folder that no disaster reaches.
pub(crate) struct Study {
    _folder: TempDir,
    scenario: PathBuf,
}

impl Study {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("it works without a disaster");
        let scenario = folder.path().join("study.toml");
        let axis = "[sweep]\nruns = 2\n[sweep.product]\nradio.tx_power_dbm = [-50.0, -55.0]\n";
        fs::write(&scenario, format!("{SHORT}{axis}")).expect("it works without a disaster");
        Self { _folder: folder, scenario }
    }

    pub(crate) fn sweep(&self) -> Sweep {
        Sweep::read(&self.scenario, &[], None, None).expect("it works without a disaster")
    }
}

/// As the program does it: the table, then the folder of finished runs is removed.
fn run(study: &Study, folder: &Path) -> Result<(), String> {
    let out = folder.join("t.csv");
    if out.exists() && !folder.join("t.csv.parts").exists() {
        return Ok(());
    }
    let sweep = study.sweep();
    let work = || -> Result<(), Box<dyn std::error::Error>> {
        let rows = sweep::run(&sweep, Shard::default(), &out, folder.join("t.csv.parts").exists(), &Unwatched)?;
        sweep::write_table(&out, &sweep, &rows)?;
        Ok(sweep::clear_parts(&out)?)
    };
    work().map_err(|error| error.to_string())
}

#[test]
fn a_sweep_goes_on_to_the_same_table_after_any_disaster() {
    let study = Study::new();
    let (table, disasters) = goes_on(&|folder| run(&study, folder), "t.csv", |left| {
        assert!(!left.folder.join("t.csv.parts").exists(), "{left}");
    });
    assert_eq!(String::from_utf8_lossy(&table).lines().count(), 5);
    assert!(disasters > 100, "{disasters}");
}
