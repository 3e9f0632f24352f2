//! Figures of the packet trace of a recording.

mod delays;
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

/// All figures of the packets: `delay-cdf`, `outcomes-by-node`, `outcomes-over-time` and `time-line`. The first two are
/// those of the summary if there are no packets. Only those that have something to show.
#[must_use]
pub fn of_packets(source: &PacketSource<'_>) -> Vec<Figure> {
    let &PacketSource { title, traffic, .. } = source;
    let pictures = [
        ("delay-cdf", delays::draw(source).or_else(|| summary::delays(title, traffic))),
        ("outcomes-by-node", outcomes::by_node(source).or_else(|| summary::by_node(title, traffic))),
        ("outcomes-over-time", outcomes::over_time(source)),
        ("time-line", time_line::draw(source)),
    ];
    let figure = |(name, picture): (&str, Option<_>)| Some(Figure { name: name.to_owned(), picture: picture? });
    pictures.into_iter().filter_map(figure).collect()
}

/// Nanoseconds as seconds.
fn seconds(nanos: u64) -> f64 {
    nanos as f64 / 1e9
}
