//! The tables and figures of the thesis (2018, chapter 3), computed anew: what it published beside what comes out here.
//!
//! Each experiment has the id of its table or figure and runs scenarios that ship with the program, over several seeds.
//! Nothing is fitted to a published number; where the definitions differ, a note says how.

mod catalogue;
mod experiment;
mod figures;
mod line;
mod sensitivity;
mod shipped;
mod worked_example;

pub use catalogue::{CHAPTER_3, find};
pub use experiment::{Check, Claim, Content, Experiment, Quantity, Term};
pub use figures::{write_figures, write_pictures};
pub use line::{Line, Ours, write_csv};
pub use shipped::{SHIPPED, write_scenarios};

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::Path;

use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::summary::Measure;
use crate::sweep::{self, Mean, Plan, Row};

/// All runs of the scenarios that experiments need.
#[derive(Debug)]
pub struct Runs {
    of: BTreeMap<&'static str, (Plan, Vec<Row>)>,
}

impl Runs {
    /// Runs the scenarios of `experiments`, whose files lie in `folder`, `runs` times each.
    ///
    /// # Errors
    /// If a scenario is wrong, or the user interrupts.
    pub fn make(
        experiments: &[&Experiment],
        folder: &Path,
        runs: NonZeroU32,
        interrupt: &Interrupt,
        quiet: bool,
    ) -> Result<Self, Failure> {
        let mut scenarios: Vec<&'static str> = Vec::new();
        for scenario in experiments.iter().flat_map(|experiment| experiment.scenarios()) {
            if !scenarios.contains(&scenario) {
                scenarios.push(scenario);
            }
        }
        let plan = |scenario: &&'static str| Plan::read(&folder.join(scenario), &[], None, Some(runs));
        let plans = scenarios.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
        let rows = sweep::rows(&plans, interrupt, quiet)?;
        Ok(Self { of: scenarios.into_iter().zip(plans.into_iter().zip(rows)).collect() })
    }

    /// The mean of a measure over the runs of a cell of a scenario that did not fail.
    pub(crate) fn mean(&self, scenario: &str, cell: usize, measure: Measure<'_>) -> Option<Mean> {
        let (plan, rows) = self.of.get(scenario)?;
        plan.mean(rows, cell, measure)
    }

    /// The plan of a scenario.
    pub(crate) fn plan(&self, scenario: &str) -> Option<&Plan> {
        self.of.get(scenario).map(|(plan, _)| plan)
    }

    /// The scenarios with their plans and rows.
    pub fn scenarios(&self) -> impl Iterator<Item = (&'static str, &Plan, &[Row])> {
        self.of.iter().map(|(&scenario, (plan, rows))| (scenario, plan, rows.as_slice()))
    }

    /// What went wrong in runs that failed: scenario, seed and error.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for (scenario, plan, rows) in self.scenarios() {
            failures.extend(rows.iter().filter_map(|row| {
                let error = row.outcome.as_ref().err()?;
                Some(format!("{scenario}, seed {}: {error}", plan.seed_of(row.replicate)))
            }));
        }
        failures
    }
}
