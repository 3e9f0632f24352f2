//! What the thesis leaves open: a setting that it does not print, or a word that can be read in several ways.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::error::TableError;
use super::words::{Only, Scope};

/// A setting or a definition that the thesis leaves open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenSetting {
    /// What is open, in words.
    pub name: String,
    /// The key of the scenario, or the measure of the summary.
    pub key: String,
    /// The value on the pages.
    pub taken: String,
    /// What the thesis says about it.
    pub says: String,
    /// The other values that were tried.
    pub values: Vec<String>,
}

/// One of `[[open]]` in the file of a table.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpenEntry {
    /// What is open, in words.
    pub(crate) name: String,
    /// The key of the scenario, or the measure of the summary.
    pub(crate) key: String,
    /// The value on the pages.
    pub(crate) taken: String,
    /// What the thesis says about it.
    pub(crate) says: String,
    /// The items of the lists of the table for which it is open.
    #[serde(default)]
    pub(crate) only: Only,
    /// The scenarios that it changes; all of the table if none.
    #[serde(default)]
    pub(crate) scenarios: Vec<String>,
    /// Other values that the text allows.
    pub(crate) values: Vec<OpenValueEntry>,
}

/// A value of what is open.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct OpenValueEntry {
    /// The value in words.
    pub(crate) value: String,
    /// What is set in the scenarios: `key=value`.
    #[serde(default)]
    pub(crate) set: Vec<String>,
    /// Settings of the cell that is read instead.
    #[serde(default)]
    pub(crate) at: BTreeMap<String, String>,
    /// Parts of the names of scenarios, and what stands in their place.
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
    /// Parts of the paths of measures, and what stands in their place.
    #[serde(default)]
    pub(crate) measures: BTreeMap<String, String>,
}

impl OpenEntry {
    /// What is open in `scope`; nothing if it is not meant there.
    pub(crate) fn setting(&self, scope: &Scope<'_>) -> Result<Option<OpenSetting>, TableError> {
        if !scope.keeps(&self.only)? {
            return Ok(None);
        }
        if let Some(empty) = self.values.iter().find(|value| !value.changes_something()) {
            return Err(TableError::NoChange { name: self.name.clone(), value: empty.value.clone() });
        }
        let values = self.values.iter().map(|value| scope.fill(&value.value)).collect::<Result<_, _>>()?;
        Ok(Some(OpenSetting {
            name: scope.fill(&self.name)?,
            key: self.key.clone(),
            taken: scope.fill(&self.taken)?,
            says: scope.fill(&self.says)?,
            values,
        }))
    }
}

impl OpenValueEntry {
    fn changes_something(&self) -> bool {
        !(self.set.is_empty() && self.at.is_empty() && self.files.is_empty() && self.measures.is_empty())
    }
}
