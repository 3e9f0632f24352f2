//! From packets and the paths of robots to a reception log.

mod finishing;

use std::collections::BTreeMap;
use std::time::Duration;

use sextant_channel::{Contact, Reception, Stop};
use sextant_kernel::text::counted;
use sextant_kernel::{NodeId, RobotId, SimTime};

use super::cover::Cover;
use super::gathered::Gathered;
use super::heard::HeardPackets;
use super::interval::Gaps;
use super::packet::Packet;
use super::path_ranges::PathRanges;
use super::rssi_check::RssiCheck;
use super::signal::Signal;
use super::strengths::{Report, Strengths};
use crate::doctor::{Finding, Samples};
use crate::error::robot_log_error::RobotLogError;
use crate::options::packet_delay::PacketDelay;
use crate::options::read_options::{ReadOptions, StopRule};
use crate::path::robot_path::Path;
use crate::path::slot::{self, Slot};
use crate::place::local_plane::LocalPlane;
use crate::ranges::range_table::{LONGEST_M, ReadRanges};
use crate::time::instant;

/// A path with poses farther apart says little of the way between them (m).
const SPARSE_M: f64 = 5.0;

/// Most pairs of a node and a stop that are listed although nothing was heard. Above it, an absent pair counts as one missed
/// packet.
pub(crate) const MOST_SILENT_PAIRS: usize = 4_000_000;

/// Makes a reception log of packets and the paths of the robots that heard them. Each path is cut into stops. Memory grows
/// with the pairs of a node and a stop, not with the packets.
///
/// The packets that a node sent at a stop are counted from the times at which it was heard and from its sending interval:
/// between two packets that were heard, as many were lost as intervals fit in. At a stop at which it sent none there is no
/// evidence (0 of 0). If the interval of a node is unknown, a stop counts as one packet, which was received if any was.
///
/// ```
/// use sextant_logs::{Gatherer, Packet, Path, Pose, ReadOptions, StopRule};
/// use sextant_channel::Position;
/// use sextant_kernel::SimTime;
///
/// let at = |second: u64| SimTime::from_nanos(second * 1_000_000_000);
/// let pose = |second, x_m| Pose { time: at(second), position: Position::new(x_m, 0.0, 0.0) };
/// let path = Path::new(vec![pose(0, 0.0), pose(10, 10.0)])?;
/// let every = StopRule::Distance(2.0);
/// let options = ReadOptions { stop_every: every, packet_interval_s: Some(1.0), ..ReadOptions::default() };
/// let mut gatherer = Gatherer::new(path, &options)?;
/// for second in [1, 2, 4] {
///     gatherer.take(Packet::new(at(second), "lamp"))?;
/// }
/// let log = gatherer.finish()?.log;
/// assert_eq!(log.stops().len(), 5);
/// let counts: Vec<_> = log.receptions().iter().map(|r| (r.received, r.sent)).collect();
/// assert_eq!(counts, [(1, 2), (1, 2), (1, 2), (0, 2), (0, 3)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Gatherer {
    tracks: Vec<RobotTrack>,
    robots: Vec<String>,
    stops: Vec<Stop>,
    contacts: Vec<Contact>,
    interval: Option<Duration>,
    names: Vec<String>,
    nodes: BTreeMap<String, u32>,
    heard: Gathered<HeardPackets>,
    cover: Cover,
    strengths: Strengths,
    /// What is taken off the times of packets (s).
    delay_s: f64,
    rssi: RssiCheck,
    samples: Samples,
    notes: Vec<String>,
    findings: Vec<Finding>,
    ranges: PathRanges,
    /// Those of them that packets or messages brought.
    brought: usize,
    /// The plane of the places, if they are given by latitude and longitude.
    plane: Option<LocalPlane>,
}

/// A robot: its path, cut into slots.
#[derive(Clone, Debug)]
struct RobotTrack {
    path: Path,
    slots: Vec<Slot>,
    /// The stop of each slot.
    stops: Vec<u32>,
    /// The gaps between the packets of each node.
    gaps: Vec<Gaps>,
}

impl Gatherer {
    /// A gatherer for the packets of one robot, which drove `path`.
    ///
    /// # Errors
    /// If the path would have too many stops.
    pub fn new(path: Path, options: &ReadOptions) -> Result<Self, RobotLogError> {
        Self::of_robots(vec![path], Vec::new(), options)
    }

