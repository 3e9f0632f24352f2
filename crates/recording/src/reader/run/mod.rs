//! Reads from a recording what mappers, metrics and figures need.

mod log_draft;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::reader::robot_names::RobotNames;
use foxglove::messages::PointCloud;
use prost::Message as _;
use sextant_channel::{Contact, LogError, NetworkLog, NetworkLogs, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::text::{choices, counted};
use sextant_kernel::{Files, NodeId, SimTime};

use super::recorded_summary::{ClaimedObstacle, RecordedMap, RecordedSummary};
use crate::drawing;
use crate::error::RecordingError;
use crate::mcap_file::{Piece, scan};
use crate::messages;
use crate::messages::names::{
    FILES_ATTACHMENTS, GAP_METADATA, LogTopics, RECOVERED_METADATA, SUMMARY_ATTACHMENT, WORLD_NODES_TOPIC,
};
use log_draft::LogDraft;

/// The reception log of a recording, with its metadata and attachments.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedRun {
    /// The reception logs of the networks that robots surveyed.
    pub logs: NetworkLogs,
    /// The paths of the robots, by name; empty if the recording is incomplete.
    pub paths: Vec<(String, Vec<Position>)>,
    /// Number of stops of a recovered recording that are missing between others, or are ignored because receptions of them are
    /// missing: a missing reception would mean that nothing was heard.
    pub missing_stops: usize,
    /// Whether signal-to-noise ratios of all sectors were left out, because receptions were passed on one by one.
    pub leaves_out_sector_snrs: bool,
    /// Whether ranges were left out, for the same reason.
    pub leaves_out_ranges: bool,
    /// Metadata records by name. A recording of `run` has [`crate::ORIGIN_METADATA`].
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Attachments in the order of the file.
    pub attachments: Vec<Attachment>,
}

impl RecordedRun {
    /// The reception log, of the first network if robots surveyed several.
    #[must_use]
    pub fn log(&self) -> &ReceptionLog {
        self.logs.first()
    }

    /// What the user should know of a log that is incomplete.
    #[must_use]
    pub fn concern(&self) -> Option<String> {
        concern(self.missing_stops, self.metadata.get(RECOVERED_METADATA))
    }

    /// The obstacles that each map in the summary claims, by its name; none of a map without any.
    #[must_use]
    pub fn claimed_obstacles(&self) -> Vec<(String, Vec<ClaimedObstacle>)> {
        let claims = |map: RecordedMap| (map.name(), map.calibration.obstacles);
        self.recorded_maps().into_iter().map(claims).filter(|(_, obstacles)| !obstacles.is_empty()).collect()
    }

    /// Shares of the nodes by sector displacement, of each map in the summary that has them, by its name.
    #[must_use]
    pub fn sector_displacements(&self) -> Vec<(String, Vec<f64>)> {
        let shares = |map: RecordedMap| (map.name(), map.sector_displacement);
        self.recorded_maps().into_iter().map(shares).filter(|(_, shares)| !shares.is_empty()).collect()
    }

    /// The maps in the summary; none if there is no summary.
    fn recorded_maps(&self) -> Vec<RecordedMap> {
        let summary = self.attachment(SUMMARY_ATTACHMENT).map(|attachment| &attachment.data);
        let summary = summary.and_then(|data| serde_json::from_slice::<RecordedSummary>(data).ok());
        summary.map(|summary| summary.maps).unwrap_or_default()
    }

    /// The last attachment with this `name`.
    #[must_use]
    pub fn attachment(&self, name: &str) -> Option<&Attachment> {
        self.attachments.iter().rfind(|attachment| attachment.name == name)
    }

    /// The files that the scenario names, by their paths as written there.
    #[must_use]
    pub fn files(&self) -> Files {
        let file = |attachment: &Attachment| {
            let path = attachment.name.strip_prefix(FILES_ATTACHMENTS)?;
            Some((PathBuf::from(path), attachment.data.clone()))
        };
        Files::Attached(Arc::new(self.attachments.iter().filter_map(file).collect()))
    }
}

/// What the user should know of a recording without so many of its stops, which was `recovered` if it has this record.
pub(crate) fn concern(missing_stops: usize, recovered: Option<&BTreeMap<String, String>>) -> Option<String> {
    let missing = (missing_stops > 0).then(|| {
        let stops = counted(missing_stops, "stop");
        format!("the recording is incomplete: {stops} left out, because messages are missing")
    });
    let recovered = recovered.map(|damage| {
        let at = damage.get("at_byte").map_or_else(String::new, |at| format!(" at byte {at}"));
        format!("the recording was damaged{at} and recovered: what could not be read is missing here")
    });
    let all: Vec<String> = missing.into_iter().chain(recovered).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// A file within a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub name: String,
    /// Its media type.
    pub media_type: String,
    /// Its octets.
    pub data: Vec<u8>,
}

