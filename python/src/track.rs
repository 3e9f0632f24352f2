//! Tracks of tags among receivers at known places.

use std::path::PathBuf;

use arrow_array::RecordBatch;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sextant::logs::{self, ReadOptions, RobotLogError, TagTables, TrueNodes};
use sextant::mapper::{PathError, Track, TrackPose, TrackSettings};
use sextant::mapping::{self, MapLogError, TrackJob, TrackSource};
use sextant::summary::{Stopwatch, TrackSummary};

use crate::error::OrException;
use crate::given::batch_of;
use crate::log::seconds;
use crate::options::read_options;
use crate::table::{Columns, Table};
use crate::table_log::{self, Given, memory_table};
use crate::values::of_serialized;
use crate::whole::threads;
use crate::work::supervised;

/// What tracks are made from, as Python says it.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tagged<'py> {
    /// A file or a folder, or the tables after it.
    path: Option<PathBuf>,
    places: Option<Bound<'py, PyAny>>,
    heard: Option<Bound<'py, PyAny>>,
    ranges: Option<Bound<'py, PyAny>>,
    tags: Option<Bound<'py, PyAny>>,
    known: Bound<'py, PyAny>,
    truth: Option<Bound<'py, PyAny>>,
    antenna_height: Option<f64>,
    side: Option<(f64, f64)>,
    path_error: Option<String>,
    threads: Option<Bound<'py, PyAny>>,
}

/// A file, or a table.
enum FileOrTable {
    File(PathBuf),
    Table(RecordBatch),
}

impl FileOrTable {
    fn of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        match given.extract::<PathBuf>() {
            Ok(path) => Ok(Self::File(path)),
            Err(_) => Ok(Self::Table(batch_of(given)?)),
        }
    }

    /// The places of nodes in it.
    fn nodes(&self, notes: &mut Vec<String>) -> Result<TrueNodes, RobotLogError> {
        match self {
            Self::File(path) => logs::read_truth(path, None, None, notes),
            Self::Table(table) => logs::read_truth_table(&memory_table("known", table)?, None, None, notes),
        }
    }

    /// The path in it.
    fn path(&self, options: &ReadOptions, notes: &mut Vec<String>) -> Result<logs::Path, RobotLogError> {
        match self {
            Self::File(path) => logs::read_true_path(path, options, notes),
            Self::Table(table) => logs::read_true_path_table(&memory_table("truth", table)?, options, notes),
        }
    }
}

/// The tables of a log of tags.
#[derive(Default)]
struct Tables {
    places: Option<RecordBatch>,
    heard: Option<RecordBatch>,
    ranges: Option<RecordBatch>,
    tags: Option<RecordBatch>,
}

