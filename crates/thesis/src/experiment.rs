//! The parts of an experiment.

use std::num::NonZeroU32;

use super::chart::Chart;
use super::claim::Claim;
use super::computation::Computation;
use super::line::Line;
use super::ours::Ours;
use super::published::Published;
use super::runs::{Runs, Term};

/// A table or figure of the thesis.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Number of the table or figure, or a word.
    pub id: String,
    /// Its title.
    pub title: String,
    /// The chapter of the thesis.
    pub chapter: u8,
    /// Runs of each of its scenarios, if the user does not choose: as many as decide its conclusions, as far as that is
    /// affordable.
    pub runs: NonZeroU32,
    /// The lines of its table.
    pub lines: Vec<Quantity>,
    /// Whether lines without a value are left out, if others have one.
    pub leave_out_empty_lines: bool,
    /// Figures of measures over its runs.
    pub charts: Vec<Chart>,
    /// Conclusions to check, of the thesis or ours.
    pub claims: Vec<Claim>,
    /// Notes on different definitions, and on what the thesis does not say.
    pub notes: Vec<String>,
}

/// A value of ours, and its published value.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its description.
    pub what: String,
    /// How it is computed.
    pub ours: Computation,
    /// The printed unit.
    pub unit: String,
    /// The published value, in the printed unit.
    pub published: Option<Published>,
}

impl Quantity {
    fn line(&self, runs: &Runs) -> Line {
        let (what, published, unit) = (self.what.clone(), self.published.clone(), self.unit.clone());
        Line { what, published, unit, ours: self.ours.ours(runs) }
    }
}

impl Experiment {
    /// The scenarios that it runs, each once.
    #[must_use]
    pub fn scenarios(&self) -> Vec<&str> {
        let mut scenarios: Vec<&str> = Vec::new();
        for Term { scenario, .. } in self.lines.iter().flat_map(|line| line.ours.terms()) {
            if !scenarios.contains(&scenario.as_str()) {
                scenarios.push(scenario);
            }
        }
        scenarios
    }

    /// The lines of its table.
    #[must_use]
    pub fn lines(&self, runs: &Runs) -> Vec<Line> {
        let mut lines: Vec<_> = self.lines.iter().map(|quantity| quantity.line(runs)).collect();
        let is_empty = |line: &Line| matches!(line.ours, Ours::Missing | Ours::Never);
        if self.leave_out_empty_lines && !lines.iter().all(is_empty) {
            lines.retain(|line| !is_empty(line));
        }
        lines
    }

    /// The lines of its conclusions.
    #[must_use]
    pub fn conclusions(&self, runs: &Runs) -> Vec<Line> {
        self.claims.iter().map(|claim| claim.line(runs)).collect()
    }
}
