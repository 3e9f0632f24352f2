//! Recording of a simulation while it runs.

use sextant_channel::{Contact, Position, Reception, Stop};
use sextant_kernel::{NodeId, SimTime};
use sextant_sim::{
    BusyNetwork, Field, FieldId, FrameOnAir, Ieee802154, NetworkId, Observer, Pose, Progress, Sensed, TargetId,
    Technology, World,
};

use crate::interrupt::Interrupt;
use crate::recording::{
    CapturedDmgFrame, CapturedFrame, FileCapture, FileRecorder, Level, RecordingError, Sensation, Signal, messages,
};
use crate::scenario::Scenario;
use crate::terminal;

/// Records a simulation while it runs, shows its progress, and stops it if the user interrupts or a write fails.
pub(super) struct Gathering<'a> {
    recorder: &'a mut FileRecorder,
    frames: bool,
    sniffer: Option<Sniffer<'a>>,
    interrupt: &'a Interrupt,
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
}

/// Captures frames.
pub(super) struct Sniffer<'a> {
    /// The file to write.
    pub(super) capture: &'a mut FileCapture,
    /// The robot whose receptions are captured; all frames on air if absent.
    pub(super) robot: Option<usize>,
    /// The networks.
    pub(super) networks: Vec<Sniffed>,
    /// The radio channel of IEEE 802.15.4 to name instead of that of the radios.
    pub(super) channel: Option<u8>,
}

/// A network whose frames are captured.
pub(super) struct Sniffed {
    technology: Technology,
    /// Carrier frequency that its channel names; that of the radios if absent (Hz).
    carrier_hz: Option<f64>,
}

impl From<&BusyNetwork> for Sniffed {
    fn from(network: &BusyNetwork) -> Self {
        let carrier_hz = network.link.channel.carrier_ghz().map(|carrier_ghz| 1e9 * carrier_ghz);
        Self { technology: network.link.technology.clone(), carrier_hz }
    }
}

impl Sniffer<'_> {
    /// Captures a frame, if it is to be captured.
    fn sniff(&mut self, frame: &FrameOnAir<'_>) -> Result<(), RecordingError> {
        let power = match self.robot {
            None => None,
            Some(robot) => match frame.heard.iter().find(|heard| heard.collector == robot) {
                None => return Ok(()),
                Some(heard) => Some(heard.power),
            },
        };
        let FrameOnAir { start, airtime, bytes, .. } = *frame;
        let Sniffed { technology, carrier_hz } = &self.networks[frame.network.index()];
        match technology {
            Technology::Ieee802154(Ieee802154 { radio, .. }) => {
                let signal = power.map(|power| Signal { power, sensitivity: radio.sensitivity() });
                let channel = self.channel.unwrap_or(radio.channel());
                let page = radio.phy().page();
                self.capture.frame(&CapturedFrame { start, airtime, mpdu: bytes, channel, page, signal })
            }
            Technology::Ieee80211ad(links) => {
                let carrier_hz = carrier_hz.unwrap_or(links.radio.carrier_hz());
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

impl<'a> Gathering<'a> {
    /// A gathering by the robots `names` of `scenario`. If `frames` is set, every frame is recorded.
    pub(super) fn new(
        recorder: &'a mut FileRecorder,
        frames: bool,
        sniffer: Option<Sniffer<'a>>,
        interrupt: &'a Interrupt,
        (progress, shown): (terminal::Progress, Shown),
        names: impl Iterator<Item = String>,
        scenario: &'a Scenario,
    ) -> Self {
        let world = scenario.world();
        let network_names = scenario.networks().iter().map(|network| network.name.clone().unwrap_or_default());
        let network_names: Vec<String> = network_names.collect();
        let others = scenario.surveyed().into_iter().skip(1);
        let others = others.map(|network| (network, network_names[network.index()].clone())).collect();
        let robots = names.map(|name| Track { name, places: Vec::new(), heading_rad: 0.0 }).collect();
        let fields = world.fields.clone();
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
            failure: None,
        }
    }

    /// The paths of the robots and the fields as they were, or the first failure to record.
    pub(super) fn finish(self) -> Result<(Vec<Track>, Vec<Field>), RecordingError> {
        self.progress.clear();
        self.failure.map_or(Ok((self.robots, self.fields)), Err)
    }

    /// Records that a robot is at a place, with its heading.
    fn record_place(&mut self, robot: usize, time: SimTime, position: Position) {
        let track = &mut self.robots[robot];
        if track.places.last() != Some(&position) {
            track.places.push(position);
        }
        self.record(|recorder, robots| {
            recorder.robot(time, &robots[robot].name, position, robots[robot].heading_rad)
        });
    }

    fn record(&mut self, write: impl FnOnce(&mut FileRecorder, &[Track]) -> Result<(), RecordingError>) {
        if self.failure.is_none() {
            self.failure = write(self.recorder, &self.robots).err();
        }
    }
}

impl Observer for Gathering<'_> {
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
        self.record(|recorder, robots| recorder.odometry(time, &robots[robot].name, pose.position, pose.heading_rad));
    }

    fn met(&mut self, contact: Contact) {
        self.record(|recorder, robots| recorder.contact(&robots[contact.robot.index()].name, &contact));
    }

    fn stopped(&mut self, network: NetworkId, index: u32, stop: &Stop, _end: SimTime, receptions: &[Reception]) {
        let other = self.others.iter().find(|(other, _)| *other == network).map(|(_, name)| name.clone());
        self.record(|recorder, robots| {
            recorder.stop(other.as_deref(), &robots[stop.robot.index()].name, index, stop, receptions)
        });
    }

    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        let world = self.world;
        self.record(|recorder, _| recorder.target(time, world.targets[target.index()].name(), position));
    }

    fn sensed(&mut self, node: NodeId, time: SimTime, sensed: &Sensed) {
        let (sensation, name) = Sensation::of(*sensed, self.world);
        self.record(|recorder, _| recorder.sensed(time, node, name, sensation));
    }

    fn source_removed(&mut self, field: FieldId, source: usize, time: SimTime) {
        self.fields[field.index()].remove(source, time);
        let name = self.world.fields[field.index()].name();
        self.record(|recorder, _| recorder.note(time, Level::Info, name, &format!("source {source} was removed")));
    }

    fn framed(&mut self, frame: FrameOnAir<'_>) {
        if let Some(sniffer) = &mut self.sniffer
            && self.failure.is_none()
        {
            self.failure = sniffer.sniff(&frame).err();
        }
        if !self.frames {
            return;
        }
        let source = frame.source.0;
        let message = messages::FrameMessage {
            start_ns: frame.start.as_nanos(),
            airtime_ns: (SimTime::ZERO + frame.airtime).as_nanos(),
            source,
            mpdu: frame.bytes.to_vec(),
            outcome: frame.outcome.name().to_owned(),
            power_dbm: frame.power.map(|power| power.0),
            network: self.network_names[frame.network.index()].clone(),
        };
        self.record(|recorder, _| recorder.frame(&message));
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
            Shown::NodesHeard => {
                let seconds = progress.time.as_secs_f64();
                let note = format!("nodes heard, {} stops, {seconds:.0} s simulated", progress.stops);
                self.progress.set(progress.nodes_heard as u64, note);
            }
        }
        self.failure.is_none() && !self.interrupt.is_requested()
    }
}
