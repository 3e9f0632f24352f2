//! The capture of the frames of a run, as an observer.

use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_recording::{CapturedDmgFrame, CapturedFrame, FileCapture, RecordingError, Signal, Technologies};
use sextant_scenario::Scenario;
use sextant_sim::{FrameFormat, FrameOnAir, Network, Observer, Progress};

use super::error::RunError;
use super::observer::{MissionEnd, RunObserver, RunStart, SimulationStart, SurveyEnd};
use crate::summary::Summary;

/// Captures the frames of a run in a file for Wireshark: all frames on air, or those that one robot receives. The file is
/// called `PATH.part` until the run is over. A failure ends the simulation, and the run returns it.
pub struct RunCapture {
    path: PathBuf,
    /// The file; created when the run begins.
    file: Option<FileCapture>,
    /// Whose frames are captured; `None` if those of the present simulation are not.
    receiver: Option<Receiver>,
    networks: Vec<CapturedNetwork>,
    /// The radio channel of IEEE 802.15.4 to name instead of that of the radios.
    channel: Option<u8>,
    /// From time 0 of the run to time 0 of the simulation.
    offset: Duration,
    failure: Option<RecordingError>,
}

/// Whose frames are captured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Receiver {
    /// All frames on air.
    All,
    /// Those that the robot with this number receives.
    Robot(usize),
}

/// A network whose frames are captured.
#[derive(Clone, Copy)]
struct CapturedNetwork {
    format: FrameFormat,
    /// Carrier frequency that its channel names; that of the radios if absent (Hz).
    carrier_hz: Option<f64>,
}

impl From<&Network> for CapturedNetwork {
    fn from(network: &Network) -> Self {
        let carrier_hz = network.channel.carrier_ghz().map(|carrier_ghz| 1e9 * carrier_ghz);
        Self { format: network.technology.frame_format(), carrier_hz }
    }
}

impl RunCapture {
    /// A capture that will be written to the file `path`.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            file: None,
            receiver: None,
            networks: Vec::new(),
            channel: None,
            offset: Duration::ZERO,
            failure: None,
        }
    }

    /// The first failure of a simulation.
    fn check(&self) -> Result<(), RunError> {
        self.failure.clone().map_or(Ok(()), |failure| Err(failure.into()))
    }

    /// Captures a frame, if it is to be captured.
    fn capture(&mut self, frame: &FrameOnAir<'_>) -> Result<(), RecordingError> {
        let (Some(capture), Some(receiver)) = (&mut self.file, self.receiver) else { return Ok(()) };
        let start = frame.start + self.offset;
        let power = match receiver {
            Receiver::All => None,
            Receiver::Robot(robot) => match frame.heard.iter().find(|heard| heard.collector == robot) {
                None => return Ok(()),
                Some(heard) => Some(heard.power),
            },
        };
        let FrameOnAir { airtime, bytes, .. } = *frame;
        let CapturedNetwork { format, carrier_hz } = self.networks[frame.network.index()];
        match format {
            FrameFormat::Tap { page, channel, sensitivity } => {
                let signal = power.map(|power| Signal { power, sensitivity });
                let channel = self.channel.or(frame.channel).unwrap_or(channel);
                capture.frame(&CapturedFrame { start, airtime, mpdu: bytes, channel, page, signal })
            }
            FrameFormat::Radiotap { carrier_hz: of_radio } => {
                let carrier_hz = carrier_hz.unwrap_or(of_radio);
                capture.dmg_frame(&CapturedDmgFrame { start, airtime, octets: bytes, carrier_hz, power })
            }
        }
    }
}

/// The technologies of the networks.
fn technologies(scenario: &Scenario) -> Technologies {
    let is_radiotap = |network: &Network| matches!(network.technology.frame_format(), FrameFormat::Radiotap { .. });
    let mut all = scenario.networks().iter().map(is_radiotap);
    let first = all.next().unwrap_or(false);
    match (first, all.all(|other| other == first)) {
        (_, false) => Technologies::Both,
        (false, true) => Technologies::Ieee802154,
        (true, true) => Technologies::Ieee80211ad,
    }
}

impl Observer for RunCapture {
    fn framed(&mut self, frame: FrameOnAir<'_>) {
        if self.failure.is_none() {
            self.failure = self.capture(&frame).err();
        }
    }

    fn wants_frames(&self) -> bool {
        self.receiver.is_some()
    }

    fn goes_on(&mut self, _progress: Progress) -> bool {
        self.failure.is_none()
    }
}

impl RunObserver for RunCapture {
    fn run_started(&mut self, start: &RunStart<'_>) -> Result<(), RunError> {
        let scenario = start.scenario;
        self.file = Some(FileCapture::create(&self.path, technologies(scenario))?);
        self.networks = scenario.networks().iter().map(CapturedNetwork::from).collect();
        self.channel = scenario.recording().pcap.channel;
        Ok(())
    }

    fn simulation_started(&mut self, start: &SimulationStart<'_>) -> Result<(), RunError> {
        self.offset = start.start - SimTime::ZERO;
        self.receiver = match &start.scenario.recording().pcap.robot {
            None => Some(Receiver::All),
            // A robot that takes no part receives nothing.
            Some(name) => start.robots.iter().position(|robot| robot == name).map(Receiver::Robot),
        };
        Ok(())
    }

    fn survey_finished(&mut self, _end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.check()
    }

    fn mission_finished(&mut self, _end: &MissionEnd<'_>) -> Result<(), RunError> {
        self.check()
    }

    fn run_finished(&mut self, _summary: &Summary) -> Result<(), RunError> {
        self.file.take().map_or(Ok(()), |capture| Ok(capture.finish()?))
    }
}
