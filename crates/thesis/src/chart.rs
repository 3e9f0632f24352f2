//! Figures of measures over runs.

use serde::Deserialize;

use super::runs::{Runs, Term};
use super::values::Values;
use super::words::RUNS;
use sextant_figure::{Bars, Curves, Figure, Series};

/// A figure of measures over runs.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The name of its file.
    pub name: String,
    /// How values are drawn.
    pub kind: ChartKind,
    /// The unit of the values.
    pub values: Values,
    /// The title.
    pub title: String,
    /// The note below the title; `{runs}` stands for the most runs of a point.
    pub note: String,
    /// Name of the horizontal axis, with its unit.
    pub across: String,
    /// Name of the vertical axis, with its unit.
    pub up: String,
    /// What is drawn.
    pub lines: Vec<ChartLine>,
}

/// How values are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChartKind {
    /// As curves with intervals.
    Curves,
    /// As curves without intervals, such as the shares of a distribution.
    PlainCurves,
    /// As bars at whole numbers.
    Bars,
}

/// A curve, or the bars of one colour.
#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Its name in the legend.
    pub name: String,
    /// The measure at each horizontal value.
    pub points: Vec<(Across, Term)>,
}

/// A horizontal value.
#[derive(Clone, Debug)]
pub enum Across {
    /// A setting.
    Setting(f64),
    /// The mean of what came out, not in its unit.
    Measured(Term),
}

impl Chart {
    /// The figure, with the mean of each measure that has values, or the share of an outcome, and its 95 % interval except of
    /// plain curves.
    pub(super) fn figure(&self, runs: &Runs) -> Figure {
        let curves = Curves {
            title: self.title.clone(),
            note: self.note.replace(&format!("{{{RUNS}}}"), &self.most_runs(runs).to_string()),
            across: self.across.clone(),
            up: self.up.clone(),
            series: self.lines.iter().map(|line| self.kind.shown(line.series(self.values, runs))).collect(),
        };
        match self.kind {
            ChartKind::Curves | ChartKind::PlainCurves => curves.figure(&self.name),
            ChartKind::Bars => Bars(curves).figure(&self.name),
        }
    }

    /// The most runs with a value of a point.
    fn most_runs(&self, runs: &Runs) -> usize {
        let points = self.lines.iter().flat_map(|line| &line.points);
        points.filter_map(|(_, term)| runs.mean(term)).map(|mean| mean.runs).max().unwrap_or(0)
    }
}

impl Across {
    fn value(&self, runs: &Runs) -> Option<f64> {
        match self {
            Self::Setting(value) => Some(*value),
            Self::Measured(term) => runs.mean(term).map(|mean| mean.mean),
        }
    }
}

impl ChartKind {
    /// The part of `series` that is drawn.
    fn shown(self, series: Series) -> Series {
        match self {
            Self::Curves | Self::Bars => series,
            Self::PlainCurves => Series { intervals: Vec::new(), ..series },
        }
    }
}

impl ChartLine {
    fn series(&self, values: Values, runs: &Runs) -> Series {
        let mut series = Series { name: self.name.clone(), points: Vec::new(), intervals: Vec::new() };
        for (across, term) in &self.points {
            let (Some(x), Some(average)) = (across.value(runs), runs.average(term)) else { continue };
            let factor = match values {
                Values::Printed => term.measure.unit().for_people().0,
                Values::Shares => 1.0,
            };
            series.points.push((x, factor * average.value()));
            series.intervals.push(average.interval_95().map(|ends| ends.map(|end| factor * end)));
        }
        series
    }
}
