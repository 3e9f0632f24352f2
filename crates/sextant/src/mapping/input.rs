//! The input of `map`: a reception log and what is known with it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use sextant_channel::{NetworkLogs, ObstacleField, Position, ReceptionLog};
use sextant_kernel::{Files, NodeId, RobotId, Seed, SettingError, SimTime, Watch};
use sextant_mapper::{EstimatedPath, LateClock, PathError, PlacePrior, estimate_path};

use super::error::MapLogError;
use crate::floorplan::{self, FloorPlanError, FloorPlanOptions, LengthUnit};
use crate::measure::Dimensions;
use crate::scenario::{AlgorithmName, MapSettings, RecordedScenario, ScenarioErrors};
use sextant_kernel::text::{counted, listed};
use sextant_logs::doctor::ClockOffset;
use sextant_logs::{self as robot_log, LocalPlane, Names, ReadOptions, RobotLog, Source, TrueNodes};
use sextant_recording::{self as recording, MutualKnowledge, ORIGIN_METADATA, RecordedRun, SCENARIO_ATTACHMENT};

/// A reception log and what is known with it.
#[derive(Clone, Debug)]
pub struct Input {
    /// The reception logs of the networks that robots surveyed; the first one is that to map.
    pub logs: NetworkLogs,
    /// The known paths of robots, by name.
    pub paths: Vec<(String, Vec<Position>)>,
    /// The recording of `run` that it was read from, if it was one.
    pub recording: Option<PathBuf>,
    /// The scenario of the log, if it is from a recording.
    pub scenario: Option<String>,
    /// The files that the scenario names.
    pub files: Files,
    /// The true positions of nodes, by name.
    pub truth: Option<BTreeMap<String, Position>>,
    /// In how many dimensions they are known.
    pub true_dimensions: Dimensions,
    /// What the user knows of the places of nodes.
    pub prior: Option<PlacePrior>,
    /// What the nodes know of each other, for maps that use it.
    pub known: MutualKnowledge,
    /// Seed of the algorithms that use random numbers.
    pub seed: Seed,
    /// The estimated path, if the log is on one.
    pub estimated_path: Option<EstimatedPath>,
    /// The log on the path as it was believed to be, if the estimated one is another.
    pub believed_log: Option<ReceptionLog>,
    /// How late the packets of the log are by the clock of its path, if it tells that.
    pub clock: Option<ClockOffset>,
    /// The middle of the time of each stop that is a part of a path, by its robot and its start.
    pub middles: BTreeMap<(RobotId, SimTime), SimTime>,
    /// The name of the file whose odometry is the path of the log, if it is one.
    pub odometry: Option<String>,
    /// What stands on the floor, if the user has a plan of it: maps that know obstacles know these, and figures show them.
    pub floor: Option<ObstacleField>,
    /// Notes on the log for the user.
    pub notes: Vec<String>,
    /// The plane of the places, if the log has them by latitude and longitude.
    pub plane: Option<LocalPlane>,
}

impl Input {
    /// Reads a recording of `run`, or the log of a robot. If robots surveyed several networks, the log to map is that of
    /// `network`, or of the first one. `options` are for logs of robots.
    ///
    /// # Errors
    /// If it cannot be read, or robots did not survey `network`.
    pub fn read(path: &Path, network: Option<&str>, options: &ReadOptions) -> Result<Self, MapLogError> {
        if Source::of(path).is_some() {
            return Ok(Self::of_log(robot_log::read(path, options)?));
        }
        robot_log::refuse_options(path, options)?;
        Self::of_recording(path, recording::read_log(path)?, network)
    }

    /// The log of a robot, which was read from files or from tables in memory. What is odd in it is noted.
    ///
    /// ```
    /// use sextant::mapping::Input;
    /// use sextant_logs::{MemoryColumn, MemoryLog, MemoryTable, ReadOptions, read_tables};
    ///
    /// let column = |name: &str, column: MemoryColumn<'static>| (name.to_owned(), column);
    /// let stops = vec![
    ///     column("stop", MemoryColumn::texts([Some("A"), Some("B")])),
    ///     column("x_m", MemoryColumn::floats(vec![0.0, 1.5])),
    ///     column("y_m", MemoryColumn::floats(vec![0.0, 0.0])),
    /// ];
    /// let receptions = vec![
    ///     column("node", MemoryColumn::texts([Some("lamp")])),
    ///     column("stop", MemoryColumn::texts([Some("B")])),
    ///     column("received", MemoryColumn::whole(vec![1])),
    /// ];
    /// let stops = MemoryTable::new("stops", stops)?;
    /// let tables = MemoryLog::new(stops, MemoryTable::new("receptions", receptions)?);
    /// let input = Input::of_log(read_tables(&tables, &ReadOptions::default())?);
    /// assert_eq!(input.log().names(), ["lamp"]);
    /// # Ok::<(), sextant_logs::RobotLogError>(())
    /// ```
    #[must_use]
    pub fn of_log(RobotLog { log, plane, mut notes, findings, clock, middles, odometry }: RobotLog) -> Self {
        notes.extend(findings.iter().map(ToString::to_string));
        Self { clock, middles, odometry, ..Self::of_robot(log, plane, notes) }
    }

