//! A controller of a robot in Python.

use std::sync::Arc;

use pyo3::prelude::*;
use sextant::scenario::Scenario;
use sextant::sim::{Controller, Ending, RobotCommand, Situation};

use super::robot::{Command, Robot, in_situation};
use crate::names::Names;
use crate::work::Brake;

/// Asks an object of Python what the robot does next.
pub(super) struct PyController {
    /// The bound method `next`.
    next: Py<PyAny>,
    robot: Py<Robot>,
    brake: Arc<Brake>,
}

impl PyController {
    pub(super) fn new(
        py: Python<'_>,
        (name, object): (&str, Py<PyAny>),
        scenario: &Scenario,
        names: Arc<Names>,
        brake: Arc<Brake>,
    ) -> PyResult<Self> {
        let next = object.getattr(py, "next")?;
        let robot = Py::new(py, Robot::new(name, scenario, names))?;
        Ok(Self { next, robot, brake })
    }
}

impl Clone for PyController {
    /// The same object: a copy has no state of its own.
    fn clone(&self) -> Self {
        let (next, robot) = Python::attach(|py| (self.next.clone_ref(py), self.robot.clone_ref(py)));
        Self { next, robot, brake: Arc::clone(&self.brake) }
    }
}

impl Controller for PyController {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        if self.brake.is_stopped() {
            return RobotCommand::Finish(Ending::Stuck);
        }
        let command = Python::attach(|py| {
            let answer = in_situation(situation, || self.next.call1(py, (&self.robot,)))?;
            Command::of(answer.bind(py))
        });
        command.unwrap_or_else(|error| {
            self.brake.fail(error);
            RobotCommand::Finish(Ending::Stuck)
        })
    }
}
