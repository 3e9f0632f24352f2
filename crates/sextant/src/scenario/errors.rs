//! The errors of a scenario, collected while it is checked.

use sextant_kernel::SettingError;

use super::document::Document;
use super::error::ScenarioError;

/// Collects errors.
pub(super) struct Errors<'a> {
    pub(super) document: &'a Document,
    pub(super) found: Vec<ScenarioError>,
}

impl Errors<'_> {
    pub(super) fn refuse(&mut self, error: &SettingError) {
        self.found.push(self.document.outside(error));
    }

    /// The value; an error is collected as one within `table`, or of the scenario itself if that is empty.
    pub(super) fn take<T>(&mut self, table: &str, result: Result<T, SettingError>) -> Option<T> {
        result.map_err(|error| self.refuse(&if table.is_empty() { error } else { error.within(table) })).ok()
    }
}
