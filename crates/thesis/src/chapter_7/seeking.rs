//! The arrivals of all methods in a scenario over the offsets of the sensors.

use super::super::chart::{Across, Chart, ChartKind, ChartLine};
use super::super::claim::{Check, Claim};
use super::super::line::{Line, Ours};
use super::super::published::Published;
use super::super::runs::{Runs, Term};
use super::method::{Method, Snr, term};
use sextant::summary::measures::application;
use sextant::summary::{ApplicationSummary, Number};
use sextant::sweep::Share;

pub(super) const ARRIVED: &Number<ApplicationSummary> = &application::ARRIVED;
pub(super) const TIME_S: &Number<ApplicationSummary> = &application::TIME_S;
pub(super) const TRUE_VALUE: &Number<ApplicationSummary> = &application::LEAST_ARRIVAL_VALUE;

/// Section of the simulations.
pub(super) const SIMULATIONS: &str = "section 7.4.1";

/// Section of the experiment with a robot.
pub(super) const EXPERIMENT: &str = "section 7.4.2";

/// A true value below this at an arrival is a false arrival. The robots seek 9.
pub(super) const TRUE_LEVEL: f64 = 8.5;

/// More than this share of the runs are most: with ten runs, all of which arrive, the exact interval is above it.
pub(super) const MOST: f64 = 2.0 / 3.0;

/// What is common to the notes of all experiments.
pub(super) const DEFINITIONS: &str = "SNR is the mean square of the field at the nodes over the variance of the offsets, which the thesis does not define; \
     \"no offsets\" is 200 dB. A robot arrives when it believes in a value of at least 8.9; where the true value is below 8.5, \
     the arrival is false. Times are means over the runs that arrived, falsely too.";

/// A scenario with its methods and offsets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seeking {
    pub(super) scenario: &'static str,
    /// Begins each line; empty if the experiment has one scenario.
    pub(super) place: &'static str,
    pub(super) methods: &'static [&'static Method],
    pub(super) snrs: &'static [Snr],
}

impl Seeking {
    pub(super) fn term(&self, method: &Method, snr: Snr, number: &'static Number<ApplicationSummary>) -> Term {
        term(self.scenario, method, snr, number)
    }

    fn cells(&self) -> impl Iterator<Item = (&'static Method, Snr)> {
        let Self { methods, snrs, .. } = *self;
        methods.iter().flat_map(move |method| snrs.iter().map(move |snr| (*method, *snr)))
    }

    fn what(&self, what: &str, method: &Method, snr: Snr) -> String {
        let place = if self.place.is_empty() { String::new() } else { format!("{}: ", self.place) };
        format!("{place}{what}, {}, {}", method.name, snr.words())
    }

    /// The share of the runs in which the value of `number` is one that `counts`; runs without a value do not.
    pub(super) fn share(
        &self,
        runs: &Runs,
        (what, method, snr): (&str, &Method, Snr),
        number: &'static Number<ApplicationSummary>,
        counts: impl Fn(f64) -> bool,
    ) -> Line {
        let values = runs.values(&self.term(method, snr, number));
        // Each successful run says whether the robot arrived.
        let outcomes = runs.values(&self.term(method, snr, ARRIVED)).into_iter().map(|(run, _)| {
            let counted = values.iter().any(|&(other, value)| other == run && counts(value));
            f64::from(u8::from(counted))
        });
        let ours = Share::of(&outcomes.collect::<Vec<f64>>()).map_or(Ours::Missing, Ours::Share);
        Line { what: self.what(what, method, snr), published: None, unit: "%", ours }
    }

    /// The mean of a number over the runs that have it.
    pub(super) fn mean(
        &self,
        runs: &Runs,
        (what, method, snr): (&str, &Method, Snr),
        number: &'static Number<ApplicationSummary>,
        published: Option<Published>,
    ) -> Line {
        let term = self.term(method, snr, number);
        let (factor, unit) = term.measure.unit().for_people();
        let ours = match runs.mean(&term) {
            Some(mean) => Ours::Mean(mean.times(factor)),
            None if runs.have_succeeded(&term) => Ours::Never,
            None => Ours::Missing,
        };
        Line { what: self.what(what, method, snr), published, unit, ours }
    }

