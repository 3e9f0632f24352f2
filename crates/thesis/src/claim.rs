//! Conclusions of the thesis, checked with our runs.

use std::ops::Range;

use super::finding::Finding;
use super::line::Line;
use super::ours::Ours;
use super::published::Published;
use super::runs::{Runs, Term};
use sextant::summary::Unit;
use sextant_study::sweep::{Mean, Share};

/// A conclusion.
#[derive(Clone, Debug)]
pub struct Claim {
    /// The conclusion.
    pub text: String,
    /// The text of the thesis; `None` if the conclusion is ours.
    pub published: Option<Published>,
    /// The condition.
    pub check: Check,
}

/// The condition of a conclusion, on means over runs.
#[derive(Clone, Debug)]
pub enum Check {
    /// Each mean is above the previous one.
    Rising(Vec<Term>),
    /// The first is below each of the others.
    Least(Vec<Term>),
    /// The first is above each of the others.
    Greatest(Vec<Term>),
    /// All differences are less than this.
    Within(Vec<Term>, f64),
    /// The ratio of the first to the second is in this range.
    Ratio([Term; 2], Range<f64>),
    /// The first less the second is in this range.
    Difference([Term; 2], Range<f64>),
    /// The mean is below this limit.
    Below(Term, f64),
    /// The mean is above this limit.
    Above(Term, f64),
}

impl Claim {
    /// The result of `runs`; `None` if a term has no value in any run.
    #[must_use]
    pub fn finding(&self, runs: &Runs) -> Option<Finding> {
        self.check.finding(runs)
    }

    pub(super) fn line(&self, runs: &Runs) -> Line {
        Line {
            what: self.text.clone(),
            published: self.published.clone(),
            unit: self.check.unit().1.to_owned(),
            better: None,
            reading: None,
            ours: self.finding(runs).map_or(Ours::Missing, Ours::Finding),
        }
    }
}

impl Check {
    /// The result of `runs`; `None` if a term has no value in any run.
    #[must_use]
    pub fn finding(&self, runs: &Runs) -> Option<Finding> {
        let margins = self.margins(&|term| runs.values(term))?;
        let (factor, unit) = self.unit();
        Finding::of(&margins, factor, unit)
    }

    /// The terms that it compares.
    #[must_use]
    pub fn terms(&self) -> Vec<&Term> {
        match self {
            Self::Rising(terms) | Self::Least(terms) | Self::Greatest(terms) | Self::Within(terms, _) => {
                terms.iter().collect()
            }
            Self::Ratio(terms, _) | Self::Difference(terms, _) => terms.iter().collect(),
            Self::Below(term, _) | Self::Above(term, _) => vec![term],
        }
    }

    /// The same of other terms.
    pub(crate) fn with_terms<E>(&self, change: &mut impl FnMut(&Term) -> Result<Term, E>) -> Result<Self, E> {
        let mut all = |terms: &[Term]| terms.iter().map(&mut *change).collect::<Result<Vec<_>, E>>();
        Ok(match self {
            Self::Rising(terms) => Self::Rising(all(terms)?),
            Self::Least(terms) => Self::Least(all(terms)?),
            Self::Greatest(terms) => Self::Greatest(all(terms)?),
            Self::Within(terms, most) => Self::Within(all(terms)?, *most),
            Self::Ratio([a, b], range) => Self::Ratio([change(a)?, change(b)?], range.clone()),
            Self::Difference([a, b], range) => Self::Difference([change(a)?, change(b)?], range.clone()),
            Self::Below(term, limit) => Self::Below(change(term)?, *limit),
            Self::Above(term, limit) => Self::Above(change(term)?, *limit),
        })
    }

    /// The factor from margins to their printed unit, and that unit.
    fn unit(&self) -> (f64, &'static str) {
        match self {
            Self::Ratio(..) => (1.0, ""),
            _ => match self.terms()[0].measure.unit().for_people() {
                (factor, "%") => (factor, "points"),
                other => other,
            },
        }
    }

