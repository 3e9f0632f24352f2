//! Observers of a simulation.

mod several;

use std::time::Duration;

use sextant_channel::{Contact, Dbm, HeardAtStop, Position, Stop};
use sextant_kernel::{NodeId, SimTime, StationId};

use crate::service::estimate::Estimate;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::PacketTrace;
use crate::service::sensed::{FieldId, Sensed, TargetId};
use crate::station::Pose;

/// A frame that was on air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameOnAir<'a> {
    /// The network in which it was sent.
    pub network: NetworkId,
    /// Number of its radio channel, if programs choose it; if not, that of the settings.
    pub channel: Option<u8>,
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The station that sent it: nodes come first, then robots, then sinks.
    pub source: StationId,
    /// The MAC frame (MPDU), frame check sequence included.
    pub bytes: &'a [u8],
    /// For a data frame to one station, its outcome there; for one to all, its best outcome at any station whose
    /// application hears. For a beacon, its best outcome at any node; for an acknowledgement that a robot or sink sends
    /// to a node, also at any node, because it has no address; for other acknowledgements, at the station that waits.
    pub outcome: FrameOutcome,
    /// Power at that station (dBm), if a signal was measured.
    pub power: Option<Dbm>,
    /// The robots and sinks that received it, by number.
    pub heard: &'a [HeardFrame],
}

/// A frame at a robot or sink that received it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardFrame {
    /// Number of the robot or sink: robots come first, then sinks.
    pub collector: usize,
    /// Power there (dBm).
    pub power: Dbm,
}

/// Watches a simulation while it runs, for example as a recording or a progress bar. By default, an observer
/// ignores everything and the simulation continues.
pub trait Observer {
    /// A robot is at `position` at `time`: where the simulation begins, and at the start and the end of a straight drive.
    fn moved(&mut self, _robot: usize, _time: SimTime, _position: Position) {}

    /// A robot on an arc has this `pose` at `time`: at the start and the end of the arc, and between them at equal
    /// distances with at most 5 degrees of turn from one to the next.
    fn curved(&mut self, robot: usize, time: SimTime, pose: Pose) {
        self.moved(robot, time, pose.position);
    }

    /// A robot believes to have this `pose` at `time`: called after each [`Observer::moved`] and [`Observer::curved`] of
    /// a robot whose odometry has errors. Other robots believe what is true.
    fn believed(&mut self, _robot: usize, _time: SimTime, _pose: Pose) {}

    /// A robot met an obstacle.
    fn met(&mut self, _contact: Contact) {}

    /// A robot has listened at stop `index` of the log of `network`, from `stop.time` until `end`, and heard this.
    fn stopped(&mut self, _network: NetworkId, _index: u32, _stop: &Stop, _end: SimTime, _heard: HeardAtStop<'_>) {}

    /// A station has worked out something about the world.
    fn estimated(&mut self, _station: StationId, _time: SimTime, _estimate: &Estimate) {}

    /// A packet over several hops begins at a station: it waits there until the link takes it. Its `number` is of those that the
    /// station had before, their last 16 bits.
    fn originated(&mut self, _station: StationId, _number: u16, _time: SimTime) {}

    /// A target is at `position` at `time`: the start or the end of a leg, the end of its way through the world, or the
    /// end of the simulation.
    fn target_moved(&mut self, _target: TargetId, _time: SimTime, _position: Position) {}

    /// A robot captured a target, which is gone then: [`Observer::target_gone`] follows.
    fn captured(&mut self, _robot: usize, _target: TargetId, _time: SimTime) {}

    /// A target is not in the world any more: it left or was captured where [`Observer::target_moved`] has just said.
    fn target_gone(&mut self, _target: TargetId, _time: SimTime) {}

    /// A sensor of a node says something.
    fn sensed(&mut self, _node: NodeId, _time: SimTime, _sensed: &Sensed) {}

    /// The battery of a node is empty: the node dies.
    fn depleted(&mut self, _node: NodeId, _time: SimTime) {}

    /// A station removed the source number `source` of a field.
    fn source_removed(&mut self, _field: FieldId, _source: usize, _time: SimTime) {}

    /// A frame was on air; called at its end, and only if [`Observer::wants_frames`].
    fn framed(&mut self, _frame: FrameOnAir<'_>) {}

    /// Whether [`Observer::framed`] is called. A simulation asks once, before the start.
    fn wants_frames(&self) -> bool {
        false
    }

    /// A link has ended its work on a packet, or the simulation has ended before; called only if
    /// [`Observer::wants_packets`].
    fn traced(&mut self, _packet: &PacketTrace) {}

    /// Whether [`Observer::traced`] is called. A simulation asks once, before the start.
    fn wants_packets(&self) -> bool {
        false
    }

    /// Asked after each stop, and each thousand events; `false` ends the simulation there. A stop that is not over
    /// then is not in the log.
    fn goes_on(&mut self, _progress: Progress) -> bool {
        true
    }
}

/// Progress of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Current time.
    pub time: SimTime,
    /// Number of stops so far, of all robots.
    pub stops: usize,
    /// Number of nodes heard at least once.
    pub nodes_heard: usize,
    /// Number of all nodes.
    pub nodes: usize,
    /// Number of packets that applications have offered so far.
    pub packets_offered: u64,
}

/// Ignores everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {}

/// Passes everything on to another observer, but remembers whether that wants frames, so that no frame has to ask it.
pub(crate) struct RememberingObserver<'a> {
    observer: &'a mut dyn Observer,
    wants_frames: bool,
}

impl<'a> RememberingObserver<'a> {
    pub(crate) fn new(observer: &'a mut dyn Observer) -> Self {
        Self { wants_frames: observer.wants_frames(), observer }
    }
}
