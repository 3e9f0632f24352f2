//! Recording of a simulation while it runs.

use std::time::Duration;

use sextant_channel::{Contact, Position, Reception, Stop};
use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_sim::{
    Estimate, Field, FieldId, FrameFormat, FrameOnAir, Network, NetworkId, Observer, Pose, Progress, Sensed,
    TargetId, World,
};

use super::witness::Witness;
use crate::interrupt::Interrupt;
use crate::recording::{
    CapturedDmgFrame, CapturedFrame, FileCapture, FileRecorder, Level, RecordingError, Sensation, Signal, messages,
};
use crate::scenario::Scenario;
use crate::terminal;

/// Records a simulation while it runs, shows its progress, and stops it if the user interrupts or a write fails.
pub(super) struct Gathering<'a, 'i> {
    recorder: &'a mut FileRecorder,
    frames: bool,
    sniffer: Option<Sniffer<'a>>,
    interrupt: &'i Interrupt,
    progress: terminal::Progress,
    shown: Shown,
    robots: Vec<Track>,
    world: &'a World,
    /// The surveyed networks whose logs have topics of their own, by name: all but the first.
    others: Vec<(NetworkId, String)>,
    /// The name of each network, if it has one.
    network_names: Vec<String>,
    /// The fields, with the sources that were removed so far.
    fields: Vec<Field>,
    /// From time 0 of the recording to time 0 of the simulation.
    offset: Duration,
    /// What an application did, if it is one.
    witness: Option<Witness<'i>>,
    failure: Option<RecordingError>,
}

/// What the progress bar shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// Nodes heard by robots.
    NodesHeard,
    /// Simulated seconds, and packets.
    Packets,
    /// Simulated seconds, and messages of nodes that compute a map.
    Messages,
    /// Simulated seconds of an application.
    Seconds,
}

/// Captures frames.
pub(super) struct Sniffer<'a> {
    /// The file to write.
    capture: &'a mut FileCapture,
    /// The robot whose receptions are captured; all frames on air if absent.
    robot: Option<usize>,
    /// The networks.
    networks: Vec<Sniffed>,
    /// The radio channel of IEEE 802.15.4 to name instead of that of the radios.
    channel: Option<u8>,
}

/// A network whose frames are captured.
struct Sniffed {
    format: FrameFormat,
    /// Carrier frequency that its channel names; that of the radios if absent (Hz).
    carrier_hz: Option<f64>,
}

impl From<&Network> for Sniffed {
    fn from(network: &Network) -> Self {
        let carrier_hz = network.channel.carrier_ghz().map(|carrier_ghz| 1e9 * carrier_ghz);
        Self { format: network.technology.frame_format(), carrier_hz }
    }
}

impl<'a> Sniffer<'a> {
    /// Captures the frames of `scenario` that `robot` receives, or all.
    pub(super) fn new(capture: &'a mut FileCapture, scenario: &Scenario, robot: Option<usize>) -> Self {
        let networks = scenario.networks().iter().map(Sniffed::from).collect();
        Self { capture, robot, networks, channel: scenario.recording().pcap.channel }
    }

    /// Captures a frame that begins at `start` of the recording, if it is to be captured.
    fn sniff(&mut self, frame: &FrameOnAir<'_>, start: SimTime) -> Result<(), RecordingError> {
        let power = match self.robot {
            None => None,
            Some(robot) => match frame.heard.iter().find(|heard| heard.collector == robot) {
                None => return Ok(()),
                Some(heard) => Some(heard.power),
            },
        };
        let FrameOnAir { airtime, bytes, .. } = *frame;
        let Sniffed { format, carrier_hz } = &self.networks[frame.network.index()];
        match *format {
            FrameFormat::Tap { page, channel, sensitivity } => {
                let signal = power.map(|power| Signal { power, sensitivity });
                let channel = self.channel.unwrap_or(channel);
                self.capture.frame(&CapturedFrame { start, airtime, mpdu: bytes, channel, page, signal })
            }
            FrameFormat::Radiotap { carrier_hz: of_radio } => {
                let carrier_hz = carrier_hz.unwrap_or(of_radio);
                self.capture.dmg_frame(&CapturedDmgFrame { start, airtime, octets: bytes, carrier_hz, power })
            }
        }
    }
}

