//! Runs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sextant::channel::ReceptionLog;
use sextant::kernel::NodeId;
use sextant::mapping::Input;
use sextant::recording::read_tables;
use sextant::run::{MissionEnd, SimulationStart, SurveyEnd};
use sextant::scenario::Scenario as Checked;
use sextant::sim::{Observer, Progress};
use sextant::{RunError, RunObserver, RunRecorder};

use crate::error::OrException;
use crate::log::{receptions_of, stops_of};
use crate::map::{Map, Origin};
use crate::programs::Given;
use crate::scenario::Scenario;
use crate::table::{Columns, Table};
use crate::values::of_serialized;
use crate::work::{Supervisor, guarded};

/// A run that is over.
#[pyclass(frozen, module = "sextant._native")]
pub(crate) struct Run {
    scenario: Scenario,
    run: sextant::Run,
    record: Option<PathBuf>,
    maps: Vec<Py<Map>>,
}

/// Runs `scenario` with the programs of the user.
pub(crate) fn simulate(
    scenario: &Checked,
    given: Given,
    record: Option<&Path>,
    supervisor: &Supervisor,
) -> Result<sextant::Run, RunError> {
    let mut observer = (record.map(RunRecorder::new), Told { supervisor, of: None });
    given.run(scenario, &mut observer, supervisor)
}

/// Tells how far simulations are.
struct Told<'a> {
    supervisor: &'a Supervisor,
    of: Option<Of>,
}

/// What is told of a simulation, and how many steps it has.
#[derive(Clone, Copy)]
enum Of {
    NodesHeard(u64),
    Seconds(u64),
}

impl Observer for Told<'_> {
    fn goes_on(&mut self, progress: Progress) -> bool {
        match self.of {
            Some(Of::NodesHeard(nodes)) => self.supervisor.set("gathering", nodes, progress.nodes_heard as u64),
            Some(Of::Seconds(seconds)) => {
                self.supervisor.set("simulating", seconds, progress.time.as_nanos() / 1_000_000_000);
            }
            None => {}
        }
        true
    }
}

impl RunObserver for Told<'_> {
    fn simulation_started(&mut self, start: &SimulationStart<'_>) -> Result<(), RunError> {
        let duration = match start.mission {
            Some(application) => Some(application.duration),
            None => start.scenario.config().duration_s.map(std::time::Duration::from_secs_f64),
        };
        let surveys = start.mission.is_none() && !start.robots.is_empty();
        self.of = match duration.filter(|_| !surveys) {
            Some(duration) => Some(Of::Seconds(duration.as_secs())),
            None => Some(Of::NodesHeard(start.scenario.world().nodes.len() as u64)),
        };
        Ok(())
    }

    fn survey_finished(&mut self, _end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.of = None;
        Ok(())
    }

    fn mission_finished(&mut self, _end: &MissionEnd<'_>) -> Result<(), RunError> {
        self.of = None;
        Ok(())
    }
}

impl Run {
    pub(crate) fn new(scenario: Scenario, run: sextant::Run, record: Option<PathBuf>) -> PyResult<Self> {
        let origin = run.survey().map(|survey| {
            let nodes = scenario.0.world().nodes.iter();
            let truth = nodes.map(|node| (node.name.clone(), node.position)).collect();
            let mut input = Input::of_networks(survey.logs.clone());
            input.truth = Some(truth);
            Arc::new(Origin { title: scenario.0.name().to_owned(), input })
        });
        let maps = origin
            .iter()
            .flat_map(|origin| run.maps().iter().map(|made| Map::of_run(Arc::clone(origin), &scenario.0, made)));
        let maps = Python::attach(|py| maps.map(|map| Py::new(py, map)).collect::<PyResult<_>>())?;
        Ok(Self { scenario, run, record, maps })
    }

    fn log(&self) -> PyResult<&ReceptionLog> {
        let survey = self.run.survey().ok_or_else(|| PyValueError::new_err("the scenario has no survey"))?;
        Ok(survey.logs.first())
    }
}

#[pymethods]
impl Run {
    #[getter]
    fn scenario(&self) -> Scenario {
        self.scenario.clone()
    }

    #[getter]
    fn record(&self) -> Option<PathBuf> {
        self.record.clone()
    }

    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_serialized(py, self.run.summary())
    }

    #[getter]
    fn stops(&self) -> PyResult<Table> {
        stops_of(self.log()?)
    }

    #[getter]
    fn receptions(&self) -> PyResult<Table> {
        receptions_of(self.log()?)
    }

    #[getter]
    fn nodes(&self) -> PyResult<Table> {
        let nodes = &self.scenario.0.world().nodes;
        Columns::default()
            .texts("node", nodes.iter().map(|node| &node.name))
            .places(nodes.iter().map(|node| node.position))
            .table()
    }

    #[getter]
    fn maps(&self, py: Python<'_>) -> Vec<(String, Py<Map>)> {
        self.maps.iter().map(|map| (map.get().name().to_owned(), map.clone_ref(py))).collect()
    }

    #[getter]
    fn interrupted(&self) -> bool {
        self.run.summary().interrupted
    }

    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(String, Table)>> {
        match &self.record {
            Some(record) => tables_of(py, record),
            None => Err(PyValueError::new_err("the run was not recorded; give `record=\"run.mcap\"`")),
        }
    }

    /// How many nodes were heard at least once, in words.
    #[getter]
    fn heard_text(&self) -> String {
        let nodes = self.scenario.0.world().nodes.len();
        let Ok(log) = self.log() else { return format!("{nodes} nodes, no survey") };
        let is_heard =
            |node: &usize| log.of(NodeId::from_index(*node)).iter().any(|reception| reception.received > 0);
        format!("{} of {nodes} nodes heard", (0..log.node_count()).filter(is_heard).count())
    }
}

/// All tables of a recording, by name.
pub(crate) fn tables_of(py: Python<'_>, recording: &Path) -> PyResult<Vec<(String, Table)>> {
    let mut made: Vec<(String, crate::recorded::Growing)> = Vec::new();
    let read = guarded(py, || {
        read_tables(recording, &mut |piece| {
            crate::recorded::take(&mut made, &piece);
            Ok(())
        })
    });
    read?.or_exception(py)?;
    made.into_iter().map(|(name, table)| Ok((name, table.finish()?))).collect()
}
