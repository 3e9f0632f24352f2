//! What a listener heard: everything that a mapper may know.

mod builder;
mod columns;
mod drive;
mod heard_at_stop;
mod log_error;
mod network_logs;
mod range_samples;
mod sector_snrs;
mod view;

use std::borrow::Cow;
use std::sync::Arc;

use sextant_kernel::{NodeId, RobotId, SimTime};

use crate::antenna::sector_table::SectorTable;
use crate::geometry::position::Position;
pub use builder::ReceptionLogBuilder;
use columns::ReceptionColumns;
pub use drive::Drive;
pub use heard_at_stop::{HeardAtStop, StopLog};
pub use log_error::LogError;
pub use network_logs::{NetworkLog, NetworkLogs};
use range_samples::RangeSamples;
pub use range_samples::{Mounting, RangeSample};
use sector_snrs::SectorSnrs;
pub use sector_snrs::{SectorReport, SectorSnr};
pub use view::{Receptions, ReceptionsIter};

/// A place where a robot listened for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The robot that listened.
    pub robot: RobotId,
    /// Start of listening.
    pub time: SimTime,
    /// Where the robot stood, in its own odometry frame (m).
    pub position: Position,
    /// How the antenna of the robot was turned about the vertical, counterclockwise from x (rad). The sectors of the log
    /// are then those in the frame of the robot. `None` if they keep their directions in the frame of the stops: the robot
    /// has a compass, or an antenna without sectors.
    pub heading_rad: Option<f64>,
}

impl Stop {
    /// A stop of the first robot at the start, with directions in the frame of the stops.
    #[must_use]
    pub fn at(position: Position) -> Self {
        Self { robot: RobotId(0), time: SimTime::ZERO, position, heading_rad: None }
    }
}

/// What was heard of one node at one stop. If a pair of node and stop has no reception, the robot listened and
/// heard nothing (0 of 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reception {
    /// The node that was heard.
    pub node: NodeId,
    /// Index of the stop.
    pub stop: u32,
    /// Packets received, at most `sent`.
    pub received: u32,
    /// Packets that the node is known to have sent while the robot listened: in a simulated log, those from the first to
    /// the last one received, by their sequence numbers. 0 of 0 is no evidence.
    pub sent: u32,
    /// Identity of the antenna sector with the best reception, if the listener has sectors (0-based).
    pub sector: Option<u8>,
    /// Mean received signal strength of the packets (dBm), if it was measured.
    pub rssi_dbm: Option<f64>,
    /// Signal-to-noise ratio of the listener's own best packet, as the node reported it (dB), if nodes report it.
    pub snr_db: Option<f64>,
}

impl Reception {
    /// So many packets `received` of those `sent`, of which nothing else is known.
    #[must_use]
    pub fn heard(node: NodeId, stop: u32, received: u32, sent: u32) -> Self {
        Self { node, stop, received, sent, sector: None, rssi_dbm: None, snr_db: None }
    }
}

/// A place where a robot met an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The robot that met the obstacle.
    pub robot: RobotId,
    /// Time of the contact.
    pub time: SimTime,
    /// The point of contact on the obstacle (m).
    pub position: Position,
}

/// Everything that robots recorded on a survey: where they listened, what they heard there, where
/// they drove and what they met. No ground truth. Receptions are sorted by node, then by stop, at most one per pair.
///
/// Receptions are stored in columns: four octets each for the stop. The other columns take memory only if a reception
/// differs from the default: one packet received of one, no sector, no signal strength.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceptionLog {
    names: Vec<String>,
    /// Shared with the parts of the log.
    stops: Arc<Vec<Stop>>,
    /// Sorted by node, then by stop.
    columns: ReceptionColumns,
    /// Where the receptions of each node begin, and the end of the last.
    first: Vec<usize>,
    contacts: Vec<Contact>,
    robots: Vec<String>,
    sectors: Option<SectorTable>,
    /// Shared with the same log with other names or counts.
    sector_snrs: Arc<SectorSnrs>,
    /// Shared as they are.
    ranges: Arc<RangeSamples>,
}

