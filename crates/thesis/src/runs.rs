//! The runs of experiments.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use super::error::ReproductionError;
use sextant::summary::Measure;
use sextant_kernel::Watch;
use sextant_kernel::text::counted;
use sextant_study::sweep::{self, Mean, RunRow, Share, Sweep};

/// A measure of a cell of a scenario.
#[derive(Clone, Debug)]
pub struct Term {
    /// The scenario that ships with the program.
    pub scenario: String,
    /// The settings of the cell in the sweep, with their values as in tables; empty for a scenario without a sweep.
    pub settings: Vec<(String, String)>,
    /// What is measured.
    pub measure: Measure,
}

/// How often each scenario is run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RunCounts {
    /// All as often.
    Each(NonZeroU32),
    /// As often as its experiments say, by scenario; once if none does.
    Usual(BTreeMap<String, NonZeroU32>),
}

impl RunCounts {
    fn of(&self, scenario: &str) -> NonZeroU32 {
        match self {
            Self::Each(count) => *count,
            Self::Usual(counts) => counts.get(scenario).copied().unwrap_or(NonZeroU32::MIN),
        }
    }
}

/// All finished runs of scenarios.
#[derive(Debug)]
pub struct Runs {
    folder: PathBuf,
    counts: RunCounts,
    of: BTreeMap<String, (Sweep, Vec<RunRow>)>,
}

impl Runs {
    /// No runs yet. The files of scenarios are in `folder`, and each scenario will be run as often as `counts` says.
    #[must_use]
    pub fn new(folder: PathBuf, counts: RunCounts) -> Self {
        Self { folder, counts, of: BTreeMap::new() }
    }

    fn plan_of(&self, scenario: &str, runs: NonZeroU32) -> Result<Sweep, ReproductionError> {
        Ok(Sweep::read(&self.folder.join(scenario), &[], None, Some(runs))?)
    }

    /// Runs those of `scenarios` that have not been run yet, and returns their names. Before it starts, `tell` gets how
    /// many runs that are, in words. If `watch` stops the work, finished runs are kept.
    ///
    /// # Errors
    /// If a scenario is invalid, or `watch` stops the work.
    pub fn make<'a>(
        &mut self,
        scenarios: &[&'a str],
        tell: impl FnOnce(&str),
        watch: &dyn Watch,
    ) -> Result<Vec<&'a str>, ReproductionError> {
        let new: Vec<_> = scenarios.iter().copied().filter(|name| !self.of.contains_key(*name)).collect();
        let plan = |scenario: &&str| self.plan_of(scenario, self.counts.of(scenario));
        let plans = new.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
        if !new.is_empty() {
            let runs = counted(plans.iter().map(Sweep::survey_count).sum(), "run");
            tell(&format!("{runs} of {}, then one of each for its figures", counted(new.len(), "scenario")));
        }
        let (rows, outcome) = sweep::rows(&plans, watch);
        for (scenario, made) in new.iter().zip(plans.into_iter().zip(rows)) {
            self.insert(scenario, made);
        }
        Ok(outcome.map(|()| new)?)
    }

    /// Reads the runs of those of `scenarios` that have a table in the folder `from`, as [`write_tables`](Self::write_tables)
    /// writes them. Returns whether all have one.
    ///
    /// # Errors
    /// If a table cannot be read, or is that of other settings.
    pub fn read(&mut self, scenarios: &[&str], from: &Path) -> Result<bool, ReproductionError> {
        for scenario in scenarios {
            let table = from.join(table_name(scenario));
            if !self.of.contains_key(*scenario) && table.is_file() {
                let plan = self.plan_of(scenario, NonZeroU32::MIN)?;
                let rows = sweep::read_table(&table, &plan)?;
                self.insert(scenario, (plan, rows));
            }
        }
        Ok(scenarios.iter().all(|scenario| self.of.contains_key(*scenario)))
    }

    /// Writes the tables of the finished runs of `scenarios` into the folder `out`: `runs-SCENARIO.csv`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_tables(&self, scenarios: &[&str], out: &Path) -> Result<(), ReproductionError> {
        for (scenario, plan, rows) in self.scenarios().filter(|(scenario, ..)| scenarios.contains(scenario)) {
            sweep::write_table(&out.join(table_name(scenario)), plan, &rows)?;
        }
        Ok(())
    }

    /// Adds the rows of a scenario.
    pub fn insert(&mut self, scenario: &str, (plan, rows): (Sweep, Vec<RunRow>)) {
        self.of.insert(scenario.to_owned(), (plan, rows));
    }

    /// The values of a term in the successful runs, each with the number of the run.
    #[must_use]
    pub fn values(&self, term: &Term) -> Vec<(u32, f64)> {
        let Some((plan, rows)) = self.of.get(&term.scenario) else { return Vec::new() };
        let Some(cell) = cell(plan, &term.settings) else { return Vec::new() };
        plan.values_of(rows, cell, &term.measure)
    }

    /// The mean of a term over the successful runs; `None` if there are none.
    #[must_use]
    pub fn mean(&self, term: &Term) -> Option<Mean> {
        let values: Vec<f64> = self.values(term).into_iter().map(|(_, value)| value).collect();
        Mean::of(&values)
    }

    /// The share of the successful runs in which the outcome of a term happened; `None` if there are none.
    #[must_use]
    pub fn share(&self, term: &Term) -> Option<Share> {
        let outcomes: Vec<f64> = self.values(term).into_iter().map(|(_, outcome)| outcome).collect();
        Share::of(&outcomes)
    }

    /// The numbers of the successful runs of the cell of a term.
    #[must_use]
    pub fn successful(&self, term: &Term) -> Vec<u32> {
        let Some((plan, rows)) = self.of.get(&term.scenario) else { return Vec::new() };
        let cell = cell(plan, &term.settings);
        let successful = rows.iter().filter(|row| Some(row.cell) == cell && row.outcome.is_ok());
        successful.map(|row| row.replicate).collect()
    }

    /// How often a scenario was run.
    #[must_use]
    pub fn made(&self, scenario: &str) -> u32 {
        let rows = self.of.get(scenario).map_or(&[][..], |(_, rows)| rows);
        rows.iter().map(|row| row.replicate + 1).max().unwrap_or(0)
    }

    /// The plan of a scenario that was run.
    #[must_use]
    pub fn plan(&self, scenario: &str) -> Option<&Sweep> {
        self.of.get(scenario).map(|(plan, _)| plan)
    }

    /// The scenarios with their plans and rows.
    pub fn scenarios(&self) -> impl Iterator<Item = (&str, &Sweep, &[RunRow])> {
        self.of.iter().map(|(scenario, (plan, rows))| (scenario.as_str(), plan, rows.as_slice()))
    }

    /// The failed runs: scenario, seed and error.
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

/// The name of the table of the runs of a scenario.
fn table_name(scenario: &str) -> String {
    format!("runs-{}.csv", scenario.trim_end_matches(".toml").replace('/', "-"))
}

/// The first cell that has these settings.
fn cell(plan: &Sweep, settings: &[(String, String)]) -> Option<usize> {
    let has = |cell: usize| {
        let values = plan.values(cell);
        settings.iter().all(|(key, wanted)| {
            plan.keys().iter().zip(&values).any(|(column, value)| column.name == *key && value == wanted)
        })
    };
    (0..plan.cells().len()).find(|&cell| has(cell))
}
