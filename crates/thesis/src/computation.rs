//! How our value of a line is computed.

use sextant::summary::Unit;
use sextant_mapper::{Trapezoid, TrapezoidConfig};
use sextant_study::sweep::{Mean, Share};

use super::claim::{Check, paired};
use super::finding::Verdict;
use super::ours::Ours;
use super::runs::{Runs, Term};
use super::table::Likelihood;

/// How our value of a line is computed.
#[derive(Clone, Debug)]
pub enum Computation {
    /// The mean over the runs, or the share of the runs in which an outcome happened.
    Mean(Term),
    /// The share of the successful runs with at least this value; a run without a value has less.
    AtLeast(Term, f64),
    /// The cell with the least mean.
    Least(Least),
    /// A number that needs no run: the likelihood of a node at a vertex.
    Exact(Option<f64>),
}

/// The cell with the least mean.
#[derive(Clone, Debug)]
pub struct Least {
    /// The cells among which it is sought.
    pub candidates: Vec<Candidate>,
    /// Whether the cell is shown, and not its mean.
    pub is_shown: bool,
}

/// A cell that may have the least mean.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The mean.
    pub term: Term,
    /// What is shown of the cell.
    pub shown: String,
    /// Indices of the cells that are shown beside it if they are not significantly worse.
    pub beside: Vec<usize>,
}

impl Computation {
    /// The terms that it reads.
    #[must_use]
    pub fn terms(&self) -> Vec<&Term> {
        match self {
            Self::Mean(term) | Self::AtLeast(term, _) => vec![term],
            Self::Least(least) => least.candidates.iter().map(|candidate| &candidate.term).collect(),
            Self::Exact(_) => Vec::new(),
        }
    }

    /// The same of other terms.
    pub(crate) fn with_terms<E>(&self, change: &mut impl FnMut(&Term) -> Result<Term, E>) -> Result<Self, E> {
        Ok(match self {
            Self::Mean(term) => Self::Mean(change(term)?),
            Self::AtLeast(term, limit) => Self::AtLeast(change(term)?, *limit),
            Self::Least(least) => {
                let mut least = least.clone();
                for candidate in &mut least.candidates {
                    candidate.term = change(&candidate.term)?;
                }
                Self::Least(least)
            }
            Self::Exact(value) => Self::Exact(*value),
        })
    }

    /// How much another computation moves the value, in the printed unit: the mean over runs of the same seed. `None` if
    /// either is no mean over runs.
    pub(crate) fn moved(&self, other: &Self, runs: &Runs) -> Option<Mean> {
        let (Self::Mean(term), Self::Mean(other)) = (self, other) else { return None };
        let moved = paired(&runs.values(other), &runs.values(term), &|other, value| other - value)?;
        Some(moved.times(term.measure.unit().for_people().0))
    }

    /// The printed unit of the value.
    pub(crate) fn unit(&self) -> &'static str {
        match self {
            Self::Mean(term) => term.measure.unit().for_people().1,
            Self::AtLeast(..) => "%",
            Self::Least(least) if least.is_shown => "",
            Self::Least(least) => {
                least.candidates.first().map_or("", |candidate| candidate.term.measure.unit().for_people().1)
            }
            Self::Exact(_) => "",
        }
    }

    /// The value from `runs`.
    pub(crate) fn ours(&self, runs: &Runs) -> Ours {
        match self {
            Self::Mean(term) if term.measure.unit() == Unit::Outcome => {
                runs.share(term).map_or(Ours::Missing, Ours::Share)
            }
            Self::Mean(term) => mean(term, runs),
            Self::AtLeast(term, limit) => at_least(term, *limit, runs).map_or(Ours::Missing, Ours::Share),
            Self::Least(least) => least.ours(runs),
            Self::Exact(value) => value.map_or(Ours::Missing, Ours::Exact),
        }
    }
}

fn mean(term: &Term, runs: &Runs) -> Ours {
    match runs.mean(term) {
        Some(mean) => Ours::Mean(mean.times(term.measure.unit().for_people().0)),
        None if runs.successful(term).is_empty() => Ours::Missing,
        None => Ours::Never,
    }
}

fn at_least(term: &Term, limit: f64, runs: &Runs) -> Option<Share> {
    let values = runs.values(term);
    let outcome = |run: u32| values.iter().any(|&(other, value)| other == run && value >= limit);
    let outcomes = runs.successful(term).into_iter().map(|run| f64::from(u8::from(outcome(run))));
    Share::of(&outcomes.collect::<Vec<_>>())
}

impl Least {
    fn ours(&self, runs: &Runs) -> Ours {
        let means = self.candidates.iter().filter_map(|of| Some((of, runs.mean(&of.term)?.mean)));
        match means.min_by(|(_, a), (_, b)| a.total_cmp(b)) {
            None => Ours::Missing,
            Some((best, _)) if self.is_shown => self.shown(best, runs),
            Some((best, _)) => mean(&best.term, runs),
        }
    }

    fn shown(&self, best: &Candidate, runs: &Runs) -> Ours {
        let is_as_good = |other: &&Candidate| {
            let check = Check::Least([best, other].map(|of| of.term.clone()).to_vec());
            check.finding(runs).is_some_and(|finding| finding.verdict != Verdict::Holds)
        };
        let beside = best.beside.iter().map(|&i| &self.candidates[i]);
        let as_good = beside.filter(is_as_good).map(|other| other.shown.clone()).collect();
        Ours::Choice { best: best.shown.clone(), as_good }
    }
}

/// The likelihood of a node at a vertex; `None` if the profile is invalid.
pub(crate) fn likelihood(of: &Likelihood) -> Option<f64> {
    let profile = Trapezoid::try_from(TrapezoidConfig::new(of.p0, of.plateau_m, of.range_m).literal()).ok()?;
    let factor = |(stop, &distance_m): (usize, &f64)| {
        let s = profile.probability(distance_m);
        if stop + 1 == of.heard_at { s } else { 1.0 - s }
    };
    Some(of.distances_m.iter().enumerate().map(factor).product())
}