impl Default for ReceptionLog {
    /// A log without nodes and stops.
    fn default() -> Self {
        Self {
            names: Vec::new(),
            stops: Arc::default(),
            columns: ReceptionColumns::default(),
            first: vec![0],
            contacts: Vec::new(),
            robots: Vec::new(),
            sectors: None,
            sector_snrs: Arc::default(),
            ranges: Arc::default(),
        }
    }
}

impl ReceptionLog {
    /// A log of the nodes `names` (index = [`NodeId`]; known nodes that were never heard included).
    /// The receptions may come in any order. For logs that are too large for a list of [`Reception`]s use a
    /// [`ReceptionLogBuilder`].
    ///
    /// # Errors
    /// If a reception names a node or stop that does not exist, appears twice, or has more packets than were sent;
    /// if a stop or its heading is not finite.
    pub fn new(
        names: Vec<String>,
        stops: Vec<Stop>,
        receptions: Vec<Reception>,
        contacts: Vec<Contact>,
    ) -> Result<Self, LogError> {
        let mut builder = ReceptionLogBuilder::default();
        builder.extend(receptions);
        builder.build(names, stops, contacts)
    }

    /// The same log with these names of the robots (index = [`RobotId`]); an empty list means that they are not
    /// known.
    ///
    /// # Errors
    /// If a stop or a contact is of a robot that is not among them.
    pub fn with_robots(self, robots: Vec<String>) -> Result<Self, LogError> {
        let unnamed = Self { robots: Vec::new(), ..self };
        match unnamed.robot_count().checked_sub(1) {
            Some(last) if !robots.is_empty() && last >= robots.len() => {
                Err(LogError::UnknownRobot { robot: RobotId::from_index(last).0, robots: robots.len() })
            }
            _ => Ok(Self { robots, ..unnamed }),
        }
    }

    /// The same log with other names of its nodes, in the same order.
    ///
    /// # Panics
    /// If there are more or fewer names than nodes.
    #[must_use]
    pub fn with_names(self, names: Vec<String>) -> Self {
        assert_eq!(names.len(), self.names.len(), "each node has a name");
        Self { names, ..self }
    }

