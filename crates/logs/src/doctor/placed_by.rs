//! What a log places receptions by, so that advice fits it.

use std::collections::BTreeMap;

use sextant_kernel::{RobotId, SimTime};

/// What a log places receptions by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacedBy {
    /// The times of packets, on a path: a clock may be wrong.
    Times,
    /// The stop or the place in each row.
    Rows,
}

impl PlacedBy {
    /// Of a log with these middles of stops that are parts of a path ([`RobotLog::middles`](crate::RobotLog::middles)).
    #[must_use]
    pub fn of_middles(middles: &BTreeMap<(RobotId, SimTime), SimTime>) -> Self {
        if middles.is_empty() { Self::Rows } else { Self::Times }
    }

    /// What else is checked because of that, after other things.
    pub(super) const fn clocks(self) -> &'static str {
        match self {
            Self::Times => ", that clocks agree (`packet_delay=auto`)",
            Self::Rows => "",
        }
    }
}
