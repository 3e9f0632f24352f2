//! Where the rows of finished runs stand on the disk.

use std::collections::BTreeSet;
use std::num::NonZeroU32;
use std::ops::Range;

use sextant::NumberRange;
use sextant_recording::output::store::{PartName, RowPlace};

use super::row::RunRow;

/// Where the rows of some runs stand, and what is known of all of them.
#[derive(Debug)]
pub(crate) struct RunPlaces {
    range: NumberRange,
    /// Of each run of the range, from its first one; nothing if the run has no row.
    places: Vec<Option<Place>>,
    /// The runs that failed.
    failed: BTreeSet<usize>,
    count: usize,
    /// Of each measure, whether any run has a value.
    has_value: Vec<bool>,
    parts: Vec<PartName>,
}

/// Where a row stands: 16 octets.
#[derive(Clone, Copy, Debug)]
struct Place {
    start: u64,
    length: u32,
    /// The number of its part, from 1.
    part: NonZeroU32,
}

/// The places of the rows of one part.
#[derive(Debug)]
pub(super) struct PartPlaces<'a> {
    all: &'a mut RunPlaces,
    part: NonZeroU32,
}

impl RunPlaces {
    /// No rows of the runs in `range`, which have so many `measures`.
    pub(super) fn none(range: NumberRange, measures: usize) -> Self {
        Self {
            range,
            places: vec![None; range.len()],
            failed: BTreeSet::new(),
            count: 0,
            has_value: vec![false; measures],
            parts: Vec::new(),
        }
    }

    /// To add rows of `part`.
    pub(super) fn part(&mut self, part: PartName) -> PartPlaces<'_> {
        if self.parts.last() != Some(&part) {
            self.parts.push(part);
        }
        let number = u32::try_from(self.parts.len()).ok().and_then(NonZeroU32::new);
        PartPlaces { part: number.unwrap_or(NonZeroU32::MIN), all: self }
    }

    fn place(&self, number: usize) -> Option<Place> {
        *self.places.get(number.checked_sub(self.range.start)?)?
    }

    /// Where the row of a run stands; `None` if it has none.
    pub(super) fn of(&self, number: usize) -> Option<RowPlace> {
        let Place { start, length, part } = self.place(number)?;
        Some(RowPlace { part: *self.parts.get(part.get() as usize - 1)?, start, length: length as usize })
    }

    /// Whether a run has a row.
    pub(crate) fn has(&self, number: usize) -> bool {
        self.place(number).is_some()
    }

    /// Whether a run has a row without an error.
    pub(crate) fn has_succeeded(&self, number: usize) -> bool {
        self.has(number) && !self.failed.contains(&number)
    }

    /// The runs that failed.
    pub(crate) fn failed(&self) -> &BTreeSet<usize> {
        &self.failed
    }

    /// Forgets the rows of runs that failed, so that they are done again.
    pub(crate) fn forget_failed(&mut self) {
        self.count -= self.failed.len();
        for number in std::mem::take(&mut self.failed) {
            self.places[number - self.range.start] = None;
        }
    }

    /// Forgets the rows of runs that are not wanted.
    pub(super) fn retain(&mut self, is_wanted: impl Fn(usize) -> bool) {
        for (number, place) in (self.range.start..).zip(&mut self.places) {
            if place.is_some() && !is_wanted(number) {
                *place = None;
                self.count -= 1;
                self.failed.remove(&number);
            }
        }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Of each measure, whether any run has a value.
    pub(super) fn has_value(&self) -> &[bool] {
        &self.has_value
    }
}

impl PartPlaces<'_> {
    /// Adds the row of a run, which stands `within` the octets that begin at `start`. A run that succeeded in any part has
    /// succeeded.
    pub(super) fn add(&mut self, number: usize, row: &RunRow, start: u64, within: Range<usize>) {
        let all = &mut *self.all;
        if !all.range.has(number) {
            return;
        }
        let slot = &mut all.places[number - all.range.start];
        let is_failed = row.outcome.is_err();
        if slot.is_some() && (is_failed || !all.failed.contains(&number)) {
            return;
        }
        all.count += usize::from(slot.is_none());
        // A block is shorter than 2^32 octets.
        let length = u32::try_from(within.len()).unwrap_or(u32::MAX);
        *slot = Some(Place { start: start + within.start as u64, length, part: self.part });
        match &row.outcome {
            Err(_) => {
                all.failed.insert(number);
            }
            Ok(values) => {
                all.failed.remove(&number);
                values.iter().zip(&mut all.has_value).for_each(|(value, has)| *has |= value.is_some());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_succeeded_in_any_part_has_succeeded() {
        let range = NumberRange { start: 10, end: 20 };
        let part = |number| PartName { range, unfinished: Some(number) };
        let mut places = RunPlaces::none(range, 2);
        let failed = RunRow { cell: 0, replicate: 0, outcome: Err("no".into()) };
        let row = RunRow { outcome: Ok(vec![None, Some(1.0)]), ..failed.clone() };
        places.part(part(1)).add(12, &failed, 100, 5..9);
        places.part(part(1)).add(13, &failed, 100, 9..13);
        assert_eq!((places.has(12), places.has_succeeded(12), places.has_value()), (true, false, &[false; 2][..]));
        places.part(part(2)).add(12, &row, 50, 0..7);
        places.part(part(3)).add(12, &failed, 0, 0..3);
        assert_eq!(places.of(12), Some(RowPlace { part: part(2), start: 50, length: 7 }));
        assert_eq!((places.count(), places.has_succeeded(12), places.has_value()), (2, true, &[false, true][..]));
        places.forget_failed();
        assert_eq!((places.count(), places.has(13), places.has(12), places.of(9)), (1, false, true, None));
        assert_eq!(size_of::<Option<Place>>(), 16);
    }
}
