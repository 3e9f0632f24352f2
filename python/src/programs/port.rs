//! The port of an application: what it can know and do.

use std::sync::Arc;
use std::time::Duration;

use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scoped_tls_hkt::scoped_thread_local;
use sextant::channel::{Position, Reception};
use sextant::kernel::{EventKey, NodeId, SimTime, StationId};
use sextant::scenario::Scenario;
use sextant::sim::{self, Destination, Driving, NetworkId, Payload, SweepKind, Timer};

use super::events::{DriveEnd, Pose, checked_place};
use super::radio::Radio;
use super::robot::{checked_arc, direction};
use super::seeded::Seeded;
use crate::entries::each_entry_of_dict;
use crate::error::RunError;
use crate::names::{Names, StationKind};

/// Gives the port of the library to whoever asks.
trait Lend {
    fn lend(&mut self, ask: &mut dyn FnMut(&mut sim::Port<'_>));
}

impl Lend for sim::Port<'_> {
    fn lend(&mut self, ask: &mut dyn FnMut(&mut sim::Port<'_>)) {
        ask(self);
    }
}

scoped_thread_local!(static mut PORT: for<'a> &'a mut (dyn Lend + 'a));

/// Calls `call`, in which the port is open.
pub(super) fn with_port<T>(port: &mut sim::Port<'_>, call: impl FnOnce() -> T) -> T {
    let port: &mut dyn Lend = port;
    PORT.set(port, call)
}

/// The longest time that an application can wait for (s).
const LONGEST_S: f64 = 1e9;

/// The port of a station.
#[pyclass(frozen, module = "sextant")]
pub(crate) struct Port {
    station: StationId,
    kind: StationKind,
    networks: u8,
    names: Arc<Names>,
    seeded: Seeded,
}

/// A timer that was set.
#[pyclass(frozen, module = "sextant")]
pub(crate) struct TimerKey(EventKey);

impl Port {
    pub(super) fn new(station: &str, scenario: &Scenario, names: Arc<Names>) -> Self {
        let station = names.station(station).unwrap_or_default();
        Self {
            station,
            kind: names.kind(station),
            networks: u8::try_from(scenario.networks().len()).unwrap_or(u8::MAX),
            names,
            seeded: Seeded::new(scenario, station),
        }
    }

    /// Asks the port of the library.
    pub(super) fn ask<T>(&self, ask: impl FnOnce(&mut sim::Port<'_>) -> T) -> PyResult<T> {
        let closed = || PyRuntimeError::new_err("a port can be used only while its application is called");
        if !PORT.is_set() {
            return Err(closed());
        }
        let (mut ask, mut answer, mut is_own) = (Some(ask), None, false);
        PORT.with(|port| {
            port.lend(&mut |port| {
                is_own = port.station() == self.station;
                if let Some(ask) = ask.take().filter(|_| is_own) {
                    answer = Some(ask(port));
                }
            });
        });
        answer.ok_or_else(closed)
    }

    /// As [`ask`](Self::ask), of a robot.
    fn ask_robot<T>(&self, ask: impl FnOnce(&mut sim::Port<'_>) -> T) -> PyResult<T> {
        if self.kind != StationKind::Robot {
            let (name, kind) = (self.names.name(self.station), self.kind());
            return Err(PyRuntimeError::new_err(format!("`{name}` is a {kind}; only robots can do this")));
        }
        self.ask(ask)
    }

    /// Refuses a robot that drives already.
    fn ask_standing<T>(&self, ask: impl FnOnce(&mut sim::Port<'_>) -> T) -> PyResult<T> {
        let answer = self.ask_robot(|port| port.drive_ahead().is_none().then(|| ask(port)))?;
        answer.ok_or_else(|| PyRuntimeError::new_err("the robot drives already; call port.halt() first"))
    }

    /// The station with a name, or all.
    pub(super) fn destination(&self, to: Option<&str>) -> PyResult<Destination> {
        let Some(name) = to else { return Ok(Destination::All) };
        let station = self.names.station(name);
        let unknown = || PyKeyError::new_err(format!("there is no station `{name}`"));
        Ok(Destination::Station(station.ok_or_else(unknown)?))
    }

    /// The name of a station.
    pub(super) fn name(&self, station: StationId) -> &str {
        self.names.name(station)
    }

    fn network(&self, network: u8) -> PyResult<NetworkId> {
        if network < self.networks {
            Ok(NetworkId(network))
        } else {
            let last = self.networks.saturating_sub(1);
            Err(PyValueError::new_err(format!("the network is {network}; allowed: a number from 0 to {last}")))
        }
    }
}

/// A span of time.
pub(super) fn span(seconds: f64) -> PyResult<Duration> {
    if (0.0..=LONGEST_S).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err(PyValueError::new_err(format!("the time is {seconds} s; allowed: 0 to 1e9 s")))
    }
}

/// A distance from the robot or the node (m).
fn reach(reach_m: f64) -> PyResult<f64> {
    if reach_m >= 0.0 {
        Ok(reach_m)
    } else {
        Err(PyValueError::new_err(format!("the reach is {reach_m} m; allowed: a number from 0")))
    }
}

fn pose(pose: sim::Pose) -> Pose {
    Pose::new(pose.position, pose.heading_rad)
}

/// How a drive ended at once; `None` if the robot is under way.
fn ended(driving: Driving) -> Option<DriveEnd> {
    match driving {
        Driving::UnderWay => None,
        Driving::Over(end) => Some(end.into()),
    }
}

#[pymethods]
impl Port {
    /// Name of this station.
    #[getter]
    fn station(&self) -> &str {
        self.names.name(self.station)
    }

    /// ``"node"``, ``"robot"`` or ``"sink"``.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.kind {
            StationKind::Node => "node",
            StationKind::Robot => "robot",
            StationKind::Sink => "sink",
        }
    }

    /// Time of the simulation (s).
    #[getter]
    fn now_s(&self) -> PyResult<f64> {
        self.ask(|port| port.now().as_secs_f64())
    }

    /// Number of nodes in the world.
    #[getter]
    fn node_count(&self) -> usize {
        self.names.nodes().len()
    }

    /// Energy that is left in the battery of the station (J); none if it has no battery.
    #[getter]
    fn charge_j(&self) -> PyResult<Option<f64>> {
        self.ask(|port| port.charge_j())
    }

    /// Where the station is and where it looks; of a robot by its odometry.
    #[getter]
    fn pose(&self) -> PyResult<Pose> {
        self.ask(|port| pose(port.pose()))
    }

    /// The pose at a time (s), as the station moves now: before its drive the start of that, after it the end.
    fn pose_at(&self, time_s: f64) -> PyResult<Pose> {
        let time = SimTime::ZERO + span(time_s)?;
        self.ask(|port| pose(port.pose_at(time)))
    }

    /// Seed of this station in this run, for generators of your own.
    #[getter]
    fn seed(&self) -> u128 {
        self.seeded.seed()
    }

    /// A generator of random numbers that depends on the seed of the run and on the station alone.
    #[getter]
    fn random(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.seeded.generator(py)
    }

    /// A random number in [0, 1) that depends on the run, the station and `number` alone.
    fn uniform(&self, number: u64) -> PyResult<f64> {
        self.ask(|port| port.uniform(number))
    }

    /// A random whole number from 0 to `count` - 1 that depends on the run, the station and `number` alone.
    fn choice(&self, number: u64, count: u32) -> PyResult<usize> {
        if count == 0 {
            return Err(PyValueError::new_err("the count is 0; allowed: at least 1"));
        }
        self.ask(|port| port.choice(number, count as usize))
    }

    /// Gives a frame to the MAC, for one station or for all that hear it. Returns its number; ``sent`` follows.
    #[pyo3(signature = (payload, to=None, network=0))]
    fn send(&self, payload: &[u8], to: Option<&str>, network: u8) -> PyResult<u32> {
        let network = self.network(network)?;
        let to = self.destination(to)?;
        let sent = self.ask(|port| port.send(network, to, Payload::Octets(payload)))?;
        let frame = sent.map_err(|why| match why {
            sim::SendError::NoSuchStation(station) => {
                RunError::new_err(format!("`{}` cannot receive the frame", self.names.name(station)))
            }
            why => RunError::new_err(why.to_string()),
        })?;
        Ok(frame.0)
    }

    /// Sets a timer: ``timer`` is called after so many seconds, with this number. Returns a key for ``cancel``.
    #[pyo3(signature = (seconds, timer=0))]
    fn after(&self, seconds: f64, timer: u16) -> PyResult<TimerKey> {
        let span = span(seconds)?;
        self.ask(|port| TimerKey(port.after(span, Timer(timer))))
    }

    /// Cancels a timer, if it is pending.
    fn cancel(&self, key: &TimerKey) -> PyResult<()> {
        self.ask(|port| port.cancel(key.0))
    }

    /// Opens the receiver of a robot for so many seconds, whether it stands or drives; ``listened`` follows.
    #[pyo3(signature = (seconds, network=0))]
    fn listen(&self, seconds: f64, network: u8) -> PyResult<()> {
        let (span, network) = (span(seconds)?, self.network(network)?);
        self.ask_robot(|port| port.listen(network, span))
    }

    /// The radio of the station, in a network with ``mac.program``.
    #[pyo3(signature = (network=0))]
    fn radio(slf: Bound<'_, Self>, network: u8) -> PyResult<Radio> {
        let port = slf.get();
        let network = port.network(network)?;
        port.ask(|port| port.radio(network).map(drop))?.map_err(|why| RunError::new_err(why.to_string()))?;
        Ok(Radio::new(slf.unbind(), network))
    }

    /// Whether the links of a network sweep sectors.
    #[pyo3(signature = (network=0))]
    fn has_sectors(&self, network: u8) -> PyResult<bool> {
        let network = self.network(network)?;
        self.ask(|port| port.has_sectors(network))
    }

    /// Number of sectors of the station's antenna, all rings and tilts together; ``None`` without sector sweeps.
    #[pyo3(signature = (network=0))]
    fn sectors(&self, network: u8) -> PyResult<Option<u8>> {
        let network = self.network(network)?;
        self.ask(|port| port.sectors(network))
    }

    /// Begins a sector sweep: nodes answer ``"gather"``, nobody answers ``"announce"``; ``swept`` follows.
    #[pyo3(signature = (kind="gather", network=0))]
    fn sweep(&self, kind: &str, network: u8) -> PyResult<()> {
        let kind = match kind {
            "gather" => SweepKind::Gather,
            "announce" => SweepKind::Announce,
            other => {
                let words = format!("the kind of the sweep is {other:?}; allowed: \"gather\", \"announce\"");
                return Err(PyValueError::new_err(words));
            }
        };
        let network = self.network(network)?;
        self.ask(|port| port.sweep(network, kind))?.map_err(|why| RunError::new_err(why.to_string()))
    }

    /// Drives straight to a place (m). Returns the end of a drive that is over at once; else ``drive_ended`` follows.
    #[pyo3(signature = (x_m, y_m, z_m=None))]
    fn drive_to(&self, x_m: f64, y_m: f64, z_m: Option<f64>) -> PyResult<Option<DriveEnd>> {
        let z_m = match z_m {
            Some(z_m) => z_m,
            None => self.ask(|port| port.pose().position.z_m)?,
        };
        let place = checked_place(x_m, y_m, z_m)?;
        self.ask_standing(|port| ended(port.drive(place)))
    }

    /// Drives an arc of so many metres that turns by so many radians, counter-clockwise. Returns as ``drive_to``.
    fn drive_arc(&self, length_m: f64, turn_rad: f64) -> PyResult<Option<DriveEnd>> {
        checked_arc(length_m, turn_rad)?;
        self.ask_standing(|port| ended(port.drive_arc(length_m, turn_rad)))
    }

    /// Drives for so many seconds at the robot's speed and turns meanwhile. Returns as ``drive_to``.
    fn steer(&self, seconds: f64, turn_rate_rad_per_s: f64) -> PyResult<Option<DriveEnd>> {
        let span = span(seconds)?;
        checked_arc(0.0, turn_rate_rad_per_s * seconds)?;
        self.ask_standing(|port| ended(port.steer(span, turn_rate_rad_per_s)))
    }

    /// Stops the robot where it is; ``drive_ended`` is not called.
    fn halt(&self) -> PyResult<()> {
        self.ask_robot(|port| port.halt())
    }

    /// When the drive under way ends (s), and the point of contact on an obstacle that ends it.
    #[getter]
    #[expect(clippy::type_complexity, reason = "a tuple of Python")]
    fn drive_ahead(&self) -> PyResult<Option<(f64, Option<(f64, f64, f64)>)>> {
        self.ask_robot(|port| {
            let ahead = port.drive_ahead()?;
            let contact = ahead.contact.map(|at: Position| (at.x_m, at.y_m, at.z_m));
            Some((ahead.end.as_secs_f64(), contact))
        })
    }

    /// Distance to the next obstacle in a direction (m), at most `range_m`: what a range sensor says.
    #[pyo3(signature = (direction_rad, range_m=10.0))]
    fn clearance(&self, direction_rad: f64, range_m: f64) -> PyResult<f64> {
        let direction = direction(direction_rad, range_m)?;
        self.ask_robot(|port| port.clearance_m(direction, range_m))
    }

    /// The targets that truly are not farther than `reach_m` from here, by number.
    fn targets_within(&self, reach_m: f64) -> PyResult<Vec<u16>> {
        let reach_m = reach(reach_m)?;
        self.ask(|port| port.targets_within(reach_m).into_iter().map(|target| target.0).collect())
    }

    /// Captures the targets that are not farther than `reach_m` from the robot. Returns their numbers.
    fn capture(&self, reach_m: f64) -> PyResult<Vec<u16>> {
        let reach_m = reach(reach_m)?;
        self.ask_robot(|port| port.capture(reach_m).into_iter().map(|target| target.0).collect())
    }

    /// Removes the sources of fields that are not farther than `reach_m` from here. Returns how many.
    fn remove_sources(&self, reach_m: f64) -> PyResult<usize> {
        let reach_m = reach(reach_m)?;
        self.ask(|port| port.remove_sources(reach_m))
    }

    /// Writes a stop: what was heard since `since_s` of each node, as received, sent and mean strength (dBm).
    #[pyo3(signature = (heard, since_s, network=0))]
    fn log_stop(&self, heard: &Bound<'_, PyDict>, since_s: f64, network: u8) -> PyResult<()> {
        let (since, network) = (SimTime::ZERO + span(since_s)?, self.network(network)?);
        let mut receptions = Vec::new();
        each_entry_of_dict(heard, "a node", |name, heard| {
            let (received, sent, rssi_dbm): (u32, u32, Option<f64>) = heard.extract()?;
            let node = self.names.station(&name).filter(|station| self.names.kind(*station) == StationKind::Node);
            let node = node.ok_or_else(|| PyKeyError::new_err(format!("there is no node `{name}`")))?;
            if received > sent || rssi_dbm.is_some_and(|rssi_dbm| !rssi_dbm.is_finite()) {
                let found = format!("{received} of {sent} packets, {rssi_dbm:?} dBm");
                let allowed = "at most as many received as sent, and a finite strength";
                return Err(PyValueError::new_err(format!("`{name}` has {found}; allowed: {allowed}")));
            }
            let node = NodeId::from_index(node.index());
            receptions.push(Reception { node, stop: 0, received, sent, sector: None, rssi_dbm, snr_db: None });
            Ok(())
        })?;
        receptions.sort_by_key(|reception| reception.node);
        let is_past = self.ask_robot(|port| {
            let is_past = since <= port.now();
            if is_past {
                let position = port.pose_at(since).position;
                port.log_stop(network, since, position, receptions);
            }
            is_past
        })?;
        if is_past {
            Ok(())
        } else {
            Err(PyValueError::new_err(format!("since_s is {since_s}, which is in the future")))
        }
    }

    /// Ends the application of this station.
    fn finish(&self) -> PyResult<()> {
        self.ask(|port| port.finish())
    }

    fn __repr__(&self) -> String {
        format!("sextant.Port({} {:?})", self.kind(), self.station())
    }
}
