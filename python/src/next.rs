//! Where to drive next.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use sextant::floorplan::{FloorPlanError, LengthUnit};
use sextant::mapping;
use sextant::next::{NextSettings, map_settings, next_stops as stops_of};
use sextant::scenario::AlgorithmName;

use crate::error::OrException;
use crate::log::Log;
use crate::values::of_serialized;
use crate::whole::threads;
use crate::work::supervised;

/// What is asked of a log, as Python says it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked<'py> {
    stops: usize,
    algorithm: Option<String>,
    profile: Option<String>,
    network: Option<String>,
    area: Option<String>,
    floorplan: Option<PathBuf>,
    floorplan_unit: Option<String>,
    way_m: Option<f64>,
    speed_m_per_s: Option<f64>,
    listen_s: Option<f64>,
    radius_m: f64,
    robot: Option<String>,
    threads: Option<Bound<'py, PyAny>>,
}

/// The stops that bring most, as `sextant next` prints them.
#[pyfunction]
pub(crate) fn next_stops<'py>(
    py: Python<'py>,
    log: &Log,
    asked: Asked<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let threads = threads(asked.threads.as_ref())?;
    let algorithm = asked.algorithm.as_deref().map(str::parse::<AlgorithmName>).transpose();
    let algorithm = algorithm.map_err(|why| PyValueError::new_err(why.to_string()))?;
    let mut input = log.input_of(asked.network.as_deref())?;
    let settings = map_settings(&input, algorithm, asked.profile.as_deref(), asked.network.as_deref());
    let settings = settings.or_exception(py)?;
    let area = asked.area.as_deref().map(|text| mapping::read_area(text, input.plane.as_ref())).transpose();
    if let Some(path) = &asked.floorplan {
        let unit = asked.floorplan_unit.as_deref().map(str::parse::<LengthUnit>).transpose();
        let unit = unit.map_err(|why| PyValueError::new_err(format!("floorplan_unit: {why}")))?;
        let refused = |why: FloorPlanError| why.to_string().replace("option `unit`", "`floorplan_unit`");
        input.lay(path, unit).map_err(|why| PyValueError::new_err(refused(why)))?;
    }
    let asked = NextSettings {
        stops: asked.stops,
        area: area.or_exception(py)?,
        way_m: asked.way_m,
        speed_m_per_s: asked.speed_m_per_s,
        listen_s: asked.listen_s,
        radius_m: asked.radius_m,
        robot: asked.robot,
    };
    let found = supervised(py, threads, progress.as_ref(), |supervisor| {
        stops_of(&mut input, &settings, &asked, supervisor).map(|(found, _)| found)
    })?;
    of_serialized(py, &found.or_exception(py)?)
}
