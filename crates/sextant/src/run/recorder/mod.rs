//! The recording of a run, as an observer.

mod air;
mod events;
mod fields;
mod maps;
mod mission;
mod opening;
mod packets;
mod rhythms;
mod track;

use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_recording::{FileRecorder, Level, Phase, RecordingError, Relay, SURVEY};
use sextant_scenario::Scenario;
use sextant_sim::{Field, NetworkId};

use super::ending;
use super::error::RunError;
use super::observer::{MapEnd, MissionEnd, RunObserver, RunStart, SimulationStart, SurveyEnd};
use crate::summary::Summary;
use air::Air;
use track::CommandTrack;

/// Records a run to a file: `PATH.part` while the run goes on, `PATH` when it is complete. After the first failure it
/// ends the simulation, and the run returns the failure; what was recorded until then stays in `PATH.part`.
pub struct RunRecorder {
    path: PathBuf,
    /// The file; created when the run begins.
    recorder: Option<FileRecorder>,
    simulation: RecordedSimulation,
    /// The phases of the run so far.
    phases: Vec<Phase>,
    has_applications: bool,
    /// Who else gets what is recorded, until the run begins.
    relay: Option<Box<dyn Relay>>,
    failure: Option<RecordingError>,
    /// Number of packets recorded so far.
    packets: u64,
}

/// What the recording of the events of a simulation needs.
#[derive(Default)]
struct RecordedSimulation {
    /// Whether every frame is recorded.
    frames: bool,
    /// Whether every packet is recorded.
    packets: bool,
    /// Whether packets go over several hops.
    has_hops: bool,
    origins: packets::Origins,
    robots: Vec<CommandTrack>,
    /// Names of the targets.
    targets: Vec<String>,
    /// The fields, with the sources that were removed so far.
    fields: Vec<Field>,
    /// The surveyed networks whose logs have separate topics, by name: all but the first.
    others: Vec<(NetworkId, String)>,
    /// The name of each network, if it has one.
    network_names: Vec<String>,
    /// From time 0 of the recording to time 0 of the simulation.
    offset: Duration,
    /// Name of the mission that is simulated; `None` for the survey.
    application: Option<String>,
    /// Where the nodes really are (m).
    nodes: Vec<Position>,
    /// Their names, if they have batteries.
    battery_names: Vec<String>,
    /// Where the sinks are (m).
    sinks: Vec<Position>,
    /// Frames that are not drawn yet.
    air: Air,
}

impl RecordedSimulation {
    fn new(start: &SimulationStart<'_>) -> Self {
        let scenario = start.scenario;
        let network_names = scenario.networks().iter().map(|network| network.name.clone().unwrap_or_default());
        let network_names: Vec<String> = network_names.collect();
        let others = scenario.surveyed().into_iter().skip(1);
        let others = others.map(|network| (network, network_names[network.index()].clone())).collect();
        Self {
            frames: scenario.recording().frames,
            packets: scenario.recording().packets,
            has_hops: scenario.routing().is_some() && start.mission.is_none(),
            origins: packets::Origins::default(),
            robots: start.robots.iter().map(|name| CommandTrack::new(name)).collect(),
            targets: scenario.world().targets.iter().map(|target| target.name().to_owned()).collect(),
            fields: scenario.world().fields.clone(),
            others,
            network_names,
            offset: start.start - SimTime::ZERO,
            application: start.mission.map(|mission| mission.name.clone()),
            nodes: scenario.world().nodes.iter().map(|node| node.position).collect(),
            battery_names: match scenario.config().battery {
                Some(_) => scenario.world().nodes.iter().map(|node| node.name.clone()).collect(),
                None => Vec::new(),
            },
            sinks: scenario.config().sinks.iter().map(|sink| sink.position_m).collect(),
            air: Air::default(),
        }
    }
}

