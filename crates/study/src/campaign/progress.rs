//! How far a plan is, by the parts in its folder.

use std::time::{Duration, SystemTime};

use sextant::NumberRange;
use sextant_recording::output::store::StoreError;

use crate::sweep::{CellRun, Done, FinishedRuns, Written};

/// How far a plan is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is known of each run.
    states: Vec<State>,
    failed: Vec<FailedRun>,
    pace: Option<Pace>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Missing,
    Done,
    Failed,
}

/// A run that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedRun {
    /// Its number in the work list.
    pub number: usize,
    /// Its cell and replicate.
    pub run: CellRun,
    /// Why it failed.
    pub reason: String,
}

/// How fast the work went from the begin of the first part to the end of the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Finished runs per second.
    pub runs_per_s: f64,
    /// How long that was (s).
    pub over_s: f64,
    /// How long what is missing takes, if it goes on like this (s).
    pub left_s: f64,
}

impl Progress {
    /// Of `runs`, of which `done` was read.
    pub(super) fn of(runs: &FinishedRuns, done: &Done) -> Result<Self, StoreError> {
        let (work, places) = (runs.sweep().work(), &done.places);
        let state = |number: usize| match places.has(number) {
            false => State::Missing,
            true if places.has_succeeded(number) => State::Done,
            true => State::Failed,
        };
        let states = (0..work.len()).map(state).collect();
        let numbers = places.failed();
        let failed = numbers.iter().zip(runs.rows(places, numbers.iter().copied())).map(|(&number, row)| {
            let reason = row?.outcome.err().unwrap_or_default();
            Ok(FailedRun { number, run: work.get(number), reason })
        });
        let failed = failed.collect::<Result<_, StoreError>>()?;
        let mut this = Self { states, failed, pace: None };
        this.pace = span_s(&done.written).map(|over_s| {
            let runs_per_s = (this.runs() - this.missing()) as f64 / over_s;
            Pace { runs_per_s, over_s, left_s: this.missing() as f64 / runs_per_s }
        });
        Ok(this)
    }

    /// Number of runs of the plan.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.states.len()
    }

    /// Number of runs that succeeded.
    #[must_use]
    pub fn done(&self) -> usize {
        self.count(State::Done)
    }

    /// The runs that failed.
    #[must_use]
    pub fn failed(&self) -> &[FailedRun] {
        &self.failed
    }

    /// Number of runs without a row.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.count(State::Missing)
    }

    /// The runs without a row.
    #[must_use]
    pub fn missing_ranges(&self) -> Vec<NumberRange> {
        NumberRange::joined(self.numbers(|state| state == State::Missing))
    }

    /// The numbers of the runs that are missing or failed.
    pub fn open(&self) -> impl Iterator<Item = usize> {
        self.numbers(|state| state != State::Done)
    }

    /// How fast the work went; `None` if nothing is done.
    #[must_use]
    pub fn pace(&self) -> Option<Pace> {
        self.pace
    }

    fn numbers(&self, wanted: impl Fn(State) -> bool) -> impl Iterator<Item = usize> {
        self.states.iter().enumerate().filter(move |(_, state)| wanted(**state)).map(|(number, _)| number)
    }

    fn count(&self, wanted: State) -> usize {
        self.numbers(|state| state == wanted).count()
    }
}

/// From the begin of the first part to the end of the last one (s).
fn span_s(written: &[Written]) -> Option<f64> {
    let begin = |part: &Written| part.at.checked_sub(Duration::try_from_secs_f64(part.wall_s).ok()?);
    let first: SystemTime = written.iter().filter_map(begin).min()?;
    let last = written.iter().map(|part| part.at).max()?;
    last.duration_since(first).ok().map(|span| span.as_secs_f64()).filter(|span_s| *span_s > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_span_of_the_work_begins_before_the_first_part_was_written() {
        let at = |s: u64| SystemTime::UNIX_EPOCH + Duration::from_secs(s);
        let written = [Written { at: at(100), wall_s: 30.0 }, Written { at: at(130), wall_s: 20.0 }];
        assert_eq!(span_s(&written), Some(60.0));
        assert_eq!(span_s(&[]), None);
    }
}
