//! What became of a transmission.

use sextant_channel::Dbm;
use sextant_kernel::StationId;

use crate::air::{Air, Arrival, Transmission};
use crate::service::outcome::FrameOutcome;

/// What became of a transmission at the stations that it is for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fate {
    /// The best outcome.
    pub(super) outcome: FrameOutcome,
    /// The first station with that outcome, if a signal was measured.
    pub(super) arrival: Option<Arrival>,
}

impl Fate {
    /// No station heard a signal.
    pub(super) fn missed(outcome: FrameOutcome) -> Self {
        Self { outcome, arrival: None }
    }

    /// The better one of this and the outcome at a station.
    pub(super) fn or(self, arrival: &Arrival) -> Self {
        let is_better = arrival.outcome > self.outcome || arrival.outcome == self.outcome && self.arrival.is_none();
        if is_better { Self { outcome: arrival.outcome, arrival: Some(*arrival) } } else { self }
    }

    /// What became of a transmission that ends now, at the stations that it `is_for`.
    pub(super) fn of(
        transmission: &Transmission,
        arrivals: &[Arrival],
        air: &Air,
        is_for: impl Fn(StationId) -> bool,
    ) -> Self {
        let arrivals = arrivals.iter().filter(|arrival| is_for(arrival.station));
        let fate = arrivals.fold(Self::missed(FrameOutcome::WORST), Self::or);
        if fate.outcome.deafness().is_none() {
            return fate;
        }
        let missed = air.missed(transmission);
        if missed > fate.outcome { Self::missed(missed) } else { fate }
    }

    /// Power at the station with the best outcome, if a signal was measured.
    pub(super) fn power(&self) -> Option<Dbm> {
        self.arrival.map(|arrival| arrival.power.to_dbm())
    }
}
