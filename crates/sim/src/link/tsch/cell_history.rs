//! The cells that a station had, and when.

use sextant_kernel::SimTime;
use sextant_mac::tsch::Cell;

use crate::service::rhythm::CellSpan;

/// The cells that a station had, and when.
#[derive(Clone, Debug, Default)]
pub(super) struct CellHistory {
    spans: Vec<CellSpan>,
}

impl CellHistory {
    /// From now on it has these cells, and no others.
    pub(super) fn change(&mut self, cells: &[Cell], now: SimTime) {
        let mut new = cells.to_vec();
        for span in self.spans.iter_mut().filter(|span| span.to.is_none()) {
            match new.iter().position(|cell| *cell == span.cell) {
                Some(kept) => drop(new.swap_remove(kept)),
                None => span.to = Some(now),
            }
        }
        // What it had for no time is nothing.
        self.spans.retain(|span| span.to != Some(span.from));
        self.spans.extend(new.into_iter().map(|cell| CellSpan { cell, from: now, to: None }));
    }

    /// All of them, in the order of slots and then of time.
    pub(super) fn into_spans(mut self) -> Vec<CellSpan> {
        self.spans.sort_by_key(|span| (span.cell.slotframe, span.cell.timeslot, span.from));
        self.spans
    }
}

#[cfg(test)]
mod tests {
    use sextant_mac::tsch::{CellOptions, CellPeer, Slotframe};

    use super::*;

    #[test]
    fn cells_have_the_times_from_which_and_until_which_they_were_kept() {
        let cell = |timeslot| Cell {
            slotframe: Slotframe { handle: 0, length: 11 },
            timeslot,
            channel_offset: 0,
            options: CellOptions::RECEIVE,
            peer: CellPeer::All,
        };
        let at = SimTime::from_nanos;
        let mut history = CellHistory::default();
        for (ns, cells) in [(0, vec![7, 3]), (5, vec![3, 4]), (5, vec![3]), (9, vec![7, 3]), (12, Vec::new())] {
            history.change(&cells.into_iter().map(cell).collect::<Vec<_>>(), at(ns));
        }
        history.change(&[cell(5)], at(20));
        let spans: Vec<_> =
            history.into_spans().into_iter().map(|span| (span.cell.timeslot, span.from, span.to)).collect();
        let expected = [(3, 0, Some(12)), (5, 20, None), (7, 0, Some(5)), (7, 9, Some(12))];
        assert_eq!(spans, expected.map(|(slot, from, to)| (slot, at(from), to.map(at))));
    }
}
