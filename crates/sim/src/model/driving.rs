//! Driving: what robots command, what they believe, and what really happens.

use sextant_channel::Position;
use sextant_kernel::{RobotId, StationId};

use super::vehicle::Drive;
use super::{Model, Note};
use crate::event::Event;
use crate::purpose;
use crate::service::delivery::DriveEnd;
use crate::station::{Curve, Luck, Motion, Pose, Trip, Way};

/// Largest turn of a part of an arc that the observer sees (rad): 5 degrees.
const TURN_OF_PART_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// Where a robot should drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Course {
    /// Straight to a place.
    To(Position),
    /// Along a curve.
    Along(Curve),
}

/// What happens on a drive.
struct Plan {
    /// The true way.
    trip: Trip,
    /// The way that the robot believes to drive in the same time.
    believed: Trip,
    /// The point of contact at the end, where the robot believes it to be, if an obstacle ends the drive.
    contact: Option<Position>,
}

impl Model {
    /// The robot begins to drive. Returns how the drive ended if it takes no time.
    ///
    /// # Panics
    /// If the station is no robot, or drives already.
    pub(crate) fn set_out(&mut self, station: StationId, course: Course) -> Option<DriveEnd> {
        let robot = self.robot(station);
        let vehicle = &self.vehicles[robot.index()];
        let (Motion::Standing(truth), Motion::Standing(belief)) =
            (self.scene.motions[station.index()], vehicle.belief)
        else {
            panic!("{station} drives already");
        };
        let speed_m_per_s = vehicle.body.speed_m_per_s;
        let planned = match course {
            Course::To(place) => Trip::straight(belief, place, self.scene.now, speed_m_per_s),
            Course::Along(curve) => Trip::along(curve, belief, self.scene.now, speed_m_per_s),
        };
        if planned.length_m <= 0.0 {
            if !planned.is_straight() {
                let heading_rad = truth.heading_rad + planned.turn_rad;
                self.stand(station, &planned, Pose { heading_rad, ..truth }, planned.to);
            }
            return Some(DriveEnd::Arrived);
        }
        let plan = self.plan(robot, planned, truth, belief);
        if plan.trip.length_m <= 0.0 {
            return Some(plan.contact.map_or(DriveEnd::Arrived, DriveEnd::Blocked));
        }
        self.depart(station, &plan);
        None
    }

    /// What happens if a robot with the pose `truth`, which believes to have the pose `belief`, drives as `planned`.
    fn plan(&mut self, robot: RobotId, planned: Trip, truth: Pose, belief: Pose) -> Plan {
        let vehicle = &mut self.vehicles[robot.index()];
        vehicle.drives += 1;
        let odometry = vehicle.body.odometry;
        if odometry.is_exact() {
            let Way { trip, contact } = Way::of(planned, &self.world.obstacles, vehicle.body.radius_m);
            return Plan { trip, believed: trip, contact };
        }
        let place = |what| [robot.0.into(), vehicle.drives, what];
        let normal = |what| self.scene.seed.normal(purpose::ODOMETRY, place(what));
        let luck = Luck { length: normal(0), heading: normal(1) };
        let turn_rad = truth.heading_rad - belief.heading_rad;
        let whole = odometry.truth(&planned, truth.position, turn_rad, luck);
        let Way { trip, contact } = Way::of(whole, &self.world.obstacles, vehicle.body.radius_m);
        let Some(contact) = contact else { return Plan { trip, believed: planned, contact: None } };
        let believed = planned.first(planned.length_m * (trip.length_m / whole.length_m));
        let believed = Trip { end: trip.end, ..believed };
        // The robot sees the obstacle from where it believes to be.
        let turn_rad = believed.to.heading_rad - trip.to.heading_rad;
        let contact = believed.to.position + (contact - trip.to.position).turned(turn_rad);
        Plan { trip, believed, contact: Some(contact) }
    }

    fn depart(&mut self, station: StationId, plan: &Plan) {
        let &Plan { trip, believed, contact } = plan;
        let robot = self.robot(station);
        self.move_as(station, Motion::Driving(trip));
        self.vehicles[robot.index()].belief = Motion::Driving(believed);
        self.note_pose(robot, &trip, trip.from, believed.from);
        let end = self.scene.after(trip.end - self.scene.now, Event::DriveEnded(station));
        self.vehicles[robot.index()].drive = Some(Drive { trip, contact, end, part: None });
        self.expect_part(station, 1);
    }