    /// Times, arrivals and true values of all cells; `published` knows published times.
    pub(super) fn lines(&self, runs: &Runs, published: impl Fn(&Method, Snr) -> Option<Published>) -> Vec<Line> {
        let mut lines: Vec<_> = self
            .cells()
            .map(|(method, snr)| self.mean(runs, ("time", method, snr), TIME_S, published(method, snr)))
            .collect();
        lines.extend(
            self.cells()
                .map(|(method, snr)| self.share(runs, ("runs that arrived", method, snr), ARRIVED, |is| is > 0.5)),
        );
        lines.extend(self.cells().map(|(method, snr)| {
            let what = "runs that arrived where the true value is at least 8.5";
            self.share(runs, (what, method, snr), TRUE_VALUE, |value| value >= TRUE_LEVEL)
        }));
        lines.extend(
            self.cells()
                .map(|(method, snr)| self.mean(runs, ("true value at the arrival", method, snr), TRUE_VALUE, None)),
        );
        lines
    }

    /// The least time in which a method can arrive, beside the `published` times.
    pub(super) fn law_minimum(&self, runs: &Runs, method: &Method, published: Published) -> Line {
        let snr = self.snrs[0];
        let what = ("least time that the law allows", method, snr);
        self.mean(runs, what, &application::LAW_MINIMUM_S, Some(published))
    }

    /// A claim that the law needs more than the longest printed time.
    pub(super) fn law_is_slower(&self, method: &Method, printed_s: f64, published: &str) -> Claim {
        Claim {
            text: format!("the law with the thesis' numbers needs more than the longest printed time, {printed_s} s"),
            published: Some(Published::new(published, SIMULATIONS)),
            check: Check::Above(self.term(method, self.snrs[0], &application::LAW_MINIMUM_S), printed_s),
        }
    }

    /// A claim that most runs of a method arrive.
    pub(super) fn most_arrive(&self, method: &Method, snr: Snr, published: Option<Published>) -> Claim {
        Claim {
            text: self.what("more than two in three runs arrive", method, snr),
            published,
            check: Check::Above(self.term(method, snr, ARRIVED), MOST),
        }
    }

    /// A claim that arrivals of a method are true ones on average.
    pub(super) fn true_on_average(&self, method: &Method, snr: Snr) -> Claim {
        Claim {
            text: self.what("the mean true value at the arrival is above 8.5", method, snr),
            published: None,
            check: Check::Above(self.term(method, snr, TRUE_VALUE), TRUE_LEVEL),
        }
    }

    /// A claim that a method is slower at each of `snrs` than at the one before.
    pub(super) fn slower_with_offsets(&self, method: &Method, snrs: &[Snr], published: Published) -> Claim {
        let words: Vec<_> = snrs.iter().map(|snr| snr.words()).collect();
        Claim {
            text: format!("{}: the time rises from {}", method.name, words.join(" to ")),
            published: Some(published),
            check: Check::Rising(snrs.iter().map(|&snr| self.term(method, snr, TIME_S)).collect()),
        }
    }

    /// The time and the true value at the arrival over the offsets.
    pub(super) fn charts(&self, id: &str, title: &str) -> Vec<Chart> {
        let chart = |name: &str, up: &'static str, number: &'static Number<ApplicationSummary>| {
            let points = |method: &Method| {
                self.snrs
                    .iter()
                    .map(|&snr| (Across::Setting(snr.drawn_db()), self.term(method, snr, number)))
                    .collect()
            };
            let line = |method: &&Method| ChartLine { name: method.name.to_owned(), points: points(method) };
            Chart {
                name: format!("{id}-{name}"),
                kind: ChartKind::Curves,
                title: title.to_owned(),
                note: "mean over the runs that arrived, with 95 % intervals; no offsets are drawn at 40 dB"
                    .to_owned(),
                across: "SNR of the sensors [dB]",
                up,
                lines: self.methods.iter().map(line).collect(),
            }
        };
        vec![chart("time", "time of arrival [s]", TIME_S), chart("value", "true value at the arrival", TRUE_VALUE)]
    }
}
