//! The runs of experiments.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use super::error::ReproductionError;
use super::variant::Variant;
use sextant::summary::Measure;
use sextant_kernel::Watch;
use sextant_kernel::text::counted;
use sextant_study::sweep::{self, Average, Mean, RunRow, Share, Sweep};

/// A measure of a cell of a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Term {
    /// The scenario, as it ships or under a reading.
    pub variant: Variant,
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
    /// As often as its experiments say; once if none does.
    Usual(BTreeMap<Variant, NonZeroU32>),
}

impl RunCounts {
    fn of(&self, variant: &Variant) -> NonZeroU32 {
        match self {
            Self::Each(count) => *count,
            Self::Usual(counts) => counts.get(variant).copied().unwrap_or(NonZeroU32::MIN),
        }
    }
}

/// All finished runs of scenarios.
#[derive(Debug)]
pub struct Runs {
    folder: PathBuf,
    counts: RunCounts,
    seed: Option<u64>,
    of: BTreeMap<Variant, (Sweep, Vec<RunRow>)>,
}

impl Runs {
    /// No runs yet. The files of scenarios are in `folder`, and each scenario will be run as often as `counts` says. The first
    /// run has the `seed`, or that of the scenario.
    #[must_use]
    pub fn new(folder: PathBuf, counts: RunCounts, seed: Option<u64>) -> Self {
        Self { folder, counts, seed, of: BTreeMap::new() }
    }

    fn plan_of(&self, variant: &Variant, runs: NonZeroU32) -> Result<Sweep, ReproductionError> {
        Ok(Sweep::read(&self.folder.join(&variant.scenario), &variant.set, self.seed, Some(runs))?)
    }

    /// Runs those of `variants` that have not been run yet, and returns those. Before it starts, `tell` gets how
    /// many runs that are, in words. If `watch` stops the work, finished runs are kept.
    ///
    /// # Errors
    /// If a scenario is invalid, or `watch` stops the work.
    pub fn make(
        &mut self,
        variants: &[Variant],
        tell: impl FnOnce(&str),
        watch: &dyn Watch,
    ) -> Result<Vec<Variant>, ReproductionError> {
        let new: Vec<_> = variants.iter().filter(|variant| !self.of.contains_key(*variant)).cloned().collect();
        let plan = |variant: &Variant| self.plan_of(variant, self.counts.of(variant));
        let plans = new.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
        if !new.is_empty() {
            let runs = counted(plans.iter().map(Sweep::survey_count).sum(), "run");
            let of_readings = new.iter().filter(|variant| !variant.is_shipped()).count();
            let readings = match of_readings {
                0 => String::new(),
                count => format!(" and of {} with settings of a reading", counted(count, "scenario")),
            };
            let shipped = counted(new.len() - of_readings, "scenario");
            tell(&format!("{runs} of {shipped}{readings}, then one of each scenario for its figures"));
        }
        let (rows, outcome) = sweep::rows(&plans, watch);
        for (variant, made) in new.iter().zip(plans.into_iter().zip(rows)) {
            self.insert(variant.clone(), made);
        }
        Ok(outcome.map(|()| new)?)
    }

    /// Reads the runs of those of `variants` that have a table in the folder `from`, as [`write_tables`](Self::write_tables)
    /// writes them. Returns whether all have one.
    ///
    /// # Errors
    /// If a table cannot be read, or is that of other settings.
    pub fn read(&mut self, variants: &[Variant], from: &Path) -> Result<bool, ReproductionError> {
        for variant in variants {
            let table = from.join(variant.table_name());
            if !self.of.contains_key(variant) && table.is_file() {
                let plan = self.plan_of(variant, NonZeroU32::MIN)?;
                let rows = sweep::read_table(&table, &plan)?;
                self.insert(variant.clone(), (plan, rows));
            }
        }
        Ok(self.has(variants))
    }

    /// Whether all `variants` were run.
    #[must_use]
    pub fn has<'a>(&self, variants: impl IntoIterator<Item = &'a Variant>) -> bool {
        variants.into_iter().all(|variant| self.of.contains_key(variant))
    }

    /// Writes the tables of the finished runs of `variants` into the folder `out`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_tables(&self, variants: &[Variant], out: &Path) -> Result<(), ReproductionError> {
        for (variant, plan, rows) in self.variants().filter(|(variant, ..)| variants.contains(variant)) {
            sweep::write_table(&out.join(variant.table_name()), plan, &rows)?;
        }
        Ok(())
    }

    /// Adds the rows of a scenario.
    pub fn insert(&mut self, variant: Variant, (plan, rows): (Sweep, Vec<RunRow>)) {
        self.of.insert(variant, (plan, rows));
    }

    /// The values of a term in the successful runs, each with the number of the run.
    #[must_use]
    pub fn values(&self, term: &Term) -> Vec<(u32, f64)> {
        let Some((plan, rows)) = self.of.get(&term.variant) else { return Vec::new() };
        let Some(cell) = cell(plan, &term.settings) else { return Vec::new() };
        plan.values_of(rows, cell, &term.measure)
    }

    /// The mean of a term over the successful runs; `None` if there are none.
    #[must_use]
    pub fn mean(&self, term: &Term) -> Option<Mean> {
        let values: Vec<f64> = self.values(term).into_iter().map(|(_, value)| value).collect();
        Mean::of(&values)
    }

    /// The average of a term over the successful runs: of an outcome the share of the runs in which it happened, and the mean
    /// of others. `None` if there are none.
    #[must_use]
    pub fn average(&self, term: &Term) -> Option<Average> {
        let values: Vec<f64> = self.values(term).into_iter().map(|(_, value)| value).collect();
        Average::of(term.measure.unit(), &values)
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
        let Some((plan, rows)) = self.of.get(&term.variant) else { return Vec::new() };
        let cell = cell(plan, &term.settings);
        let successful = rows.iter().filter(|row| Some(row.cell) == cell && row.outcome.is_ok());
        successful.map(|row| row.replicate).collect()
    }

    /// How often a scenario was run.
    #[must_use]
    pub fn made(&self, variant: &Variant) -> u32 {
        let rows = self.of.get(variant).map_or(&[][..], |(_, rows)| rows);
        rows.iter().map(|row| row.replicate + 1).max().unwrap_or(0)
    }

    /// The plan of a scenario that was run.
    #[must_use]
    pub fn plan(&self, variant: &Variant) -> Option<&Sweep> {
        self.of.get(variant).map(|(plan, _)| plan)
    }

    /// The scenarios with their plans and rows.
    pub fn variants(&self) -> impl Iterator<Item = (&Variant, &Sweep, &[RunRow])> {
        self.of.iter().map(|(variant, (plan, rows))| (variant, plan, rows.as_slice()))
    }

    /// The failed runs: scenario, seed and error.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for (Variant { scenario, reading, .. }, plan, rows) in self.variants() {
            let of = if reading.is_empty() { scenario.clone() } else { format!("{scenario} ({reading})") };
            failures.extend(rows.iter().filter_map(|row| {
                let error = row.outcome.as_ref().err()?;
                Some(format!("{of}, seed {}: {error}", plan.seed_of(row.replicate)))
            }));
        }
        failures
    }
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
