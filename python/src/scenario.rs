//! Scenarios.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};
use sextant::forecast::warnings;
use sextant::recording::admission::{OutputKind, Outputs, Replace};
use sextant::sim::RoleConfig;
use sextant::template::Template;

use crate::entries::each_entry_of_dict;
use crate::error::OrException;
use crate::programs::Given;
use crate::run::{Run, simulate};
use crate::table::{Columns, Table};
use crate::values::{document, of_serialized, setting};
use crate::whole::{threads, whole};
use crate::work::{guarded, supervised};

/// A scenario, checked.
#[pyclass(frozen, module = "sextant._native")]
#[derive(Clone)]
pub(crate) struct Scenario(pub(crate) sextant::Scenario);

/// Settings of Python as those of the library: each `key=value`, and the seed.
pub(crate) fn settings(settings: &Bound<'_, PyDict>) -> PyResult<(Vec<String>, Option<u64>)> {
    let (mut set, mut seed) = (Vec::new(), None);
    each_entry_of_dict(settings, "a setting", |key, value| {
        if key == "seed" {
            seed = Some(whole("seed", &value, 0..=u64::MAX)?);
        } else {
            set.push(setting(&key, &value)?);
        }
        Ok(())
    })?;
    Ok((set, seed))
}

#[pymethods]
impl Scenario {
    /// The scenario in the file `path`, with other `settings`.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, settings: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (set, seed) = self::settings(settings)?;
        let read = guarded(py, || sextant::Scenario::load_with(path, &set, seed))?;
        Ok(Self(read.or_exception(py)?))
    }

    /// The scenario of a mapping, with other `settings`.
    #[staticmethod]
    fn of_mapping(py: Python<'_>, mapping: &Bound<'_, PyMapping>, settings: &Bound<'_, PyDict>) -> PyResult<Self> {
        Self::parse(py, &document(mapping)?, settings)
    }

    /// The scenario of a TOML text, with other `settings`.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str, settings: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (set, seed) = self::settings(settings)?;
        let read = guarded(py, || sextant::Scenario::parse_with(text, &set, seed))?;
        Ok(Self(read.or_exception(py)?))
    }

    /// One of the scenarios to begin with.
    #[staticmethod]
    fn template(py: Python<'_>, name: &str, settings: &Bound<'_, PyDict>) -> PyResult<Self> {
        match Template::named(name).and_then(Template::scenario) {
            Some(template) => Self::parse(py, template.text, settings),
            None => {
                let names = Template::all().iter().filter(|template| template.scenario().is_some());
                let names: Vec<&str> = names.map(|template| template.name).collect();
                let allowed = names.join(", ");
                Err(PyValueError::new_err(format!("there is no template {name:?}; allowed: {allowed}")))
            }
        }
    }

    /// The robots that survey.
    #[getter]
    fn surveyors(&self) -> Vec<String> {
        let robots = self.0.config().robots.iter().filter(|robot| robot.role == RoleConfig::Survey);
        robots.map(|robot| robot.name.clone()).collect()
    }

    /// The names of the nodes.
    #[getter]
    fn node_names(&self) -> Vec<String> {
        self.0.world().nodes.iter().map(|node| node.name.clone()).collect()
    }

    fn with_settings(&self, py: Python<'_>, settings: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (set, seed) = self::settings(settings)?;
        Ok(Self(guarded(py, || self.0.with_all(&set, seed))?.or_exception(py)?))
    }

    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed().0
    }

    #[getter]
    fn text(&self) -> &str {
        self.0.text()
    }

    #[getter]
    fn file(&self) -> String {
        self.0.file_name()
    }

    #[getter]
    fn nodes(&self) -> usize {
        self.0.world().nodes.len()
    }

    #[getter]
    fn robots(&self) -> Vec<String> {
        self.0.config().robots.iter().map(|robot| robot.name.clone()).collect()
    }

    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        guarded(py, || warnings(&self.0).iter().map(ToString::to_string).collect())
    }

    /// The link between two stations, item by item.
    #[pyo3(signature = (a, b, network=None))]
    fn link<'py>(&self, py: Python<'py>, a: &str, b: &str, network: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let report = guarded(py, || sextant::explain_link(&self.0, a, b, network))?;
        of_serialized(py, &report.map_err(|why| PyValueError::new_err(why.to_string()))?)
    }

    /// The links over which frames are received, a row each.
    #[pyo3(signature = (network=None, least=0.01))]
    fn graph(&self, py: Python<'_>, network: Option<&str>, least: f64) -> PyResult<Table> {
        let edges = guarded(py, || sextant::link::graph(&self.0, network, least))?;
        let edges = edges.map_err(|why| PyValueError::new_err(why.to_string()))?;
        Columns::default()
            .texts("from", edges.iter().map(|edge| &edge.from))
            .texts("to", edges.iter().map(|edge| &edge.to))
            .numbers("distance_m", edges.iter().map(|edge| edge.distance_m))
            .numbers("received_dbm", edges.iter().map(|edge| edge.received_dbm))
            .numbers("probability", edges.iter().map(|edge| edge.probability))
            .table()
    }

    #[pyo3(signature = (record=None, progress=None, controllers=None, applications=None, threads=None, force=false))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn run(
        &self,
        py: Python<'_>,
        record: Option<PathBuf>,
        progress: Option<Py<PyAny>>,
        controllers: Option<&Bound<'_, PyDict>>,
        applications: Option<&Bound<'_, PyDict>>,
        threads: Option<&Bound<'_, PyAny>>,
        force: bool,
    ) -> PyResult<Run> {
        let threads = self::threads(threads)?;
        self.0.check_grids().or_exception(py)?;
        if let Some(record) = &record {
            let mut outputs = Outputs::new(if force { Replace::Any } else { Replace::Ours });
            self.0.sources().for_each(|source| {
                outputs.reads(source);
            });
            outputs.writes("record", record, OutputKind::Recording).admit().or_exception(py)?;
        }
        let given = Given::new(&self.0, controllers, applications)?;
        let done = supervised(py, threads, progress.as_ref(), |supervisor| {
            simulate(&self.0, given, record.as_deref(), supervisor)
        })?;
        Run::new(self.clone(), done.or_exception(py)?, record)
    }

    fn __repr__(&self) -> String {
        let nodes = self.nodes();
        format!("sextant.Scenario({:?}: {nodes} nodes, seed {})", self.name(), self.seed())
    }
}
