//! The recording of an application.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Estimate, Survey};

use super::maps::{GivenMap, MadeMap};
use super::score::{self, Scored};
use super::simulate::Prepared;
use super::summary::sum_up;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::recording::messages::{ApplicationMessage, CaptureMessage, EstimateMessage};
use crate::recording::{FileCapture, FileRecorder, Level, Phase, RecordingError};
use crate::run::fields;
use crate::run::gather::{Gathered, Gathering, Manner, Shown, Sniffer};
use crate::run::witness::Witness;
use crate::scenario::{Application, Scenario};
use crate::summary::ApplicationSummary;
use crate::terminal;

/// Where an application is recorded.
pub(in crate::run) struct Outputs<'a> {
    pub(in crate::run) recorder: &'a mut FileRecorder,
    pub(in crate::run) capture: Option<&'a mut FileCapture>,
    /// Time 0 of the application in the recording.
    pub(in crate::run) start: SimTime,
    /// Whether progress is hidden.
    pub(in crate::run) quiet: bool,
}

/// Runs an application and records it: a phase of the recording. It gets one of the maps that were `made`, and its robots
/// start where their `survey` ended.
pub(in crate::run) fn record(
    scenario: &Scenario,
    application: &Application,
    (made, survey): (&[MadeMap], Option<&Survey>),
    outputs: Outputs<'_>,
    interrupt: &Interrupt,
) -> Result<(ApplicationSummary, Phase), Failure> {
    let Outputs { recorder, capture, start, quiet } = outputs;
    let map = GivenMap::of(scenario, application, made)?;
    let prepared = Prepared::new(scenario, application, &map, survey)?;
    let names: Vec<String> = application.robots.iter().map(|&robot| scenario.bodies()[robot].name.clone()).collect();
    let name = &application.name;
    recorder.application(start, &description(scenario, application, &names))?;
    recorder.note(start, Level::Info, name, &format!("begins on the map `{}`", application.map.name()))?;
    let what = if application.algorithm.is_search() { "searching" } else { "seeking" };
    let offset = start - SimTime::ZERO;
    let captured = scenario.recording().pcap.robot.as_ref();
    let robot = captured.map(|robot| names.iter().position(|name| name == robot));
    let manner = Manner {
        frames: scenario.recording().frames,
        // A robot that takes no part receives nothing.
        sniffer: capture
            .filter(|_| robot != Some(None))
            .map(|capture| Sniffer::new(capture, scenario, robot.flatten())),
        progress: (terminal::Progress::new(what, application.duration.as_secs(), quiet), Shown::Seconds),
        offset,
        witness: Some(Witness::new(scenario, names.len(), interrupt)),
    };
    let mut gathering = Gathering::new(recorder, interrupt, names.iter().cloned(), scenario, manner);
    let (survey, records) = prepared.run(&mut gathering)?;
    let Gathered { tracks, fields, witness } = gathering.finish()?;
    let witness = witness.expect("an application has a witness");
    let end = survey.end + offset;
    for track in &tracks {
        recorder.application_path(end, name, &track.name, &track.places)?;
    }
    fields::record_phase(scenario, &fields, (survey.end, offset), !application.algorithm.is_search(), recorder)?;
    let scored = score::score(&witness, scenario.world().nodes.len(), &map.placement);
    let recording = Recording { scenario, application, names: &names, offset };
    recording.captures(&witness, recorder)?;
    recording.estimates(&scored, recorder)?;
    recording.distances(&witness, survey.end, recorder)?;
    let summary = sum_up(scenario, application, &map, (&survey, &records), (&witness, &scored));
    recorder.note(end, Level::Info, name, &summary.outcome())?;
    Ok((summary, Phase { name: name.clone(), start, end }))
}

fn description(scenario: &Scenario, application: &Application, robots: &[String]) -> ApplicationMessage {
    let sought = application.algorithm.sought();
    ApplicationMessage {
        name: application.name.clone(),
        algorithm: application.algorithm.name.to_owned(),
        map: application.map.name().to_owned(),
        robots: robots.to_vec(),
        field: sought.map_or_else(String::new, |(field, _)| scenario.world().fields[field].name().to_owned()),
        level: sought.map(|(_, level)| level),
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
    fn captures(&self, witness: &Witness<'_>, recorder: &mut FileRecorder) -> Result<(), RecordingError> {
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
    fn distances(
        &self,
        witness: &Witness<'_>,
        end: SimTime,
        recorder: &mut FileRecorder,
    ) -> Result<(), RecordingError> {
        if !self.application.algorithm.is_search() {
            return Ok(());
        }
        for (robot, name) in self.names.iter().enumerate() {
            let series = format!("{}/{name}/distance_to_target_m", self.application.name);
            for (time, distance_m) in score::distances_to_target(witness, robot, end) {
                recorder.metric(time + self.offset, &series, distance_m)?;
            }
        }
        Ok(())
    }

    fn message(&self, scored: &Scored) -> EstimateMessage {
        let world = self.scenario.world();
        let (what, name, place, value) = match scored.estimate {
            Estimate::OwnPlace(place) => ("own_place", "", Some(place), None),
            Estimate::TargetPlace { target, place } => {
                ("target_place", world.targets[target.index()].name(), Some(place), None)
            }
            Estimate::FieldValue { field, value } => {
                ("field_value", world.fields[field.index()].name(), None, Some(value))
            }
        };
        EstimateMessage {
            time_ns: (scored.time + self.offset).as_nanos(),
            station: self.station(scored.station).to_owned(),
            what: what.to_owned(),
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
