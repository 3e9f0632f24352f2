//! Whether cells are what a plan says of them.

use std::collections::BTreeMap;

use sextant::summary::measures::Subjects;
use sextant_kernel::SettingError;
use sextant_scenario::{ScenarioErrors, SurveyIdentity};

use super::facts::{self, Contents};
use super::plan::Sweep;

/// Why cells are not what a plan says.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum CellCheckError {
    /// One is no valid scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// What is said of one is not true.
    #[error(transparent)]
    Untrue(#[from] SettingError),
}

/// Works the `cells` of `sweep` out again, and compares them with what it says: the hash of each scenario, which cells share a
/// survey, and what there is to measure.
///
/// # Errors
/// If one is not a valid scenario, or another one.
pub(crate) fn check_cells(sweep: &Sweep, cells: &[usize]) -> Result<(), CellCheckError> {
    let settings: Vec<_> = cells.iter().map(|&cell| sweep.cells()[cell].settings.clone()).collect();
    let facts = facts::of_cells(sweep.file(), sweep.set(), Some(sweep.seed()), sweep.keys(), &settings)?;
    let mut contents = Contents::default();
    let mut subjects = Subjects::default();
    // Two cells share a survey if, and only if, their numbers say so.
    let mut numbers: BTreeMap<SurveyIdentity, usize> = BTreeMap::new();
    let mut surveys: BTreeMap<usize, SurveyIdentity> = BTreeMap::new();
    for (&number, cell) in cells.iter().zip(&facts) {
        let claimed = &sweep.cells()[number];
        let sha256 = contents.sha256(cell).map_err(ScenarioErrors::from)?;
        if sha256 != claimed.sha256 {
            let allowed = format!("`{sha256}`, the hash of this cell");
            return Err(
                SettingError::new(format!("sha256[{number}]"), format!("`{}`", claimed.sha256), allowed).into()
            );
        }
        if cell.others != claimed.others {
            let allowed = format!("{:?}, the values of the settings that other cells set", cell.others);
            let found = format!("{:?}", claimed.others);
            return Err(SettingError::new(format!("others[{number}]"), found, allowed).into());
        }
        let survey = *surveys.entry(claimed.survey).or_insert(cell.survey);
        let same = *numbers.entry(cell.survey).or_insert(claimed.survey);
        if survey != cell.survey || same != claimed.survey {
            let allowed = "one number for cells that share their surveys, and another for each other one";
            return Err(SettingError::new(format!("surveys[{number}]"), claimed.survey, allowed).into());
        }
        subjects.extend(&cell.subjects);
    }
    let is_all = cells.len() == sweep.cells().len();
    let is_known = if is_all { subjects == *sweep.subjects() } else { sweep.subjects().has(&subjects) };
    if !is_known {
        let allowed = "the maps and applications of the cells";
        return Err(SettingError::new("subjects", "another list", allowed).into());
    }
    Ok(())
}
