//! Applications, as figures show them.

use prost::Message as _;
use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::super::way::Way;
use super::RecordedWorld;
use super::sensing::{RecordedField, RecordedTarget};
use crate::drawing::{self, place};
use crate::messages::MetricMessage;
use crate::messages::applications::{ApplicationMessage, CaptureMessage, EstimateMessage};
use crate::messages::phase::Phase;

/// An application and its phase. All instants are those of the recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedApplication {
    /// Its name.
    pub name: String,
    /// Its algorithm.
    pub algorithm: String,
    /// Name of its map.
    pub map: String,
    /// Name of the field whose source it seeks; `None` if it searches targets.
    pub field: Option<String>,
    /// The level that it seeks, in the unit of the field.
    pub level: Option<f64>,
    /// When its phase begins.
    pub start: SimTime,
    /// The paths of its robots, by name.
    pub paths: Vec<(String, Vec<Position>)>,
    /// The targets in its phase.
    pub targets: Vec<RecordedTarget>,
    /// The recorded instants of the fields in its phase.
    pub fields: Vec<RecordedField>,
    /// Where stations thought that targets were, in the world.
    pub target_places: Vec<RecordedTargetPlace>,
    /// The captured targets.
    pub captures: Vec<RecordedCapture>,
    /// Its time series in the order of the file, each with its name below that of the application.
    pub series: Vec<(String, Vec<(SimTime, f64)>)>,
}

/// Where a station thought that a target was.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedTargetPlace {
    /// When it thought so.
    pub time: SimTime,
    /// Name of the target.
    pub target: String,
    /// The place in the world.
    pub place: Position,
}

/// A captured target.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedCapture {
    /// When.
    pub time: SimTime,
    /// Name of the robot.
    pub robot: String,
    /// Name of the target.
    pub target: String,
    /// Where the target was.
    pub place: Position,
}

impl RecordedApplication {
    /// The time series whose names end with `what`, each with the name of its station.
    pub fn series_of<'a>(&'a self, what: &'a str) -> impl Iterator<Item = (&'a str, &'a [(SimTime, f64)])> {
        let named = move |(name, points): &'a (String, Vec<_>)| {
            let station = name.strip_suffix(what)?.strip_suffix('/')?;
            Some((station, points.as_slice()))
        };
        self.series.iter().filter_map(named)
    }
}

impl RecordedWorld {
    /// Adds a message on a topic of an application.
    pub(super) fn add_application(
        &mut self,
        name: &str,
        rest: &str,
        time: SimTime,
        data: &[u8],
    ) -> Result<(), String> {
        if rest.is_empty() {
            let ApplicationMessage { name, algorithm, map, field, level, .. } =
                ApplicationMessage::decode(data).map_err(|why| why.to_string())?;
            let field = Some(field).filter(|field| !field.is_empty());
            let application = RecordedApplication {
                name,
                algorithm,
                map,
                field,
                level,
                start: time,
                ..RecordedApplication::default()
            };
            self.applications.push(application);
            return Ok(());
        }
        let Some(application) = self.applications.iter_mut().find(|application| application.name == name) else {
            return Err(format!("there is no description of the application `{name}` before"));
        };
        match rest {
            "estimates" => application.target_places.extend(target_place(data)?),
            "captures" => application.captures.push(capture(data)?),
            _ => {
                if let Some(robot) = rest.strip_prefix("path/") {
                    application.paths.push((robot.to_owned(), drawing::path_of(data)?));
                }
            }
        }
        Ok(())
    }

    /// Adds a value of a time series, if it is one of an application.
    pub(super) fn add_metric(&mut self, time: SimTime, data: &[u8]) -> Result<(), String> {
        let MetricMessage { name, value, .. } = MetricMessage::decode(data).map_err(|why| why.to_string())?;
        let Some((first, rest)) = name.split_once('/') else { return Ok(()) };
        let Some(application) = self.applications.iter_mut().find(|application| application.name == first) else {
            return Ok(());
        };
        if time < application.start {
            let start = application.start;
            return Err(format!(
                "the value `{name}` is of {time}; allowed: times from {start}, when `{first}` began"
            ));
        }
        match application.series.iter_mut().find(|(other, _)| other == rest) {
            Some((_, points)) => points.push((time, value)),
            None => application.series.push((rest.to_owned(), vec![(time, value)])),
        }
        Ok(())
    }

    /// Divides targets, fields and what sensors said by the phases of the run: those of the first phase stay.
    pub(super) fn divide(&mut self, phases: &[Phase]) {
        let Some(first) = phases.first() else { return };
        for application in &mut self.applications {
            let Some(phase) = phases.iter().find(|phase| phase.name == application.name) else { continue };
            let within = |target: &RecordedTarget| {
                let way = target.way.within(phase.start, phase.end);
                RecordedTarget { name: target.name.clone(), way }
            };
            application.targets = self.targets.iter().map(within).collect();
            application.fields = self.fields.iter().filter(|field| phase.contains(field.time)).cloned().collect();
        }
        for target in &mut self.targets {
            target.way = target.way.within(first.start, first.end);
        }
        self.targets.retain(|target| target.way != Way::default());
        self.fields.retain(|field| first.contains(field.time));
        self.samples.retain(|sample| first.contains(sample.time));
        self.detections.retain(|detection| first.contains(detection.time));
    }
}

/// Where a station thought that a target was; `None` for other estimates.
fn target_place(data: &[u8]) -> Result<Option<RecordedTargetPlace>, String> {
    let message = EstimateMessage::decode(data).map_err(|why| why.to_string())?;
    let EstimateMessage { world_x_m: Some(x_m), world_y_m: Some(y_m), world_z_m: Some(z_m), .. } = message else {
        return Ok(None);
    };
    if message.what != "target_place" {
        return Ok(None);
    }
    let place = place(x_m, y_m, z_m)?;
    Ok(Some(RecordedTargetPlace { time: SimTime::from_nanos(message.time_ns), target: message.name, place }))
}

fn capture(data: &[u8]) -> Result<RecordedCapture, String> {
    let CaptureMessage { time_ns, robot, target, x_m, y_m, z_m } =
        CaptureMessage::decode(data).map_err(|why| why.to_string())?;
    Ok(RecordedCapture { time: SimTime::from_nanos(time_ns), robot, target, place: place(x_m, y_m, z_m)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_from_before_its_application_is_refused() {
        let start = SimTime::from_nanos(5_000_000_000);
        let application = RecordedApplication { name: "search".to_owned(), start, ..RecordedApplication::default() };
        let mut world = RecordedWorld { applications: vec![application], ..RecordedWorld::default() };
        let message =
            MetricMessage { time_ns: 0, name: "search/rover/error_m".to_owned(), value: 1.0 }.encode_to_vec();
        assert_eq!(world.add_metric(start, &message), Ok(()));
        let refused = world.add_metric(SimTime::from_nanos(4_000_000_000), &message).unwrap_err();
        assert!(refused.contains("is of 4.000000000 s; allowed: times from 5.000000000 s"), "{refused}");
        assert_eq!(world.applications[0].series, [("rover/error_m".to_owned(), vec![(start, 1.0)])]);
    }
}