impl RunRecorder {
    /// A recorder that will write to the file `path`.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            recorder: None,
            simulation: RecordedSimulation::default(),
            phases: Vec::new(),
            has_applications: false,
            relay: None,
            failure: None,
            packets: 0,
        }
    }

    /// The same recorder, whose messages `relay` gets too, at the moment when they are recorded.
    #[must_use]
    pub fn with_relay(self, relay: Box<dyn Relay>) -> Self {
        Self { relay: Some(relay), ..self }
    }

    fn file(&mut self) -> &mut FileRecorder {
        self.recorder.as_mut().expect("the file is created when the run begins")
    }

    /// Records what happened at `time` of the simulation; `write` gets the time in the recording.
    fn record(
        &mut self,
        time: SimTime,
        write: impl FnOnce(&mut FileRecorder, &mut RecordedSimulation, SimTime) -> Result<(), RecordingError>,
    ) {
        if let (None, Some(recorder)) = (&self.failure, &mut self.recorder) {
            let time = time + self.simulation.offset;
            self.failure = write(recorder, &mut self.simulation, time).err();
        }
    }

    /// The first failure of a simulation.
    fn check(&self) -> Result<(), RunError> {
        self.failure.clone().map_or(Ok(()), |failure| Err(failure.into()))
    }
}

impl RunObserver for RunRecorder {
    fn run_started(&mut self, start: &RunStart<'_>) -> Result<(), RunError> {
        self.has_applications = !start.scenario.missions().is_empty();
        let recorder = self.recorder.insert(FileRecorder::create(&self.path)?);
        if let Some(relay) = self.relay.take() {
            recorder.set_relay(relay);
        }
        opening::open(recorder, start.scenario)?;
        opening::discoveries(recorder, start)?;
        Ok(())
    }

    fn simulation_started(&mut self, start: &SimulationStart<'_>) -> Result<(), RunError> {
        self.simulation = RecordedSimulation::new(start);
        let recorder = self.file();
        if let Some(mission) = start.mission {
            mission::open(recorder, start, mission)?;
        }
        set_sensitivities(recorder, start.scenario);
        Ok(())
    }

    fn survey_finished(&mut self, survey: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.check()?;
        let end = survey.simulated.survey.end;
        let recorder = self.recorder.as_mut().expect("the file is created when the run begins");
        for track in &mut self.simulation.robots {
            recorder.path(end, &track.name, &track.places)?;
            track.close(end, None, recorder)?;
            if self.has_applications {
                track.stay(end, recorder)?;
            }
        }
        self.simulation.air.draw(Duration::ZERO, recorder)?;
        let nodes = survey.scenario.world().nodes.len();
        for robot in ending::robots(survey.scenario, survey.simulated) {
            if let Some(text) = robot.end(nodes) {
                recorder.note(end, Level::Info, &robot.name, &text)?;
            }
        }
        if let Some(routing) = &survey.simulated.routing {
            let edges = super::routing::edges(survey.scenario, routing, &survey.simulated.survey.deaths);
            recorder.tree(end, &edges)?;
            recorder.parent_changes(end, &super::routing::parent_changes(survey.scenario, routing))?;
        }
        recorder.batteries(end, &super::battery::messages(&survey.simulated.survey))?;
        if self.simulation.packets {
            rhythms::record(recorder, end, &self.simulation.network_names, &survey.simulated.survey.networks)?;
        }
        fields::record(survey.scenario, &self.simulation.fields, end, recorder)?;
        self.phases.push(Phase { name: SURVEY.to_owned(), start: SimTime::ZERO, end });
        Ok(())
    }

    fn map_finished(&mut self, map: &MapEnd<'_>) -> Result<(), RunError> {
        maps::record(self.file(), map)
    }

    fn mission_finished(&mut self, end: &MissionEnd<'_>) -> Result<(), RunError> {
        self.check()?;
        let recorder = self.recorder.as_mut().expect("the file is created when the run begins");
        let phase = mission::close(recorder, &mut self.simulation, end)?;
        self.phases.push(phase);
        Ok(())
    }

    fn run_finished(&mut self, summary: &Summary) -> Result<(), RunError> {
        let Some(mut recorder) = self.recorder.take() else { return Ok(()) };
        if self.has_applications && (!summary.interrupted || self.phases.len() > 1) {
            recorder.phases(&self.phases)?;
        }
        recorder.summary(&summary.to_json())?;
        Ok(recorder.finish()?)
    }
}

/// Tells the recorder how sensitive the radios of each log are, so that it can write link qualities.
fn set_sensitivities(recorder: &mut FileRecorder, scenario: &Scenario) {
    for (i, network) in scenario.surveyed().into_iter().enumerate() {
        let network = &scenario.networks()[network.index()];
        if network.technology.antennas().is_none() {
            let other = (i > 0).then(|| network.name.as_deref().unwrap_or_default());
            recorder.set_sensitivity(other, network.technology.sensitivity());
        }
    }
}
