//! What an application can know and do.

use std::time::Duration;

use sextant_channel::{Contact, Position, RangeSample, RangingDevice, Stop, StopLog};
use sextant_kernel::{EventKey, NodeId, Seed, SimTime, StationId};

use crate::event::{Event, Timer};
use crate::model::{Course, Model, Note};
use crate::purpose;
use crate::service::delivery::DriveEnd;
use crate::service::due_frames::DueFrames;
use crate::service::estimate::Estimate;
use crate::service::network_id::NetworkId;
use crate::service::report::{Destination, FrameId, Payload, SendError};
use crate::service::sensed::{FieldId, TargetId};
use crate::service::sweep::{SweepError, SweepKind};
use crate::station::{Curve, Pose, RangeSensors, StationKind};

/// What the application of one station can know and do.
pub struct Port<'a> {
    pub(crate) model: &'a mut Model,
    pub(crate) station: StationId,
}

/// What a command to drive brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Driving {
    /// The robot drives; [`Application::drive_ended`](super::Application::drive_ended) is called at the end.
    UnderWay,
    /// The robot is where it should be, or cannot move at all.
    Over(DriveEnd),
}

/// A drive under way, as the robot's range sensors foresee it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveAhead {
    /// When it ends, if the robot is not halted.
    pub end: SimTime,
    /// The point of contact on the obstacle that ends it, if one does (m).
    pub contact: Option<Position>,
}

