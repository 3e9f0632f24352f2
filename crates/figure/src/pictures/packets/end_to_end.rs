//! The distribution of the delays of packets over several hops, from the node that had them to where they go.

use std::collections::BTreeMap;

use super::delays::curve;
use super::{PacketSource, seconds};
use crate::paint::picture::Picture;
use crate::plot::curves::Curves;

/// A packet over several hops.
#[derive(Clone, Copy, Debug, Default)]
struct Journey {
    /// Whether a node had it after the warm-up.
    is_counted: bool,
    /// When it first arrived (ns).
    arrived_ns: Option<u64>,
}

/// The figure; `None` if no packet over several hops arrived.
pub(super) fn draw(source: &PacketSource<'_>) -> Option<Picture> {
    let delays = delays_s(source);
    let curves = Curves {
        title: format!("{}: delay of packets end to end", source.title),
        note: "share of the packets that arrived with at most this time from the offer to the first arrival, over all hops"
            .to_owned(),
        across: "delay (s)".to_owned(),
        up: "share of the packets that arrived".to_owned(),
        series: if delays.is_empty() { Vec::new() } else { vec![curve("", "", &delays)] },
    };
    (!curves.series.is_empty()).then(|| curves.draw())
}

/// The delays of the packets of nodes that arrived, in ascending order (s).
fn delays_s(source: &PacketSource<'_>) -> Vec<f64> {
    let first_sink = source.names.len().saturating_sub(source.drawn.sinks.len());
    let is_sink = |station: u32| station as usize >= first_sink;
    let in_warm_up = source.packets.iter().filter(|packet| !packet.packet.counted && !is_sink(packet.packet.source));
    let warm_up_ns = in_warm_up.map(|packet| packet.packet.offered_ns).max();
    let mut journeys: BTreeMap<(u32, u32, u64), Journey> = BTreeMap::new();
    for packet in source.packets {
        let (packet, Some(hop)) = (&packet.packet, &packet.hop) else { continue };
        let journey = journeys.entry((hop.origin, hop.number, hop.origin_offered_ns)).or_default();
        journey.is_counted |= packet.source == hop.origin && packet.counted;
        let is_there = packet.destination.is_some_and(|station| match hop.target {
            Some(target) => station == target,
            None => is_sink(station),
        });
        if is_there {
            journey.arrived_ns = journey.arrived_ns.into_iter().chain(packet.delivered_ns).min();
        }
    }
    let counted = journeys
        .into_iter()
        .filter(|((_, _, offered_ns), journey)| journey.is_counted && warm_up_ns.is_none_or(|end| *offered_ns > end));
    let arrived = counted
        .filter_map(|((_, _, offered_ns), journey)| Some(seconds(journey.arrived_ns?.saturating_sub(offered_ns))));
    let mut delays: Vec<f64> = arrived.collect();
    delays.sort_by(f64::total_cmp);
    delays
}
