//! A robot as its controller sees it.

use std::f64::consts::TAU;
use std::sync::Arc;

use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use scoped_tls_hkt::scoped_thread_local;
use sextant::channel::Position;
use sextant::scenario::Scenario;
use sextant::sim::{CommandOutcome, Ending, RobotCommand, Situation};

use super::events::{Pose, checked_place};
use super::seeded::Seeded;
use crate::names::Names;
use crate::whole::whole_u32;

/// The most directions that a robot can be asked for at once.
const MOST_RANGES: u32 = 100_000;

scoped_thread_local!(static SITUATION: for<'a> &'a Situation<'a>);

/// Calls `call`, in which the robot knows its situation.
pub(super) fn in_situation<T>(situation: &Situation<'_>, call: impl FnOnce() -> T) -> T {
    SITUATION.set(situation, call)
}

/// Asks the situation.
fn known<T>(ask: impl FnOnce(&Situation<'_>) -> T) -> PyResult<T> {
    if SITUATION.is_set() {
        Ok(SITUATION.with(ask))
    } else {
        Err(PyRuntimeError::new_err("a robot can be asked only while its controller is called"))
    }
}

/// A robot.
#[pyclass(frozen, module = "sextant")]
pub(crate) struct Robot {
    name: String,
    names: Arc<Names>,
    seeded: Seeded,
}

impl Robot {
    pub(super) fn new(name: &str, scenario: &Scenario, names: Arc<Names>) -> Self {
        let station = names.station(name).unwrap_or_default();
        Self { name: name.to_owned(), names, seeded: Seeded::new(scenario, station) }
    }
}

/// What was heard of a node at the last stop.
#[pyclass(frozen, get_all, module = "sextant")]
pub(crate) struct Heard {
    node: String,
    packets: u32,
    sent: u32,
    rssi_dbm: f64,
}

#[pymethods]
impl Heard {
    fn __repr__(&self) -> String {
        let Self { node, packets, sent, rssi_dbm } = self;
        format!("Heard(node={node:?}, packets={packets}, sent={sent}, rssi_dbm={rssi_dbm:.1})")
    }
}

/// What a robot is to do next.
#[pyclass(frozen, module = "sextant")]
pub(crate) struct Command(RobotCommand);

impl Command {
    /// The answer of a controller.
    pub(super) fn of(answer: &Bound<'_, PyAny>) -> PyResult<RobotCommand> {
        match answer.cast::<Self>() {
            Ok(command) => Ok(command.get().0),
            Err(_) => {
                let kind = answer.get_type().name()?;
                Err(PyTypeError::new_err(format!(
                    "`next` returned {kind}; allowed: what robot.drive_to, robot.drive_arc, robot.listen, robot.sweep or \
                     robot.finish return"
                )))
            }
        }
    }
}

#[pymethods]
impl Command {
    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}

#[pymethods]
impl Robot {
    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Time of the simulation (s).
    #[getter]
    fn time_s(&self) -> PyResult<f64> {
        known(|situation| situation.time.as_secs_f64())
    }

    /// Where the robot is and where it looks, by its odometry.
    #[getter]
    fn pose(&self) -> PyResult<Pose> {
        known(|situation| Pose::new(situation.position, situation.heading_rad))
    }

    /// Number of nodes in the world.
    #[getter]
    fn node_count(&self) -> PyResult<usize> {
        known(|situation| situation.node_count)
    }

    /// How the last command ended: ``"started"`` (none was given yet), ``"arrived"``, ``"blocked"`` or ``"listened"``.
    #[getter]
    fn outcome(&self) -> PyResult<&'static str> {
        known(|situation| match situation.outcome {
            CommandOutcome::Started => "started",
            CommandOutcome::Arrived => "arrived",
            CommandOutcome::Blocked(_) => "blocked",
            CommandOutcome::Listened(_) => "listened",
        })
    }

    /// The point of contact on the obstacle that blocked the last drive (m), or ``None``.
    #[getter]
    fn contact(&self) -> PyResult<Option<(f64, f64, f64)>> {
        known(|situation| match situation.outcome {
            CommandOutcome::Blocked(contact) => Some((contact.x_m, contact.y_m, contact.z_m)),
            CommandOutcome::Started | CommandOutcome::Arrived | CommandOutcome::Listened(_) => None,
        })
    }

    /// What was heard of each node at the stop that just ended; empty after a drive.
    #[getter]
    fn heard(&self) -> PyResult<Vec<Heard>> {
        known(|situation| match situation.outcome {
            CommandOutcome::Listened(heard) => heard
                .iter()
                .map(|heard| Heard {
                    node: self.names.nodes()[heard.node.index()].clone(),
                    packets: heard.packets,
                    sent: heard.sent,
                    rssi_dbm: heard.rssi_dbm,
                })
                .collect(),
            CommandOutcome::Started | CommandOutcome::Arrived | CommandOutcome::Blocked(_) => Vec::new(),
        })
    }

    /// Seed of this robot in this run, for generators of your own.
    #[getter]
    fn seed(&self) -> u128 {
        self.seeded.seed()
    }

    /// A generator of random numbers that depends on the seed of the run and on the robot alone.
    #[getter]
    fn random(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.seeded.generator(py)
    }

    /// Distance to the next obstacle in a direction (m), at most `range_m`: what a range sensor says.
    #[pyo3(signature = (direction_rad, range_m=10.0))]
    fn clearance(&self, direction_rad: f64, range_m: f64) -> PyResult<f64> {
        let direction = direction(direction_rad, range_m)?;
        known(|situation| situation.clearance_m(direction, range_m))
    }

    /// Clearances in `count` directions (m), evenly spread from the x axis counter-clockwise.
    #[pyo3(signature = (count=None, range_m=10.0))]
    fn ranges(&self, count: Option<&Bound<'_, PyAny>>, range_m: f64) -> PyResult<Vec<f64>> {
        let count = count.map_or(Ok(8), |count| whole_u32("count", count, 1..=MOST_RANGES))?;
        (0..count).map(|i| self.clearance(TAU * f64::from(i) / f64::from(count), range_m)).collect()
    }

    /// The command to drive straight to a place (m), at the present height if `z_m` is absent.
    #[pyo3(signature = (x_m, y_m, z_m=None))]
    fn drive_to(&self, x_m: f64, y_m: f64, z_m: Option<f64>) -> PyResult<Command> {
        let z_m = match z_m {
            Some(z_m) => z_m,
            None => known(|situation| situation.position.z_m)?,
        };
        Ok(Command(RobotCommand::Drive(checked_place(x_m, y_m, z_m)?)))
    }

    /// The command to drive an arc of so many metres that turns by so many radians, counter-clockwise.
    fn drive_arc(&self, length_m: f64, turn_rad: f64) -> PyResult<Command> {
        checked_arc(length_m, turn_rad)?;
        Ok(Command(RobotCommand::DriveArc { length_m, turn_rad }))
    }

    /// The command to stand and listen for the time that the scenario says.
    fn listen(&self) -> Command {
        Command(RobotCommand::Listen)
    }

    /// As ``listen``, in a network whose links sweep sectors.
    fn sweep(&self) -> PyResult<Command> {
        if known(|situation| situation.sweeps_sectors())? {
            Ok(Command(RobotCommand::Listen))
        } else {
            Err(PyRuntimeError::new_err("the robot has no sector sweeps in its networks; use robot.listen()"))
        }
    }

    /// The command to end the survey: ``"complete"``, ``"steps_exhausted"`` or ``"stuck"``.
    #[pyo3(signature = (ending="complete"))]
    fn finish(&self, ending: &str) -> PyResult<Command> {
        Ok(Command(RobotCommand::Finish(match ending {
            "complete" => Ending::Complete,
            "steps_exhausted" => Ending::StepsExhausted,
            "stuck" => Ending::Stuck,
            other => {
                return Err(PyValueError::new_err(format!(
                    "the ending is {other:?}; allowed: \"complete\", \"steps_exhausted\", \"stuck\""
                )));
            }
        })))
    }

    fn __repr__(&self) -> String {
        format!("sextant.Robot({:?})", self.name)
    }
}

/// A direction of range sensors.
pub(super) fn direction(direction_rad: f64, range_m: f64) -> PyResult<Position> {
    if direction_rad.is_finite() && range_m > 0.0 && range_m <= Position::FARTHEST_M {
        Ok(Position::new(libm::cos(direction_rad), libm::sin(direction_rad), 0.0))
    } else {
        Err(PyValueError::new_err(format!(
            "the direction is {direction_rad} rad and the range {range_m} m; allowed: a finite angle, and a range above 0"
        )))
    }
}

/// Refuses an arc that cannot be driven.
pub(super) fn checked_arc(length_m: f64, turn_rad: f64) -> PyResult<()> {
    if (0.0..=Position::FARTHEST_M).contains(&length_m) && turn_rad.is_finite() {
        Ok(())
    } else {
        Err(PyValueError::new_err(format!(
            "the arc is {length_m} m long and turns by {turn_rad} rad; allowed: a length from 0, and a finite angle"
        )))
    }
}
