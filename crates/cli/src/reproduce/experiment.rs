//! What an experiment consists of.

use super::line::{Line, Ours};
use super::{Runs, sensitivity, worked_example};
use crate::summary::Measure;
use crate::sweep::Mean;

/// A table or figure of the thesis.
#[derive(Debug)]
pub struct Experiment {
    /// Number of the table or figure, or a word.
    pub id: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// What is computed.
    pub content: Content,
    /// Scenarios of which the distribution of the nodes' connectivity errors is drawn.
    pub distributions: &'static [&'static str],
    /// What the thesis concludes, as far as it can be checked.
    pub claims: &'static [Claim],
    /// Where definitions differ, and what the thesis leaves open.
    pub notes: &'static [&'static str],
}

/// What an experiment computes.
#[derive(Debug)]
pub enum Content {
    /// Means over the runs of scenarios.
    Quantities(&'static [Quantity]),
    /// The best settings of a sweep over p0 and R in three environments.
    Sensitivity,
    /// Likelihoods at the vertices of a small example.
    WorkedExample,
}

/// A mean over the runs of a scenario, and what was published for it.
#[derive(Debug)]
pub struct Quantity {
    /// What it is.
    pub what: &'static str,
    /// The scenario that ships with the program.
    pub scenario: &'static str,
    /// What is measured.
    pub measure: Measure<'static>,
    /// What turns the column into the unit.
    pub factor: f64,
    /// The unit.
    pub unit: &'static str,
    /// What the thesis says, in this unit.
    pub published: Option<&'static str>,
}

/// Something that the thesis concludes.
#[derive(Debug)]
pub struct Claim {
    /// The conclusion.
    pub text: &'static str,
    /// What it says of means.
    pub check: Check,
}

/// What is measured of a scenario.
pub type Term = (&'static str, Measure<'static>);

/// What a conclusion says of means.
#[derive(Debug)]
pub enum Check {
    /// Each is above the one before.
    Rising(&'static [Term]),
    /// Two differ by at most this much.
    Within(Term, Term, f64),
    /// The first is the second times a factor in this range.
    Ratio(Term, Term, std::ops::RangeInclusive<f64>),
}

impl Experiment {
    /// The scenarios that it needs, each once.
    pub fn scenarios(&self) -> Vec<&'static str> {
        let mut scenarios: Vec<&'static str> = Vec::new();
        let quantities = match self.content {
            Content::Quantities(quantities) => quantities,
            Content::Sensitivity => return vec![sensitivity::SCENARIO],
            Content::WorkedExample => return Vec::new(),
        };
        for quantity in quantities {
            if !scenarios.contains(&quantity.scenario) {
                scenarios.push(quantity.scenario);
            }
        }
        scenarios
    }

    /// Its lines: published and ours, then the conclusions.
    #[must_use]
    pub fn lines(&self, runs: &Runs) -> Vec<Line> {
        let mut lines = match self.content {
            Content::Quantities(quantities) => quantities.iter().map(|quantity| quantity.line(runs)).collect(),
            Content::Sensitivity => sensitivity::lines(runs),
            Content::WorkedExample => worked_example::lines(),
        };
        lines.extend(self.claims.iter().map(|claim| claim.line(runs)));
        lines
    }
}

impl Quantity {
    fn line(&self, runs: &Runs) -> Line {
        let scaled = |mean: Mean| Mean {
            mean: self.factor * mean.mean,
            half_width_95: mean.half_width_95.map(|half_width| self.factor * half_width),
            ..mean
        };
        Line {
            what: self.what.to_owned(),
            published: self.published.unwrap_or_default().to_owned(),
            unit: self.unit,
            ours: runs.mean(self.scenario, 0, self.measure).map_or(Ours::Missing, |mean| Ours::Mean(scaled(mean))),
        }
    }
}

impl Check {
    /// The means that it needs.
    #[must_use]
    pub fn terms(&self) -> Vec<Term> {
        match self {
            Self::Rising(terms) => terms.to_vec(),
            Self::Within(a, b, _) | Self::Ratio(a, b, _) => vec![*a, *b],
        }
    }

    /// Whether it holds for these means.
    fn holds(&self, means: &[f64]) -> bool {
        match self {
            Self::Rising(_) => means.windows(2).all(|pair| pair[0] < pair[1]),
            Self::Within(_, _, most) => (means[0] - means[1]).abs() <= *most,
            Self::Ratio(_, _, range) => range.contains(&(means[0] / means[1])),
        }
    }
}

impl Claim {
    /// Whether it holds for the means of `runs`; `None` if one is missing.
    #[must_use]
    pub fn holds(&self, runs: &Runs) -> Option<bool> {
        let mean = |(scenario, measure)| runs.mean(scenario, 0, measure).map(|mean| mean.mean);
        let means: Option<Vec<f64>> = self.check.terms().into_iter().map(mean).collect();
        means.map(|means| self.check.holds(&means))
    }

    fn line(&self, runs: &Runs) -> Line {
        let ours = match self.holds(runs) {
            Some(true) => Ours::Text("holds".to_owned()),
            Some(false) => Ours::Text("does not hold".to_owned()),
            None => Ours::Missing,
        };
        Line { what: self.text.to_owned(), published: "yes".to_owned(), unit: "", ours }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::measures;

    #[test]
    fn a_conclusion_is_checked_as_it_reads() {
        const A: Term = ("a", Measure::OfRun(&measures::run::STOPS));
        const B: Term = ("b", Measure::OfRun(&measures::run::STOPS));
        for (check, means, holds) in [
            (Check::Rising(&[A, B]), [1.0, 2.0], true),
            (Check::Rising(&[A, B]), [2.0, 2.0], false),
            (Check::Within(A, B, 0.5), [2.0, 2.5], true),
            (Check::Within(A, B, 0.5), [2.0, 1.4], false),
            (Check::Ratio(A, B, 1.5..=2.5), [4.0, 2.0], true),
            (Check::Ratio(A, B, 1.5..=2.5), [2.0, 4.0], false),
        ] {
            assert_eq!(check.holds(&means), holds, "{check:?} for {means:?}");
        }
    }
}
