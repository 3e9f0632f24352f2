//! Figures of the packet trace of a recording.

mod delays;
mod end_to_end;
mod outcomes;
mod summary;
mod time_line;

use sextant_recording::{RecordedActivity, RecordedPacket, RecordedTraffic, RecordedWorld};

use crate::paint::file::Figure;

/// What is known of the packets of a recording.
#[derive(Clone, Copy, Debug)]
pub struct PacketSource<'a> {
    /// The beginning of all titles.
    pub title: &'a str,
    /// The names of the stations: nodes come first, then robots, then sinks.
    pub names: &'a [String],
    /// The tree and the batteries, if there are any.
    pub drawn: &'a RecordedWorld,
    /// The packets; none if they were not recorded.
    pub packets: &'a [RecordedPacket],
    /// What radios did besides.
    pub activity: &'a RecordedActivity,
    /// What the summary says of the traffic, for recordings without packets.
    pub traffic: &'a [RecordedTraffic],
    /// The instants that the time line shows.
    pub window: TimeWindow,
}

/// A part of the simulated time (s). Without both ends, the way of a packet over most hops is shown, or else the first busy time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimeWindow {
    /// Its start.
    pub from_s: Option<f64>,
    /// Its end.
    pub to_s: Option<f64>,
}

impl PacketSource<'_> {
    /// The name of a station.
    fn name(&self, station: u32) -> String {
        self.names.get(station as usize).cloned().unwrap_or_else(|| format!("station {station}"))
    }
}

/// What a packet of the trace, or of the traffic in the summary, is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Span {
    /// From the node that has it to its receiver.
    Whole,
    /// One hop of a way over several.
    Hop,
}

impl Span {
    fn of(source: &PacketSource<'_>) -> Self {
        let has_hops = || source.packets.iter().any(|packet| packet.hop.is_some());
        if !source.drawn.tree.is_empty() || has_hops() { Self::Hop } else { Self::Whole }
    }

    /// The end of what a title says of packets.
    fn of_packets(self) -> &'static str {
        match self {
            Self::Whole => "packets",
            Self::Hop => "packets on each hop",
        }
    }

    /// What shares are of.
    fn offered(self) -> &'static str {
        match self {
            Self::Whole => "share of the packets offered",
            Self::Hop => "share of the packets offered on a hop: a packet over several hops counts on each",
        }
    }

    /// The same of delays, with how they are known.
    fn delivered(self, how: &str) -> String {
        match self {
            Self::Whole => format!("share of the delivered packets with at most this time{how}"),
            Self::Hop => format!(
                "share of the packets delivered on a hop with at most this time on it{how}: a packet over several hops counts on each"
            ),
        }
    }
}

/// All figures of the packets: `delay-cdf`, `delay-end-to-end`, `outcomes-by-node`, `outcomes-over-time` and `time-line`.
/// Delays and outcomes by node are those of the summary if there are no packets. Where packets go over several hops, all but
/// the second are of each hop. Only those that have something to show.
#[must_use]
pub fn of_packets(source: &PacketSource<'_>) -> Vec<Figure> {
    let &PacketSource { title, traffic, .. } = source;
    let span = Span::of(source);
    let pictures = [
        ("delay-cdf", delays::draw(source, span).or_else(|| summary::delays(title, span, traffic))),
        ("delay-end-to-end", end_to_end::draw(source)),
        ("outcomes-by-node", outcomes::by_node(source, span).or_else(|| summary::by_node(title, span, traffic))),
        ("outcomes-over-time", outcomes::over_time(source, span)),
        ("time-line", time_line::draw(source)),
    ];
    let figure = |(name, picture): (&str, Option<_>)| Some(Figure { name: name.to_owned(), picture: picture? });
    pictures.into_iter().filter_map(figure).collect()
}

/// Nanoseconds as seconds.
fn seconds(nanos: u64) -> f64 {
    nanos as f64 / 1e9
}