    /// The margin of each comparison, positive if it supports the conclusion; `None` if a term has no values. Terms are
    /// compared run by run, because runs of the same number have the same seed.
    fn margins(&self, values: &impl Fn(&Term) -> Vec<(u32, f64)>) -> Option<Vec<Mean>> {
        let margin = |a: &Term, b: &Term, of: &dyn Fn(f64, f64) -> f64| paired(&values(a), &values(b), of);
        let below = |a: &Term, b: &Term| margin(a, b, &|a, b| b - a);
        match self {
            Self::Rising(terms) => terms.windows(2).map(|pair| below(&pair[0], &pair[1])).collect(),
            Self::Least(terms) => terms[1..].iter().map(|other| below(&terms[0], other)).collect(),
            Self::Greatest(terms) => terms[1..].iter().map(|other| below(other, &terms[0])).collect(),
            Self::Within(terms, most) => {
                let ordered = terms.iter().enumerate().flat_map(|(i, a)| {
                    terms.iter().enumerate().filter(move |&(j, _)| j != i).map(move |(_, b)| (a, b))
                });
                ordered.map(|(a, b)| margin(a, b, &|a, b| most - (a - b))).collect()
            }
            Self::Ratio([a, b], range) => {
                [margin(a, b, &|a, b| a / b - range.start), margin(a, b, &|a, b| range.end - a / b)]
                    .into_iter()
                    .collect()
            }
            Self::Difference([a, b], range) => {
                [margin(a, b, &|a, b| a - b - range.start), margin(a, b, &|a, b| range.end - (a - b))]
                    .into_iter()
                    .collect()
            }
            Self::Below(term, limit) if term.measure.unit() == Unit::Outcome => {
                share(&values(term)).map(|share| vec![Mean { mean: limit - share.mean, ..share }])
            }
            Self::Above(term, limit) if term.measure.unit() == Unit::Outcome => {
                share(&values(term)).map(|share| vec![Mean { mean: share.mean - limit, ..share }])
            }
            Self::Below(term, limit) => [margin(term, term, &|value, _| limit - value)].into_iter().collect(),
            Self::Above(term, limit) => [margin(term, term, &|value, _| value - limit)].into_iter().collect(),
        }
    }
}

/// The interval of the share of the runs with an outcome. That of a mean would have no width if all runs were equal.
fn share(outcomes: &[(u32, f64)]) -> Option<Mean> {
    let outcomes: Vec<f64> = outcomes.iter().map(|&(_, outcome)| outcome).collect();
    Share::of(&outcomes).map(|share| share.interval())
}

