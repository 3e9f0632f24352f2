//! Maps of logs, at once and tile by tile.

use std::num::NonZeroUsize;
use std::path::Path;

use sextant::mapping::tiles::{self, KeptTiles, TileCount, TileFolders, Tiling};
use sextant::mapping::{self, Input};
use sextant::scenario::{MapSettings, RecordedScenario};
use sextant::summary::Stopwatch;
use sextant::{RunRecorder, Scenario, Unwatched};
use sextant_logs::ReadOptions;
use tempfile::TempDir;

use super::trial::{SHORT, Trial, goes_on, undisturbed};

/// A recording in a folder that no disaster reaches.
struct Recorded(TempDir);

impl Recorded {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("it works without a disaster");
        let scenario = Scenario::parse(SHORT).expect("it works without a disaster");
        sextant::run(&scenario, &mut RunRecorder::new(&folder.path().join("run.mcap")), &Unwatched)
            .expect("it works without a disaster");
        Self(folder)
    }

    fn settings(&self) -> MapSettings {
        let scenario = RecordedScenario { name: "short", text: SHORT, files: &Default::default() };
        MapSettings::new(Some(scenario), None, None, None, &[]).expect("it works without a disaster")
    }

    fn map(&self, folder: &Path) -> Result<(), String> {
        let path = self.0.path().join("run.mcap");
        let mut input = Input::read(&path, None, &ReadOptions::default()).expect("it works without a disaster");
        let out = folder.join("map.csv");
        let settings = self.settings();
        let mapped = mapping::map(&mut input, &settings, Some(&out), Stopwatch::start(), &Unwatched);
        mapped.map(|_| ()).map_err(|error| error.to_string())
    }

    fn map_in_tiles(&self, folder: &Path) -> Result<(), String> {
        let path = self.0.path().join("run.mcap");
        let (mut input, survey) =
            tiles::survey(&path, None, &ReadOptions::default(), &Unwatched).expect("it works without a disaster");
        let count = TileCount::Exactly(NonZeroUsize::new(2).expect("it works without a disaster"));
        let settings = self.settings();
        let tiling = Tiling::new(&input, &survey, &settings, count).expect("it works without a disaster");
        let kept = KeptTiles { folder: folder.join("kept"), only: None };
        let out = folder.join("map.csv");
        let start = Stopwatch::start();
        let folders = TileFolders { out: Some(&out), kept: Some(&kept) };
        let mapped = tiles::map_tiles(&mut input, survey, tiling, &settings, folders, start, &Unwatched);
        mapped.map(|_| ()).map_err(|error| error.to_string())
    }
}

#[test]
fn a_map_is_whole_or_not_there() {
    let recorded = Recorded::new();
    let map = undisturbed(&|folder| recorded.map(folder), "map.csv");
    Trial { prepare: &|_| {}, work: &|folder| recorded.map(folder) }.each(|left| {
        left.check_whole("map.csv", None, &map);
        left.check_tidy();
    });
}

#[test]
fn a_map_in_tiles_goes_on_to_the_same_map_after_any_disaster() {
    let recorded = Recorded::new();
    let (_, disasters) = goes_on(&|folder| recorded.map_in_tiles(folder), "map.csv", |_| {});
    assert!(disasters > 100, "{disasters}");
}
