//! Maps.

use std::sync::Arc;

use pyo3::prelude::*;
use sextant::Scenario;
use sextant::channel::Position;
use sextant::logs::COVARIANCE;
use sextant::mapper::{Concern, CoordinateFrame, Estimate, EstimatorFindings, TopologyMap};
use sextant::mapping::{ComputedMap, Input};
use sextant::run::Evaluation;
use sextant::scenario::{AlgorithmName, MapJob};
use sextant::summary::MapSummary;

use crate::picture::{self, Drawn};
use crate::table::{Columns, Table};
use crate::values::of_serialized;
use crate::work::guarded;

/// The log that maps are of, and its title in pictures.
pub(crate) struct Origin {
    pub(crate) title: String,
    pub(crate) input: Input,
}

/// A map.
#[pyclass(frozen, module = "sextant._native")]
pub(crate) struct Map {
    origin: Arc<Origin>,
    name: String,
    /// The map among those to compute; `None` for one that nodes computed.
    job: Option<MapJob>,
    map: TopologyMap,
    learned: Option<EstimatorFindings>,
    summary: MapSummary,
    notes: Vec<String>,
}

impl Map {
    /// A map of a run.
    pub(crate) fn of_run(origin: Arc<Origin>, scenario: &Scenario, made: &Evaluation) -> Self {
        let Evaluation { name, map, learned, summary, .. } = made.clone();
        let job = scenario.maps().iter().find(|job| job.name == name).cloned();
        Self { origin, name, job, map, learned, summary, notes: Vec::new() }
    }

    /// A map of a log.
    pub(crate) fn of_log(
        origin: Arc<Origin>,
        computed: ComputedMap<'_>,
        summary: MapSummary,
        notes: Vec<String>,
    ) -> Self {
        let ComputedMap { named, map, learned } = computed;
        Self { origin, name: named.name.clone(), job: Some(named.clone()), map, learned, summary, notes }
    }

    fn computed(&self) -> Option<ComputedMap<'_>> {
        let named = self.job.as_ref()?;
        Some(ComputedMap { named, map: self.map.clone(), learned: self.learned.clone() })
    }

    /// The nodes that have a place.
    fn placed(&self) -> impl Iterator<Item = (&String, &Estimate)> + Clone {
        let names = self.origin.input.log().names();
        names.iter().zip(&self.map.estimates).filter_map(|(name, estimate)| Some((name, estimate.as_ref()?)))
    }
}

#[pymethods]
impl Map {
    #[getter]
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn algorithm(&self) -> &str {
        self.map.algorithm
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_serialized(py, &self.summary)
    }

    /// The places, as the columns of the file of a map.
    #[getter]
    fn places(&self) -> PyResult<Table> {
        let has_covariance = self.placed().any(|(_, place)| place.covariance.is_some());
        let plane = self.origin.input.plane.filter(|_| !matches!(self.map.frame, CoordinateFrame::Relative(_)));
        let mut columns = Columns::default()
            .texts("node", self.placed().map(|(name, _)| name))
            .places(self.placed().map(|(_, place)| place.position))
            .whole("ties", self.placed().map(|(_, place)| i64::from(place.ties)))
            .flags("infeasible", self.placed().map(|(_, place)| place.infeasible))
            .optional_texts(
                "concern",
                self.placed().map(|(_, place)| place.concern.map(|concern: Concern| concern.name().to_owned())),
            );
        for (row, column, name) in COVARIANCE.into_iter().filter(|_| has_covariance) {
            let entries = self.placed().map(|(_, place)| place.covariance.map(|covariance| covariance[row][column]));
            columns = columns.optional_numbers(name, entries);
        }
        if let Some(plane) = plane {
            let on_earth = || self.placed().map(|(_, place)| plane.to_geodetic(place.position).rounded());
            columns = columns
                .numbers("lat", on_earth().map(|place| place.lat_deg))
                .numbers("lon", on_earth().map(|place| place.lon_deg))
                .when(plane.has_altitude(), |columns| {
                    columns.numbers("alt_m", on_earth().map(|place| place.height_m))
                });
        }
        columns.table()
    }

    /// The true places of the nodes of the log that have one.
    #[getter]
    fn truth(&self) -> PyResult<Option<Table>> {
        let Some(truth) = &self.origin.input.truth else { return Ok(None) };
        let names = self.origin.input.log().names();
        let known: Vec<(&String, Position)> =
            names.iter().filter_map(|name| Some((name, *truth.get(name)?))).collect();
        let table = Columns::default()
            .texts("node", known.iter().map(|(name, _)| name))
            .places(known.iter().map(|(_, place)| *place))
            .table()?;
        Ok(Some(table))
    }

    /// The stops of the log.
    #[getter]
    fn stops(&self) -> PyResult<Table> {
        crate::log::stops_of(self.origin.input.log())
    }

    /// All figures of the map, each with its name, as SVG.
    fn figures(&self, py: Python<'_>) -> PyResult<Vec<Drawn>> {
        guarded(py, || picture::of_map(&self.origin, self.computed().as_ref()))?
    }

    fn __repr__(&self) -> String {
        let (mapped, all) = (self.map.mapped(), self.map.estimates.len());
        let error = self.summary.position_error_m.as_ref();
        let error = error.map_or_else(String::new, |error| format!(", {:.2} m mean error", error.mean));
        format!("sextant.Map({}: {mapped} of {all} nodes{error})", self.name)
    }
}

/// The algorithms by name, each with its description.
#[pyfunction]
pub(crate) fn algorithms() -> Vec<(&'static str, &'static str)> {
    AlgorithmName::all().into_iter().map(|algorithm| (algorithm.name(), algorithm.description())).collect()
}