    /// The logs of the networks that robots surveyed, the first one to map.
    #[must_use]
    pub fn of_networks(logs: NetworkLogs) -> Self {
        Self { logs, ..Self::of_robot(ReceptionLog::default(), None, Vec::new()) }
    }

    /// The log of a robot, with places in `plane` if there is one.
    pub(super) fn of_robot(log: ReceptionLog, plane: Option<LocalPlane>, notes: Vec<String>) -> Self {
        Self {
            logs: log.into(),
            paths: Vec::new(),
            recording: None,
            scenario: None,
            files: Files::default(),
            truth: None,
            true_dimensions: Dimensions::Space,
            prior: None,
            known: MutualKnowledge::default(),
            seed: Seed(1),
            estimated_path: None,
            believed_log: None,
            clock: None,
            middles: BTreeMap::new(),
            odometry: None,
            floor: None,
            notes,
            plane,
        }
    }

    /// What is known with the log `run` of the recording at `path`, which is read for it once more. The log to map is that of
    /// `network`, or of the first one.
    pub(super) fn of_recording(
        path: &Path,
        mut run: RecordedRun,
        network: Option<&str>,
    ) -> Result<Self, MapLogError> {
        if let Some(name) = network
            && let Err(known) = run.logs.put_first(name)
        {
            let known: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
            let known = known.join(", ");
            return Err(MapLogError::Network { name: name.to_owned(), path: path.to_owned(), known });
        }
        let scenario = run.attachment(SCENARIO_ATTACHMENT);
        let scenario = scenario.map(|attachment| String::from_utf8_lossy(&attachment.data).into_owned());
        let files = run.files();
        let mut notes: Vec<String> = run.concern().into_iter().collect();
        if run.leaves_out_sector_snrs {
            notes.push(
                "the signal-to-noise ratios of all sectors are not used, because the log is mapped part by part"
                    .to_owned(),
            );
        }
        if run.leaves_out_ranges {
            notes.push(robot_log::UNUSED_RANGES.to_owned());
        }
        if !run.metadata.contains_key(ORIGIN_METADATA) {
            notes.push("the recording does not name its scenario".to_owned());
        }
        let seed = run.metadata.get(ORIGIN_METADATA).and_then(|origin| origin.get("seed")?.parse().ok());
        let known = recording::read_known(path, run.log().node_count())?;
        let truth = recording::read_truth(path)?;
        Ok(Self {
            logs: run.logs,
            paths: run.paths,
            recording: Some(path.to_owned()),
            scenario,
            files,
            truth,
            true_dimensions: Dimensions::Space,
            prior: None,
            known,
            seed: Seed(seed.unwrap_or(1)),
            estimated_path: None,
            believed_log: None,
            clock: None,
            middles: BTreeMap::new(),
            odometry: None,
            floor: None,
            notes,
            plane: None,
        })
    }

    /// The reception log to map, of the first network if robots surveyed several.
    #[must_use]
    pub fn log(&self) -> &ReceptionLog {
        self.logs.first()
    }

    /// The maps to compute from this log: those of its scenario if it has one, with what overrides them
    /// ([`MapSettings::new`]).
    ///
    /// # Errors
    /// All errors found.
    pub fn map_settings(
        &self,
        algorithm: Option<AlgorithmName>,
        profile: Option<&str>,
        network: Option<&str>,
        set: &[String],
    ) -> Result<MapSettings, ScenarioErrors> {
        let name = match &self.recording {
            Some(path) => format!("{SCENARIO_ATTACHMENT} of {}", path.display()),
            None => SCENARIO_ATTACHMENT.to_owned(),
        };
        let scenario = self.scenario.as_deref();
        let scenario = scenario.map(|text| RecordedScenario { name: &name, text, files: &self.files });
        MapSettings::new(scenario, algorithm, profile, network, set)
    }

