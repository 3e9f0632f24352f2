//! What applications did: ways, captures, predictions and time series.

use serde::Serialize;
use sextant_recording::RecordedApplication;

use super::column::Column;
use super::frame::Frame;
use super::plane::Plane;
use super::world::{Body, Way};

/// An application.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReportedMission {
    /// Its name.
    pub name: String,
    /// Its algorithm.
    pub algorithm: String,
    /// Name of its map.
    pub map: String,
    /// Name of the field whose source it seeks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// The level that it seeks, in the unit of the field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<f64>,
    /// When its phase begins (s).
    pub start_s: f64,
    /// The ways of its robots, without times.
    pub robots: Vec<Body>,
    /// The targets in its phase.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub targets: Vec<Body>,
    /// The recorded instants of the fields in its phase.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<Plane>,
    /// Where stations thought that targets were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predictions: Option<Predictions>,
    /// The captured targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub captures: Option<Captures>,
    /// Its time series.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub series: Vec<TimeSeries>,
}

/// Where stations thought that targets were, in the world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Predictions {
    /// When (s).
    pub times_s: Column,
    /// Coordinates (m).
    pub places_m: Column,
}

/// Captured targets.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Captures {
    /// When (s).
    pub times_s: Column,
    /// Coordinates (m).
    pub places_m: Column,
    /// Names of the robots.
    pub robots: Vec<String>,
    /// Names of the targets.
    pub targets: Vec<String>,
}

/// A value over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeSeries {
    /// Its name: `STATION/WHAT`.
    pub name: String,
    /// When (s).
    pub times_s: Column,
    /// The values.
    pub values: Column,
}

impl ReportedMission {
    /// What is recorded of an application.
    pub(super) fn of(recorded: &RecordedApplication, frame: &Frame) -> Self {
        let RecordedApplication { target_places, captures, .. } = recorded;
        let way = |(name, path): &(String, Vec<_>)| Body { name: name.clone(), way: Way::untimed(path, frame) };
        let series = |(name, points): &(String, Vec<_>)| TimeSeries {
            name: name.clone(),
            times_s: frame.times(points.iter().map(|(time, _)| *time)),
            values: Column::reals(points.iter().map(|(_, value)| *value)),
        };
        Self {
            name: recorded.name.clone(),
            algorithm: recorded.algorithm.clone(),
            map: recorded.map.clone(),
            field: recorded.field.clone(),
            level: recorded.level,
            start_s: frame.seconds(recorded.start),
            robots: recorded.paths.iter().map(way).collect(),
            targets: recorded.targets.iter().map(|target| Body::of_target(target, frame)).collect(),
            fields: Plane::of_fields(&recorded.fields, frame),
            predictions: (!target_places.is_empty()).then(|| Predictions {
                times_s: frame.times(target_places.iter().map(|at| at.time)),
                places_m: frame.places(target_places.iter().map(|at| at.place)),
            }),
            captures: (!captures.is_empty()).then(|| Captures {
                times_s: frame.times(captures.iter().map(|capture| capture.time)),
                places_m: frame.places(captures.iter().map(|capture| capture.place)),
                robots: captures.iter().map(|capture| capture.robot.clone()).collect(),
                targets: captures.iter().map(|capture| capture.target.clone()).collect(),
            }),
            series: recorded.series.iter().map(series).collect(),
        }
    }
}
