//! The writer of recordings.

mod applications;
mod compact;
mod detail;
mod drawings;
mod file;
mod packets;
mod playing;
mod relay;
mod sensing;
mod so_far;

pub use file::FileRecorder;
pub use relay::Relay;
pub use so_far::RecordingSoFar;

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use foxglove::Encode;
use foxglove::messages::{Log, log::Level};
use mcap::Attachment;
use mcap::records::{MessageHeader, Metadata};
use sextant_channel::{
    Anchor, Contact, Dbm, HeardAtStop, Link, NeighbourLog, Position, RangeSample, Reception, ReceptionLog,
    SectorReport, SectorTable, Stop,
};
use sextant_kernel::SimTime;

use self::detail::Detail;
use super::drawing;
use super::error::RecordingError;
use super::link_quality::link_quality;
use super::messages;
use crate::container::sink::Sink;
use crate::messages::names::{
    ANCHORS_TOPIC, BEACONS_TOPIC, FILES_ATTACHMENTS, FRAMES_TOPIC, LINKS_KEY, LogTopics, MAPPED_NODES_TOPIC,
    NEIGHBOURS_TOPIC, NETWORKS_TOPIC, ORIGIN_METADATA, SCENARIO_ATTACHMENT, SUMMARY_ATTACHMENT,
};

/// A chunk is closed after this many stops, even if it has few messages.
const STOPS_PER_CHUNK: u32 = 32;

/// The origin of a recording. Its bytes depend on the origin and the text of the scenario alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin<'a> {
    /// Name of the scenario.
    pub scenario: &'a str,
    /// Seed of the run.
    pub seed: u64,
    /// Version of the program.
    pub version: &'a str,
}

/// Writes a recording. Each call may fail. After the first failure, every call returns the same failure.
/// [`FileRecorder::finish`] completes the recording; without it, the data stays in `PATH.part`.
pub struct Recorder<W: Write> {
    sink: Sink<W>,
    /// Channel and number of messages so far, by topic.
    topics: BTreeMap<String, (u16, u32)>,
    encoded: Vec<u8>,
    stops_in_chunk: u32,
    detail: Detail,
    /// Sensitivity of the robots' radios by the name of a log; that of the first log has none.
    sensitivities: BTreeMap<Option<String>, Dbm>,
    /// Who else gets what is written.
    relay: Option<Box<dyn Relay>>,
}

impl<W: Write> Recorder<W> {
    /// A recorder that writes to `output`; `name` is its name in errors.
    ///
    /// # Errors
    /// If the header cannot be written.
    pub fn new(output: W, name: &Path) -> Result<Self, RecordingError> {
        Sink::new(output, name).map(Self::from_sink)
    }

    fn from_sink(sink: Sink<W>) -> Self {
        Self {
            sink,
            topics: BTreeMap::new(),
            encoded: Vec::new(),
            stops_in_chunk: 0,
            detail: Detail::default(),
            sensitivities: BTreeMap::new(),
            relay: None,
        }
    }

    /// From now on, `relay` gets what is written too. Call it before the first message.
    pub fn set_relay(&mut self, relay: Box<dyn Relay>) {
        self.relay = Some(relay);
    }