    /// The same log with each slot counted as one packet, which is received if at least one packet of the slot was.
    #[must_use]
    pub fn at_least_one(&self) -> Cow<'_, Self> {
        if self.columns.has_counts() {
            Cow::Owned(Self {
                names: self.names.clone(),
                stops: Arc::clone(&self.stops),
                columns: self.columns.at_least_one(),
                first: self.first.clone(),
                contacts: self.contacts.clone(),
                robots: self.robots.clone(),
                sectors: self.sectors.clone(),
                sector_snrs: Arc::clone(&self.sector_snrs),
                ranges: Arc::clone(&self.ranges),
            })
        } else {
            Cow::Borrowed(self)
        }
    }

    /// The log as it was at `time`: the first stops, up to the first one that had not begun before, what was heard there, and
    /// the contacts until then.
    #[must_use]
    pub fn until(&self, time: SimTime) -> Self {
        let stops: Vec<Stop> = self.stops.iter().take_while(|stop| stop.time < time).copied().collect();
        let mut receptions = ReceptionLogBuilder::default();
        receptions.extend(self.receptions().iter().filter(|reception| (reception.stop as usize) < stops.len()));
        let reports = self.sector_reports().filter(|report| (report.stop as usize) < stops.len());
        reports.for_each(|report| receptions.report(report));
        let contacts = self.contacts.iter().filter(|contact| contact.time < time).copied().collect();
        let cut = receptions.build(self.names.clone(), stops, contacts).expect("a part of a log is a log");
        let ranges = Arc::new(self.ranges.until(time));
        Self { robots: self.robots.clone(), sectors: self.sectors.clone(), ranges, ..cut }
    }

    /// The log of other nodes, called `names`, who were heard at the same stops by the same robots: a part of a log that is
    /// too large to be in memory at once. The stops are shared, not copied. Signal-to-noise ratios of all sectors are those
    /// that `receptions` has.
    ///
    /// # Errors
    /// If a reception is invalid, or names a sector that the log does not have.
    pub fn part(&self, names: Vec<String>, receptions: ReceptionLogBuilder) -> Result<Self, LogError> {
        let part = receptions.build_at(names, Arc::clone(&self.stops), self.contacts.clone())?;
        let part = Self { robots: self.robots.clone(), ..part };
        match &self.sectors {
            Some(sectors) => part.with_sectors(sectors.clone()),
            None => Ok(part),
        }
    }

    /// Names of the robots; the index is the [`RobotId`]. Empty if the names are not known.
    #[must_use]
    pub fn robots(&self) -> &[String] {
        &self.robots
    }

    /// The name of a robot. If the names are not known: `robot-0` for the first robot, and so on.
    #[must_use]
    pub fn robot_name(&self, robot: RobotId) -> Cow<'_, str> {
        match self.robots.get(robot.index()) {
            Some(name) => Cow::Borrowed(name),
            None => Cow::Owned(format!("robot-{}", robot.0)),
        }
    }

    /// Number of robots: those with names or, if names are not known, those that stopped or met an obstacle.
    #[must_use]
    pub fn robot_count(&self) -> usize {
        let of_stops = self.stops.iter().map(|stop| stop.robot);
        let of_contacts = self.contacts.iter().map(|contact| contact.robot);
        let seen = of_stops.chain(of_contacts).map(|robot| robot.index() + 1).max().unwrap_or(0);
        seen.max(self.robots.len())
    }

    /// The straight lines from each stop to the next one of the same robot, by time; stops of one time are in the order of the
    /// log.
    pub fn drives(&self) -> impl Iterator<Item = Drive> {
        let mut last: Vec<Option<Position>> = vec![None; self.robot_count()];
        let mut path: Vec<usize> = (0..self.stops.len()).collect();
        path.sort_by_key(|&stop| self.stops[stop].time);
        path.into_iter().filter_map(move |stop| {
            let Stop { robot, position, .. } = self.stops[stop];
            let from = last[robot.index()].replace(position)?;
            Some(Drive { robot, from, to: position })
        })
    }

    /// The same log with these sectors of the listener.
    ///
    /// # Errors
    /// If a reception names a sector that is not among them.
    pub fn with_sectors(self, sectors: SectorTable) -> Result<Self, LogError> {
        self.check_sectors(&sectors)?;
        Ok(Self { sectors: Some(sectors), ..self })
    }

    /// Whether every sector of a reception, and every sector with a signal-to-noise ratio, is among `sectors`.
    ///
    /// # Errors
    /// If a sector is not.
    pub fn check_sectors(&self, sectors: &SectorTable) -> Result<(), LogError> {
        let heard_in = |id: Option<u8>| id.filter(|&id| !sectors.contains(id));
        let place = self.receptions().sectors().and_then(|ids| ids.iter().position(|&id| heard_in(id).is_some()));
        match place.and_then(|at| self.receptions().get(at)) {
            Some(Reception { node, stop, sector: Some(sector), .. }) => Err(LogError::UnknownSector {
                node: self.names[node.index()].clone(),
                stop,
                sector,
                known: sectors.identities(),
            }),
            _ => self.sector_snrs.check_sectors(&self.names, sectors),
        }
    }

    /// The same log with the signal-to-noise ratios of all sectors that nodes reported, in any order, instead of those that
    /// it had.
    ///
    /// # Errors
    /// If a report names a node, stop or sector that does not exist, is of a node that was not heard at the stop, appears
    /// twice, or is not finite.
    pub fn with_sector_snrs(self, reports: Vec<SectorReport>) -> Result<Self, LogError> {
        let sector_snrs = SectorSnrs::new(&self, reports)?;
        if let Some(sectors) = &self.sectors {
            sector_snrs.check_sectors(&self.names, sectors)?;
        }
        Ok(Self { sector_snrs: Arc::new(sector_snrs), ..self })
    }

    /// Whether the signal-to-noise ratios of all sectors were reported for some reception.
    #[must_use]
    pub fn has_sector_snrs(&self) -> bool {
        !self.sector_snrs.is_empty()
    }

    /// The signal-to-noise ratios of the sectors in which `node` heard the robot at `stop`, by ascending sector; empty if
    /// it did not report them. A sector that is absent was not decoded.
    #[must_use]
    pub fn sector_snrs(&self, node: NodeId, stop: u32) -> &[SectorSnr] {
        self.sector_snrs.of(node, stop)
    }

    /// The signal-to-noise ratios of all sectors one by one, by node, stop and sector.
    pub fn sector_reports(&self) -> impl Iterator<Item = SectorReport> {
        self.sector_snrs.reports()
    }

    /// The same log with ranges that robots measured, in the order of time, instead of those that it had.
    ///
    /// # Errors
    /// If a range is to a node that does not exist, or is not finite.
    pub fn with_ranges(self, ranges: Vec<RangeSample>) -> Result<Self, LogError> {
        let ranges = Arc::new(RangeSamples::new(&self.names, ranges)?);
        Ok(Self { ranges, ..self })
    }

    /// The same log with its stops, ranges and contacts at other places: `place` gives where a place of a robot at a time is, and how
    /// far all is turned there, counterclockwise (rad).
    #[must_use]
    pub fn placed_again(&self, place: impl Fn(RobotId, SimTime, Position) -> (Position, f64)) -> Self {
        let stop = |stop: &Stop| {
            let (position, turn_rad) = place(stop.robot, stop.time, stop.position);
            Stop { position, heading_rad: stop.heading_rad.map(|heading_rad| heading_rad + turn_rad), ..*stop }
        };
        let contact = |contact: &Contact| {
            let (position, _) = place(contact.robot, contact.time, contact.position);
            Contact { position, ..*contact }
        };
        Self {
            stops: Arc::new(self.stops.iter().map(stop).collect()),
            contacts: self.contacts.iter().map(contact).collect(),
            ranges: Arc::new(self.ranges.placed_again(place)),
            ..self.clone()
        }
    }

    /// The ranges that robots measured: by node, those of a node in the order of time.
    #[must_use]
    pub fn ranges(&self) -> &[RangeSample] {
        self.ranges.all()
    }

    /// The ranges to one node, in the order of time.
    #[must_use]
    pub fn ranges_to(&self, node: NodeId) -> &[RangeSample] {
        self.ranges.of(node)
    }

    /// The stop to which each of [`ranges`](Self::ranges) belongs: the last one of its robot that had begun when it was measured, or
    /// the first one.
    #[must_use]
    pub fn stops_of_ranges(&self) -> Vec<u32> {
        self.ranges.stops(&self.stops)
    }

    /// The sectors of the listener, if the log has them.
    #[must_use]
    pub fn sectors(&self) -> Option<&SectorTable> {
        self.sectors.as_ref()
    }

    /// Whether the antenna turns, so that a sector has another direction at each stop: some stop has a heading.
    #[must_use]
    pub fn has_headings(&self) -> bool {
        self.stops.iter().any(|stop| stop.heading_rad.is_some())
    }

    /// Number of nodes, heard or not.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.names.len()
    }

    /// Names of the nodes; the index is the [`NodeId`].
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// All stops, in the order of the survey.
    #[must_use]
    pub fn stops(&self) -> &[Stop] {
        &self.stops
    }

    /// All receptions, by node, then by stop.
    #[must_use]
    pub fn receptions(&self) -> Receptions<'_> {
        Receptions::of_nodes(self, 0..self.names.len())
    }

    /// The receptions of one node, by stop.
    ///
    /// # Panics
    /// If the log has no such node.
    #[must_use]
    pub fn of(&self, node: NodeId) -> Receptions<'_> {
        Receptions::of_nodes(self, node.index()..node.index() + 1)
    }

    /// What was heard of a node at a stop, if the log says so.
    ///
    /// # Panics
    /// If the log has no such node.
    #[must_use]
    pub fn at(&self, node: NodeId, stop: u32) -> Option<Reception> {
        let of = self.of(node);
        of.stops().binary_search(&stop).ok().and_then(|at| of.get(at))
    }

    /// Where the robots met obstacles.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }
}

#[cfg(test)]
mod tests;