    /// Lays the floor plan of a file under the maps, in the frame of the log. Its lengths are in this unit, or in the one that the file
    /// says. What is odd in it is noted.
    ///
    /// # Errors
    /// If the plan cannot be read, or a wall is invalid.
    pub fn lay(&mut self, plan: &Path, unit: Option<LengthUnit>) -> Result<(), FloorPlanError> {
        let options = FloorPlanOptions { plane: self.plane, unit, ..FloorPlanOptions::default() };
        let read = floorplan::read(plan, &options)?;
        if read.is_by_degrees && self.plane.is_none() {
            let problem = "it is by longitude and latitude, and the log is not: where it lies in the log is not known; convert it with \
                           `sextant floorplan`, which takes an origin"
                .to_owned();
            return Err(FloorPlanError::Content { path: plan.to_owned(), problem });
        }
        let wrong = |why: SettingError| FloorPlanError::Content { path: plan.to_owned(), problem: why.to_string() };
        self.floor = Some(read.obstacles().map_err(wrong)?);
        self.notes.extend(read.notes.iter().map(|note| format!("{}: {note}", plan.display())));
        Ok(())
    }

    /// Gives the nodes of the log, and of the true positions `truth`, their names. Returns the true positions.
    ///
    /// # Errors
    /// If an alias is unknown, or two nodes get one name.
    pub fn rename(&mut self, names: &Names, truth: Option<TrueNodes>) -> Result<Option<TrueNodes>, MapLogError> {
        if let Some(recording) = &self.recording {
            return Err(MapLogError::Names { path: recording.clone() });
        }
        let (places, has_heights) = truth.map(|truth| (truth.places, truth.has_heights)).unzip();
        let log = self.logs.first_mut();
        let (renamed, places) = names.apply(std::mem::take(log), places)?;
        *log = renamed;
        Ok(places.zip(has_heights).map(|(places, has_heights)| TrueNodes { places, has_heights }))
    }

    /// Takes the true positions of nodes from a file or a table of the user, instead of those of the recording.
    pub fn take_truth(&mut self, TrueNodes { places: truth, has_heights }: TrueNodes) {
        let names: BTreeSet<&String> = self.log().names().iter().collect();
        let strangers: Vec<&String> = truth.keys().filter(|name| !names.contains(name)).collect();
        if !strangers.is_empty() {
            let (are, they) = if strangers.len() == 1 { ("is", "it is") } else { ("are", "they are") };
            self.notes.push(format!(
                "{} with a true position {are} not in the log, so {they} not measured: {}",
                counted(strangers.len(), "node"),
                listed(&strangers)
            ));
        }
        self.truth = Some(truth);
        self.true_dimensions = if has_heights { Dimensions::Space } else { Dimensions::Plane };
    }

    /// Puts the log on the path that its ranges tell, where odometry is wrong by `error`. `known` are places of nodes by name: two fix
    /// the frame.
    ///
    /// # Errors
    /// If a known node is not in the log, it has too few ranges, or `watch` ends the work.
    pub fn estimate_path(
        &mut self,
        error: PathError,
        known: &BTreeMap<String, Position>,
        watch: &dyn Watch,
    ) -> Result<(), MapLogError> {
        let log = self.log();
        let mut places = Vec::new();
        let mut strangers = Vec::new();
        for (name, &place) in known {
            match log.names().iter().position(|node| node == name) {
                Some(node) => places.push((NodeId::from_index(node), place)),
                None => strangers.push(name),
            }
        }
        // Ranges tell their delay with the path. Packets do not, and a path bends to a late clock.
        let late = self.clock.filter(|clock| clock.is_clear && log.ranges().is_empty());
        let estimated = match late {
            Some(ClockOffset { delay_s, error_s, .. }) => {
                EstimatedPath::believed(log, error, LateClock { delay_s, deviation_s: error_s })
            }
            None => estimate_path(log, error, &places, watch)?,
        };
        let moved = estimated.log(log);
        if !strangers.is_empty() {
            self.notes
                .push(format!("known places of nodes that are not in the log are not used: {}", listed(&strangers)));
        }
        self.notes.push(estimated.fit.to_string());
        let believed = std::mem::replace(self.logs.first_mut(), moved);
        self.believed_log = estimated.fit.is_moved().then_some(believed);
        self.estimated_path = Some(estimated);
        Ok(())
    }

    /// The true position of each node of the log, where it is known; `None` if none is, because then the maps cannot be
    /// measured.
    pub(super) fn true_places(&mut self) -> Option<Vec<Option<Position>>> {
        let truth = self.truth.as_ref()?;
        let names = self.log().names();
        let places: Vec<Option<Position>> = names.iter().map(|name| truth.get(name).copied()).collect();
        let unknown: Vec<&String> =
            names.iter().zip(&places).filter(|(_, place)| place.is_none()).map(|(name, _)| name).collect();
        if unknown.is_empty() {
            return Some(places);
        }
        let known = names.len() - unknown.len();
        let measured = match known {
            0 => "the maps are not measured".to_owned(),
            1 => "only the other node is measured".to_owned(),
            known => format!("only the other {known} are measured"),
        };
        self.notes.push(format!(
            "the true positions of {} of {} are unknown ({}): {measured}",
            unknown.len(),
            counted(names.len(), "node"),
            listed(&unknown),
        ));
        (known > 0).then_some(places)
    }
}