    /// Writes the summary section and returns the output.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn into_output(self) -> Result<W, RecordingError> {
        self.sink.finish()
    }

    /// Writes the origin of the recording, as the first record after the header.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn origin(&mut self, origin: Origin<'_>) -> Result<(), RecordingError> {
        let Origin { scenario, seed, version } = origin;
        let values = [("scenario", scenario.to_owned()), ("seed", seed.to_string()), ("version", version.to_owned())];
        self.describe(&Metadata {
            name: ORIGIN_METADATA.to_owned(),
            metadata: values.map(|(key, value)| (key.to_owned(), value)).into(),
        })
    }

    /// Writes the text of the scenario with all overrides (TOML).
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn scenario(&mut self, toml: &str) -> Result<(), RecordingError> {
        self.attach(SCENARIO_ATTACHMENT, "application/toml", toml.as_bytes())
    }

    /// Writes a file that the scenario names, so that the recording says all; `path` is as written there.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn named_file(&mut self, path: &str, content: &[u8]) -> Result<(), RecordingError> {
        self.attach(&format!("{FILES_ATTACHMENTS}{path}"), "application/octet-stream", content)
    }

    /// Writes the summary (JSON). Leave out its `timing`, so that the recording depends on scenario, seed and version
    /// alone.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn summary(&mut self, json: &str) -> Result<(), RecordingError> {
        self.attach(SUMMARY_ATTACHMENT, "application/json", json.as_bytes())
    }

    fn attach(&mut self, name: &str, media_type: &str, data: &[u8]) -> Result<(), RecordingError> {
        self.sink.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: data.into(),
        })?;
        if let Some(relay) = &mut self.relay {
            relay.attachment(name, media_type, data);
        }
        Ok(())
    }

    /// Writes what is known by name.
    fn describe(&mut self, metadata: &Metadata) -> Result<(), RecordingError> {
        self.sink.metadata(metadata)?;
        if let Some(relay) = &mut self.relay {
            relay.metadata(&metadata.name, &metadata.metadata);
        }
        Ok(())
    }

    /// Writes the names of all nodes that the robots know (index = `NodeId`). Call it before the first stop.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn nodes(&mut self, names: &[String]) -> Result<(), RecordingError> {
        self.write(SimTime::ZERO, "/nodes", &messages::NodesMessage { first: 0, names: names.to_vec() })
    }

    /// Writes the receptions of hello packets between nodes before the survey.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn neighbours(&mut self, log: &NeighbourLog) -> Result<(), RecordingError> {
        self.links(NEIGHBOURS_TOPIC, log)
    }

    /// Writes the receptions of the anchors' packets by nodes before the survey.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn beacons(&mut self, log: &NeighbourLog) -> Result<(), RecordingError> {
        self.links(BEACONS_TOPIC, log)
    }

    fn links(&mut self, topic: &str, log: &NeighbourLog) -> Result<(), RecordingError> {
        if log.links().is_empty() {
            // Without a message there is no topic: that nobody was heard is another thing than that nobody listened.
            let values = BTreeMap::from([(LINKS_KEY.to_owned(), "0".to_owned())]);
            self.describe(&Metadata { name: topic.to_owned(), metadata: values })?;
        }
        log.links().iter().try_for_each(|&Link { listener, sender, received, sent, rssi_dbm }| {
            let message = messages::LinkMessage { listener: listener.0, sender: sender.0, received, sent, rssi_dbm };
            self.write(SimTime::ZERO, topic, &message)
        })
    }

    /// Writes the nodes that know their position.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn anchors(&mut self, anchors: &[Anchor]) -> Result<(), RecordingError> {
        anchors.iter().try_for_each(|&Anchor { node, position: Position { x_m, y_m, z_m } }| {
            let message = messages::AnchorMessage { node: node.0, x_m, y_m, z_m };
            self.write(SimTime::ZERO, ANCHORS_TOPIC, &message)
        })
    }

    /// Writes the names of the networks that robots survey, if there are several: the log of the first one has the topics
    /// of a log of one network.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn networks(&mut self, names: &[String]) -> Result<(), RecordingError> {
        self.write(SimTime::ZERO, NETWORKS_TOPIC, &messages::NetworksMessage { names: names.to_vec() })
    }

    /// Writes the directions of the sectors of the robots, and their gains if they are known, in the log of the first network
    /// or of the one called `other`. Call it once, before the first stop.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn sectors(&mut self, other: Option<&str>, sectors: &SectorTable) -> Result<(), RecordingError> {
        let LogTopics { sectors: directions, sector_gains, .. } = LogTopics::new(other);
        for sector in sectors.iter() {
            self.write(SimTime::ZERO, &directions, &messages::SectorMessage::from(sector))?;
        }
        match sectors.gains().and_then(messages::SectorGainsMessage::new) {
            Some(message) => self.write(SimTime::ZERO, &sector_gains, &message),
            None => Ok(()),
        }
    }

    /// The robots' radios in the log `other`, or in the first one, are of IEEE 802.15.4 with this sensitivity: their
    /// receptions are recorded with a link quality.
    pub fn set_sensitivity(&mut self, other: Option<&str>, sensitivity: Dbm) {
        self.sensitivities.insert(other.map(str::to_owned), sensitivity);
    }

    /// Writes a stop and all that was `heard` there, in the log of the first network or of the one called `other`. The stops
    /// of a log are numbered from 0 in the order of the calls, and `heard` refers to that number. A chunk never ends within a
    /// stop, so that a crash loses complete stops only.
    ///
    /// # Errors
    /// If any write failed, now or before.
    ///
    /// # Panics
    /// If there are 2³² receptions.
    pub fn stop<'a>(
        &mut self,
        other: Option<&str>,
        robot: &str,
        index: u32,
        stop: &Stop,
        heard: impl Into<HeardAtStop<'a>>,
    ) -> Result<(), RecordingError> {
        let HeardAtStop { receptions, reports, ranges } = heard.into();
        let Position { x_m, y_m, z_m } = stop.position;
        let topics = LogTopics::new(other);
        let message = messages::StopMessage {
            stop: index,
            time_ns: stop.time.as_nanos(),
            x_m,
            y_m,
            z_m,
            robot: robot.to_owned(),
            receptions: u32::try_from(receptions.len()).expect("fewer than 2^32 receptions"),
            heading_rad: stop.heading_rad,
        };
        self.append(stop.time, &topics.stops, &message)?;
        // Before the receptions, which complete the stop.
        if !reports.is_empty() {
            self.append(stop.time, &topics.sector_snrs, &messages::SectorSnrsMessage::new(index, reports))?;
        }
        for sample in ranges {
            self.append(stop.time, &topics.ranges, &messages::RangeMessage::new(index, sample))?;
        }
        let sensitivity = self.sensitivities.get(&other.map(str::to_owned)).copied();
        if self.detail == Detail::Compact && !receptions.is_empty() {
            let message = messages::StopReceptionsMessage::new(index, receptions, sensitivity);
            self.append(stop.time, &topics.receptions, &message)?;
            return self.end_stop();
        }
        for &Reception { node, stop: at, received, sent, sector, rssi_dbm, snr_db } in receptions {
            let lqi = rssi_dbm.zip(sensitivity).map(|(dbm, sensitivity)| link_quality(Dbm(dbm), sensitivity).into());
            let message = messages::ReceptionMessage {
                node: node.0,
                stop: at,
                received,
                sent,
                sector: sector.map(u32::from),
                rssi_dbm,
                snr_db,
                lqi,
            };
            self.append(stop.time, &topics.receptions, &message)?;
        }
        self.end_stop()
    }

    /// Ends a stop, after which a chunk may end.
    fn end_stop(&mut self) -> Result<(), RecordingError> {
        self.stops_in_chunk += 1;
        if self.stops_in_chunk >= STOPS_PER_CHUNK {
            self.stops_in_chunk = 0;
            return self.sink.end_chunk();
        }
        self.sink.settle()
    }

    /// Writes a point of an obstacle that the range sensor of `robot` detected.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn contact(&mut self, robot: &str, contact: &Contact) -> Result<(), RecordingError> {
        let Position { x_m, y_m, z_m } = contact.position;
        let message = messages::ContactMessage { time_ns: contact.time.as_nanos(), x_m, y_m, z_m };
        self.write(contact.time, &format!("/robot/{robot}/contacts"), &message)
    }

    /// Writes a complete reception log: names, sectors, stops with receptions, contacts.
    ///
    /// # Errors
    /// If any write failed, now or before.
    ///
    /// # Panics
    /// If the log has 2³² stops.
    pub fn log(&mut self, log: &ReceptionLog) -> Result<(), RecordingError> {
        self.nodes(log.names())?;
        if let Some(sectors) = log.sectors() {
            self.sectors(None, sectors)?;
        }
        let mut by_stop = log.receptions().to_vec();
        by_stop.sort_by_key(|reception| (reception.stop, reception.node));
        let mut reports: Vec<SectorReport> = log.sector_reports().collect();
        reports.sort_by_key(|report| (report.stop, report.node));
        let mut ranges: Vec<(u32, RangeSample)> =
            log.stops_of_ranges().into_iter().zip(log.ranges().iter().copied()).collect();
        ranges.sort_by_key(|&(stop, sample)| (stop, sample.time, sample.node));
        let mut rest_of_ranges = ranges.as_slice();
        let (mut rest, mut rest_of_reports) = (by_stop.as_slice(), reports.as_slice());
        for (index, stop) in log.stops().iter().enumerate() {
            let index = u32::try_from(index).expect("fewer than 2^32 stops");
            let (here, later) = rest.split_at(rest.partition_point(|reception| reception.stop <= index));
            let of_stop = rest_of_reports.partition_point(|report| report.stop <= index);
            let (reports, later_reports) = rest_of_reports.split_at(of_stop);
            let (of_stop, later_ranges) =
                rest_of_ranges.split_at(rest_of_ranges.partition_point(|&(stop, _)| stop <= index));
            let ranges: Vec<RangeSample> = of_stop.iter().map(|&(_, sample)| sample).collect();
            rest_of_ranges = later_ranges;
            let heard = HeardAtStop { receptions: here, reports, ranges: &ranges };
            self.stop(None, &log.robot_name(stop.robot), index, stop, heard)?;
            (rest, rest_of_reports) = (later, later_reports);
        }
        log.contacts().iter().try_for_each(|contact| self.contact(&log.robot_name(contact.robot), contact))
    }

    /// Writes what a node found that computed its own place.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn mapped_node(&mut self, time: SimTime, node: &messages::MappedNodeMessage) -> Result<(), RecordingError> {
        self.write(time, MAPPED_NODES_TOPIC, node)
    }

    /// Writes a frame, at the time of its end.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn frame(&mut self, frame: &messages::FrameMessage) -> Result<(), RecordingError> {
        self.write(SimTime::from_nanos(frame.start_ns.saturating_add(frame.airtime_ns)), FRAMES_TOPIC, frame)
    }

    /// Writes one value of the time series `name`, which ends in its unit.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn metric(&mut self, time: SimTime, name: &str, value: f64) -> Result<(), RecordingError> {
        self.write(
            time,
            "/metrics",
            &messages::MetricMessage { time_ns: time.as_nanos(), name: name.to_owned(), value },
        )
    }

    /// Writes a text message from the part of the program called `source`.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn note(&mut self, time: SimTime, level: Level, source: &str, message: &str) -> Result<(), RecordingError> {
        let log = Log {
            timestamp: Some(drawing::timestamp(time)),
            level: level.into(),
            message: message.to_owned(),
            name: source.to_owned(),
            ..Log::default()
        };
        self.write(time, "/log", &log)
    }

    /// Writes a message after which a chunk may end.
    fn write<M: Encode + prost::Message>(
        &mut self,
        time: SimTime,
        topic: &str,
        message: &M,
    ) -> Result<(), RecordingError> {
        self.append(time, topic, message)?;
        self.sink.settle()
    }

    fn append<M: Encode + prost::Message>(
        &mut self,
        time: SimTime,
        topic: &str,
        message: &M,
    ) -> Result<(), RecordingError> {
        if !self.topics.contains_key(topic) {
            let schema = M::get_schema().expect("every recorded message has a schema");
            let channel = self.sink.channel(topic, &schema)?;
            self.topics.insert(topic.to_owned(), (channel, 0));
            if let Some(relay) = &mut self.relay {
                relay.channel(channel, topic, &schema);
            }
        }
        let (channel_id, sequence) = self.topics.get_mut(topic).expect("the topic was added above");
        let time_ns = time.as_nanos();
        let channel_id = *channel_id;
        let header = MessageHeader { channel_id, sequence: *sequence, log_time: time_ns, publish_time: time_ns };
        *sequence = sequence.wrapping_add(1);
        self.encoded.clear();
        prost::Message::encode(message, &mut self.encoded).expect("a vector has room");
        self.sink.message(&header, &self.encoded)?;
        if let Some(relay) = &mut self.relay {
            relay.message(channel_id, time, &self.encoded);
        }
        Ok(())
    }
}
