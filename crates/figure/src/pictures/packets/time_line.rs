//! The time line: what each station does for its packets, as bars.

use std::collections::BTreeSet;

use plotters::style::RGBColor;
use sextant_recording::RecordedPacket;

use super::PacketSource;
use super::TimeWindow;
use super::seconds;
use crate::paint::palette::{CURVES, GRID, INK, OBSTACLE, OBSTACLE_RIM};
use crate::paint::picture::{Anchor, Area, Picture, Point, Stroke, shortened};
use crate::plot::axes::{Axes, Axis, FRAME, Shown, TICK_TEXT};
use crate::plot::sheet::{Entry, Sheet, Symbol};

/// Width of the plot (px).
const WIDTH: f64 = 820.0;
/// Height of the row of a station (px).
const ROW: f64 = 24.0;
/// Stations that are drawn, at most.
const MOST_ROWS: usize = 40;
/// Longest name of a station (px).
const LONGEST_NAME: f64 = 64.0;
/// Airtimes before and after the first collision, or the first transmission, that are shown by default.
const AROUND: (f64, f64) = (8.0, 16.0);
/// A bar is at least this wide (px).
const LEAST_PX: f64 = 2.0;

/// What a bar means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bar {
    Backoff,
    IdleAssessment,
    BusyAssessment,
    Received,
    Collided,
    Lost,
    Acknowledgement,
    Unanswered,
}

const BARS: [(Bar, RGBColor, &str); 8] = [
    (Bar::Backoff, OBSTACLE, "backoff"),
    (Bar::IdleAssessment, CURVES[4], "channel found idle, until the frame begins"),
    (Bar::BusyAssessment, INK, "channel found busy"),
    (Bar::Received, CURVES[2], "frame received"),
    (Bar::Collided, CURVES[1], "frame lost to a collision"),
    (Bar::Lost, CURVES[3], "frame lost otherwise"),
    (Bar::Acknowledgement, CURVES[0], "acknowledgement received"),
    (Bar::Unanswered, OBSTACLE_RIM, "no acknowledgement"),
];

/// A bar of a station (s).
struct Span {
    bar: Bar,
    from_s: f64,
    to_s: f64,
}

/// The figure; `None` if nothing was sent or assessed.
pub(super) fn draw(source: &PacketSource<'_>) -> Option<Picture> {
    let (from_s, to_s) = window(source)?;
    let is_shown = |span: &Span| span.to_s >= from_s && span.from_s <= to_s;
    let mut rows: Vec<(u32, Vec<Span>)> = Vec::new();
    let sources: BTreeSet<u32> = source.packets.iter().map(|packet| packet.packet.source).collect();
    for station in sources {
        let own = source.packets.iter().filter(|packet| packet.packet.source == station);
        let near = own
            .filter(|packet| seconds(packet.packet.ended_ns) >= from_s && seconds(packet.packet.offered_ns) <= to_s);
        let spans: Vec<_> = near.flat_map(spans).filter(is_shown).collect();
        if !spans.is_empty() {
            rows.push((station, spans));
        }
    }
    let stations = rows.len();
    rows.truncate(MOST_ROWS);
    let shown: BTreeSet<usize> =
        rows.iter().flat_map(|(_, spans)| spans).filter_map(|span| place(span.bar)).collect();
    let legend = shown
        .iter()
        .map(|&bar| Entry { symbol: Symbol::Square { side: 12.0, fill: BARS[bar].1 }, text: BARS[bar].2.to_owned() });
    let more =
        if stations > rows.len() { format!("; {} more stations", stations - rows.len()) } else { String::new() };
    let sheet = Sheet {
        title: format!("{}: time line", source.title),
        note: format!("{from_s:.4} s to {to_s:.4} s, one row a station{more}"),
        bar: None,
        legend: legend.collect(),
    };
    let (mut picture, areas) = sheet.lay_out(&[(WIDTH, ROW * rows.len().max(1) as f64)]);
    let axes = Axes {
        across: Axis {
            low: 0.0,
            high: 1e3 * (to_s - from_s),
            name: format!("time after {from_s:.4} s (ms)"),
            shown: Shown::All,
        },
        up: Axis { low: 0.0, high: 0.0, name: String::new(), shown: Shown::All },
        area: areas[0],
    };
    let rows_axes = Axes { up: Axis { high: rows.len().max(1) as f64, ..axes.up.clone() }, ..axes };
    for (row, (station, spans)) in rows.iter().enumerate() {
        let top = areas[0].top + ROW * row as f64;
        let middle = top + ROW / 2.0;
        picture.line(Point::new(areas[0].left, middle), Point::new(areas[0].right(), middle), Stroke::new(GRID, 1.0));
        for span in spans {
            let x = |s: f64| rows_axes.at(1e3 * (s.clamp(from_s, to_s) - from_s), 0.0).x;
            let (left, right) = (x(span.from_s), x(span.to_s));
            let half = if span.bar == Bar::Backoff { ROW * 0.15 } else { ROW * 0.36 };
            let Some((_, color, _)) = place(span.bar).and_then(|bar| BARS.get(bar)) else { continue };
            let width = (right - left).max(LEAST_PX);
            picture.rectangle(Area { left, top: middle - half, width, height: 2.0 * half }, *color);
        }
        let name = shortened(&source.name(*station), LONGEST_NAME, TICK_TEXT);
        picture.text(Point::new(areas[0].left - 8.0, middle), &name, Anchor::End, TICK_TEXT);
    }
    picture.frame(areas[0], FRAME);
    draw_times(&rows_axes, &mut picture);
    Some(picture)
}

