//! What became of the packets, by node and over time.

use std::collections::BTreeMap;

use sextant_recording::messages::PacketMessage;

use super::{PacketSource, Span, seconds};
use crate::paint::picture::Picture;
use crate::plot::stacks::{Stack, Stacks};

/// Parts into which the time is divided.
const TIME_PARTS: u32 = 40;

/// What a packet counts as, and what it is called in the legend.
pub(super) const FATES: [(&str, &str); 9] = [
    ("received", "received"),
    ("lost_collision", "collision"),
    ("lost_signal", "weak signal"),
    ("not_listened", "no receiver listened"),
    ("out_of_range", "out of range"),
    ("lost_channel_access", "no channel access"),
    ("lost_queue", "queue full"),
    ("died", "node died"),
    ("pending", "pending at the end"),
];

/// Shares by the node that offered; `None` if there is no packet.
pub(super) fn by_node(source: &PacketSource<'_>, span: Span) -> Option<Picture> {
    let mut counts: BTreeMap<u32, Vec<u64>> = BTreeMap::new();
    for packet in counted(source) {
        count(counts.entry(packet.source).or_insert_with(|| vec![0; FATES.len()]), packet);
    }
    let stack = |(station, counts): (u32, Vec<u64>)| {
        let middle = f64::from(station);
        Stack { from: middle - 0.42, to: middle + 0.42, counts }
    };
    let stacks: Vec<_> = counts.into_iter().map(stack).collect();
    draw(source, span, "by node", "index of the node that offered", stacks)
}

/// Shares by the time of the offer; `None` if there is no packet.
pub(super) fn over_time(source: &PacketSource<'_>, span: Span) -> Option<Picture> {
    let offers = || counted(source).map(|packet| packet.offered_ns);
    let (first, last) = (offers().min()?, offers().max()?);
    let width = (last - first) / u64::from(TIME_PARTS) + 1;
    let mut counts = vec![vec![0; FATES.len()]; TIME_PARTS as usize];
    for packet in counted(source) {
        let part = usize::try_from((packet.offered_ns - first) / width).unwrap_or(0);
        if let Some(counts) = counts.get_mut(part) {
            count(counts, packet);
        }
    }
    let edge = |part: u64| seconds(first + part * width);
    let stacks = (0..).zip(counts).map(|(part, counts)| Stack { from: edge(part), to: edge(part + 1), counts });
    let offered = stacks.filter(|stack| stack.counts.iter().any(|&count| count > 0)).collect();
    draw(source, span, "over time", "time of the offer (s)", offered)
}

fn counted<'a>(source: &PacketSource<'a>) -> impl Iterator<Item = &'a PacketMessage> + use<'a> {
    source.packets.iter().map(|packet| &packet.packet).filter(|packet| packet.counted)
}

fn count(counts: &mut [u64], packet: &PacketMessage) {
    if let Some(fate) = FATES.iter().position(|(fate, _)| *fate == packet.fate) {
        counts[fate] += 1;
    }
}

fn draw(source: &PacketSource<'_>, span: Span, what: &str, across: &str, stacks: Vec<Stack>) -> Option<Picture> {
    let stacks = Stacks {
        title: format!("{}: outcomes of {} {what}", source.title, span.of_packets()),
        note: span.offered().to_owned(),
        across: across.to_owned(),
        layers: FATES.map(|(_, words)| words).to_vec(),
        stacks,
    };
    stacks.draw()
}
