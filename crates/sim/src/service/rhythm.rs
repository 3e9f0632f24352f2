//! When the radios of a network are on by plan.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::tsch::Cell;

/// When the radio of a station is on by plan, whether or not somebody sends.
#[derive(Clone, Debug, PartialEq)]
pub enum Rhythm {
    /// In the cells of its schedule, in which it listens or may send.
    Cells {
        /// Length of a slot.
        slot: Duration,
        /// The cells that it had whatever it sent, each time that it had one.
        cells: Vec<CellSpan>,
    },
    /// In checks of the channel.
    Checks {
        /// Start of the first one.
        first: SimTime,
        /// True time from one to the next.
        interval: Duration,
        /// How long one takes if nobody sends.
        length: Duration,
    },
}

/// A cell that a station had for a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellSpan {
    /// The cell.
    pub cell: Cell,
    /// Since when it followed a schedule with the cell.
    pub from: SimTime,
    /// Until when; `None` if it did at the end.
    pub to: Option<SimTime>,
}
