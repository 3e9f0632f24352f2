//! The parts of an experiment.

use super::chart::Chart;
use super::claim::Claim;
use super::line::{Line, Ours};
use super::published::Published;
use super::runs::{Runs, Term};
use sextant::summary::{Measure, Unit};
use sextant_figure::Figure;

/// A table or figure of the thesis.
#[derive(Debug)]
pub struct Experiment {
    /// Number of the table or figure, or a word.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What it computes.
    pub content: Content,
    /// Pairs of a scenario and a map whose distribution of connectivity errors is drawn.
    pub distributions: &'static [(&'static str, &'static str)],
    /// Figures of measures over its runs.
    pub charts: Vec<Chart>,
    /// Conclusions to check, of the thesis or ours.
    pub claims: Vec<Claim>,
    /// Notes on different definitions, and on what the thesis does not say.
    pub notes: &'static [&'static str],
}

/// What an experiment computes.
#[derive(Debug)]
pub enum Content {
    /// Means over the runs of scenarios.
    Quantities(Vec<Quantity>),
    /// Lines and figures by special functions.
    Computed {
        /// The scenarios that it runs.
        scenarios: &'static [&'static str],
        /// Its lines.
        lines: fn(&Runs) -> Vec<Line>,
        /// Its figures.
        figures: fn(&Runs) -> Vec<Figure>,
    },
}

/// A mean over the runs of a scenario, and its published value.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its description.
    pub what: String,
    /// What is measured.
    pub term: Term,
    /// The printed unit, if it is not that of the measure.
    pub unit: Option<&'static str>,
    /// The published value, in the printed unit.
    pub published: Option<Published>,
}

impl Quantity {
    /// A measure of a scenario without a published value.
    pub fn new(what: impl Into<String>, scenario: &'static str, measure: Measure<'static>) -> Self {
        Self { what: what.into(), term: Term::new(scenario, measure), unit: None, published: None }
    }

    /// The same with the published `value` from `source`.
    #[must_use]
    pub fn published(self, value: impl Into<String>, source: &'static str) -> Self {
        Self { published: Some(Published::new(value, source)), ..self }
    }

    /// The same with another printed unit; the number does not change.
    #[must_use]
    pub fn in_unit(self, unit: &'static str) -> Self {
        Self { unit: Some(unit), ..self }
    }

    fn line(&self, runs: &Runs) -> Line {
        let (factor, unit) = self.term.measure.unit().for_people();
        Line {
            what: self.what.clone(),
            published: self.published.clone(),
            unit: self.unit.unwrap_or(unit),
            ours: self.ours(runs, factor),
        }
    }

    fn ours(&self, runs: &Runs, factor: f64) -> Ours {
        if self.term.measure.unit() == Unit::Outcome {
            return runs.share(&self.term).map_or(Ours::Missing, Ours::Share);
        }
        match runs.mean(&self.term) {
            Some(mean) => Ours::Mean(mean.times(factor)),
            None if runs.have_succeeded(&self.term) => Ours::Never,
            None => Ours::Missing,
        }
    }
}

impl Experiment {
    /// The scenarios that it runs, each once.
    #[must_use]
    pub fn scenarios(&self) -> Vec<&'static str> {
        let mut scenarios: Vec<&'static str> = Vec::new();
        let quantities = match &self.content {
            Content::Quantities(quantities) => quantities,
            Content::Computed { scenarios, .. } => return scenarios.to_vec(),
        };
        for Quantity { term, .. } in quantities {
            if !scenarios.contains(&term.scenario) {
                scenarios.push(term.scenario);
            }
        }
        scenarios
    }

    /// The lines of its table.
    #[must_use]
    pub fn lines(&self, runs: &Runs) -> Vec<Line> {
        match &self.content {
            Content::Quantities(quantities) => quantities.iter().map(|quantity| quantity.line(runs)).collect(),
            Content::Computed { lines, .. } => lines(runs),
        }
    }

    /// The lines of its conclusions.
    #[must_use]
    pub fn conclusions(&self, runs: &Runs) -> Vec<Line> {
        self.claims.iter().map(|claim| claim.line(runs)).collect()
    }
}