/// The mean of `of` over the runs that have both values.
pub(crate) fn paired(a: &[(u32, f64)], b: &[(u32, f64)], of: &dyn Fn(f64, f64) -> f64) -> Option<Mean> {
    let pair = |&(run, a): &(u32, f64)| b.iter().find(|(other, _)| *other == run).map(|&(_, b)| of(a, b));
    Mean::of(&a.iter().filter_map(pair).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::super::finding::Verdict;
    use super::super::variant::Variant;
    use super::*;

    fn term(scenario: &str) -> Term {
        Term {
            variant: Variant::shipped(scenario),
            settings: Vec::new(),
            measure: "gathering.stops".parse().unwrap(),
        }
    }

    fn finding(check: &Check, of: &[(&str, &[f64])]) -> Option<Finding> {
        let values = |term: &Term| {
            let (_, values) =
                of.iter().find(|(name, _)| *name == term.variant.scenario).expect("each term has values");
            (0..).zip(values.iter().copied()).collect()
        };
        Finding::of(&check.margins(&values)?, 1.0, "")
    }

    #[test]
    fn a_conclusion_holds_does_not_hold_or_cannot_be_told() {
        use Verdict::{CannotBeTold, DoesNotHold, Holds};
        let abc = || vec![term("a"), term("b"), term("c")];
        let ab = || [term("a"), term("b")];
        // Three runs each, with different scatter: t(0.975; 2) = 4.30, so the interval of a difference is about ±0.4.
        let scatter = |mean: f64, turn: usize| {
            let mut runs = [mean - 0.1, mean, mean + 0.1];
            runs.rotate_left(turn);
            runs
        };
        for (check, a, b, c, verdict) in [
            (Check::Rising(abc()), 1.0, 2.0, 3.0, Holds),
            (Check::Rising(abc()), 1.0, 3.0, 2.0, DoesNotHold),
            (Check::Rising(abc()), 1.0, 1.1, 2.0, CannotBeTold),
            (Check::Rising(abc()), 1.0, 1.1, 0.0, DoesNotHold),
            (Check::Least(abc()), 1.0, 3.0, 2.0, Holds),
            (Check::Least(abc()), 1.0, 3.0, 0.0, DoesNotHold),
            (Check::Least(abc()), 1.0, 3.0, 1.1, CannotBeTold),
            (Check::Greatest(abc()), 3.0, 1.0, 2.0, Holds),
            (Check::Greatest(abc()), 3.0, 1.0, 4.0, DoesNotHold),
            (Check::Greatest(abc()), 3.0, 1.0, 2.9, CannotBeTold),
            (Check::Within(abc(), 2.0), 1.0, 2.0, 1.5, Holds),
            (Check::Within(abc(), 2.0), 1.0, 2.0, 5.0, DoesNotHold),
            (Check::Within(abc(), 2.0), 1.0, 2.9, 2.0, CannotBeTold),
            (Check::Ratio(ab(), 1.5..2.5), 40.0, 20.0, 0.0, Holds),
            (Check::Ratio(ab(), 1.5..2.5), 20.0, 40.0, 0.0, DoesNotHold),
            (Check::Ratio(ab(), 1.5..2.5), 3.1, 2.0, 0.0, CannotBeTold),
            (Check::Difference(ab(), 0.5..1.5), 3.0, 2.0, 0.0, Holds),
            (Check::Difference(ab(), 0.5..1.5), 2.0, 3.0, 0.0, DoesNotHold),
            (Check::Difference(ab(), 0.5..1.5), 5.0, 2.0, 0.0, DoesNotHold),
            (Check::Difference(ab(), 0.5..1.5), 3.4, 2.0, 0.0, CannotBeTold),
            (Check::Below(term("a"), 2.0), 1.0, 0.0, 0.0, Holds),
            (Check::Below(term("a"), 2.0), 3.0, 0.0, 0.0, DoesNotHold),
            (Check::Below(term("a"), 2.0), 1.9, 0.0, 0.0, CannotBeTold),
            (Check::Above(term("a"), 2.0), 3.0, 0.0, 0.0, Holds),
            (Check::Above(term("a"), 2.0), 1.0, 0.0, 0.0, DoesNotHold),
            (Check::Above(term("a"), 2.0), 2.1, 0.0, 0.0, CannotBeTold),
        ] {
            let found =
                finding(&check, &[("a", &scatter(a, 0)), ("b", &scatter(b, 1)), ("c", &scatter(c, 2))]).unwrap();
            assert_eq!(found.verdict, verdict, "{a}, {b}, {c}: {found:?} for {check:?}");
        }
    }

    #[test]
    fn runs_of_the_same_seed_are_compared_with_each_other() {
        let check = Check::Least(vec![term("a"), term("b")]);
        // Runs differ much between seeds, but little within a seed: independent samples could not show the difference.
        let found = finding(&check, &[("a", &[1.0, 5.0, 9.0]), ("b", &[1.2, 5.25, 9.15])]).unwrap();
        assert_eq!(found.verdict, Verdict::Holds);
        assert!((found.margin.mean - 0.2).abs() < 1e-9, "{found:?}");
        // t(0.975; 2) = 4.302653 times the standard deviation 0.05 over the root of 3.
        assert!((found.margin.half_width_95.unwrap() - 4.302_653 * 0.05 / 3.0_f64.sqrt()).abs() < 1e-5, "{found:?}");
    }

    #[test]
    fn the_share_of_the_runs_with_an_outcome_has_an_exact_interval() {
        use Verdict::{CannotBeTold, DoesNotHold, Holds};
        let captured = || Term { measure: "applications.detarsk.captured".parse().unwrap(), ..term("a") };
        // The lower end of the interval of n in n runs is the n-th root of 0.025: 0.69 for 10, 0.83 for 20.
        for (check, captured, missed, verdict) in [
            (Check::Above(captured(), 0.8), 10, 0, CannotBeTold),
            (Check::Above(captured(), 0.8), 20, 0, Holds),
            (Check::Above(captured(), 0.8), 10, 10, DoesNotHold),
            (Check::Below(captured(), 0.2), 0, 10, CannotBeTold),
            (Check::Below(captured(), 0.2), 0, 20, Holds),
            (Check::Below(captured(), 0.2), 10, 10, DoesNotHold),
        ] {
            let outcomes = [vec![1.0; captured], vec![0.0; missed]].concat();
            let found = finding(&check, &[("a", &outcomes)]).unwrap();
            assert_eq!(found.verdict, verdict, "{captured}, {missed}: {found:?} for {check:?}");
        }
    }

    #[test]
    fn one_run_decides_nothing_and_no_run_gives_no_finding() {
        let check = Check::Least(vec![term("a"), term("b")]);
        let found = finding(&check, &[("a", &[1.0]), ("b", &[2.0])]).unwrap();
        assert_eq!((found.verdict, found.margin.mean), (Verdict::CannotBeTold, 1.0));
        assert_eq!(finding(&check, &[("a", &[1.0]), ("b", &[])]), None);
    }
}