impl Port<'_> {
    /// Current time.
    #[must_use]
    pub fn now(&self) -> SimTime {
        self.model.scene.now
    }

    /// The station.
    #[must_use]
    pub fn station(&self) -> StationId {
        self.station
    }

    /// What the station is.
    #[must_use]
    pub fn kind(&self) -> StationKind {
        self.model.scene.roll.kind(self.station)
    }

    /// The node that a station is; `None` if it is a robot or a sink.
    #[must_use]
    pub fn node(&self, station: StationId) -> Option<NodeId> {
        self.model.scene.roll.is_node(station).then_some(NodeId(station.0))
    }

    /// Number of nodes in the world: the only thing that robots know about the network in advance (thesis, chapter
    /// 3).
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.model.scene.roll.nodes
    }

    /// The seed of all randomness, for draws at addresses of the application's own.
    #[must_use]
    pub fn seed(&self) -> Seed {
        self.model.scene.seed
    }

    /// 128 random bits of this station, for a generator of the application's own: see
    /// [`program_seed`](crate::program_seed).
    #[must_use]
    pub fn program_seed(&self) -> u128 {
        purpose::program_seed(self.seed(), self.station)
    }

    /// The seed of the traffic in a network.
    pub(crate) fn seed_of(&self, network: NetworkId) -> Seed {
        purpose::traffic_seed(self.seed(), network)
    }

    /// A random number of this station, uniform in (0, 1): each `number` has its own, always the same in a run.
    #[must_use]
    pub fn uniform(&self, number: u64) -> f64 {
        self.seed().uniform(purpose::APPLICATION, [self.station.0.into(), number, 0])
    }

    /// A random choice of this station among `count`: an index below it, each equally likely. Each `number` has its
    /// own, always the same in a run.
    ///
    /// # Panics
    /// If `count` is zero, or does not fit in 32 bits.
    #[must_use]
    pub fn choice(&self, number: u64, count: usize) -> usize {
        let count = u32::try_from(count).expect("at most 2^32 things to choose from");
        assert!(count > 0, "there is nothing to choose from");
        let bits = self.seed().bits(purpose::APPLICATION, [self.station.0.into(), number, 1]);
        // The upper 32 bits scaled to the range.
        usize::try_from(((bits >> 32) * u64::from(count)) >> 32).expect("below 2^32")
    }

    /// Gives a frame to the link of a network: it is sent as soon as the channel allows, after those given before. In a
    /// network with sector sweeps, a frame to all is sent from each sector of the station in turn, at each tilt of a
    /// steered antenna; a frame to one station is refused.
    ///
    /// # Errors
    /// If the transmit queue is full, the payload is too large, or the destination cannot receive it.
    #[inline]
    pub fn send(&mut self, network: NetworkId, to: Destination, payload: Payload<'_>) -> Result<FrameId, SendError> {
        self.model.networks[network.index()].offer(self.station, to, payload, &mut self.model.scene)
    }

    /// Tells the link of a network to which station the packets of this one go from now on: links that agree with it on when to
    /// send do so. `None` if it is not known.
    pub fn follow(&mut self, network: NetworkId, parent: Option<StationId>) {
        self.model.networks[network.index()].follow(self.station, parent, &mut self.model.scene);
    }

    /// Whether nobody who listens is near, so that what the station sends reaches nobody, and holds back nobody who is
    /// heard. Then an application that [may rest](super::Application::may_rest) need not send it. It is
    /// [woken](super::Application::woken) when a listener comes near. Always false if all nodes are simulated.
    #[must_use]
    #[inline]
    pub fn is_out_of_hearing(&self) -> bool {
        self.model.halo.as_ref().is_some_and(|halo| halo.is_outside(self.station))
    }

    /// The station has chosen another one as its parent in a tree. In a network with slots its time comes from there from now on,
    /// if it has joined. Other technologies need not know.
    pub fn take_time_from(&mut self, network: NetworkId, parent: StationId) {
        self.model.networks[network.index()].take_time_from(self.station, parent);
    }

    /// Energy that is left in the battery of the station (J), as a meter of its charge would show; `None` if it has no battery.
    #[must_use]
    pub fn charge_j(&mut self) -> Option<f64> {
        self.model.charge_j(self.station)
    }

    /// Nothing happens in the event that is handled now: it does not count.
    pub(crate) fn discount_event(&mut self) {
        self.model.scene.discounted += 1;
    }

    /// Leaves out frames of this station that were due while it rested.
    pub(crate) fn skip(&mut self, network: NetworkId, frames: u64) {
        self.model.networks[network.index()].skip(self.station, frames);
    }

    /// Notes which frames of this station were due in a network since [`counted_from`](Self::counted_from).
    pub(crate) fn note_due(&mut self, network: NetworkId, due: DueFrames) {
        self.model.networks[network.index()].note_due(self.station, due);
    }

    /// What happens before it is not counted.
    pub(crate) fn counted_from(&self) -> SimTime {
        self.model.scene.counted_from
    }

    /// Sets a timer: [`Application::timed`](super::Application::timed) is called `span` from now. Any number may be
    /// pending.
    #[inline]
    pub fn after(&mut self, span: Duration, timer: Timer) -> EventKey {
        self.model.scene.after(span, Event::Timer(self.station, timer))
    }

    /// Cancels a timer, if it is pending.
    pub fn cancel(&mut self, key: EventKey) {
        self.model.scene.queue.cancel(key);
    }

    /// A robot opens its receiver for `span`, whether it stands or drives;
    /// [`Application::listened`](super::Application::listened) is called at the end. If it listens already, the new
    /// time replaces what is left of the old one. An acknowledgement that is under way at the end is sent first.
    /// Nodes and sinks listen anyway, and go on afterwards.
    /// The power of a frame is that where the robot is when the frame begins.
    pub fn listen(&mut self, network: NetworkId, span: Duration) {
        self.model.networks[network.index()].listen(self.station, span, &mut self.model.scene);
    }

    /// Whether the links of a network sweep sectors.
    #[must_use]
    pub fn has_sectors(&self, network: NetworkId) -> bool {
        self.model.networks[network.index()].sweeps_sectors()
    }

    /// How the robots measure ranges in a network; `None` if they do not.
    #[must_use]
    pub fn ranging(&self, network: NetworkId) -> Option<&RangingDevice> {
        self.model.rangings[network.index()].as_ref().map(|ranging| &ranging.device)
    }

    /// A robot measures the range to a node in a network, from where its odometry says that it is. No frame is sent for that. `None`
    /// if the network has no ranging, if the node is not in it or dead, or if the try brings no range.
    ///
    /// # Panics
    /// If the station is no robot.
    #[must_use]
    pub fn measure_range(&self, network: NetworkId, node: NodeId) -> Option<RangeSample> {
        self.model.measure_range(self.station, network, node)
    }

    /// Number of sectors of the station's antenna in a network, all rings and tilts together; `None` if it has none, or the
    /// links of the network do not sweep.
    #[must_use]
    pub fn sectors(&self, network: NetworkId) -> Option<u8> {
        self.model.networks[network.index()].sectors(self.station)
    }

    /// Begins a sector sweep; [`Application::swept`](super::Application::swept) is called at its end. A steered antenna
    /// sweeps at one tilt after the other. A broadcast of this station that is under way ends first; those that wait in its
    /// transmit queue come afterwards.
    ///
    /// # Errors
    /// If a sweep of this station or its answer to another sweep is under way, or the network has no sector sweeps.
    pub fn sweep(&mut self, network: NetworkId, kind: SweepKind) -> Result<(), SweepError> {
        self.model.networks[network.index()].sweep(self.station, kind, &mut self.model.scene)
    }

    /// Where the station is and where it looks; for a robot, by its odometry.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose_at(self.now())
    }

    /// The pose at `time` of a station that moves on as it does now: the start of its drive before that, the end of its
    /// drive after that.
    #[must_use]
    pub fn pose_at(&self, time: SimTime) -> Pose {
        match self.kind() {
            StationKind::Robot(robot) => self.model.vehicles[robot].believed_at(time),
            StationKind::Node(_) | StationKind::Sink(_) => {
                self.model.scene.motions[self.station.index()].pose_at(time)
            }
        }
    }

    /// A robot turns towards `place`, which takes no time, and drives straight there, at its speed, or until an
    /// obstacle is in the way. It may listen and send meanwhile.
    ///
    /// # Panics
    /// If the station is no robot, or drives already.
    pub fn drive(&mut self, place: Position) -> Driving {
        self.set_out(Course::To(place))
    }

    /// A robot drives `length_m` along an arc at its speed, or until an obstacle is in the way. On the way its heading
    /// turns by `turn_rad`, counterclockwise. An arc without length is a turn on the spot, which takes no time.
    ///
    /// # Panics
    /// If the station is no robot, or drives already, or the length is negative, or a number is not finite.
    pub fn drive_arc(&mut self, length_m: f64, turn_rad: f64) -> Driving {
        assert!(
            length_m >= 0.0 && length_m.is_finite() && turn_rad.is_finite(),
            "an arc of {length_m} m, {turn_rad} rad"
        );
        self.set_out(Course::Along(Curve { length_m, climb_m: 0.0, turn_rad }))
    }

    /// A robot drives for `span` at its speed and turns meanwhile at `turn_rate_rad_per_s`, counterclockwise, unless an
    /// obstacle is in the way.
    ///
    /// # Panics
    /// If the station is no robot, or drives already, or the turn rate is not finite.
    pub fn steer(&mut self, span: Duration, turn_rate_rad_per_s: f64) -> Driving {
        let speed_m_per_s = self.model.vehicles[self.model.robot(self.station).index()].body.speed_m_per_s;
        let span_s = span.as_secs_f64();
        self.drive_arc(speed_m_per_s * span_s, turn_rate_rad_per_s * span_s)
    }

    fn set_out(&mut self, course: Course) -> Driving {
        self.model.set_out(self.station, course).map_or(Driving::UnderWay, Driving::Over)
    }

    /// A robot stops where it is. [`Application::drive_ended`](super::Application::drive_ended) is not called for a
    /// drive that was halted. Nothing happens if it stands.
    ///
    /// # Panics
    /// If the station is no robot.
    pub fn halt(&mut self) {
        self.model.halt(self.station);
    }

    /// The drive under way of a robot; `None` if it stands.
    ///
    /// # Panics
    /// If the station is no robot.
    #[must_use]
    pub fn drive_ahead(&self) -> Option<DriveAhead> {
        let drive = self.model.vehicles[self.model.robot(self.station).index()].drive?;
        Some(DriveAhead { end: drive.trip.end, contact: drive.contact })
    }

    /// How far a robot could drive straight in `direction` (of any length above zero) before its hull touches an
    /// obstacle (m), at most `range_m`: the reading of its range sensors.
    ///
    /// # Panics
    /// If the station is no robot.
    #[must_use]
    pub fn clearance_m(&self, direction: Position, range_m: f64) -> f64 {
        self.range_sensors().clearance_m(direction, range_m)
    }

    /// The range sensors of a robot.
    pub(crate) fn range_sensors(&self) -> RangeSensors<'_> {
        let truth = self.model.scene.motions[self.station.index()].pose_at(self.now());
        RangeSensors {
            obstacles: &self.model.world.obstacles,
            radius_m: self.model.vehicles[self.model.robot(self.station).index()].body.radius_m,
            place: truth.position,
            turn_rad: truth.heading_rad - self.pose().heading_rad,
        }
    }

    /// Tells the observer where the robot starts.
    pub(crate) fn tell_start(&mut self) {
        self.model.note_start(self.station);
    }

    /// Writes an obstacle into the log of this robot: it meets the obstacle at `time` at the point `position`. Nothing
    /// else writes contacts.
    pub fn log_contact(&mut self, time: SimTime, position: Position) {
        let robot = self.model.robot(self.station);
        self.model.notes.push(Note::Met(Contact { robot, time, position }));
    }

    /// Writes a stop of this robot into the log of a network: it has listened at `position` from `since` until now. The number of
    /// the stop in what it heard is filled in, and the heading of the robot by its odometry if its antenna turns with it.
    ///
    /// # Panics
    /// If the station is no robot; and at the end of the simulation, if what was heard is no log: a node twice at a stop, or
    /// more packets received than sent.
    pub fn log_stop(&mut self, network: NetworkId, since: SimTime, position: Position, heard: impl Into<StopLog>) {
        let robot = self.model.robot(self.station);
        let turns = self.model.networks[network.index()].turns_antennas();
        let heading_rad = turns.then(|| self.pose_at(since).heading_rad);
        self.model.notes.push(Note::Stopped(
            network,
            Stop { robot, time: since, position, heading_rad },
            heard.into(),
        ));
    }

    /// Tells the observer what the application has worked out.
    pub fn tell(&mut self, estimate: Estimate) {
        self.model.notes.push(Note::Estimated(self.station, estimate));
    }

    /// Tells the observer that a packet over several hops begins here now, with this number among those of the station. Numbers
    /// follow each other, and go round.
    pub fn tell_origin(&mut self, number: u16) {
        self.model.notes.push(Note::Originated(self.station, number));
        if self.now() >= self.counted_from() {
            self.model.origins.begin(self.station, number);
        }
    }

    /// Whether a packet over several hops counts: it began at the station `origin`, with this number, after the warm-up. That is
    /// for what is counted; a station does not know it.
    #[must_use]
    pub fn is_counted(&self, origin: StationId, number: u16) -> bool {
        self.model.origins.counts(origin, number)
    }

    /// The targets that are truly within `reach_m` of the station now, by number: what it can touch.
    #[must_use]
    pub fn targets_within(&self, reach_m: f64) -> Vec<TargetId> {
        let place = self.model.scene.place(self.station);
        let places = self.model.sensing.places(self.now());
        places.filter(|(_, target)| target.distance_m(place) <= reach_m).map(|(target, _)| target).collect()
    }

    /// A robot captures the targets that are truly within `reach_m` of it now: they are gone from the world. A sensor
    /// that detects one says [`Left`](crate::Sensed::Left) at this instant, after the call. Returns them by number.
    ///
    /// # Panics
    /// If the station is no robot.
    pub fn capture(&mut self, reach_m: f64) -> Vec<TargetId> {
        let robot = self.model.robot(self.station);
        let captured = self.targets_within(reach_m);
        for &target in &captured {
            self.model.notes.push(Note::Captured(robot, target));
            let place = self.model.sensing.vanish(target, &mut self.model.scene);
            self.model.notes.push(Note::TargetGone(target, place));
        }
        captured
    }

    /// Removes the sources of fields whose centres are truly within `reach_m` of the station. Returns their number.
    pub fn remove_sources(&mut self, reach_m: f64) -> usize {
        let (place, now) = (self.model.scene.place(self.station), self.now());
        let mut removed = 0;
        for (i, field) in self.model.world.fields.iter_mut().enumerate() {
            for source in 0..field.gaussians().len() {
                let gaussian = field.gaussians()[source];
                if gaussian.is_active(now) && gaussian.center().distance_m(place) <= reach_m {
                    field.remove(source, now);
                    self.model.notes.push(Note::SourceRemoved(FieldId::from_index(i), source));
                    removed += 1;
                }
            }
        }
        removed
    }

    /// The task of the application is done. The simulation ends when the tasks of all are. A second call changes
    /// nothing, and neither does one of an application without a task.
    pub fn finish(&mut self) {
        let had_task = std::mem::take(&mut self.model.has_task[self.station.index()]);
        self.model.unfinished -= usize::from(had_task);
        if let Some(halo) = self.model.halo.as_mut().filter(|halo| had_task && halo.is_listener(self.station)) {
            // It hears nothing any more.
            halo.lift(self.station);
        }
    }
}
