//! The document: what a report is of, and its sections.

use serde::Serialize;

use super::missions::ReportedMission;
use super::reproduction::Reproduction;
use super::sweep::SweepTable;
use super::world::World;

/// A report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// What it is of.
    pub kind: DocumentKind,
    /// Its title: the name of a scenario, a log or a table.
    pub title: String,
    /// Where the data are from.
    pub origin: Origin,
    /// What the reader should know, in sentences.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// The summary as the text of a JSON object, as `--summary` writes it but without times of a machine: each number with
    /// all its digits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub summary: Option<String>,
    /// Everything with a place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world: Option<World>,
    /// The applications.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub applications: Vec<ReportedMission>,
    /// The table of a sweep.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepTable>,
    /// A reproduction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reproduction: Option<Reproduction>,
    /// The text of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
}

/// What a report is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DocumentKind {
    /// A run.
    Run,
    /// Maps of a log.
    Log,
    /// The table of a sweep.
    Sweep,
    /// A reproduction.
    Reproduction,
}

/// Where the data are from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Name of the file or folder, without the folders above it.
    pub file: String,
    /// Name of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
    /// Seed of all randomness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<String>,
    /// Version of the program that made the data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// Version of the program that made this report.
    pub reported_by: String,
}

impl Report {
    /// An empty report of what is in `file`.
    pub(super) fn new(kind: DocumentKind, title: &str, file: &str) -> Self {
        let origin =
            Origin { file: file.to_owned(), reported_by: env!("CARGO_PKG_VERSION").to_owned(), ..Origin::default() };
        Self {
            kind,
            title: title.to_owned(),
            origin,
            notes: Vec::new(),
            summary: None,
            world: None,
            applications: Vec::new(),
            sweep: None,
            reproduction: None,
            scenario: None,
        }
    }
}
