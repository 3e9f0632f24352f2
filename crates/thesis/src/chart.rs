//! Figures of measures over runs.

use super::runs::{Runs, Term};
use sextant_figure::{Bars, Curves, Figure, Series};

/// A figure of measures over runs.
#[derive(Clone, Debug)]
pub struct Chart {
    /// The name of its file.
    pub name: String,
    /// How values are drawn.
    pub kind: ChartKind,
    /// The title.
    pub title: String,
    /// The note below the title.
    pub note: String,
    /// Name of the horizontal axis, with its unit.
    pub across: &'static str,
    /// Name of the vertical axis, with its printed unit.
    pub up: &'static str,
    /// What is drawn.
    pub lines: Vec<ChartLine>,
}

/// How values are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChartKind {
    /// As curves with intervals.
    Curves,
    /// As curves without intervals: the shares of a distribution.
    Distribution,
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
    /// The mean of what came out, not in its printed unit.
    Measured(Term),
}

impl Chart {
    /// The figure, with the mean of each measure that has values, and its 95 % interval except in distributions.
    pub(super) fn figure(&self, runs: &Runs) -> Figure {
        let curves = Curves {
            title: self.title.clone(),
            note: self.note.clone(),
            across: self.across.to_owned(),
            up: self.up.to_owned(),
            series: self.lines.iter().map(|line| self.kind.shown(line.series(runs))).collect(),
        };
        match self.kind {
            ChartKind::Curves | ChartKind::Distribution => curves.figure(&self.name),
            ChartKind::Bars => Bars(curves).figure(&self.name),
        }
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
            Self::Distribution => Series { half_widths: Vec::new(), ..series },
        }
    }
}

impl ChartLine {
    fn series(&self, runs: &Runs) -> Series {
        let mut series = Series { name: self.name.clone(), points: Vec::new(), half_widths: Vec::new() };
        for (across, term) in &self.points {
            let (Some(x), Some(mean)) = (across.value(runs), runs.mean(term)) else { continue };
            let mean = mean.times(term.measure.unit().for_people().0);
            series.points.push((x, mean.mean));
            series.half_widths.push(mean.half_width_95.unwrap_or(0.0));
        }
        series
    }
}