    /// Schedules the end of the part of an arc with this number, if it is not the last one.
    fn expect_part(&mut self, station: StationId, part: u32) {
        let robot = self.robot(station);
        let Some(drive) = &mut self.vehicles[robot.index()].drive else { return };
        let parts = parts(&drive.trip);
        drive.part = (part < parts).then(|| {
            let due = drive.trip.start + (drive.trip.end - drive.trip.start) * part / parts;
            (part, self.scene.after(due - self.scene.now, Event::ArcPartDriven(station)))
        });
    }

    /// The robot has driven a part of an arc.
    pub(crate) fn pass(&mut self, station: StationId) {
        let robot = self.robot(station);
        let (now, vehicle) = (self.scene.now, &self.vehicles[robot.index()]);
        let Some(Drive { trip, part: Some((part, _)), .. }) = vehicle.drive else {
            unreachable!("a part is driven only on an arc");
        };
        self.note_pose(robot, &trip, trip.at(now), vehicle.believed_at(now));
        self.expect_part(station, part + 1);
    }

    /// The robot is at the end of its drive. Returns the point of contact, if an obstacle ended it.
    pub(crate) fn arrive(&mut self, station: StationId) -> Option<Position> {
        let robot = self.robot(station);
        let vehicle = &mut self.vehicles[robot.index()];
        let (Some(Drive { trip, contact, .. }), Motion::Driving(believed)) = (vehicle.drive.take(), vehicle.belief)
        else {
            unreachable!("a robot arrives only from a drive");
        };
        vehicle.path_length_m += trip.length_m;
        self.stand(station, &trip, trip.to, believed.to);
        contact
    }

    /// The robot stops where it is, if it drives.
    pub(crate) fn halt(&mut self, station: StationId) {
        let robot = self.robot(station);
        let now = self.scene.now;
        let vehicle = &mut self.vehicles[robot.index()];
        let (Some(Drive { trip, end, part, .. }), Motion::Driving(believed)) = (vehicle.drive.take(), vehicle.belief)
        else {
            return;
        };
        for event in [Some(end), part.map(|(_, event)| event)].into_iter().flatten() {
            self.scene.queue.cancel(event);
        }
        let (driven, believed) = (trip.cut_at(now), believed.cut_at(now));
        vehicle.path_length_m += driven.length_m;
        self.stand(station, &trip, driven.to, believed.to);
    }

    /// The robot stands, after `trip`.
    fn stand(&mut self, station: StationId, trip: &Trip, truth: Pose, belief: Pose) {
        let robot = self.robot(station);
        self.move_as(station, Motion::Standing(truth));
        self.vehicles[robot.index()].belief = Motion::Standing(belief);
        self.note_pose(robot, trip, truth, belief);
    }

    pub(super) fn move_as(&mut self, station: StationId, motion: Motion) {
        self.scene.motions[station.index()] = motion;
        for network in &self.networks {
            network.moves(station, &mut self.scene);
        }
        self.follow(station);
    }

    /// Notes the place where a robot starts.
    pub(crate) fn note_start(&mut self, station: StationId) {
        let robot = self.robot(station);
        let now = self.scene.now;
        let truth = self.scene.motions[station.index()].pose_at(now);
        self.notes.push(Note::Moved(robot, truth.position));
        self.note_belief(robot, self.vehicles[robot.index()].believed_at(now));
    }

    /// Notes the pose of a robot on `trip`.
    fn note_pose(&mut self, robot: RobotId, trip: &Trip, truth: Pose, belief: Pose) {
        let note = if trip.is_straight() { Note::Moved(robot, truth.position) } else { Note::Curved(robot, truth) };
        self.notes.push(note);
        self.note_belief(robot, belief);
    }

    fn note_belief(&mut self, robot: RobotId, belief: Pose) {
        if !self.vehicles[robot.index()].body.odometry.is_exact() {
            self.notes.push(Note::Believed(robot, belief));
        }
    }
}

/// Number of parts of equal length in which the observer sees a trip.
fn parts(trip: &Trip) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of parts")]
    let parts = (trip.turn_rad.abs() / TURN_OF_PART_RAD).ceil() as u32;
    parts.max(1)
}
