//! The errors of a scenario, collected while it is checked.

use sextant_kernel::SettingError;

use crate::document::Document;
use crate::error::ScenarioErrors;

/// Collects errors.
#[derive(Default)]
pub(crate) struct Errors {
    pub(crate) found: Vec<SettingError>,
}

impl Errors {
    /// Collects an error. Tables that several networks or applications share are checked for each, and a mistake in them is one.
    pub(crate) fn refuse(&mut self, error: &SettingError) {
        if !self.found.contains(error) {
            self.found.push(error.clone());
        }
    }

    /// The value; an error is collected as one within `table`, or of the scenario itself if that is empty.
    pub(crate) fn take<T>(&mut self, table: &str, result: Result<T, SettingError>) -> Option<T> {
        let of_table = |error: SettingError| if table.is_empty() { error } else { error.within(table) };
        result.map_err(|error| self.refuse(&of_table(error))).ok()
    }

    /// The errors with their places in `document`, if there are any.
    pub(crate) fn placed(&self, document: &Document) -> Result<(), ScenarioErrors> {
        ScenarioErrors::check(self.found.iter().map(|error| document.outside(error)).collect())
    }
}
