//! The bars of a time line: what a station does for its packets, and its other frames.

use std::collections::BTreeSet;

use plotters::style::RGBColor;
use sextant_recording::{FrameType, RecordedFrame, RecordedPacket};

use super::super::{PacketSource, seconds};
use crate::paint::palette::{CURVES, FAINT_INK, INK, OBSTACLE, OBSTACLE_RIM};

/// What a bar means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Bar {
    Backoff,
    IdleAssessment,
    BusyAssessment,
    Received,
    ToAll,
    Collided,
    Lost,
    Acknowledged,
    Unanswered,
    Acknowledgement,
    Beacon,
    WakeUp,
    Control,
}

/// How a bar is drawn.
pub(super) struct Look {
    pub(super) bar: Bar,
    pub(super) fill: RGBColor,
    /// Its height as a share of the row.
    pub(super) height: f64,
    pub(super) text: &'static str,
}

const fn look(bar: Bar, fill: RGBColor, height: f64, text: &'static str) -> Look {
    Look { bar, fill, height, text }
}

/// All bars, in the order of the legend.
pub(super) const LOOKS: [Look; 13] = [
    look(Bar::Backoff, OBSTACLE, 0.3, "backoff"),
    look(Bar::IdleAssessment, CURVES[4], 0.72, "channel found idle, until the frame begins"),
    look(Bar::BusyAssessment, INK, 0.72, "channel found busy"),
    look(Bar::Received, CURVES[2], 0.72, "frame received"),
    look(Bar::ToAll, CURVES[5], 0.72, "frame to all"),
    look(Bar::Collided, CURVES[1], 0.72, "frame lost to a collision"),
    look(Bar::Lost, CURVES[3], 0.72, "frame lost otherwise"),
    look(Bar::Acknowledged, CURVES[0], 0.72, "acknowledgement received"),
    look(Bar::Unanswered, OBSTACLE_RIM, 0.72, "no acknowledgement"),
    look(Bar::Acknowledgement, CURVES[0], 0.4, "acknowledgement on air"),
    look(Bar::Beacon, CURVES[5], 0.4, "beacon of the MAC"),
    look(Bar::WakeUp, FAINT_INK, 0.4, "strobe or wake-up frame"),
    look(Bar::Control, FAINT_INK, 0.4, "other frame of the MAC"),
];

impl Bar {
    /// How it is drawn.
    pub(super) fn look(self) -> &'static Look {
        LOOKS.iter().find(|look| look.bar == self).unwrap_or(&LOOKS[0])
    }
}

/// A bar of a station (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) station: u32,
    pub(super) bar: Bar,
    pub(super) from_s: f64,
    pub(super) to_s: f64,
}

/// The bars of a source that overlap with a window (s), by their start.
pub(super) fn within(source: &PacketSource<'_>, (from_s, to_s): (f64, f64)) -> Vec<Span> {
    let is_shown = |span: &Span| span.to_s >= from_s && span.from_s <= to_s;
    let near = source
        .packets
        .iter()
        .filter(|packet| seconds(packet.packet.ended_ns) >= from_s && seconds(packet.packet.offered_ns) <= to_s);
    let mut spans: Vec<Span> = near.flat_map(of_packet).chain(of_frames(source)).filter(is_shown).collect();
    spans.sort_by(|a, b| a.from_s.total_cmp(&b.from_s).then(a.station.cmp(&b.station)));
    spans
}

/// The bars of a packet.
fn of_packet(packet: &RecordedPacket) -> Vec<Span> {
    let mut spans = Vec::new();
    let station = packet.packet.source;
    let mut add = |bar, from_ns: u64, to_ns: u64| {
        spans.push(Span { station, bar, from_s: seconds(from_ns), to_s: seconds(to_ns) });
    };
    let next_frame = |after: u64| packet.transmissions.iter().map(|sent| sent.start_ns).find(|&start| start >= after);
    for (i, assessment) in packet.assessments.iter().enumerate() {
        if assessment.backoff_ns < assessment.start_ns {
            add(Bar::Backoff, assessment.backoff_ns, assessment.start_ns);
        }
        let next = packet.assessments.get(i + 1).map(|next| next.backoff_ns);
        match (assessment.busy, next_frame(assessment.start_ns)) {
            (true, _) => add(Bar::BusyAssessment, assessment.start_ns, next.unwrap_or(packet.packet.ended_ns)),
            (false, Some(start)) => {
                add(Bar::IdleAssessment, assessment.start_ns, next.map_or(start, |next| next.min(start)));
            }
            (false, None) => add(Bar::IdleAssessment, assessment.start_ns, packet.packet.ended_ns),
        }
    }
    let is_for_one = packet.packet.destination.is_some();
    for (i, sent) in packet.transmissions.iter().enumerate() {
        let end = sent.start_ns + sent.airtime_ns;
        let bar = match sent.outcome.as_str() {
            "received" if is_for_one => Bar::Received,
            "received" => Bar::ToAll,
            "collided" => Bar::Collided,
            _ => Bar::Lost,
        };
        add(bar, sent.start_ns, end);
        let is_last = i + 1 == packet.transmissions.len();
        match sent.acknowledged_ns {
            Some(acknowledged) => add(Bar::Acknowledged, end, acknowledged),
            None if is_for_one && packet.packet.kind == "data" => {
                let next = packet.assessments.iter().map(|next| next.backoff_ns).find(|&next| next >= end);
                // Without assessments, the sender knows at the latest when it sends again.
                let again = packet.transmissions.get(i + 1).map(|again| again.start_ns.min(2 * end - sent.start_ns));
                let until = next.or(again).filter(|_| !is_last).unwrap_or(packet.packet.ended_ns);
                add(Bar::Unanswered, end, until.max(end));
            }
            None => {}
        }
    }
    spans
}