/// Reads the reception log of the recording `path`, with the names of unheard nodes. Drawings, frames and the true
/// positions of the nodes are skipped. Needs memory for the log and one chunk.
///
/// # Errors
/// If the file cannot be read, is damaged, or holds no reception log.
pub fn read_log(path: &Path) -> Result<RecordedRun, RecordingError> {
    let (run, topics) = read_with(path, None)?;
    with_stops(path, run, &topics)
}

/// The run, if a robot stopped somewhere.
fn with_stops(path: &Path, run: RecordedRun, topics: &[String]) -> Result<RecordedRun, RecordingError> {
    if run.log().stops().is_empty() {
        return Err(RecordingError::NoLog { path: path.to_owned(), topics: choices(topics) });
    }
    Ok(run)
}

/// Takes the receptions of a recording, one by one.
pub type TakeReception<'a> = &'a mut dyn FnMut(Reception, &Stop) -> Result<(), RecordingError>;

/// Reads the recording `path` as [`read_log`] does, but passes the receptions of one network to `take`, each with its stop, in
/// the order of the stops, instead of keeping them: that of `network`, or the first one. The logs of all networks have no
/// receptions then, no signal-to-noise ratios of all sectors and no ranges. Needs memory for the stops, the names, one chunk and the receptions of one stop.
///
/// # Errors
/// Those of [`read_log`], and the first error of `take`.
pub fn stream_log(
    path: &Path,
    network: Option<&str>,
    take: TakeReception<'_>,
) -> Result<RecordedRun, RecordingError> {
    let (run, topics) = read_with(path, Some(Stream { network, take, failed: None }))?;
    with_stops(path, run, &topics)
}

/// Reads the recording `path` of a run, of which no robot may have stopped anywhere.
///
/// # Errors
/// If the file cannot be read or is damaged.
pub fn read_run(path: &Path) -> Result<RecordedRun, RecordingError> {
    read_with(path, None).map(|(run, _)| run)
}

/// Where receptions go instead of into a log.
struct Stream<'a> {
    /// The network whose receptions are passed on; the first one if absent.
    network: Option<&'a str>,
    take: TakeReception<'a>,
    /// The error of whoever took them.
    failed: Option<RecordingError>,
}

/// Reads a recording, and the topics in it.
fn read_with(path: &Path, stream: Option<Stream<'_>>) -> Result<(RecordedRun, Vec<String>), RecordingError> {
    let mut reading = RunReading { draft: RunDraft { stream, ..RunDraft::default() }, ..RunReading::default() };
    sound(path, &mut |piece| reading.take(path, &piece))?;
    let topics = std::mem::take(&mut reading.topics);
    Ok((reading.finish(path)?, topics))
}

/// A run that is being read.
#[derive(Default)]
pub(crate) struct RunReading<'a> {
    draft: RunDraft<'a>,
    topics: Vec<String>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    attachments: Vec<Attachment>,
}

impl RunReading<'_> {
    /// Takes a piece of the recording `path`.
    pub(crate) fn take(&mut self, path: &Path, piece: &Piece<'_>) -> Result<(), RecordingError> {
        match piece {
            Piece::Header { .. } => {}
            Piece::Message { channel, data, .. } => {
                if !self.topics.contains(&channel.topic) {
                    self.topics.push(channel.topic.clone());
                }
                let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
                self.draft.add(&channel.topic, schema, data).map_err(|problem| {
                    let failed = self.draft.stream.as_mut().and_then(|stream| stream.failed.take());
                    failed.unwrap_or_else(|| RecordingError::message(path, &channel.topic, problem))
                })?;
            }
            Piece::Attachment { name, media_type, data } => self.attachments.push(Attachment {
                name: (*name).to_owned(),
                media_type: (*media_type).to_owned(),
                data: data.to_vec(),
            }),
            Piece::Metadata(record) => {
                if record.name.starts_with(GAP_METADATA) {
                    self.draft.logs().for_each(LogDraft::gap);
                }
                self.metadata.insert(record.name.clone(), record.metadata.clone());
            }
        }
        Ok(())
    }

    /// The run, now that all pieces of the recording `path` were taken.
    pub(crate) fn finish(mut self, path: &Path) -> Result<RecordedRun, RecordingError> {
        self.draft.logs().for_each(LogDraft::cut_last_stop);
        let missing_stops = self.draft.logs().map(|log| log.missing_stops).sum();
        let paths = std::mem::take(&mut self.draft.paths);
        let RunDraft { leaves_out_sector_snrs, leaves_out_ranges, .. } = self.draft;
        let logs = self.draft.build().map_err(|why| RecordingError::Log { path: path.to_owned(), why })?;
        let Self { metadata, attachments, .. } = self;
        Ok(RecordedRun {
            logs,
            paths,
            missing_stops,
            leaves_out_sector_snrs,
            leaves_out_ranges,
            metadata,
            attachments,
        })
    }
}

