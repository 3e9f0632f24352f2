//! What runs cost: CPU times that were measured.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde::Deserialize;

/// CPU times of one run of each scenario, all cells of its sweep together, as they were measured on one machine.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Costs {
    /// The machine.
    pub machine: String,
    /// How they were measured.
    pub method: String,
    cpu_s: BTreeMap<String, f64>,
}

impl Costs {
    /// The times that were measured.
    ///
    /// # Panics
    /// Never: the file is a part of the program, and a test reads it.
    #[must_use]
    pub fn measured() -> &'static Self {
        static COSTS: OnceLock<Costs> = OnceLock::new();
        COSTS.get_or_init(|| toml::from_str(include_str!("../tables/costs.toml")).expect("a test reads the file"))
    }

    /// The scenarios that were measured, each with the CPU time of one run (s).
    pub fn all(&self) -> impl Iterator<Item = (&str, f64)> {
        self.cpu_s.iter().map(|(scenario, &run_s)| (scenario.as_str(), run_s))
    }

    /// CPU time of one run of `scenario` (s).
    #[must_use]
    pub fn of_run_s(&self, scenario: &str) -> Option<f64> {
        self.cpu_s.get(scenario).copied()
    }

    /// CPU time of one run of each of `scenarios` (s); `None` if one of them was not measured.
    pub fn of_runs_s<'a>(&self, scenarios: impl IntoIterator<Item = &'a str>) -> Option<f64> {
        scenarios.into_iter().try_fold(0.0, |sum, scenario| Some(sum + self.of_run_s(scenario)?))
    }
}
