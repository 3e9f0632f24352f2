//! A network, of any technology.

use std::ops::Range;
use std::time::Duration;

use sextant_channel::SectorTable;
use sextant_kernel::{SimTime, StationId};

use super::ieee80211ad::network as ieee80211ad;
use super::ieee802154::network as ieee802154;
use crate::event::link::LinkEvent;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::packets::NetworkRecord;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::sweep::{SweepAnswer, SweepError, SweepKind};

/// A network, of any technology.
pub(crate) enum Network {
    Ieee802154(ieee802154::Network),
    Ieee80211ad(ieee80211ad::Network),
}

impl Network {
    /// The network starts to work at a station.
    pub(crate) fn begin(&mut self, station: StationId, scene: &mut Scene) {
        match self {
            Self::Ieee802154(network) => network.begin(station, scene),
            Self::Ieee80211ad(network) => network.begin(station, scene),
        }
    }

    /// Starts what the network does by itself, after all stations.
    pub(crate) fn begin_schedule(&mut self, scene: &mut Scene) {
        match self {
            Self::Ieee802154(network) => network.begin_beacons(scene),
            Self::Ieee80211ad(_) => {}
        }
    }

    /// Packets count that are offered from this instant on. Sector sweeps all count.
    pub(crate) fn count_from(&mut self, instant: SimTime) {
        match self {
            Self::Ieee802154(network) => network.count_from(instant),
            Self::Ieee80211ad(_) => {}
        }
    }

    /// Energy counts from now on. That of sector sweeps counts from the start.
    pub(crate) fn restart_meters(&mut self, now: SimTime) {
        match self {
            Self::Ieee802154(network) => network.restart_meters(now),
            Self::Ieee80211ad(_) => {}
        }
    }

    #[inline]
    pub(crate) fn handle(
        &mut self,
        station: StationId,
        event: LinkEvent,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        match (self, event) {
            (Self::Ieee802154(network), LinkEvent::Ieee802154(event)) => {
                network.handle(station, event, scene, observer)
            }
            (Self::Ieee80211ad(network), LinkEvent::Ieee80211ad(event)) => {
                network.handle(station, event, scene, observer);
            }
            (Self::Ieee802154(_), LinkEvent::Ieee80211ad(_)) | (Self::Ieee80211ad(_), LinkEvent::Ieee802154(_)) => {
                unreachable!("a network has events of its own technology")
            }
        }
    }

    /// Takes a frame to send.
    #[inline]
    pub(crate) fn offer(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        match self {
            Self::Ieee802154(network) => network.offer(station, to, payload, scene),
            Self::Ieee80211ad(network) => network.offer(station, to, payload, scene),
        }
    }

    /// Whether its links sweep sectors.
    pub(crate) fn has_sectors(&self) -> bool {
        matches!(self, Self::Ieee80211ad(_))
    }

    /// Number of sectors of the antenna of a station; `None` if it has none, or the links do not sweep.
    pub(crate) fn sectors(&self, station: StationId) -> Option<u8> {
        match self {
            Self::Ieee802154(_) => None,
            Self::Ieee80211ad(network) => network.sectors(station),
        }
    }

    /// The directions of the sectors of robots; `None` if the links do not sweep.
    pub(crate) fn robot_sectors(&self) -> Option<SectorTable> {
        match self {
            Self::Ieee802154(_) => None,
            Self::Ieee80211ad(network) => network.robot_sectors(),
        }
    }

    /// Begins a sector sweep of a station.
    pub(crate) fn sweep(&mut self, station: StationId, kind: SweepKind, scene: &mut Scene) -> Result<(), SweepError> {
        match self {
            Self::Ieee802154(_) => Err(SweepError::NoSectors),
            Self::Ieee80211ad(network) => network.sweep(station, kind, scene),
        }
    }

    /// The answers to the sweep of a station that has just ended.
    pub(crate) fn take_answers(&mut self, station: StationId) -> Vec<SweepAnswer> {
        match self {
            Self::Ieee802154(_) => Vec::new(),
            Self::Ieee80211ad(network) => network.take_answers(station),
        }
    }

    /// A station listens for `span` from now.
    pub(crate) fn listen(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        match self {
            Self::Ieee802154(network) => network.listen(station, span, scene),
            Self::Ieee80211ad(network) => network.listen(station, span, scene),
        }
    }

    /// A station dies: its radio is off from now on, or from the end of the frame on air.
    pub(crate) fn die(&mut self, station: StationId, scene: &mut Scene) {
        match self {
            Self::Ieee802154(network) => network.die(station, scene),
            Self::Ieee80211ad(network) => network.die(station, scene),
        }
    }

    /// Whether an event is the end of the frame that a station has on air.
    pub(crate) fn ends_frame(&self, station: StationId, event: LinkEvent) -> bool {
        match (self, event) {
            (Self::Ieee802154(network), LinkEvent::Ieee802154(event)) => network.ends_frame(station, event),
            (Self::Ieee80211ad(network), LinkEvent::Ieee80211ad(event)) => network.ends_frame(station, event),
            (Self::Ieee802154(_), LinkEvent::Ieee80211ad(_)) | (Self::Ieee80211ad(_), LinkEvent::Ieee802154(_)) => {
                false
            }
        }
    }

    /// A station moves differently from now on.
    pub(crate) fn moves(&self, station: StationId, scene: &mut Scene) {
        match self {
            Self::Ieee802154(network) => network.moves(station, scene),
            Self::Ieee80211ad(network) => network.moves(station, scene),
        }
    }

    /// The frame that was received last, and where its payload is.
    pub(crate) fn take_payload(&mut self) -> (Vec<u8>, Range<usize>) {
        match self {
            Self::Ieee802154(network) => network.take_payload(),
            Self::Ieee80211ad(network) => network.take_payload(),
        }
    }

    /// Gives the buffer of [`Network::take_payload`] back.
    pub(crate) fn give_back(&mut self, frame: Vec<u8>) {
        match self {
            Self::Ieee802154(network) => network.give_back(frame),
            Self::Ieee80211ad(network) => network.give_back(frame),
        }
    }

    /// What the network leaves behind, by station.
    pub(crate) fn finish(self, now: SimTime) -> NetworkRecord {
        match self {
            Self::Ieee802154(network) => network.finish(now),
            Self::Ieee80211ad(network) => network.finish(now),
        }
    }
}