/// The path of a robot.
pub(super) struct Track {
    pub(super) name: String,
    pub(super) places: Vec<Position>,
    heading_rad: f64,
}

/// How a simulation is recorded.
pub(super) struct Manner<'a, 'i> {
    /// Whether every frame is recorded.
    pub(super) frames: bool,
    /// Captures frames.
    pub(super) sniffer: Option<Sniffer<'a>>,
    /// The progress bar, and what it shows.
    pub(super) progress: (terminal::Progress, Shown),
    /// From time 0 of the recording to time 0 of the simulation.
    pub(super) offset: Duration,
    /// Sees what an application does, if the simulation is one.
    pub(super) witness: Option<Witness<'i>>,
}

/// What is left when a simulation has been recorded.
pub(super) struct Gathered<'i> {
    /// The paths of the robots.
    pub(super) tracks: Vec<Track>,
    /// The fields as they were.
    pub(super) fields: Vec<Field>,
    /// What an application did.
    pub(super) witness: Option<Witness<'i>>,
}

impl<'a, 'i> Gathering<'a, 'i> {
    /// A gathering by the robots `names` of `scenario`.
    pub(super) fn new(
        recorder: &'a mut FileRecorder,
        interrupt: &'i Interrupt,
        names: impl Iterator<Item = String>,
        scenario: &'a Scenario,
        manner: Manner<'a, 'i>,
    ) -> Self {
        let world = scenario.world();
        let network_names = scenario.networks().iter().map(|network| network.name.clone().unwrap_or_default());
        let network_names: Vec<String> = network_names.collect();
        let others = scenario.surveyed().into_iter().skip(1);
        for (i, network) in scenario.surveyed().into_iter().enumerate() {
            let technology = &scenario.networks()[network.index()].technology;
            if technology.antennas().is_none() {
                let other = (i > 0).then(|| network_names[network.index()].as_str());
                recorder.set_sensitivity(other, technology.sensitivity());
            }
        }
        let others = others.map(|network| (network, network_names[network.index()].clone())).collect();
        let robots = names.map(|name| Track { name, places: Vec::new(), heading_rad: 0.0 }).collect();
        let fields = world.fields.clone();
        let Manner { frames, sniffer, progress: (progress, shown), offset, witness } = manner;
        Self {
            recorder,
            frames,
            sniffer,
            interrupt,
            progress,
            shown,
            robots,
            world,
            others,
            network_names,
            fields,
            offset,
            witness,
            failure: None,
        }
    }

    /// What is left, or the first failure to record.
    pub(super) fn finish(self) -> Result<Gathered<'i>, RecordingError> {
        self.progress.clear();
        let Self { robots: tracks, fields, witness, failure, .. } = self;
        failure.map_or(Ok(Gathered { tracks, fields, witness }), Err)
    }

    /// Records that a robot is at a place, with its heading.
    fn record_place(&mut self, robot: usize, time: SimTime, position: Position) {
        let track = &mut self.robots[robot];
        if track.places.last() != Some(&position) {
            track.places.push(position);
        }
        if let Some(witness) = &mut self.witness {
            witness.moved(robot, time, position);
        }
        self.record(time, |recorder, robots, time| {
            recorder.robot(time, &robots[robot].name, position, robots[robot].heading_rad)
        });
    }

    /// Records what happened at `time` of the simulation; `write` gets the time in the recording.
    fn record(
        &mut self,
        time: SimTime,
        write: impl FnOnce(&mut FileRecorder, &[Track], SimTime) -> Result<(), RecordingError>,
    ) {
        if self.failure.is_none() {
            self.failure = write(self.recorder, &self.robots, time + self.offset).err();
        }
    }
}

impl Observer for Gathering<'_, '_> {
    fn moved(&mut self, robot: usize, time: SimTime, position: Position) {
        let track = &mut self.robots[robot];
        if let Some(&last) = track.places.last()
            && last != position
        {
            track.heading_rad = (position.y_m - last.y_m).atan2(position.x_m - last.x_m);
        }
        self.record_place(robot, time, position);
    }

    fn curved(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.robots[robot].heading_rad = pose.heading_rad;
        self.record_place(robot, time, pose.position);
    }

    fn believed(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.record(time, |recorder, robots, time| {
            recorder.odometry(time, &robots[robot].name, pose.position, pose.heading_rad)
        });
    }

