//! A mission in the recording of a run.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_recording::messages::{ApplicationMessage, CaptureMessage, EstimateMessage};
use sextant_recording::{FileRecorder, Level, Phase, RecordingError};
use sextant_scenario::{PlannedMission, Scenario};
use sextant_sim::Estimate;

use super::{RecordedSimulation, fields};
use crate::run::mission::{Scored, distances_to_target};
use crate::run::observer::{MissionEnd, SimulationStart};
use crate::run::witness::Witness;

/// Records that a mission begins.
pub(super) fn open(
    recorder: &mut FileRecorder,
    start: &SimulationStart<'_>,
    mission: &PlannedMission,
) -> Result<(), RecordingError> {
    recorder.application(start.start, &description(start.scenario, mission, start.robots))?;
    let note = format!("begins on the map `{}`", mission.map.name());
    recorder.note(start.start, Level::Info, &mission.name, &note)
}

/// Records what is known at the end of an application, and returns its phase.
pub(super) fn close(
    recorder: &mut FileRecorder,
    simulation: &mut RecordedSimulation,
    end: &MissionEnd<'_>,
) -> Result<Phase, RecordingError> {
    let MissionEnd { scenario, mission, start, survey, performance } = *end;
    let (name, offset) = (&mission.name, simulation.offset);
    let stop = survey.end + offset;
    for track in &mut simulation.robots {
        recorder.application_path(stop, name, &track.name, &track.places)?;
        track.close(stop, Some(name), recorder)?;
        track.stay(stop, recorder)?;
    }
    let seeks = mission.goal().field().is_some();
    simulation.air.draw(offset, recorder)?;
    fields::record_phase(scenario, &simulation.fields, survey.end, offset, seeks, recorder)?;
    let names: Vec<String> = simulation.robots.iter().map(|track| track.name.clone()).collect();
    let recording = Recording { scenario, mission, names: &names, offset };
    recording.captures(&performance.witness, recorder)?;
    recording.estimates(&performance.scored, recorder)?;
    recording.distances(&performance.witness, survey.end, recorder)?;
    recorder.note(stop, Level::Info, name, &performance.summary.participants())?;
    recorder.note(stop, Level::Info, name, &performance.summary.outcome())?;
    Ok(Phase { name: name.clone(), start, end: stop })
}

fn description(scenario: &Scenario, mission: &PlannedMission, robots: &[String]) -> ApplicationMessage {
    let sought = mission.goal().field();
    ApplicationMessage {
        name: mission.name.clone(),
        algorithm: mission.algorithm.to_owned(),
        map: mission.map.name().to_owned(),
        robots: robots.to_vec(),
        field: sought
            .map_or_else(String::new, |sought| scenario.world().fields[sought.field.index()].name().to_owned()),
        level: sought.and_then(|sought| sought.level),
    }
}

/// The recording of what was found after the simulation.
struct Recording<'a> {
    scenario: &'a Scenario,
    mission: &'a PlannedMission,
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
            recorder.capture(&self.mission.name, &message)
        })
    }

    /// Estimates, and the time series of their errors.
    fn estimates(&self, scored: &[Scored], recorder: &mut FileRecorder) -> Result<(), RecordingError> {
        for scored in scored {
            let time = scored.time + self.offset;
            recorder.estimate(&self.mission.name, &self.message(scored))?;
            if let Some(place) = scored.place {
                let (station, what) = (self.station(scored.station), what(&scored.estimate));
                recorder.estimated_place(time, &self.mission.name, station, what, place, scored.error)?;
            }
            let series = |what: &str| format!("{}/{}/{what}", self.mission.name, self.station(scored.station));
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
        if !self.mission.goal().is_targets() {
            return Ok(());
        }
        for (robot, name) in self.names.iter().enumerate() {
            let series = format!("{}/{name}/distance_to_target_m", self.mission.name);
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
