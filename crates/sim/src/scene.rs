//! What links act on: the clock, the pending events, the airs, and where the stations are.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::{Draws, EventKey, EventQueue, Seed, SimTime, StationId};

use crate::air::{Air, Interface};
use crate::event::Event;
use crate::service::network_id::NetworkId;
use crate::service::outcome::Deafness;
use crate::service::packet_trace::PacketTrace;
use crate::service::upcall::Upcall;
use crate::station::{Motion, Roll};

/// The clock, the pending events, the airs, and where the stations are.
pub(crate) struct Scene {
    pub(crate) now: SimTime,
    /// The event under way.
    pub(crate) event: Event,
    /// Events that links took without the queue.
    pub(crate) steps: u64,
    pub(crate) queue: EventQueue<Event>,
    pub(crate) airs: Vec<Air>,
    pub(crate) motions: Vec<Motion>,
    pub(crate) roll: Roll,
    /// The nodes that move, in their order.
    pub(crate) moving: Vec<StationId>,
    pub(crate) seed: Seed,
    /// The backoffs of each station.
    pub(crate) backoffs: Vec<Draws>,
    /// Number of packets that applications have offered.
    pub(crate) offered: u64,
    /// Number of events that do not count, because nothing happened.
    pub(crate) discounted: u64,
    /// What happens before it is not counted.
    pub(crate) counted_from: SimTime,
    /// What links have to say to the applications.
    pub(crate) upcalls: Vec<Upcall>,
    /// Packets that have ended, for the observer; none if packets are not traced.
    pub(crate) traced: Vec<PacketTrace>,
}

impl Scene {
    /// Schedules an event `span` from now.
    #[inline]
    pub(crate) fn after(&mut self, span: Duration, event: Event) -> EventKey {
        self.queue.push(self.now + span, event.rank(), event)
    }

    /// Schedules an event at `time`.
    #[inline]
    pub(crate) fn at(&mut self, time: SimTime, event: Event) -> EventKey {
        self.queue.push(time, event.rank(), event)
    }

    /// The receiver of a station in an air listens from now on, or is deaf for a reason.
    pub(crate) fn tune(&mut self, air: usize, interface: Interface, deafness: Option<Deafness>) {
        let Interface { receiver, station } = interface;
        let (now, motion, air) = (self.now, &self.motions[station.index()], &mut self.airs[air]);
        match deafness {
            None => air.listen(now, receiver, station, motion),
            Some(deafness) => air.deafen(now, receiver, station, motion, deafness),
        }
    }

    /// Backoff number `number` of a station in a network: uniform from 0 to `max_inclusive`.
    #[inline]
    pub(crate) fn backoff(&self, network: NetworkId, station: StationId, number: u64, max_inclusive: u32) -> u32 {
        let bits = self.backoffs[station.index()].bits([number, network.0.into()]);
        // The upper 32 bits scaled to the range: exact for 2^n equally likely numbers.
        u32::try_from(((bits >> 32) * (u64::from(max_inclusive) + 1)) >> 32).expect("below 2^32")
    }

    /// A body without a radio moves like this from now on; without a motion it is gone.
    pub(crate) fn body_moves(&mut self, body: usize, motion: Option<Motion>) {
        self.airs.iter_mut().for_each(|air| air.body_moves(body, motion));
    }

    /// Where the robots are now.
    pub(crate) fn robots(&self) -> impl Iterator<Item = Position> {
        (0..self.roll.robots).map(|robot| self.place(self.roll.robot(robot)))
    }

    /// Whether a station is a node that moves.
    pub(crate) fn is_moving_node(&self, station: StationId) -> bool {
        !self.moving.is_empty() && self.moving.binary_search(&station).is_ok()
    }

    /// Where a station is now.
    #[inline]
    pub(crate) fn place(&self, station: StationId) -> Position {
        self.motions[station.index()].at(self.now)
    }
}