    fn met(&mut self, contact: Contact) {
        // What a robot meets in an application is not knowledge of the survey.
        if self.witness.is_none() {
            self.record(contact.time, |recorder, robots, _| {
                recorder.contact(&robots[contact.robot.index()].name, &contact)
            });
        }
    }

    fn stopped(&mut self, network: NetworkId, index: u32, stop: &Stop, _end: SimTime, receptions: &[Reception]) {
        // Nor are its stops.
        if self.witness.is_some() {
            return;
        }
        let other = self.others.iter().find(|(other, _)| *other == network).map(|(_, name)| name.clone());
        self.record(stop.time, |recorder, robots, _| {
            recorder.stop(other.as_deref(), &robots[stop.robot.index()].name, index, stop, receptions)
        });
    }

    fn estimated(&mut self, station: StationId, time: SimTime, estimate: &Estimate) {
        if let Some(witness) = &mut self.witness {
            witness.estimated(station, time, estimate);
        }
    }

    fn captured(&mut self, robot: usize, target: TargetId, time: SimTime) {
        if let Some(witness) = &mut self.witness {
            witness.captured(robot, target, time);
        }
        let found = format!("{} captured {}", self.robots[robot].name, self.world.targets[target.index()].name());
        self.record(time, |recorder, _, time| recorder.note(time, Level::Info, "capture", &found));
    }

    fn target_gone(&mut self, target: TargetId, time: SimTime) {
        if let Some(witness) = &mut self.witness {
            witness.target_gone(target, time);
        }
    }

    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        if let Some(witness) = &mut self.witness {
            witness.target_moved(target, time, position);
        }
        let name = self.world.targets[target.index()].name();
        self.record(time, |recorder, _, time| recorder.target(time, name, position));
    }

    fn sensed(&mut self, node: NodeId, time: SimTime, sensed: &Sensed) {
        let (sensation, name) = Sensation::of(*sensed, self.world);
        self.record(time, |recorder, _, time| recorder.sensed(time, node, name, sensation));
    }

    fn source_removed(&mut self, field: FieldId, source: usize, time: SimTime) {
        self.fields[field.index()].remove(source, time);
        if let Some(witness) = &mut self.witness {
            witness.source_removed(field, source, time);
        }
        let name = self.world.fields[field.index()].name();
        self.record(time, |recorder, _, time| {
            recorder.note(time, Level::Info, name, &format!("source {source} was removed"))
        });
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        let start = frame.start + self.offset;
        if let Some(sniffer) = &mut self.sniffer
            && self.failure.is_none()
        {
            self.failure = sniffer.sniff(&frame, start).err();
        }
        if !self.frames {
            return;
        }
        let source = frame.source.0;
        let message = messages::FrameMessage {
            start_ns: start.as_nanos(),
            airtime_ns: (SimTime::ZERO + frame.airtime).as_nanos(),
            source,
            mpdu: frame.bytes.to_vec(),
            outcome: frame.outcome.name().to_owned(),
            power_dbm: frame.power.map(|power| power.0),
            network: self.network_names[frame.network.index()].clone(),
            deafness: frame.outcome.deafness().map_or_else(String::new, |deafness| deafness.name().to_owned()),
        };
        self.record(frame.start, |recorder, _, _| recorder.frame(&message));
    }

    fn wants_frames(&self) -> bool {
        self.frames || self.sniffer.is_some()
    }

    fn goes_on(&mut self, progress: Progress) -> bool {
        let whole_seconds = progress.time.as_nanos() / 1_000_000_000;
        match self.shown {
            Shown::Packets => {
                self.progress
                    .set(whole_seconds, format!("s simulated, {} packets offered", progress.packets_offered));
            }
            Shown::Messages => {
                let stops =
                    if self.robots.is_empty() { String::new() } else { format!(", {} stops", progress.stops) };
                let note = format!("s simulated at most, {} messages{stops}", progress.packets_offered);
                self.progress.set(whole_seconds, note);
            }
            Shown::Seconds => self.progress.set(whole_seconds, "s simulated at most".to_owned()),
            Shown::NodesHeard => {
                let seconds = progress.time.as_secs_f64();
                let note = format!("nodes heard, {} stops, {seconds:.0} s simulated", progress.stops);
                self.progress.set(progress.nodes_heard as u64, note);
            }
        }
        self.failure.is_none() && !self.interrupt.is_requested()
    }
}