impl Tables {
    /// Calls `visit` with what they are: the log of a robot that stopped, or what was measured between tags and receivers.
    fn visit<T>(
        &self,
        options: &ReadOptions,
        visit: impl FnOnce(TrackSource<'_>) -> Result<T, MapLogError>,
    ) -> Result<T, MapLogError> {
        if let Some(stops) = self.places.as_ref().filter(|places| places.column_by_name("stop").is_some()) {
            let given = Given {
                places: stops.clone(),
                heard: self.heard.clone(),
                ranges: self.ranges.clone(),
                contacts: None,
            };
            return visit(TrackSource::Log(&table_log::read(&given, options)?));
        }
        let ranges = self.ranges.as_ref().map(|batch| memory_table("ranges", batch)).transpose()?;
        let packets = self.heard.as_ref().map(|batch| memory_table("packets", batch)).transpose()?;
        let odometry = self.places.as_ref().map(|batch| memory_table("odometry", batch)).transpose()?;
        let tags = self.tags.as_ref().map(|batch| memory_table("tags", batch)).transpose()?;
        visit(TrackSource::Tables(&TagTables { ranges, packets, odometry, tags }))
    }
}

/// Tracks of tags.
#[pyclass(frozen, module = "sextant._native")]
pub(crate) struct Tracks {
    tracks: Vec<(String, Track)>,
    summaries: Vec<TrackSummary>,
    notes: Vec<String>,
}

#[pymethods]
impl Tracks {
    /// The poses of all tags, as the columns of the file of a track.
    #[getter]
    fn track(&self) -> PyResult<Table> {
        // Columns are made of iterators that know their length.
        let all = self.tracks.iter().flat_map(|(tag, track)| track.poses.iter().map(move |pose| (tag, pose)));
        let all: Vec<(&String, &TrackPose)> = all.collect();
        let poses = || all.iter().copied();
        let numbers = |of: fn(&TrackPose) -> f64| poses().map(move |(_, pose)| of(pose));
        Columns::default()
            .numbers("t_s", poses().map(|(_, pose)| seconds(pose.time)))
            .texts("tag", poses().map(|(tag, _)| tag))
            .places(poses().map(|(_, pose)| pose.position))
            .numbers("cov_xx_m2", numbers(|pose| pose.covariance[0][0]))
            .numbers("cov_xy_m2", numbers(|pose| pose.covariance[0][1]))
            .numbers("cov_yy_m2", numbers(|pose| pose.covariance[1][1]))
            .optional_numbers("cov_zz_m2", poses().map(|(_, pose)| pose.height_variance_m2))
            .numbers("velocity_x_m_per_s", numbers(|pose| pose.velocity_m_per_s[0]))
            .numbers("velocity_y_m_per_s", numbers(|pose| pose.velocity_m_per_s[1]))
            .table()
    }

    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_serialized(py, &self.summaries)
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    fn __repr__(&self) -> String {
        let of = |(tag, track): &(String, Track)| format!("{tag}: {} poses", track.poses.len());
        format!("sextant.Tracks({})", self.tracks.iter().map(of).collect::<Vec<_>>().join(", "))
    }
}

/// The tracks of tags.
#[pyfunction]
pub(crate) fn track(
    py: Python<'_>,
    tagged: Tagged<'_>,
    options: &Bound<'_, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Tracks> {
    let options = read_options(options)?;
    let threads = threads(tagged.threads.as_ref())?;
    let finite = |name: &str, value: f64| {
        let refused = || PyValueError::new_err(format!("`{name}` is {value}; allowed: a finite number of metres"));
        if value.is_finite() { Ok(value) } else { Err(refused()) }
    };
    let height_m = tagged.antenna_height.map(|height_m| finite("antenna_height", height_m)).transpose()?;
    let side = tagged.side.map(|(x, y)| Ok::<_, PyErr>([finite("side", x)?, finite("side", y)?])).transpose()?;
    let odometry = match &tagged.path_error {
        Some(text) => text.parse().map_err(|why| PyValueError::new_err(format!("`path_error`: {why}")))?,
        None => PathError::default(),
    };
    let path = tagged.path.clone();
    let known = FileOrTable::of(&tagged.known)?;
    let truth = tagged.truth.as_ref().map(FileOrTable::of).transpose()?;
    let table = |given: &Option<Bound<'_, PyAny>>| given.as_ref().map(batch_of).transpose();
    let tables = Tables {
        places: table(&tagged.places)?,
        heard: table(&tagged.heard)?,
        ranges: table(&tagged.ranges)?,
        tags: table(&tagged.tags)?,
    };
    if path.is_none() && tables.ranges.is_none() && tables.heard.is_none() {
        return Err(PyTypeError::new_err("a track needs ranges, or receptions with strengths, and there is neither"));
    }
    let done = supervised(py, threads, progress.as_ref(), |supervisor| -> Result<_, MapLogError> {
        let mut notes = Vec::new();
        let known = known.nodes(&mut notes)?.places;
        let truth = truth.as_ref().map(|truth| truth.path(&options, &mut notes)).transpose()?;
        let settings = TrackSettings { height_m, side, odometry };
        let tracks = |source: TrackSource<'_>| {
            let job = TrackJob { source, known: &known, options: &options, settings, truth: truth.as_ref() };
            mapping::tracks(&job, Stopwatch::start(), supervisor)
        };
        let (summary, tracks) = match &path {
            Some(path) => tracks(TrackSource::File(path))?,
            None => tables.visit(&options, tracks)?,
        };
        notes.extend(summary.notes);
        Ok(Tracks { tracks, summaries: summary.tracks, notes })
    })?;
    done.or_exception(py)
}
