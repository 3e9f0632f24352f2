//! What a station knows of a neighbour with which it agrees on cells.

use sextant_kernel::StationId;

use super::super::{Asn, CellPlace, SixPCommand};

/// How often all cells are given up before the neighbour is believed to be gone.
pub(super) const CLEAR_TRIES: u8 = 3;

/// After so many frames in negotiated cells without an acknowledgement a request that is not acknowledged either says that the
/// neighbour does not have these cells: over a link that delivers a quarter of them it happens once in a hundred times.
pub(super) const MOST_UNANSWERED: u16 = 16;

/// How the sending of a message ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// It was acknowledged.
    Acknowledged,
    /// It was sent as often as allowed.
    GivenUp,
}

/// A transaction that the station has begun.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Transaction {
    pub(super) command: SixPCommand,
    pub(super) sequence: u8,
    pub(super) deadline: Asn,
}

/// What changes when an answer to the neighbour is acknowledged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Nothing,
    Added(CellPlace),
    Deleted(CellPlace),
    Relocated { from: CellPlace, to: CellPlace },
}

/// A neighbour.
#[derive(Clone, Debug)]
pub(super) struct Peer {
    pub(super) station: StationId,
    /// Number of the next transaction between the two.
    pub(super) sequence: u8,
    pub(super) open: Option<Transaction>,
    /// The number of the transaction of the neighbour that is being answered, and what it changes.
    pub(super) answer: Option<(u8, Change)>,
    /// It is not asked before this slot.
    pub(super) held_until: Asn,
    /// Frames in negotiated cells since the last one that it acknowledged.
    pub(super) unanswered: u16,
    /// How often it will still be asked to give up all cells; 0 if it need not be.
    pub(super) clears: u8,
}

impl Peer {
    pub(super) const fn new(station: StationId) -> Self {
        Self { station, sequence: 0, open: None, answer: None, held_until: Asn(0), unanswered: 0, clears: 0 }
    }

    /// Whether a transaction may begin, but for the wait.
    pub(super) const fn is_free(&self) -> bool {
        self.open.is_none() && self.answer.is_none()
    }

    /// A transaction has ended well: its number is that of no other but after a round from 1 to 255 (RFC 8480, section 3.4.6.2).
    pub(super) const fn count(&mut self) {
        self.sequence = if self.sequence == u8::MAX { 1 } else { self.sequence + 1 };
    }
}
