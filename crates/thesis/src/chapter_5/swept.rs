//! The errors of maps over a swept setting.

use super::super::chart::{Across, Chart, ChartKind, ChartLine};
use super::super::environment::Environment;
use super::super::experiment::Quantity;
use super::super::published::Published;
use super::super::runs::Term;
use super::subject::Subject;
use sextant::summary::measures::{map, position_errors};
use sextant::summary::{MapSummary, Number};

pub(super) const MEAN: &Number<MapSummary> = &map::POSITION_ERROR_MEAN_M;
pub(super) const P95: &Number<MapSummary> = &map::POSITION_ERROR_P95_M;
pub(super) const WITHIN_1_M: &Number<MapSummary> = &position_errors::WITHIN_1_M;
pub(super) const ZERO: &Number<MapSummary> = &map::SECTOR_DISPLACEMENT_0;
pub(super) const THREE: &Number<MapSummary> = &map::SECTOR_DISPLACEMENT_3;

/// What is computed in each cell.
const NUMBERS: [(&str, &Number<MapSummary>); 6] = [
    ("mean distance error", MEAN),
    ("95th percentile of the distance error", P95),
    ("nodes with an error of at most 1 m", WITHIN_1_M),
    ("nodes with zero sector displacement", ZERO),
    ("nodes with a sector displacement of three", THREE),
    ("nodes without a position", &map::UNMAPPED),
];

/// A map in an environment, over the values of a setting.
#[derive(Clone, Copy)]
pub(super) struct Swept {
    pub(super) environment: Environment,
    pub(super) subject: &'static Subject,
    pub(super) key: &'static str,
    /// The values, as in tables.
    pub(super) values: &'static [&'static str],
}

impl Swept {
    /// A number in the cell of `value`.
    pub(super) fn term(self, value: &str, number: &'static Number<MapSummary>) -> Term {
        self.subject.at(self.environment, (self.key, value), number)
    }

    /// A number in the cells of `values`.
    pub(super) fn terms(self, values: &[&str], number: &'static Number<MapSummary>) -> Vec<Term> {
        values.iter().map(|value| self.term(value, number)).collect()
    }

    /// The lines of all cells; `cell` tells a value in words, and `published` knows published values.
    pub(super) fn quantities(
        self,
        cell: impl Fn(&str) -> String,
        published: impl Fn(&str, &'static Number<MapSummary>) -> Option<Published>,
    ) -> Vec<Quantity> {
        let quantity = |what: &str, value: &str, number| Quantity {
            what: format!("{}: {what}, {}, {}", self.environment.name(), cell(value), self.subject.name),
            term: self.term(value, number),
            unit: None,
            published: published(value, number),
        };
        let of = |(what, number)| self.values.iter().map(move |value| (what, *value, number));
        NUMBERS.into_iter().flat_map(of).map(|(what, value, number)| quantity(what, value, number)).collect()
    }

    fn line(self, across: &impl Fn(Self, &str) -> Across, number: &'static Number<MapSummary>) -> ChartLine {
        let points = self.values.iter().map(|value| (across(self, value), self.term(value, number)));
        ChartLine { name: format!("{}, {}", self.environment.name(), self.subject.name), points: points.collect() }
    }
}

/// The figures of an experiment.
pub(super) struct Figures<'a> {
    pub(super) id: &'static str,
    pub(super) title: &'static str,
    pub(super) across: &'static str,
    pub(super) lines: &'a [Swept],
}

impl Figures<'_> {
    /// The error, and the shares of the nodes with zero and three sectors of displacement; `across` gives the horizontal
    /// value of a cell.
    pub(super) fn charts(&self, across: impl Fn(Swept, &str) -> Across) -> Vec<Chart> {
        let chart = |name: &str, up, number| Chart {
            name: format!("{}-{name}", self.id),
            kind: ChartKind::Curves,
            title: self.title.to_owned(),
            note: "mean over the runs, with 95 % intervals".to_owned(),
            across: self.across,
            up,
            lines: self.lines.iter().map(|swept| swept.line(&across, number)).collect(),
        };
        vec![
            chart("error", "mean distance error [m]", MEAN),
            chart("displacement-0", "nodes with zero sector displacement [%]", ZERO),
            chart("displacement-3", "nodes with a sector displacement of three [%]", THREE),
        ]
    }
}