fn place(bar: Bar) -> Option<usize> {
    BARS.iter().position(|(other, _, _)| *other == bar)
}

/// Draws the ticks of the times and the name of their axis: rows have names instead of numbers.
fn draw_times(axes: &Axes, picture: &mut Picture) {
    let low = Axes { up: Axis { low: 0.0, high: 0.0, ..axes.up.clone() }, ..axes.clone() };
    low.draw(picture);
}

/// The window that is shown (s); `None` if nothing was sent.
fn window(source: &PacketSource<'_>) -> Option<(f64, f64)> {
    let TimeWindow { from_s, to_s } = source.window;
    let all = || source.packets.iter().flat_map(|packet| &packet.transmissions);
    let first = |is: &dyn Fn(&str) -> bool| {
        let sent = all().filter(|sent| is(&sent.outcome)).min_by_key(|sent| sent.start_ns)?;
        Some((seconds(sent.start_ns), seconds(sent.airtime_ns)))
    };
    let (start_s, airtime_s) = first(&|outcome| outcome == "collided").or_else(|| first(&|_| true))?;
    let default_from = (start_s - AROUND.0 * airtime_s).max(0.0);
    let span = (AROUND.0 + AROUND.1) * airtime_s;
    let from = from_s.unwrap_or_else(|| to_s.map_or(default_from, |to_s| (to_s - span).max(0.0)));
    let to = to_s.unwrap_or(from + span);
    (to > from).then_some((from, to))
}

/// The bars of a packet.
fn spans(packet: &RecordedPacket) -> Vec<Span> {
    let mut spans = Vec::new();
    let mut add = |bar, from_ns: u64, to_ns: u64| {
        spans.push(Span { bar, from_s: seconds(from_ns), to_s: seconds(to_ns) });
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
    let is_acknowledged = packet.packet.destination.is_some();
    for (i, sent) in packet.transmissions.iter().enumerate() {
        let end = sent.start_ns + sent.airtime_ns;
        let bar = match sent.outcome.as_str() {
            "received" => Bar::Received,
            "collided" => Bar::Collided,
            _ => Bar::Lost,
        };
        add(bar, sent.start_ns, end);
        let is_last = i + 1 == packet.transmissions.len();
        match sent.acknowledged_ns {
            Some(acknowledged) => add(Bar::Acknowledgement, end, acknowledged),
            None if is_acknowledged && packet.packet.kind == "data" => {
                let next = packet.assessments.iter().map(|next| next.backoff_ns).find(|&next| next >= end);
                let until = next.filter(|_| !is_last).unwrap_or(packet.packet.ended_ns);
                add(Bar::Unanswered, end, until.max(end));
            }
            None => {}
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use sextant_recording::messages::{AssessmentMessage, TransmissionMessage};

    use super::*;

    fn packet() -> RecordedPacket {
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
            acknowledged_ns: Some(3_696_000),
            ..TransmissionMessage::default()
        }];
        packet
    }

    #[test]
    fn the_bars_of_a_packet_follow_each_other() {
        let bars: Vec<_> = spans(&packet()).into_iter().map(|span| (span.bar, span.from_s, span.to_s)).collect();
        let expected = [
            (Bar::Backoff, 0.0, 0.001),
            (Bar::BusyAssessment, 0.001, 0.001_128),
            (Bar::Backoff, 0.001_128, 0.002),
            (Bar::IdleAssessment, 0.002, 0.002_32),
            (Bar::Received, 0.002_32, 0.003_152),
            (Bar::Acknowledgement, 0.003_152, 0.003_696),
        ];
        assert_eq!(bars, expected);
    }

    #[test]
    fn a_time_line_shows_the_window_that_is_asked_for() {
        let packets = [packet()];
        let at = |from_s, to_s| PacketSource {
            title: "t",
            names: &[],
            packets: &packets,
            traffic: &[],
            window: TimeWindow { from_s, to_s },
        };
        assert_eq!(window(&at(Some(1.0), Some(2.0))), Some((1.0, 2.0)));
        assert_eq!(window(&at(Some(2.0), Some(1.0))), None);
        let (from, to) = window(&at(None, None)).unwrap();
        assert!(from < 0.002_32 && to > 0.003_152, "{from} to {to}");
    }
}
