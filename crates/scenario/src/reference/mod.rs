//! What each key of a scenario means, from the JSON schema of scenarios: nothing is written twice.
//!
//! [`key_reference`] lists all keys in order; [`explain`] finds one by its path, or by the end of its path.

mod example;
mod listing;
mod lookup;
mod path;
mod view;
mod words;

use serde::Serialize;

pub use listing::key_reference;
pub use lookup::{ExplainError, Explanation, explain};

/// A key of a scenario: what it means, and what it may be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeyReference {
    /// Its path. `[]` stands for an entry of a list of tables, and `NAME` for a name of one's own:
    /// `maps[].algorithm.ml_tm.grid_step_m`, `networks.NAME.channel`.
    pub path: String,
    /// What it is, in words: `number`, `whole number`, `text`, `true or false`, `table`, `list of tables`, `choice`, ..
    pub kind: String,
    /// Its unit: `m`, `dB/km`, ..; `None` if it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// The numbers allowed, `0 or above` or `1 to 255`, as far as the schema says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<String>,
    /// Its value if it is absent, written in TOML; `None` if there is none, or if it depends on other keys.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// Whether its table is invalid without it.
    pub is_required: bool,
    /// What may be chosen; empty if it is not a choice.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<Choice>,
    /// What it means, in one paragraph.
    pub description: String,
    /// The path of the key with the same keys below it, which are listed there and not again here.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub same_as: Option<String>,
}

/// One of the values of a choice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// Its name, as written in a scenario.
    pub name: String,
    /// What it means, in one paragraph; may be empty.
    pub description: String,
    /// Whether it is written as a table with settings of its own, `[mac.csma_unslotted]`, or as a text, `"suburban"`.
    pub has_settings: bool,
}

impl KeyReference {
    /// Its last part: `grid_step_m`.
    #[must_use]
    pub fn name(&self) -> &str {
        path::last(&self.path)
    }

    /// The first sentence of its description.
    #[must_use]
    pub fn summary(&self) -> &str {
        words::first_sentence(&self.description)
    }
}

impl Choice {
    /// The first sentence of its description.
    #[must_use]
    pub fn summary(&self) -> &str {
        words::first_sentence(&self.description)
    }
}

#[cfg(test)]
mod tests;
