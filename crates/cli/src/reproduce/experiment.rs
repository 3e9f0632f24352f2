//! What an experiment consists of.

use super::claim::Claim;
use super::line::{Line, Ours};
use super::published::Published;
use super::runs::{Runs, Term};
use crate::figure::Figure;
use crate::summary::Measure;

/// A table or figure of the thesis.
#[derive(Debug)]
pub struct Experiment {
    /// Number of the table or figure, or a word.
    pub id: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// What is computed.
    pub content: Content,
    /// Scenarios, and maps of them, of which the distribution of the nodes' connectivity errors is drawn.
    pub distributions: &'static [(&'static str, &'static str)],
    /// What follows, in the thesis or here, and is checked.
    pub claims: Vec<Claim>,
    /// Where definitions differ, and what the thesis leaves open.
    pub notes: &'static [&'static str],
}

/// What an experiment computes.
#[derive(Debug)]
pub enum Content {
    /// Means over the runs of scenarios.
    Quantities(Vec<Quantity>),
    /// Lines and figures of its own.
    Computed {
        /// The scenarios that it needs.
        scenarios: &'static [&'static str],
        /// Its lines.
        lines: fn(&Runs) -> Vec<Line>,
        /// Its figures.
        figures: fn(&Runs) -> Vec<Figure>,
    },
}

/// A mean over the runs of a scenario, and what was published for it.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// What it is.
    pub what: String,
    /// What is measured.
    pub term: Term,
    /// The unit for people, if it is not that of the measure.
    pub unit: Option<&'static str>,
    /// What the thesis says, in the unit for people.
    pub published: Option<Published>,
}

impl Quantity {
    /// A measure of a scenario that the thesis does not state.
    pub fn new(what: impl Into<String>, scenario: &'static str, measure: Measure<'static>) -> Self {
        Self { what: what.into(), term: Term::new(scenario, measure), unit: None, published: None }
    }

    /// The same, of which the thesis says `value` in `source`.
    #[must_use]
    pub fn published(self, value: impl Into<String>, source: &'static str) -> Self {
        Self { published: Some(Published::new(value, source)), ..self }
    }

    /// The same in another unit of the same size.
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
            ours: runs.mean(&self.term).map_or(Ours::Missing, |mean| Ours::Mean(mean.times(factor))),
        }
    }
}

impl Experiment {
    /// The scenarios that it needs, each once.
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

    /// Published and ours.
    #[must_use]
    pub fn lines(&self, runs: &Runs) -> Vec<Line> {
        match &self.content {
            Content::Quantities(quantities) => quantities.iter().map(|quantity| quantity.line(runs)).collect(),
            Content::Computed { lines, .. } => lines(runs),
        }
    }

    /// What follows, published and found here.
    #[must_use]
    pub fn conclusions(&self, runs: &Runs) -> Vec<Line> {
        self.claims.iter().map(|claim| claim.line(runs)).collect()
    }
}