/// The bars of the frames that are no transmissions of packets, if all frames were recorded. Only networks of IEEE 802.15.4
/// have frames whose type is known.
fn of_frames(source: &PacketSource<'_>) -> Vec<Span> {
    let frames = &source.activity.frames;
    if frames.is_empty() || source.packets.iter().any(|packet| packet.packet.kind != "data") {
        return Vec::new();
    }
    let sent = |packet: &RecordedPacket| {
        let station = packet.packet.source;
        packet.transmissions.iter().map(move |sent| (station, sent.start_ns)).collect::<Vec<_>>()
    };
    let of_packets: BTreeSet<(u32, u64)> = source.packets.iter().flat_map(sent).collect();
    let others = frames.iter().filter(|frame| !of_packets.contains(&(frame.source, frame.start_ns)));
    others.map(|frame| Span { bar: bar_of(source, frame), ..span_of(frame) }).collect()
}

fn span_of(frame: &RecordedFrame) -> Span {
    let (from_s, to_s) = (seconds(frame.start_ns), seconds(frame.start_ns + frame.airtime_ns));
    Span { station: frame.source, bar: Bar::Control, from_s, to_s }
}

/// What a frame is that is no transmission of a packet. Where stations sleep, data frames beside packets wake others.
fn bar_of(source: &PacketSource<'_>, frame: &RecordedFrame) -> Bar {
    let wakes = !source.activity.checks.is_empty();
    match frame.kind {
        FrameType::Acknowledgement => Bar::Acknowledgement,
        FrameType::Beacon => Bar::Beacon,
        FrameType::Data | FrameType::Multipurpose if wakes => Bar::WakeUp,
        FrameType::Data | FrameType::Multipurpose | FrameType::Command | FrameType::Other => Bar::Control,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use sextant_recording::messages::{AssessmentMessage, TransmissionMessage};

    use super::*;

    pub(in super::super) fn packet() -> RecordedPacket {
        let mut packet = RecordedPacket::default();
        packet.packet.destination = Some(3);
        packet.packet.kind = "data".to_owned();
        packet.packet.ended_ns = 9_000_000;
        let assessment = |backoff_ns, start_ns, busy| AssessmentMessage { packet: 0, backoff_ns, start_ns, busy };
        packet.assessments = vec![assessment(0, 1_000_000, true), assessment(1_128_000, 2_000_000, false)];
        packet.transmissions = vec![TransmissionMessage {
            start_ns: 2_320_000,
            airtime_ns: 832_000,
            outcome: "received".to_owned(),
            receiver: Some(3),
            acknowledged_ns: Some(3_696_000),
            ..TransmissionMessage::default()
        }];
        packet
    }

    #[test]
    fn the_bars_of_a_packet_follow_each_other() {
        let bars: Vec<_> = of_packet(&packet()).into_iter().map(|span| (span.bar, span.from_s, span.to_s)).collect();
        let expected = [
            (Bar::Backoff, 0.0, 0.001),
            (Bar::BusyAssessment, 0.001, 0.001_128),
            (Bar::Backoff, 0.001_128, 0.002),
            (Bar::IdleAssessment, 0.002, 0.002_32),
            (Bar::Received, 0.002_32, 0.003_152),
            (Bar::Acknowledged, 0.003_152, 0.003_696),
        ];
        assert_eq!(bars, expected);
    }

    #[test]
    fn each_bar_has_a_look_of_its_own() {
        for (i, look) in LOOKS.iter().enumerate() {
            assert_eq!(look.bar.look().text, look.text);
            assert!(
                LOOKS[..i]
                    .iter()
                    .all(|other| (other.fill, other.height.to_bits()) != (look.fill, look.height.to_bits())
                        || [Bar::WakeUp, Bar::Control].contains(&look.bar)),
                "{}",
                look.text
            );
        }
    }
}
