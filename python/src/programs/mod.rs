//! Controllers and applications that are written in Python.

mod application;
mod controller;
mod events;
mod port;
mod radio;
mod radio_event;
mod robot;
mod seeded;

use std::sync::Arc;

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sextant::run::Programs;
use sextant::scenario::Scenario;
use sextant::{Run, RunError, RunObserver, run_with};

use crate::entries::each_entry_of_dict;
use crate::names::{Names, StationKind};
use crate::work::Supervisor;
use application::PyApplication;
use controller::PyController;

/// Adds the classes to the module.
pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<robot::Robot>()?;
    module.add_class::<robot::Command>()?;
    module.add_class::<robot::Heard>()?;
    module.add_class::<port::Port>()?;
    module.add_class::<port::TimerKey>()?;
    module.add_class::<radio::Radio>()?;
    module.add_class::<radio_event::RadioEvent>()?;
    module.add_class::<events::Pose>()?;
    module.add_class::<events::Delivery>()?;
    module.add_class::<events::SendReport>()?;
    module.add_class::<events::Sensed>()?;
    module.add_class::<events::DriveEnd>()?;
    module.add_class::<events::SweepAnswer>()?;
    module.add_class::<events::Announcement>()?;
    Ok(())
}

/// The programs that a user gives to stations, by the names of these.
#[derive(Default)]
pub(crate) struct Given {
    names: Arc<Names>,
    controllers: Vec<(String, Py<PyAny>)>,
    applications: Vec<(StationKind, String, Py<PyAny>)>,
}

impl Given {
    pub(crate) fn new(
        scenario: &Scenario,
        controllers: Option<&Bound<'_, PyDict>>,
        applications: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let names = Names::of(scenario);
        let mut given = Self::default();
        if let Some(controllers) = controllers {
            each_entry_of_dict(controllers, "a robot", |robot, controller| {
                given.controllers.push((robot, controller.unbind()));
                Ok(())
            })?;
        }
        let take = |station: String, application: Bound<'_, PyAny>| {
            let Some(id) = names.station(&station) else {
                let known = |names: &[String]| if names.len() > 4 { &names[..4] } else { names }.join(", ");
                return Err(PyKeyError::new_err(format!(
                    "there is no station `{station}`; nodes: {} ..; robots: {}; sinks: {}",
                    known(names.nodes()),
                    known(names.robots()),
                    known(names.sinks())
                )));
            };
            given.applications.push((names.kind(id), station, application.unbind()));
            Ok(())
        };
        if let Some(applications) = applications {
            each_entry_of_dict(applications, "a station", take)?;
        }
        given.names = Arc::new(names);
        Ok(given)
    }

    /// Runs the scenario with these programs.
    pub(crate) fn run(
        self,
        scenario: &Scenario,
        observer: &mut (impl RunObserver + Send),
        supervisor: &Supervisor,
    ) -> Result<Run, RunError> {
        if self.controllers.is_empty() && self.applications.is_empty() {
            return sextant::run(scenario, observer, supervisor);
        }
        // This thread stays known to the interpreter, so that each call of a program is short.
        let run = Python::attach(|py| {
            let programs = self.programs(py, scenario, supervisor)?;
            Ok::<_, PyErr>(py.detach(|| run_with(scenario, programs, observer, supervisor)))
        });
        run.unwrap_or_else(|error| {
            let words = RunError::Observer(error.to_string());
            supervisor.brake().fail(error);
            Err(words)
        })
    }

    fn programs(self, py: Python<'_>, scenario: &Scenario, supervisor: &Supervisor) -> PyResult<Programs<'static>> {
        let mut programs = Programs::default();
        for (robot, object) in self.controllers {
            let controller =
                PyController::new(py, (&robot, object), scenario, Arc::clone(&self.names), supervisor.brake())?;
            programs = programs.with_controller(&robot, Box::new(controller));
        }
        for (kind, station, object) in self.applications {
            let application =
                PyApplication::new(py, (&station, object), scenario, Arc::clone(&self.names), supervisor.brake())?;
            let application = Box::new(application);
            programs = match kind {
                StationKind::Node => programs.with_node(&station, application),
                StationKind::Robot => programs.with_robot(&station, application),
                StationKind::Sink => programs.with_sink(&station, application),
            };
        }
        Ok(programs)
    }
}
