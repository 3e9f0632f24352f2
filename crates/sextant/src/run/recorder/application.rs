//! An application in the recording of a run.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_recording::messages::{ApplicationMessage, CaptureMessage, EstimateMessage};
use sextant_recording::{FileRecorder, Level, Phase, RecordingError};
use sextant_scenario::{Application, Scenario};
use sextant_sim::Estimate;

use super::{RecordedSimulation, fields};
use crate::run::application::{Scored, distances_to_target};
use crate::run::observer::{ApplicationEnd, SimulationStart};
use crate::run::witness::Witness;

/// Records that an application begins.
pub(super) fn open(
    recorder: &mut FileRecorder,
    start: &SimulationStart<'_>,
    application: &Application,
) -> Result<(), RecordingError> {
    recorder.application(start.start, &description(start.scenario, application, start.robots))?;
    let note = format!("begins on the map `{}`", application.map.name());
    recorder.note(start.start, Level::Info, &application.name, &note)
}

/// Records what is known at the end of an application, and returns its phase.
pub(super) fn close(
    recorder: &mut FileRecorder,
    simulation: &mut RecordedSimulation,
    end: &ApplicationEnd<'_>,
) -> Result<Phase, RecordingError> {
    let ApplicationEnd { scenario, application, start, survey, performance } = *end;
    let (name, offset) = (&application.name, simulation.offset);
    let stop = survey.end + offset;
    for track in &mut simulation.robots {
        recorder.application_path(stop, name, &track.name, &track.places)?;
        track.close(stop, Some(name), recorder)?;
        track.stay(stop, recorder)?;
    }
    let seeks = application.goal().field().is_some();
    simulation.air.draw(offset, recorder)?;
    fields::record_phase(scenario, &simulation.fields, (survey.end, offset), seeks, recorder)?;
    let names: Vec<String> = simulation.robots.iter().map(|track| track.name.clone()).collect();
    let recording = Recording { scenario, application, names: &names, offset };
    recording.captures(&performance.witness, recorder)?;
    recording.estimates(&performance.scored, recorder)?;
    recording.distances(&performance.witness, survey.end, recorder)?;
    recorder.note(stop, Level::Info, name, &performance.summary.participants())?;
    recorder.note(stop, Level::Info, name, &performance.summary.outcome())?;
    Ok(Phase { name: name.clone(), start, end: stop })
}

fn description(scenario: &Scenario, application: &Application, robots: &[String]) -> ApplicationMessage {
    let sought = application.goal().field();
    ApplicationMessage {
        name: application.name.clone(),
        algorithm: application.algorithm.to_owned(),
        map: application.map.name().to_owned(),
        robots: robots.to_vec(),
        field: sought
            .map_or_else(String::new, |sought| scenario.world().fields[sought.field.index()].name().to_owned()),
        level: sought.and_then(|sought| sought.level),
    }
}

/// The recording of what was found after the simulation.
struct Recording<'a> {
    scenario: &'a Scenario,
    application: &'a Application,
    /// Names of the robots.
    names: &'a [String],
    offset: Duration,
}

impl Recording<'_> {
    fn captures(&self, witness: &Witness, recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        witness.captures.iter().try_for_each(|captured| {
            let time = captured.time + self.offset;
            let place = witness.target_at(captured.target, captured.time).unwrap_or_default();
            let message = CaptureMessage {
                time_ns: time.as_nanos(),
                robot: self.names[captured.robot].clone(),
                target: self.scenario.world().targets[captured.target.index()].name().to_owned(),
                x_m: place.x_m,
                y_m: place.y_m,
                z_m: place.z_m,
            };
            recorder.capture(&self.application.name, &message)
        })
    }

    /// Estimates, and the time series of their errors.
    fn estimates(&self, scored: &[Scored], recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        for scored in scored {
            let time = scored.time + self.offset;
            recorder.estimate(&self.application.name, &self.message(scored))?;
            if let Some(place) = scored.place {
                let of = (self.station(scored.station), what(&scored.estimate));
                recorder.estimated_place(time, &self.application.name, of, (place, scored.error))?;
            }
            let series = |what: &str| format!("{}/{}/{what}", self.application.name, self.station(scored.station));
            match (scored.estimate, scored.error) {
                (Estimate::OwnPlace(_), Some(error_m)) => recorder.metric(time, &series("map_error_m"), error_m)?,
                (Estimate::TargetPlace { .. }, Some(error_m)) => {
                    recorder.metric(time, &series("prediction_error_m"), error_m)?;
                }
                (Estimate::FieldValue { value, .. }, _) => {
                    recorder.metric(time, &series("field_estimate"), value)?;
                    if let Some(truth) = scored.truth {
                        recorder.metric(time, &series("field_truth"), truth)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The distance of each robot to the nearest target, if there are targets to search.
    fn distances(&self, witness: &Witness, end: SimTime, recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        if !self.application.goal().is_targets() {
            return Ok(());
        }
        for (robot, name) in self.names.iter().enumerate() {
            let series = format!("{}/{name}/distance_to_target_m", self.application.name);
            for (time, distance_m) in distances_to_target(witness, robot, end) {
                recorder.metric(time + self.offset, &series, distance_m)?;
            }
        }
        Ok(())
    }

    fn message(&self, scored: &Scored) -> EstimateMessage {
        let world = self.scenario.world();
        let (name, place, value) = match scored.estimate {
            Estimate::OwnPlace(place) => ("", Some(place), None),
            Estimate::TargetPlace { target, place } => (world.targets[target.index()].name(), Some(place), None),
            Estimate::FieldValue { field, value } => (world.fields[field.index()].name(), None, Some(value)),
        };
        EstimateMessage {
            time_ns: (scored.time + self.offset).as_nanos(),
            station: self.station(scored.station).to_owned(),
            what: what(&scored.estimate).to_owned(),
            name: name.to_owned(),
            x_m: place.map(|place| place.x_m),
            y_m: place.map(|place| place.y_m),
            z_m: place.map(|place| place.z_m),
            value,
            error: scored.error,
            world_x_m: scored.place.map(|place| place.x_m),
            world_y_m: scored.place.map(|place| place.y_m),
            world_z_m: scored.place.map(|place| place.z_m),
        }
    }

    /// Name of a station: nodes come first, then robots, then sinks.
    fn station(&self, station: StationId) -> &str {
        let nodes = &self.scenario.world().nodes;
        let Some(collector) = station.index().checked_sub(nodes.len()) else {
            return &nodes[station.index()].name;
        };
        match collector.checked_sub(self.names.len()) {
            None => &self.names[collector],
            Some(sink) => &self.scenario.config().sinks[sink].name,
        }
    }
}

/// The word for what an estimate is of.
fn what(estimate: &Estimate) -> &'static str {
    match estimate {
        Estimate::OwnPlace(_) => "own_place",
        Estimate::TargetPlace { .. } => "target_place",
        Estimate::FieldValue { .. } => "field_value",
    }
}