/// Reads the true positions of the nodes of the recording `path`, by name (m); `None` if it does not have them.
///
/// # Errors
/// If the file cannot be read or is damaged.
pub fn read_truth(path: &Path) -> Result<Option<BTreeMap<String, Position>>, RecordingError> {
    let mut names = RunDraft::default();
    let mut places: Option<Vec<(NodeId, Position)>> = None;
    sound(path, &mut |piece| {
        let Piece::Message { channel, data, .. } = piece else {
            return Ok(());
        };
        let wrong = |problem: String| RecordingError::message(path, &channel.topic, problem);
        match (channel.topic.as_str(), channel.schema.as_ref().map(|schema| schema.name.as_str())) {
            (_, Some("sextant.Nodes")) => names.add(&channel.topic, "sextant.Nodes", data).map_err(wrong),
            (WORLD_NODES_TOPIC, Some("foxglove.PointCloud")) => {
                let cloud = PointCloud::decode(data).map_err(|why| wrong(why.to_string()))?;
                places = Some(drawing::nodes_of(&cloud).map_err(wrong)?);
                Ok(())
            }
            _ => Ok(()),
        }
    })?;
    let Some(places) = places else {
        return Ok(None);
    };
    let named = places.into_iter().map(|(node, position)| {
        let name = names.names.get(node.index()).ok_or_else(|| {
            let problem = format!("node {} has no name; the number of names is {}", node.0, names.names.len());
            RecordingError::message(path, WORLD_NODES_TOPIC, problem)
        })?;
        Ok((name.clone(), position))
    });
    named.collect::<Result<_, _>>().map(Some)
}

/// Scans a file and rejects damage.
pub(crate) fn sound(
    path: &Path,
    visit: &mut dyn FnMut(Piece<'_>) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    match scan(path, visit)? {
        None => Ok(()),
        Some(damage) => Err(RecordingError::Broken {
            path: path.to_owned(),
            at_byte: damage.at_byte,
            messages: damage.messages,
            why: damage.why,
        }),
    }
}

/// The reception logs that are being read.
#[derive(Default)]
struct RunDraft<'a> {
    /// Where receptions go, if they are not kept.
    stream: Option<Stream<'a>>,
    names: Vec<String>,
    robots: RobotNames,
    /// The names of the surveyed networks, if there are several.
    networks: Vec<String>,
    log: LogDraft,
    /// The logs of the other networks, by name.
    others: Vec<(String, LogDraft)>,
    contacts: Vec<Contact>,
    paths: Vec<(String, Vec<Position>)>,
    /// Whether whoever takes receptions one by one has missed them.
    leaves_out_sector_snrs: bool,
    leaves_out_ranges: bool,
}

