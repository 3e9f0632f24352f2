//! When the radios of a network are on by plan.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::tsch::Cell;

/// When the radio of a station is on by plan, whether or not somebody sends.
#[derive(Clone, Debug, PartialEq)]
pub enum Rhythm {
    /// In the cells of its schedule, in which it listens or may send.
    Cells {
        /// When it first followed the schedule.
        from: SimTime,
        /// Length of a slot.
        slot: Duration,
        /// The cells that it has whatever it sends.
        cells: Vec<Cell>,
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
