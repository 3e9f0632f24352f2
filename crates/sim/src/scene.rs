//! What links act on: the clock, the pending events, the airs, and where the stations are.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{EventKey, EventQueue, Seed, SimTime, StationId};

use crate::air::Air;
use crate::event::Event;
use crate::service::upcall::Upcall;
use crate::station::{Motion, Roll};

/// The clock, the pending events, the airs, and where the stations are.
pub(crate) struct Scene {
    pub(crate) now: SimTime,
    pub(crate) queue: EventQueue<Event>,
    pub(crate) airs: Vec<Air>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) roll: Roll,
    pub(crate) seed: Seed,
    /// Number of packets that applications have offered.
    pub(crate) offered: u64,
    /// What links have to say to the applications.
    pub(crate) upcalls: Vec<Upcall>,
}

impl Scene {
    /// Schedules an event `span` from now.
    #[inline]
    pub(crate) fn after(&mut self, span: Duration, event: Event) -> EventKey {
        self.queue.push(self.now + span, event.rank(), event)
    }

    /// Schedules an event at `time`.
    pub(crate) fn at(&mut self, time: SimTime, event: Event) -> EventKey {
        self.queue.push(time, event.rank(), event)
    }

    /// Where a station is now.
    #[inline]
    pub(crate) fn place(&self, station: StationId) -> Position {
        self.motions[station.index()].at(self.now)
    }
}
