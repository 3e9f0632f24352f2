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

impl Ours {
    /// The value as a number in the printed unit, of a conclusion its margin; `None` if it is none.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Mean(mean) => Some(mean.mean),
            Self::Share(share) => Some(100.0 * share.share()),
            Self::Exact(value) => Some(*value),
            Self::Choice { best, .. } => best.parse().ok(),
            Self::Finding(finding) => Some(finding.margin.mean),
            Self::Never | Self::Missing => None,
        }
    }

    /// The value in words, with its `unit`.
    #[must_use]
    pub fn text(&self, unit: &str) -> String {
        let with_unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self {
            Self::Mean(mean) => mean.text(unit),
            Self::Share(share) => share.text(),
            Self::Never => "in no run".to_owned(),
            Self::Exact(value) => format!("{value:.4}{with_unit}"),
            Self::Choice { best, as_good } => choice(best, as_good),
            Self::Finding(finding) => format!("margin {}", finding.margin.text(unit)),
            Self::Missing => "no run succeeded".to_owned(),
        }
    }
}

/// The best setting, and those that are as good.
pub(crate) fn choice(best: &str, as_good: &[String]) -> String {
    if as_good.is_empty() {
        best.to_owned()
    } else {
        format!("{best} (not significantly better than {})", as_good.join(", "))
    }
}
