//! The ledger of a network: what became of the packets of its stations, and who its stations are.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::RadioStates;

use super::books::{Books, FrameSpans, RadioUse};
use super::settings::Placement;
use crate::scene::Scene;
use crate::service::delays::Delays;
use crate::service::due_frames::DueFrames;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::packets::{LeftPacket, Packets};
use crate::service::report::{Destination, SendError};
use crate::station::Roll;

/// A packet that has left its link, or stays there because its station dies or the simulation ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct CountedPacket {
    pub(super) offered: SimTime,
    pub(super) payload_octets: u64,
    pub(super) end: PacketEnd,
    pub(super) fate: PacketFate,
    pub(super) transmissions: u64,
    pub(super) assessments: u64,
}

/// The ledger of a network, whatever its technology.
pub(crate) struct Ledger {
    /// What became of the packets of each station.
    pub(super) packets: Vec<Packets>,
    /// Octets of the frames of each station that were offered.
    pub(super) octets: Vec<u64>,
    /// The frames of each station that were due, where nodes may rest.
    due: Vec<DueFrames>,
    /// Number of frames that were delivered to each station.
    pub(super) deliveries: Vec<u64>,
    /// Time from offer to first reception of the packets of each station that were received; empty without sinks.
    pub(super) delays: Vec<Delays>,
    /// The packets that were sent and stayed in links.
    pub(super) left: Vec<LeftPacket>,
    /// Packets that were offered before are not counted.
    pub(super) counted_from: SimTime,
    /// Whether each station is in the network; `None` if all are.
    members: Option<Vec<bool>>,
    /// When each station died, if it did; empty as long as none did.
    died: Vec<Option<SimTime>>,
    /// Energy model of the radios.
    pub(super) radio_states: RadioStates,
}

impl Ledger {
    /// An empty ledger of all stations.
    pub(super) fn new(placement: &Placement, roll: Roll) -> Self {
        Self {
            packets: vec![Packets::default(); roll.len()],
            octets: vec![0; roll.len()],
            due: vec![DueFrames::default(); roll.len()],
            deliveries: vec![0; roll.len()],
            delays: vec![Delays::default(); if roll.sinks > 0 { roll.len() } else { 0 }],
            left: Vec::new(),
            counted_from: SimTime::ZERO,
            members: placement.members.clone(),
            died: Vec::new(),
            radio_states: placement.radio_states.clone(),
        }
    }

    /// Whether a station is in the network.
    #[inline]
    pub(super) fn has(&self, station: StationId) -> bool {
        self.members.as_ref().is_none_or(|members| members[station.index()])
    }

    /// Counts a packet of a station that has left its link, or stays there, unless it was offered in the warm-up.
    pub(super) fn count(&mut self, station: StationId, packet: &CountedPacket) {
        let &CountedPacket { offered, payload_octets, end, fate, transmissions, assessments } = packet;
        if offered < self.counted_from {
            return;
        }
        let packets = &mut self.packets[station.index()];
        packets.count(fate, transmissions);
        // Those of a packet that stays are not known of all technologies.
        let has_left = !matches!(end, PacketEnd::Pending | PacketEnd::Died);
        packets.assessments += if has_left { assessments } else { 0 };
        packets.unacknowledged += u64::from(end == PacketEnd::NoAcknowledgement);
        packets.channel_access_failures += u64::from(end == PacketEnd::ChannelAccessFailure);
        if fate == PacketFate::Sent(FrameOutcome::Received) {
            packets.octets_received += payload_octets;
        }
    }

    /// A packet that a station was offered then is received for the first time now.
    pub(super) fn note_reception(&mut self, station: StationId, offered: SimTime, now: SimTime) {
        if offered >= self.counted_from
            && let Some(delays) = self.delays.get_mut(station.index())
        {
            delays.add(now - offered);
        }
    }

    /// Whether a station can send to `to`: to all others, or to one of the network.
    #[inline]
    pub(super) fn can_reach(&self, station: StationId, to: Destination) -> Result<(), SendError> {
        match to {
            Destination::Station(to) if to == station || to.index() >= self.packets.len() || !self.has(to) => {
                Err(SendError::NoSuchStation(to))
            }
            Destination::Station(_) | Destination::All => Ok(()),
        }
    }

    /// Counts a frame of this size (octets) that a station is offered. Returns 1, or 0 in the warm-up.
    #[inline]
    pub(super) fn offer(&mut self, station: StationId, mpdu_octets: u8, scene: &mut Scene) -> u64 {
        let counts = u64::from(scene.now >= self.counted_from);
        self.packets[station.index()].offered += counts;
        self.octets[station.index()] += counts * u64::from(mpdu_octets);
        scene.offered += 1;
        counts
    }

    /// A station dies. It may be told again, when the frame that was on air has ended.
    pub(super) fn die(&mut self, station: StationId, now: SimTime) {
        self.died.resize(self.packets.len(), None);
        self.died[station.index()].get_or_insert(now);
    }

    /// When a station died, if it did: its use of the radio counts until then.
    #[inline]
    pub(super) fn died(&self, station: StationId) -> Option<SimTime> {
        self.died.get(station.index()).copied().flatten()
    }

    /// Notes which frames of a station were due.
    pub(super) fn note_due(&mut self, station: StationId, due: DueFrames) {
        self.due[station.index()] += due;
    }

    /// The books of the network, with how each radio was used, and what frames take that were not simulated.
    pub(super) fn close(self, radios: Vec<RadioUse>, spans: FrameSpans) -> Books {
        let Self { packets, octets, due, deliveries, delays, left, members, radio_states, .. } = self;
        Books {
            packets,
            octets,
            due,
            deliveries,
            delays,
            left,
            members,
            radio_states,
            radios,
            spans,
            slots: Vec::new(),
            sleep: Vec::new(),
            rhythms: Vec::new(),
        }
    }
}
