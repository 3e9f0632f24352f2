//! Our value of a line.

use super::finding::Finding;
use sextant_study::sweep::{Mean, Share};

/// Our value of a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Ours {
    /// A mean over runs.
    Mean(Mean),
    /// The share of the runs in which something happened.
    Share(Share),
    /// No run has a value: what is measured did not happen.
    Never,
    /// A number that does not depend on random runs.
    Exact(f64),
    /// The best of several settings.
    Choice {
        /// What is shown of it.
        best: String,
        /// Those that are not significantly worse.
        as_good: Vec<String>,
    },
    /// Whether a conclusion holds.
    Finding(Finding),
    /// All runs failed.
    Missing,
}
