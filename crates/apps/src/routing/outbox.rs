//! The packets that wait in a station.

use std::collections::VecDeque;

use sextant_kernel::StationId;
use sextant_mac::routing::Data;
use sextant_sim::FrameId;

/// A packet that waits in a station, or is under way to the next one.
#[derive(Clone, Debug)]
pub(super) struct Outgoing {
    pub(super) data: Data,
    pub(super) heading: Heading,
    /// Size of its payload with the header of the packet (octets); more if the header needs more.
    pub(super) octets: usize,
    /// How often it was given to the MAC again.
    pub(super) resends: u8,
}

/// Which way a packet goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Heading {
    /// To the parent.
    Up,
    /// Along these stations.
    Down(Vec<StationId>),
}

/// The packets that wait in a station. One at a time is given to the MAC, and stays first until it is through.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    waiting: VecDeque<Outgoing>,
    /// The frame of the first one that the MAC has, and to whom it goes.
    under_way: Option<(FrameId, StationId)>,
    /// Whether the first one waits before it is given to the MAC again.
    is_pausing: bool,
}

impl Outbox {
    /// Adds a packet, if there are fewer than `most`.
    pub(super) fn add(&mut self, packet: Outgoing, most: usize) -> bool {
        let has_room = self.waiting.len() < most;
        if has_room {
            self.waiting.push_back(packet);
        }
        has_room
    }

    /// The packet to give to the MAC now, if there is one.
    pub(super) fn first(&self) -> Option<&Outgoing> {
        let is_free = self.under_way.is_none() && !self.is_pausing;
        self.waiting.front().filter(|_| is_free)
    }

    /// The first packet is with the MAC.
    pub(super) fn send(&mut self, frame: FrameId, to: StationId) {
        self.under_way = Some((frame, to));
    }

    /// The MAC is done with `frame`: to whom it went, if it was the first packet.
    pub(super) fn ended(&mut self, frame: FrameId) -> Option<StationId> {
        let (_, to) = self.under_way.take_if(|(under_way, _)| *under_way == frame)?;
        Some(to)
    }

    /// The first packet is through, or given up.
    pub(super) fn remove_first(&mut self) -> Option<Outgoing> {
        self.waiting.pop_front()
    }

    /// The first packet waits before it is given to the MAC again; `false` if that was done `most` times.
    pub(super) fn pause(&mut self, most: u8) -> bool {
        let again = self.waiting.front_mut().is_some_and(|first| {
            first.resends = first.resends.saturating_add(1);
            first.resends <= most
        });
        self.is_pausing = again;
        again
    }

    /// The pause is over.
    pub(super) fn resume(&mut self) {
        self.is_pausing = false;
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Outgoing> {
        self.waiting.iter()
    }
}
