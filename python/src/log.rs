//! Logs.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sextant::channel::{Reception, ReceptionLog};
use sextant::kernel::SimTime;
use sextant::logs::doctor::Finding;
use sextant::logs::{self, ReadOptions, RobotFrames, RobotLog, Source};
use sextant::mapping::{self, Input};
use sextant::scenario::AlgorithmName;
use sextant::summary::Stopwatch;

use crate::entries::each_entry_of_dict;
use crate::error::OrException;
use crate::given::batch_of;
use crate::map::{Map, Origin};
use crate::options::read_options;
use crate::run::tables_of;
use crate::table::{Columns, Table};
use crate::table_log::{self, Given};
use crate::values::setting;
use crate::whole::threads;
use crate::work::supervised;

/// A log of receptions, with what is known with it.
#[pyclass(frozen, module = "sextant._native")]
pub(crate) struct Log {
    origin: Arc<Origin>,
    /// What was seen on reading it to be odd.
    seen: Vec<Finding>,
    /// All that is odd in it, once it was looked for.
    findings: OnceLock<Vec<String>>,
}

/// How a log is mapped, as Python says it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Mapping<'py> {
    algorithm: Option<String>,
    profile: Option<String>,
    network: Option<String>,
    area: Option<String>,
    near_stops: Option<f64>,
    threads: Option<Bound<'py, PyAny>>,
}

impl Log {
    /// A log of which all is known that is odd in it.
    fn examined(title: String, input: Input, findings: Vec<String>) -> Self {
        Self { origin: Arc::new(Origin { title, input }), seen: Vec::new(), findings: findings.into() }
    }

    /// What is in it, with `network` first if that is given.
    pub(crate) fn input_of(&self, network: Option<&str>) -> PyResult<Input> {
        let mut input = self.origin.input.clone();
        if let Some(network) = network
            && let Err(known) = input.logs.put_first(network)
        {
            let known: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
            let known =
                if known.is_empty() { "it is of one network without a name".to_owned() } else { known.join(", ") };
            return Err(PyValueError::new_err(format!("the log has no network `{network}`; networks: {known}")));
        }
        Ok(input)
    }
}

#[pymethods]
impl Log {
    #[getter]
    fn stops(&self) -> PyResult<Table> {
        stops_of(self.origin.input.log())
    }

    #[getter]
    fn receptions(&self) -> PyResult<Table> {
        receptions_of(self.origin.input.log())
    }

    #[getter]
    fn nodes(&self) -> Vec<String> {
        self.origin.input.log().names().to_vec()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.origin.input.notes.clone()
    }

    #[getter]
    fn findings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        if self.findings.get().is_none() {
            let input = &self.origin.input;
            let (log, plane) = (input.log().clone(), input.plane);
            let (notes, findings, middles) = (Vec::new(), self.seen.clone(), input.middles.clone());
            let read = RobotLog { log, plane, notes, findings, clock: None, middles, odometry: None };
            let examined = supervised(py, None, None, |_| logs::examine(read, RobotFrames::Shared))?;
            // Another thread may have been faster, with the same result.
            let _ = self.findings.set(examined.findings.iter().map(ToString::to_string).collect());
        }
        Ok(self.findings.get().cloned().unwrap_or_default())
    }

    #[getter]
    fn networks(&self) -> Vec<String> {
        self.origin.input.logs.names().map(str::to_owned).collect()
    }

    /// All tables of a recording, by name.
    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(String, Table)>> {
        match &self.origin.input.recording {
            Some(recording) => tables_of(py, recording),
            None => Err(PyValueError::new_err("only a recording of a run has tables; this is the log of a robot")),
        }
    }

    /// The maps of the log.
    fn map(
        &self,
        py: Python<'_>,
        mapping: Mapping<'_>,
        set: &Bound<'_, PyDict>,
        truth: Option<&Bound<'_, PyAny>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Vec<Map>> {
        let threads = self::threads(mapping.threads.as_ref())?;
        let mut given = Vec::new();
        each_entry_of_dict(set, "a setting", |key, value| {
            given.push(setting(&key, &value)?);
            Ok(())
        })?;
        let algorithm = mapping.algorithm.as_deref().map(str::parse::<AlgorithmName>).transpose();
        let algorithm = algorithm.map_err(|why| PyValueError::new_err(why.to_string()))?;
        let network = mapping.network.as_deref();
        let mut input = self.input_of(network)?;
        if let Some(truth) = truth {
            let table = batch_of(truth)?;
            let truth = table_log::truth(&table, input.plane.as_ref(), &mut input.notes).or_exception(py)?;
            input.take_truth(truth);
        }
        let settings = input.map_settings(algorithm, mapping.profile.as_deref(), network, &given);
        let settings = settings.or_exception(py)?;
        let prior =
            mapping::place_prior(mapping.area.as_deref(), mapping.near_stops, input.plane.as_ref(), &settings.maps);
        input.prior = prior.or_exception(py)?;
        let known_notes = input.notes.len();
        let done = supervised(py, threads, progress.as_ref(), |supervisor| {
            mapping::map(&mut input, &settings, None, Stopwatch::start(), supervisor)
        })?;
        let (summary, computed) = done.or_exception(py)?;
        let notes = input.notes.split_off(known_notes.min(input.notes.len()));
        let origin = Arc::new(Origin { title: self.origin.title.clone(), input });
        let maps = computed.into_iter().zip(summary.maps);
        Ok(maps.map(|(map, summary)| Map::of_log(Arc::clone(&origin), map, summary, notes.clone())).collect())
    }

    fn __repr__(&self) -> String {
        let log = self.origin.input.log();
        let (stops, nodes, rows) = (log.stops().len(), log.node_count(), log.receptions().len());
        format!("sextant.Log({}: {stops} stops, {nodes} nodes, {rows} receptions)", self.origin.title)
    }
}

