//! The parts of an experiment.

use std::num::NonZeroU32;

use super::chart::Chart;
use super::claim::Claim;
use super::line::Line;
use super::open::OpenSetting;
use super::ours::Ours;
use super::picture::Picture;
use super::quantity::Quantity;
use super::reading::Reading;
use super::runs::{Runs, Term};
use super::variant::Variant;

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
    /// Runs of each of its scenarios under a reading, if the user does not choose.
    pub reading_runs: NonZeroU32,
    /// The lines of its table.
    pub lines: Vec<Quantity>,
    /// Whether lines without a value are left out, if others have one.
    pub leave_out_empty_lines: bool,
    /// Figures of measures over its runs.
    pub charts: Vec<Chart>,
    /// Pictures of one run of its scenarios.
    pub pictures: Vec<Picture>,
    /// Conclusions to check, of the thesis or ours.
    pub claims: Vec<Claim>,
    /// What the thesis leaves open.
    pub open: Vec<OpenSetting>,
    /// Other values of what is open, one at a time, and some together.
    pub readings: Vec<Reading>,
    /// Notes on different definitions, and on what the thesis does not say.
    pub notes: Vec<String>,
}

impl Experiment {
    /// The scenarios that it runs, each once.
    #[must_use]
    pub fn scenarios(&self) -> Vec<&str> {
        let mut scenarios: Vec<&str> = Vec::new();
        for Term { variant, .. } in self.lines.iter().flat_map(|line| line.ours.terms()) {
            if !scenarios.contains(&variant.scenario.as_str()) {
                scenarios.push(&variant.scenario);
            }
        }
        scenarios
    }

    /// The same as they ship.
    #[must_use]
    pub fn shipped(&self) -> Vec<Variant> {
        self.scenarios().into_iter().map(Variant::shipped).collect()
    }

    /// What its readings run beside that, each once.
    #[must_use]
    pub fn of_readings(&self) -> Vec<Variant> {
        let shipped = self.shipped();
        let mut variants = Vec::new();
        for variant in self.readings.iter().flat_map(Reading::variants) {
            if !shipped.contains(variant) && !variants.contains(variant) {
                variants.push(variant.clone());
            }
        }
        variants
    }

    /// The lines of its table.
    #[must_use]
    pub fn lines(&self, runs: &Runs) -> Vec<Line> {
        self.shown(self.lines.iter().map(|quantity| quantity.line(quantity.ours.ours(runs))).collect())
    }

    /// The `lines` without those that are left out.
    pub(crate) fn shown(&self, mut lines: Vec<Line>) -> Vec<Line> {
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
