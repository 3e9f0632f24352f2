//! A sentence on a map, and how much it matters.

use serde::Serialize;

/// A sentence on a map.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Judgement {
    /// How much it matters.
    pub level: JudgementLevel,
    /// The sentence. It begins with the name of the map.
    pub text: String,
}

/// How much a sentence matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum JudgementLevel {
    /// Something is not reliable.
    Warning,
    /// How the map came about.
    Note,
}
