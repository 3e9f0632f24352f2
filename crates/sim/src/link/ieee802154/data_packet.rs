//! Data packets of stations: when one is none any more, it is counted and traced.

use sextant_channel::Dbm;
use sextant_kernel::{SimTime, StationId};

use super::addressing::{header, pan};
use crate::link::ledger::{CountedPacket, Ledger};
use crate::link::track::{PacketTrack, Traced};
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::packet_trace::{PacketEnd, PacketFate, PacketKind};
use crate::service::packets::LeftPacket;
use crate::service::report::{Destination, FrameId};

/// A data packet of a station.
#[derive(Clone, Copy, Debug)]
pub(in crate::link) struct DataPacket {
    pub(in crate::link) id: FrameId,
    /// The number of its frames; `None` if it never had one.
    pub(in crate::link) sequence: Option<u8>,
    pub(in crate::link) to: Destination,
    pub(in crate::link) mpdu_octets: u8,
    pub(in crate::link) offered: SimTime,
}

/// Where a packet is from.
#[derive(Clone, Copy, Debug)]
pub(in crate::link) struct Origin {
    pub(in crate::link) network: NetworkId,
    pub(in crate::link) station: StationId,
    pub(in crate::link) power: Dbm,
}

/// A packet that has left its link, or stays there.
#[derive(Debug)]
pub(in crate::link) struct EndedPacket<'a> {
    pub(in crate::link) packet: DataPacket,
    pub(in crate::link) end: PacketEnd,
    pub(in crate::link) fate: PacketFate,
    pub(in crate::link) transmissions: u32,
    pub(in crate::link) assessments: u32,
    /// Its track, if packets are traced.
    pub(in crate::link) track: Option<&'a mut PacketTrack>,
}

impl EndedPacket<'_> {
    /// Counts the packet, and traces it.
    pub(in crate::link) fn enter(self, origin: Origin, ledger: &mut Ledger, scene: &mut Scene) {
        let Self { packet, end, fate, transmissions, assessments, track } = self;
        let DataPacket { id, to, mpdu_octets, offered, .. } = packet;
        if transmissions > 0 && matches!(end, PacketEnd::Died | PacketEnd::Pending) {
            ledger.left.push(LeftPacket { station: origin.station, frame: id, transmissions });
        }
        let overhead_octets = header(pan(origin.network), origin.station, to).overhead_octets();
        let payload_octets = u64::from(mpdu_octets - overhead_octets);
        let (transmissions, assessments) = (transmissions.into(), assessments.into());
        ledger
            .count(origin.station, &CountedPacket { offered, payload_octets, end, fate, transmissions, assessments });
        if let Some(track) = track {
            origin.trace(packet, (end, fate), track, ledger, scene);
        }
    }
}

impl Origin {
    /// Traces a packet that ended so.
    pub(super) fn trace(
        self,
        packet: DataPacket,
        (end, fate): (PacketEnd, PacketFate),
        track: &mut PacketTrack,
        ledger: &Ledger,
        scene: &mut Scene,
    ) {
        let Self { network, station, power } = self;
        let DataPacket { id: FrameId(number), sequence, to, mpdu_octets, offered } = packet;
        let traced = Traced {
            network,
            source: station,
            kind: PacketKind::Data,
            number,
            sequence,
            to,
            octets: mpdu_octets.into(),
            offered,
            counts: offered >= ledger.counted_from,
            end,
            fate,
        };
        scene.traced.push(track.end(&traced, &ledger.radio_states, power, scene.now));
    }
}