/// Reads what the command line reads: a recording, a folder of tables, a ROS bag, a capture.
#[pyfunction]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    network: Option<String>,
    options: &Bound<'_, PyDict>,
) -> PyResult<Log> {
    let options = read_options(options)?;
    let title = path.file_stem().map_or_else(|| "log".to_owned(), |name| name.to_string_lossy().into_owned());
    // Findings are of logs of robots alone.
    let read = supervised(py, None, None, |_| -> Result<_, mapping::MapLogError> {
        if Source::of(&path).is_some() {
            let mut read = logs::read(&path, &options)?;
            let found = std::mem::take(&mut read.findings).iter().map(ToString::to_string).collect();
            return Ok((Input::of_log(read), found));
        }
        Ok((Input::read(&path, network.as_deref(), &options)?, Vec::new()))
    })?;
    let (input, findings) = read.or_exception(py)?;
    Ok(Log::examined(title, input, findings))
}

/// A log of tables in memory.
#[pyfunction]
pub(crate) fn log_of_tables(
    py: Python<'_>,
    places: &Bound<'_, PyAny>,
    heard: Option<&Bound<'_, PyAny>>,
    contacts: Option<&Bound<'_, PyAny>>,
    ranges: Option<&Bound<'_, PyAny>>,
    options: &Bound<'_, PyDict>,
) -> PyResult<Log> {
    let options: ReadOptions = read_options(options)?;
    let contacts = contacts.map(batch_of).transpose()?;
    let [heard, ranges] = [heard, ranges].map(|table| table.map(batch_of).transpose());
    let (heard, ranges) = (heard?, ranges?);
    if heard.is_none() && ranges.is_none() {
        let problem = "a log has receptions (or packets), or `ranges` that were measured, and this one has neither";
        return Err(PyTypeError::new_err(problem));
    }
    let given = Given { places: batch_of(places)?, heard, ranges, contacts };
    let read = supervised(py, None, None, |_| table_log::read(&given, &options))?;
    let mut read = read.or_exception(py)?;
    let seen = std::mem::take(&mut read.findings);
    let origin = Arc::new(Origin { title: "log".to_owned(), input: Input::of_log(read) });
    Ok(Log { origin, seen, findings: OnceLock::new() })
}

/// The stops of a log, as the columns of stops.csv.
pub(crate) fn stops_of(log: &ReceptionLog) -> PyResult<Table> {
    let stops = log.stops();
    Columns::default()
        .whole("stop", 0..i64::try_from(stops.len()).map_err(|why| PyTypeError::new_err(why.to_string()))?)
        .numbers("t_s", stops.iter().map(|stop| seconds(stop.time)))
        .places(stops.iter().map(|stop| stop.position))
        .when(!log.robots().is_empty(), |columns| {
            columns.texts("robot", stops.iter().map(|stop| log.robot_name(stop.robot).into_owned()))
        })
        .when(log.has_headings(), |columns| {
            columns.optional_numbers("heading_rad", stops.iter().map(|stop| stop.heading_rad))
        })
        .table()
}

/// The receptions of a log, as the columns of receptions.csv.
pub(crate) fn receptions_of(log: &ReceptionLog) -> PyResult<Table> {
    let all = log.receptions();
    let names = log.names();
    let has = |is_there: fn(Reception) -> bool| all.iter().any(&is_there);
    Columns::default()
        .texts("node", all.iter().map(|reception| &names[reception.node.index()]))
        .whole("stop", all.iter().map(|reception| i64::from(reception.stop)))
        .whole("received", all.iter().map(|reception| i64::from(reception.received)))
        .whole("sent", all.iter().map(|reception| i64::from(reception.sent)))
        .when(has(|reception| reception.sector.is_some()), |columns| {
            columns.optional_whole("sector", all.iter().map(|reception| reception.sector.map(i64::from)))
        })
        .when(has(|reception| reception.rssi_dbm.is_some()), |columns| {
            columns.optional_numbers("rssi_dbm", all.iter().map(|reception| reception.rssi_dbm))
        })
        .when(has(|reception| reception.snr_db.is_some()), |columns| {
            columns.optional_numbers("snr_db", all.iter().map(|reception| reception.snr_db))
        })
        .table()
}

/// A time in seconds: of all numbers the nearest one, so that its shortest text is exact to the nanosecond for 104 days.
#[expect(clippy::cast_precision_loss, reason = "times of months are exact")]
pub(crate) fn seconds(time: SimTime) -> f64 {
    time.as_nanos() as f64 / 1e9
}
