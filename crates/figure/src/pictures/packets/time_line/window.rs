//! The part of the time that a time line shows.

use std::collections::BTreeMap;

use sextant_recording::RecordedPacket;
use sextant_recording::messages::HopMessage;

use super::super::{PacketSource, TimeWindow, seconds};

/// Airtimes before and after the first collision, or the first transmission, that are shown by default.
const AROUND: (f64, f64) = (8.0, 16.0);
/// Share of the time of a way that is shown before it and after it.
const BESIDE: f64 = 0.06;

/// A packet that goes over several hops: the station that had it first, and its number there.
pub(super) type Identity = (u32, u32);

/// The identity of the packet of which this one is a hop.
pub(super) fn identity(hop: &HopMessage) -> Identity {
    (hop.origin, hop.number)
}

/// The way of a packet over several hops, from its offer to its arrival.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WholeWay {
    pub(super) identity: Identity,
    pub(super) hops: u32,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
}

/// Of the packets that went over most hops and arrived, the quickest one.
pub(super) fn longest_way(packets: &[RecordedPacket]) -> Option<WholeWay> {
    let mut ways: BTreeMap<Identity, Vec<(&HopMessage, &RecordedPacket)>> = BTreeMap::new();
    for packet in packets {
        if let Some(hop) = &packet.hop {
            ways.entry(identity(hop)).or_default().push((hop, packet));
        }
    }
    let whole = |(identity, mut hops): (Identity, Vec<(&HopMessage, &RecordedPacket)>)| {
        hops.sort_by_key(|(hop, packet)| (hop.hops, packet.packet.offered_ns));
        // Numbers come again, and copies go other ways: only a way with each hop once is clear.
        let is_clear = (0..).zip(&hops).all(|(number, (hop, _))| hop.hops == number);
        let (first, last) = (hops.first()?.1, hops.last()?.1);
        let arrived = last.packet.delivered_ns.filter(|_| is_clear)?;
        let hops = u32::try_from(hops.len()).ok()?;
        Some(WholeWay { identity, hops, from_s: seconds(first.packet.offered_ns), to_s: seconds(arrived) })
    };
    let ways = ways.into_iter().filter_map(whole);
    ways.max_by(|a, b| a.hops.cmp(&b.hops).then((b.to_s - b.from_s).total_cmp(&(a.to_s - a.from_s))))
}

/// The window that is shown (s), and the way that it is about; `None` if nothing was sent.
pub(super) fn window(source: &PacketSource<'_>) -> Option<((f64, f64), Option<WholeWay>)> {
    let TimeWindow { from_s, to_s } = source.window;
    let all = || source.packets.iter().flat_map(|packet| &packet.transmissions);
    let first = |is: &dyn Fn(&str) -> bool| {
        let sent = all().filter(|sent| is(&sent.outcome)).min_by_key(|sent| sent.start_ns)?;
        Some((seconds(sent.start_ns), seconds(sent.airtime_ns)))
    };
    let (start_s, airtime_s) = first(&|outcome| outcome == "collided").or_else(|| first(&|_| true))?;
    if let (None, None, Some(way)) = (from_s, to_s, longest_way(source.packets).filter(|way| way.hops > 1)) {
        let beside = BESIDE * (way.to_s - way.from_s);
        return Some((((way.from_s - beside).max(0.0), way.to_s + beside), Some(way)));
    }
    let default_from = (start_s - AROUND.0 * airtime_s).max(0.0);
    let span = (AROUND.0 + AROUND.1) * airtime_s;
    let from = from_s.unwrap_or_else(|| to_s.map_or(default_from, |to_s| (to_s - span).max(0.0)));
    let to = to_s.unwrap_or(from + span);
    (to > from).then_some(((from, to), None))
}

#[cfg(test)]
mod tests {
    use sextant_recording::{RecordedActivity, RecordedWorld};

    use super::super::span::tests::packet;
    use super::*;

    fn hop(number: u32, hops: u32, offered_ns: u64, delivered_ns: Option<u64>) -> RecordedPacket {
        let mut packet = RecordedPacket::default();
        packet.packet.offered_ns = offered_ns;
        packet.packet.delivered_ns = delivered_ns;
        packet.hop = Some(HopMessage { origin: 7, number, hops, ..HopMessage::default() });
        packet
    }

    #[test]
    fn the_quickest_of_the_longest_ways_is_the_one_that_arrived_over_most_hops() {
        let packets = [
            hop(1, 0, 0, Some(10)),
            hop(1, 1, 10, Some(90)),
            hop(2, 0, 100, Some(110)),
            hop(2, 1, 110, Some(140)),
            // Lost on its last hop, and a copy.
            hop(3, 0, 200, Some(210)),
            hop(3, 1, 210, Some(220)),
            hop(3, 2, 220, None),
            hop(4, 0, 300, Some(310)),
            hop(4, 1, 310, Some(312)),
            hop(4, 1, 311, Some(313)),
        ];
        let way = longest_way(&packets).unwrap();
        assert_eq!((way.identity, way.hops), ((7, 2), 2));
        assert_eq!((way.from_s, way.to_s), (1e-7, 1.4e-7));
        assert_eq!(longest_way(&[packet()]), None);
    }

    #[test]
    fn a_time_line_shows_the_window_that_is_asked_for() {
        let (packets, activity, drawn) = ([packet()], RecordedActivity::default(), RecordedWorld::default());
        let at = |from_s, to_s| PacketSource {
            title: "t",
            names: &[],
            drawn: &drawn,
            packets: &packets,
            activity: &activity,
            traffic: &[],
            window: TimeWindow { from_s, to_s },
        };
        assert_eq!(window(&at(Some(1.0), Some(2.0))), Some(((1.0, 2.0), None)));
        assert_eq!(window(&at(Some(2.0), Some(1.0))), None);
        let ((from, to), _) = window(&at(None, None)).unwrap();
        assert!(from < 0.002_32 && to > 0.003_152, "{from} to {to}");
    }
}
