//! The ways of packets from row to row: a hop leads to the row of its receiver, and the packet waits there.

use std::collections::BTreeMap;

use super::super::{PacketSource, seconds};
use super::window::{Identity, identity};

/// A piece of the way of a packet (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub(super) identity: Option<Identity>,
    pub(super) leg: Leg,
}

/// What a piece of a way is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leg {
    /// The packet waits at a station, or is sent by it.
    At { station: u32, from_s: f64, to_s: f64 },
    /// It arrives from a station at another one.
    To { from: u32, to: u32, at_s: f64 },
    /// Its station gives it up.
    Lost { station: u32, at_s: f64 },
}

/// All pieces that overlap with a window (s).
pub(super) fn within(source: &PacketSource<'_>, (from_s, to_s): (f64, f64)) -> Vec<Piece> {
    let near = |packet: &&sextant_recording::RecordedPacket| {
        packet.packet.destination.is_some()
            && seconds(packet.packet.ended_ns) >= from_s
            && seconds(packet.packet.offered_ns) <= to_s
    };
    // When a packet of several hops arrived at a station.
    let mut arrived: BTreeMap<(Identity, u32), f64> = BTreeMap::new();
    for packet in source.packets {
        let sent = packet.transmissions.iter().find(|sent| sent.outcome == "received");
        if let (Some(hop), Some(sent), Some(to)) = (&packet.hop, sent, packet.packet.destination) {
            arrived.entry((identity(hop), to)).or_insert_with(|| seconds(sent.start_ns + sent.airtime_ns));
        }
    }
    let mut pieces = Vec::new();
    for packet in source.packets.iter().filter(near) {
        let (message, identity) = (&packet.packet, packet.hop.as_ref().map(identity));
        let station = message.source;
        let since = identity.and_then(|identity| arrived.get(&(identity, station)).copied());
        let from_s = since.unwrap_or(seconds(message.offered_ns)).min(seconds(message.offered_ns));
        let received = packet.transmissions.iter().find(|sent| sent.outcome == "received");
        let end = received.map(|sent| seconds(sent.start_ns + sent.airtime_ns));
        let last = packet.transmissions.last().map(|sent| seconds(sent.start_ns + sent.airtime_ns));
        let to_s = end.or(last).unwrap_or(seconds(message.ended_ns));
        pieces.push(Piece { identity, leg: Leg::At { station, from_s, to_s } });
        let leg = match (end, message.destination, message.end.as_str()) {
            (Some(at_s), Some(to), _) => Leg::To { from: station, to, at_s },
            (_, _, "pending") => continue,
            _ => Leg::Lost { station, at_s: to_s },
        };
        pieces.push(Piece { identity, leg });
    }
    pieces.retain(|piece| {
        let (first, last) = match piece.leg {
            Leg::At { from_s, to_s, .. } => (from_s, to_s),
            Leg::To { at_s, .. } | Leg::Lost { at_s, .. } => (at_s, at_s),
        };
        last >= from_s && first <= to_s
    });
    pieces
}

#[cfg(test)]
mod tests {
    use sextant_recording::messages::HopMessage;
    use sextant_recording::{RecordedActivity, RecordedPacket, RecordedWorld};

    use super::super::super::TimeWindow;
    use super::super::span::tests::packet;
    use super::*;

    #[test]
    fn a_packet_waits_where_it_arrived_and_goes_on_to_the_next_row() {
        let hop = |hops| Some(HopMessage { number: 5, hops, ..HopMessage::default() });
        let first = RecordedPacket { hop: hop(0), ..packet() };
        let mut second = RecordedPacket { hop: hop(1), ..packet() };
        second.packet.source = 3;
        second.packet.destination = Some(4);
        second.packet.offered_ns = 4_000_000;
        second.packet.end = "no_acknowledgement".to_owned();
        second.assessments.clear();
        second.transmissions[0].start_ns = 6_000_000;
        second.transmissions[0].outcome = "weak".to_owned();
        let (packets, activity, drawn) = ([first, second], RecordedActivity::default(), RecordedWorld::default());
        let source = PacketSource {
            title: "t",
            names: &[],
            drawn: &drawn,
            packets: &packets,
            activity: &activity,
            traffic: &[],
            window: TimeWindow::default(),
        };
        let legs: Vec<_> = within(&source, (0.0, 1.0)).into_iter().map(|piece| piece.leg).collect();
        let expected = [
            Leg::At { station: 0, from_s: 0.0, to_s: 0.003_152 },
            Leg::To { from: 0, to: 3, at_s: 0.003_152 },
            Leg::At { station: 3, from_s: 0.003_152, to_s: 0.006_832 },
            Leg::Lost { station: 3, at_s: 0.006_832 },
        ];
        assert_eq!(legs, expected);
        assert_eq!(within(&source, (0.004, 0.005)).len(), 1, "only the wait of the second one");
    }
}
