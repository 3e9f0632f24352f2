//! The cases of the chapter, and the searches that are compared.

use super::super::runs::Term;
use sextant::summary::{ApplicationSummary, Measure, Number};

/// The setting of the speed of the robot.
const SPEED: &str = "robots.0.speed_m_per_s";

/// Speeds of the robot in the sweeps (m/s), as in tables.
pub(super) const SLOW: &str = "2.0";
/// See [`SLOW`].
pub(super) const FAST: &str = "3.0";

/// A case: where the target enters and leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Case {
    pub(super) name: &'static str,
    /// The sweep over the speeds of the robot.
    pub(super) scenario: &'static str,
    /// When the target leaves (s).
    pub(super) end_s: u8,
}

/// The cases, in the order of the thesis.
pub(super) const CASES: [Case; 3] = [
    Case { name: "case 1", scenario: "target/speeds-1.toml", end_s: 82 },
    Case { name: "case 2", scenario: "target/speeds-2.toml", end_s: 84 },
    Case { name: "case 3", scenario: "target/speeds-3.toml", end_s: 44 },
];

/// An application of the scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Search {
    pub(super) name: &'static str,
    application: &'static str,
}

/// The search with our settings.
pub(super) const DETARSK: Search = Search { name: "DeTarSK", application: "detarsk" };
/// The search with the settings of the thesis.
pub(super) const THESIS: Search =
    Search { name: "DeTarSK with the settings of the thesis", application: "detarsk-thesis" };
/// The comparator.
pub(super) const P_G: Search = Search { name: "P-G", application: "p-g" };

/// The searches that are compared.
pub(super) const SEARCHES: [Search; 3] = [DETARSK, THESIS, P_G];

impl Case {
    /// A number of `search` by a robot of `speed`.
    pub(super) fn term(self, search: Search, speed: &str, number: &'static Number<ApplicationSummary>) -> Term {
        Term {
            settings: vec![(SPEED, speed.to_owned())],
            ..Term::new(self.scenario, Measure::OfApplication(search.application, number))
        }
    }
}

/// A speed in words.
pub(super) fn in_words(speed: &str) -> String {
    format!("{} m/s", speed.trim_end_matches(".0"))
}