impl RunDraft<'_> {
    /// Adds a message of the given schema, if it is part of a reception log. Returns an error message if it is invalid.
    fn add(&mut self, topic: &str, schema: &str, data: &[u8]) -> Result<(), String> {
        match schema {
            "sextant.Nodes" => self.add_nodes(decode(data)?),
            "sextant.Networks" => {
                let messages::NetworksMessage { names } = decode(data)?;
                names.iter().skip(1).for_each(|name| {
                    self.of(Some(name));
                });
                self.networks = names;
                Ok(())
            }
            "sextant.Stop" => {
                let message: messages::StopMessage = decode(data)?;
                let robot = self.robots.id(&message.robot);
                let position = Position::new(message.x_m, message.y_m, message.z_m);
                let time = SimTime::from_nanos(message.time_ns);
                let stop = Stop { robot, time, position, heading_rad: message.heading_rad };
                self.of(LogTopics::network(topic)).add_stop(&message, stop)
            }
            "sextant.StopReceptions" => {
                let mut message: messages::StopReceptionsMessage = decode(data)?;
                let log = self.of(LogTopics::network(topic));
                if !log.locate(&mut message.stop) {
                    return Ok(());
                }
                log.settle(message.node.len())?;
                message.rows()?.try_for_each(|(reception, _)| self.keep(topic, reception))
            }
            "sextant.Reception" => {
                let mut message: messages::ReceptionMessage = decode(data)?;
                let log = self.of(LogTopics::network(topic));
                if !log.locate(&mut message.stop) {
                    return Ok(());
                }
                let reception = log.reception(&message)?;
                self.keep(topic, reception)
            }
            "sextant.SectorSnrs" => {
                if self.stream.is_some() {
                    self.leaves_out_sector_snrs = true;
                    return Ok(());
                }
                let mut message: messages::SectorSnrsMessage = decode(data)?;
                let log = self.of(LogTopics::network(topic));
                if log.locate(&mut message.stop) {
                    message.reports()?.for_each(|report| log.receptions.report(report));
                }
                Ok(())
            }
            "sextant.Range" => {
                if self.stream.is_some() {
                    self.leaves_out_ranges = true;
                    return Ok(());
                }
                let mut message: messages::RangeMessage = decode(data)?;
                let log = self.of(LogTopics::network(topic));
                if log.locate(&mut message.stop) { log.add_range(&message) } else { Ok(()) }
            }
            "sextant.Sector" => self.of(LogTopics::network(topic)).add_sector(decode(data)?),
            "sextant.SectorGains" => self.of(LogTopics::network(topic)).add_gains(&decode(data)?),
            "foxglove.PosesInFrame" => {
                if let Some(name) = drawing::robot_of_path(topic) {
                    self.paths.push((name.to_owned(), drawing::path_of(data)?));
                }
                Ok(())
            }
            "sextant.Contact" => {
                let messages::ContactMessage { time_ns, x_m, y_m, z_m } = decode(data)?;
                let position = Position::new(x_m, y_m, z_m);
                let name = topic.strip_prefix("/robot/").and_then(|rest| rest.strip_suffix("/contacts"));
                let robot = self.robots.id(name.ok_or("allowed: /robot/NAME/contacts")?);
                self.contacts.push(Contact { robot, time: SimTime::from_nanos(time_ns), position });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The log of the first network, or of the one called `other`.
    fn of(&mut self, other: Option<&str>) -> &mut LogDraft {
        let Some(other) = other else { return &mut self.log };
        let at = self.others.iter().position(|(name, _)| name == other).unwrap_or_else(|| {
            self.others.push((other.to_owned(), LogDraft::default()));
            self.others.len() - 1
        });
        &mut self.others[at].1
    }

    /// Keeps a reception, or passes it on.
    fn keep(&mut self, topic: &str, reception: Reception) -> Result<(), String> {
        let network = LogTopics::network(topic);
        let Some(mut stream) = self.stream.take() else {
            self.of(network).receptions.push(reception);
            return Ok(());
        };
        // The log of a network without a name is that of any network.
        let is_other = |name: &&str| self.networks.iter().skip(1).any(|other| other == name);
        let is_wanted = network == stream.network.filter(is_other);
        let passed = if is_wanted { self.of(network).pass(reception, &mut stream) } else { Ok(()) };
        self.stream = Some(stream);
        passed
    }

    fn add_nodes(&mut self, message: messages::NodesMessage) -> Result<(), String> {
        if message.first as usize != self.names.len() {
            return Err(format!("names begin at node {}; expected: node {}", message.first, self.names.len()));
        }
        self.names.extend(message.names);
        Ok(())
    }

    /// The logs of all networks.
    fn logs(&mut self) -> impl Iterator<Item = &mut LogDraft> {
        std::iter::once(&mut self.log).chain(self.others.iter_mut().map(|(_, log)| log))
    }

    /// The logs of the networks.
    fn build(self) -> Result<NetworkLogs, LogError> {
        let (names, robots, contacts) = (self.names, self.robots.into_vec(), self.contacts);
        let build = |network, LogDraft { stops, receptions, sectors, .. }: LogDraft| {
            let log = receptions.build(names.clone(), stops, contacts.clone())?.with_robots(robots.clone())?;
            let log = match sectors {
                Some(sectors) => log.with_sectors(sectors)?,
                None => log,
            };
            Ok(NetworkLog { network, log })
        };
        let first = build(self.networks.into_iter().next(), self.log)?;
        let others = self.others.into_iter().map(|(name, log)| build(Some(name), log));
        Ok(NetworkLogs::new(first, others.collect::<Result<_, _>>()?))
    }
}

fn decode<M: prost::Message + Default>(data: &[u8]) -> Result<M, String> {
    M::decode(data).map_err(|why| why.to_string())
}
