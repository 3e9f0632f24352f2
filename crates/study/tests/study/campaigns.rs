//! Plans in folders, which several machines do.

use std::path::Path;

use sextant::{NumberRange, Unwatched};
use sextant_study::campaign::Replace;
use sextant_study::sweep::write_table;
use sextant_study::{Campaign, CampaignError};

use super::sweeps::Study;
use crate::trial::{Trial, goes_on};

/// Makes the plan, unless it is there.
fn plan(study: &Study, folder: &Path) -> Result<Campaign, CampaignError> {
    let folder = folder.join("plan");
    if Campaign::is_in(&folder) {
        return Campaign::open(&folder);
    }
    Campaign::create(study.sweep(), &folder, None, Replace::Nothing)
}

/// Does both parts of the plan, and writes the table.
fn run(study: &Study, folder: &Path) -> Result<(), String> {
    let work = || -> Result<(), Box<dyn std::error::Error>> {
        let plan = plan(study, folder)?;
        for (start, end) in [(0, 3), (3, 4)] {
            plan.run(NumberRange { start, end }, &Unwatched)?;
        }
        Ok(write_table(&folder.join("t.csv"), plan.sweep(), &plan.collect()?)?)
    };
    work().map_err(|error| error.to_string())
}

#[test]
fn a_plan_goes_on_to_the_same_table_after_any_disaster() {
    let study = Study::new();
    let (_, disasters) = goes_on(&|folder| run(&study, folder), "t.csv", |_| {});
    assert!(disasters > 200, "{disasters}");
}

#[test]
fn a_part_that_was_reported_is_there() {
    let study = Study::new();
    let part = NumberRange { start: 0, end: 4 };
    let prepare = |folder: &Path| {
        plan(&study, folder).expect("it works without a disaster");
    };
    let work = |folder: &Path| {
        let plan = plan(&study, folder).map_err(|error| error.to_string())?;
        plan.run(part, &Unwatched).map(|_| ()).map_err(|error| error.to_string())
    };
    Trial { prepare: &prepare, work: &work }.each(|left| {
        let plan = plan(&study, left.folder).unwrap_or_else(|error| panic!("{left}: {error}"));
        let progress = plan.progress().unwrap_or_else(|error| panic!("{left}: {error}"));
        assert!(left.told.is_err() || progress.missing() == 0, "{left}: {progress:?}");
    });
}
