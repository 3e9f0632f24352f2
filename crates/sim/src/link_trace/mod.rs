//! The links of a network as they were measured: the table of a scenario, and its rows by station.

mod rows;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sextant_channel::{Dbm, LinkTrace, OtherLinks, TracedLink};
use sextant_kernel::{Files, SettingError, SimTime, StationId};

use crate::station::Roll;
use crate::world::layout::PlacedNode;

/// Links as they were measured, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LinkTraceConfig {
    /// A CSV file with the columns `t_s`, `from`, `to`, optionally `channel`, and `prr`, `rssi_dbm` or both; or a file in the
    /// format K7. Each row holds until the next one of its link. `from` and `to` are nodes or sinks, and a link has both
    /// directions only if both have rows.
    pub file: PathBuf,
    /// What links without rows are.
    #[serde(default)]
    pub others: OtherLinksConfig,
}

/// What links without rows are, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum OtherLinksConfig {
    /// Nothing is heard over them.
    #[default]
    Silent,
    /// They follow the law of the channel, for example those to robots.
    Law,
}

/// The measured links of a network, by node and sink.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkTrace {
    rows: Vec<TraceRow>,
    others: OtherLinks,
}

/// The stations that a trace may name.
#[derive(Clone, Copy, Debug)]
pub struct TraceStations<'a> {
    /// The nodes.
    pub nodes: &'a [PlacedNode],
    /// The names of the sinks.
    pub sinks: &'a [&'a str],
    /// The radio channels of the network: rows of others are left out. If there are several, a row counts on its channel alone.
    pub channels: &'a [u8],
}

/// A station that a trace names, by its number among its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum TraceEnd {
    Node(usize),
    Sink(usize),
}

/// What was measured on a link from a time on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TraceRow {
    since: SimTime,
    from: TraceEnd,
    to: TraceEnd,
    /// The only radio channel on which it counts, if the network has several.
    channel: Option<u8>,
    link: TracedLink,
}

impl LinkTraceConfig {
    /// Reads the file, whose path is among `files`.
    ///
    /// # Errors
    /// If it cannot be read, has rows of channels but none of one of the network, or a row is invalid. The key is `file`.
    pub fn read(&self, stations: &TraceStations<'_>, files: &Files) -> Result<NetworkTrace, SettingError> {
        let path = files.path(&self.file);
        let text = files.read_text(&self.file).map_err(|error| {
            let allowed = "a text file that can be read; unpack it if it is compressed";
            SettingError::new("file", format!("`{}`: {error}", path.display()), allowed)
        })?;
        let rows = rows::read(&text, &self.file.display().to_string(), stations)
            .map_err(|error| files.discreet(&self.file, error))?;
        let others = match self.others {
            OtherLinksConfig::Silent => OtherLinks::Silent,
            OtherLinksConfig::Law => OtherLinks::Law,
        };
        Ok(NetworkTrace { rows, others })
    }
}

impl NetworkTrace {
    /// The last instant at which a link was measured.
    #[must_use]
    pub fn end(&self) -> SimTime {
        self.rows.iter().map(|row| row.since).max().unwrap_or_default()
    }

    /// Whether links without rows follow the law of the channel.
    #[must_use]
    pub fn leaves_others(&self) -> bool {
        self.others == OtherLinks::Law
    }

    /// The trace on a radio channel among the stations of `roll`. Links with a share of frames that arrive have at least the strength `least`.
    pub(crate) fn of(&self, roll: &Roll, channel: u8, least: Dbm) -> LinkTrace {
        let station = |end: TraceEnd| match end {
            TraceEnd::Node(node) => (node < roll.nodes).then(|| StationId::from_index(node)),
            TraceEnd::Sink(sink) => {
                (sink < roll.sinks).then(|| StationId::from_index(roll.nodes + roll.robots + sink))
            }
        };
        let mut trace = LinkTrace::new(self.others, least);
        for row in self.rows.iter().filter(|row| row.channel.is_none_or(|own| own == channel)) {
            if let (Some(from), Some(to)) = (station(row.from), station(row.to)) {
                trace.add(from, to, row.since, row.link);
            }
        }
        trace
    }
}