    /// A gatherer for the packets of several robots: the path of each by its number, and their names, or no names.
    ///
    /// # Errors
    /// If a path would have too many stops.
    pub fn of_robots(paths: Vec<Path>, robots: Vec<String>, options: &ReadOptions) -> Result<Self, RobotLogError> {
        let mut gatherer = Self {
            tracks: Vec::new(),
            robots,
            stops: Vec::new(),
            contacts: Vec::new(),
            interval: options.packet_interval_s.map(Duration::from_secs_f64),
            names: Vec::new(),
            nodes: BTreeMap::new(),
            heard: Gathered::new(),
            cover: Cover::default(),
            strengths: Strengths::of(&options.form),
            delay_s: match options.repair.packet_delay {
                PacketDelay::Seconds(delay_s) => delay_s,
                PacketDelay::Estimated => 0.0,
            },
            rssi: RssiCheck::new(options),
            samples: Samples::default(),
            notes: Vec::new(),
            findings: Vec::new(),
            ranges: PathRanges::default(),
            brought: 0,
            plane: None,
        };
        for path in paths {
            let (slots, rule) = slot::cut(&path, options.stop_every).ok_or(RobotLogError::TooManyStops)?;
            gatherer.note_path(&path, slots.len(), rule);
            gatherer.tracks.push(RobotTrack { path, slots, stops: Vec::new(), gaps: Vec::new() });
        }
        gatherer.number_stops();
        Ok(gatherer)
    }

    /// The same with places where robots met obstacles.
    #[must_use]
    pub(crate) fn with_contacts(self, contacts: Vec<Contact>) -> Self {
        Self { contacts, ..self }
    }

    /// The same of places in the plane of latitudes and longitudes, if `plane` is one.
    #[must_use]
    pub(crate) fn with_plane(self, plane: Option<LocalPlane>) -> Self {
        Self { plane, ..self }
    }

    /// How late the packets and ranges are by the clock of the path (s).
    pub(crate) fn delay_s(&self) -> f64 {
        self.delay_s
    }

    fn note_path(&mut self, path: &Path, stops: usize, rule: StopRule) {
        let number = self.tracks.len();
        let whose = match self.robots.get(number) {
            Some(name) => format!("the path of robot `{name}`"),
            None => "the path".to_owned(),
        };
        let each = match rule {
            StopRule::Distance(distance_m) => format!(", one each {distance_m} m"),
            StopRule::Time(span) => format!(", one each {} s", span.as_secs_f64()),
            StopRule::Automatic => String::new(),
        };
        let stops = counted(stops, "stop");
        self.notes.push(format!("{whose} is cut into {stops}{each} (option `stop_every` sets it)"));
        if let Some((apart_m, apart)) = path.usual_leg().filter(|(apart_m, _)| *apart_m > SPARSE_M) {
            self.notes.push(format!(
                "{whose} has poses {apart_m:.1} m and {} s apart (median over its way): between them it counts as a straight \
                 line at one speed, and corners are cut",
                instant::format_span(apart)
            ));
        }
        if path.late() > 0 {
            let late = path.late();
            self.notes.push(format!("{whose} has {late} poses that are late by at most 1 s; they were put in order"));
        }
    }

    /// Numbers the slots of all robots in the order of time.
    fn number_stops(&mut self) {
        let slots = |robot: usize| (0..self.tracks[robot].slots.len()).map(move |slot| (robot, slot));
        let mut order: Vec<(usize, usize)> = (0..self.tracks.len()).flat_map(slots).collect();
        order.sort_by_key(|&(robot, slot)| self.tracks[robot].slots[slot].start);
        for (robot, slot) in order {
            let Slot { start, position, .. } = self.tracks[robot].slots[slot];
            let number = u32::try_from(self.stops.len()).expect("at most a million stops a robot");
            self.tracks[robot].stops.push(number);
            self.stops.push(Stop { robot: RobotId::from_index(robot), time: start, position, heading_rad: None });
        }
    }

