//! Cells that two stations have agreed on.

use sextant_kernel::StationId;

use super::super::{Cell, CellOptions, CellPeer, CellPlace, Slotframe};

/// The slotframe of negotiated cells.
pub(super) const HANDLE: u8 = 2;

/// When so many frames were sent in a cell, its counts are halved (MAX_NUMTX).
const MAX_NUM_TX: u16 = 256;

/// A cell is judged when more than so many frames were sent in it, as in the simulator of 6TiSCH.
const MIN_NUM_TX: u16 = 100;

/// A cell that delivers less than the best one by more than this share is relocated (RELOCATE_PDRTHRES).
const RELOCATE_PDR_THRESHOLD: f64 = 0.5;

/// A cell in which a station sends to a neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SendCell {
    pub(super) peer: StationId,
    pub(super) place: CellPlace,
    /// NumTx and NumTxAck (RFC 9033, section 5.3).
    sent: u16,
    acknowledged: u16,
}

/// A cell in which a station listens to a neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HeardCell {
    pub(super) peer: StationId,
    pub(super) place: CellPlace,
}

fn cell(place: CellPlace, length: u16, options: CellOptions, peer: StationId) -> Cell {
    let CellPlace { timeslot, channel_offset } = place;
    let slotframe = Slotframe { handle: HANDLE, length };
    Cell { slotframe, timeslot, channel_offset, options, peer: CellPeer::Station(peer) }
}

impl HeardCell {
    pub(super) fn cell(&self, length: u16) -> Cell {
        cell(self.place, length, CellOptions::RECEIVE, self.peer)
    }
}

impl SendCell {
    pub(super) const fn new(peer: StationId, place: CellPlace) -> Self {
        Self { peer, place, sent: 0, acknowledged: 0 }
    }

    pub(super) fn cell(&self, length: u16) -> Cell {
        cell(self.place, length, CellOptions::TRANSMIT, self.peer)
    }

    /// A frame was sent in it.
    pub(super) fn count(&mut self, acknowledged: u16) {
        self.sent += 1;
        self.acknowledged += acknowledged;
        if self.sent == MAX_NUM_TX {
            self.sent /= 2;
            self.acknowledged /= 2;
        }
    }

    /// Its counts begin anew.
    pub(super) fn forget(&mut self) {
        (self.sent, self.acknowledged) = (0, 0);
    }

    /// Share of the frames in it that were acknowledged; `None` if there were too few.
    fn delivery(&self) -> Option<f64> {
        (self.sent > MIN_NUM_TX).then(|| f64::from(self.acknowledged) / f64::from(self.sent))
    }
}

/// What a look at the cells to a neighbour finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// All is well, or it is too early to say.
    Nothing,
    /// This cell delivers much less than the best one.
    Misplaced(CellPlace),
    /// No cell delivers anything: the neighbour does not have them.
    AllDead,
}

/// Looks at the cells to a neighbour: of those that deliver too little the worst one.
pub(super) fn look_at<'a>(cells: impl Iterator<Item = &'a SendCell> + Clone) -> Finding {
    let judged = || cells.clone().filter_map(|cell| Some((cell.place, cell.delivery()?)));
    let best = judged().map(|(_, delivery)| delivery).fold(0.0, f64::max);
    let worst = judged().min_by(|(_, a), (_, b)| a.total_cmp(b));
    match worst {
        Some((place, delivery)) if best - delivery > RELOCATE_PDR_THRESHOLD => Finding::Misplaced(place),
        Some(_) if best <= 0.0 && judged().count() == cells.clone().count() => Finding::AllDead,
        _ => Finding::Nothing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn used(timeslot: u16, sent: u16, acknowledged: u16) -> SendCell {
        SendCell { sent, acknowledged, ..SendCell::new(StationId(9), CellPlace { timeslot, channel_offset: 0 }) }
    }

    #[test]
    fn a_cell_fifty_points_below_the_best_is_misplaced() {
        let misplaced = |timeslot| Finding::Misplaced(CellPlace { timeslot, channel_offset: 0 });
        for (cells, found) in [
            (vec![used(1, 200, 190), used(2, 200, 89)], misplaced(2)),
            (vec![used(1, 200, 190), used(2, 200, 90)], Finding::Nothing),
            // Of two the worse one.
            (vec![used(1, 200, 40), used(2, 200, 190), used(3, 200, 20)], misplaced(3)),
            // Too few frames.
            (vec![used(1, 200, 190), used(2, 100, 0)], Finding::Nothing),
            (vec![used(1, 150, 0), used(2, 100, 0)], Finding::Nothing),
            (vec![used(1, 150, 0), used(2, 101, 0)], Finding::AllDead),
            (vec![], Finding::Nothing),
        ] {
            assert_eq!(look_at(cells.iter()), found, "{cells:?}");
        }
    }

    #[test]
    fn counts_are_halved_when_they_are_full() {
        let mut cell = used(1, 0, 0);
        (0..255).for_each(|i| cell.count(u16::from(i % 2 == 0)));
        assert_eq!((cell.sent, cell.acknowledged), (255, 128));
        cell.count(0);
        assert_eq!((cell.sent, cell.acknowledged), (128, 64));
    }
}