    /// Takes a packet; packets may come in any order. All packets of all sources pass here, so that their times and strengths
    /// are corrected in one place. A packet outside of the path of its robot, or in a gap of it, is
    /// counted and not placed.
    ///
    /// # Errors
    /// If the name of the node is empty, a level is not finite, or there is no such robot.
    pub fn take(&mut self, packet: Packet<'_>) -> Result<(), RobotLogError> {
        let refused = |problem: &str| RobotLogError::Packet { time: packet.time, problem: problem.to_owned() };
        if packet.node.is_empty() {
            return Err(refused("it has no name of a node"));
        }
        if packet.range_m.is_some_and(|range_m| range_m.abs() > LONGEST_M) {
            return Err(refused(&format!("its range is above {LONGEST_M} m: is it in another unit?")));
        }
        if [packet.rssi_dbm, packet.snr_db].iter().flatten().any(|level| !level.is_finite()) {
            return Err(refused("its signal strength or signal-to-noise ratio is not a finite number"));
        }
        let node = self.node(packet.node);
        let report = self.strengths.take(self.rssi.take(packet.rssi_dbm), packet.snr_db);
        let Some(time) = instant::shifted(packet.time, -self.delay_s) else {
            self.cover.take(SimTime::ZERO, Duration::ZERO);
            self.cover.before += 1;
            return Ok(());
        };
        let Some(track) = self.tracks.get_mut(packet.robot.index()) else {
            return Err(refused("the robot that heard it has no path"));
        };
        if track.gaps.len() <= node as usize {
            track.gaps.resize_with(node as usize + 1, Gaps::default);
        }
        let back = track.gaps[node as usize].heard(time);
        self.cover.take(time, back);
        if let Some(range_m) = packet.range_m {
            self.brought += 1;
            self.ranges.take(&track.path, packet.robot, NodeId(node), time, range_m);
        }
        if let Report::Heard(rssi_dbm) = report {
            self.samples.take(node, packet.robot, time, rssi_dbm);
        }
        let (start, end) = track.path.span();
        let slot = track.slots.partition_point(|slot| slot.end <= time);
        match track.slots.get(slot).filter(|slot| slot.start <= time) {
            Some(_) => {
                let (received, signal) = match report {
                    Report::Heard(rssi_dbm) => (1, Signal::new(1, packet.sector, rssi_dbm, packet.snr_db)),
                    Report::Noise => (0, Signal::NONE),
                };
                self.heard.push(HeardPackets {
                    node,
                    stop: track.stops[slot],
                    received,
                    missed: 1 - received,
                    signal,
                    first: time,
                    last: time,
                });
            }
            None if time < start => self.cover.before += 1,
            None if time > end => self.cover.after += 1,
            None => self.cover.in_gaps += 1,
        }
        Ok(())
    }

    /// Takes a range that the first robot measured, which is no packet: it is not counted among those that were received.
    ///
    /// # Errors
    /// If the name of the node is empty, or the range is too long.
    pub(crate) fn take_range(&mut self, time: SimTime, node: &str, range_m: f64) -> Result<(), RobotLogError> {
        let refused = |problem: String| Err(RobotLogError::Packet { time, problem });
        if node.is_empty() {
            return refused("it has no name of a node".to_owned());
        }
        if range_m.abs() > LONGEST_M {
            return refused(format!("its range is above {LONGEST_M} m: is it in another unit?"));
        }
        let node = NodeId(self.node(node));
        self.brought += 1;
        if let (Some(time), Some(track)) = (instant::shifted(time, -self.delay_s), self.tracks.first()) {
            self.ranges.take(&track.path, RobotId(0), node, time, range_m);
        }
        Ok(())
    }

    fn node(&mut self, name: &str) -> u32 {
        if let Some(&node) = self.nodes.get(name) {
            return node;
        }
        let node = NodeId::from_index(self.names.len()).0;
        self.names.push(name.to_owned());
        self.nodes.insert(name.to_owned(), node);
        node
    }

    /// The paths of the robots.
    pub(crate) fn paths(&self) -> Vec<&Path> {
        self.tracks.iter().map(|track| &track.path).collect()
    }

    /// The names of the nodes that were heard so far.
    pub(crate) fn nodes(&self) -> &[String] {
        &self.names
    }

    /// Takes the ranges to nodes, which have the numbers of [`nodes`](Self::nodes), and to others after these.
    pub(crate) fn take_ranges(&mut self, ranges: ReadRanges) {
        for name in ranges.strangers {
            self.node(&name);
        }
        self.ranges.extend(ranges.samples);
    }
}

/// Nothing heard of `sent` packets.
pub(crate) fn silent(node: NodeId, stop: u32, sent: u32) -> Reception {
    Reception { node, stop, received: 0, sent, sector: None, rssi_dbm: None, snr_db: None }
}
