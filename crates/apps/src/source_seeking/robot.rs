//! The application of a robot.

mod avoiding;
mod looking;
mod polling;
mod wandering;

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;
use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_sim::{Application, Delivery, DriveEnd, Driving, NetworkId, Port, Pose, Timer};

use super::arrival::ArrivalWatch;
use super::boundary::Boundary;
use super::field_estimate::{FieldEstimate, Readings};
use super::goal::AfterArrival;
use super::gradient::turn_rate;
use super::poll::Access;
use super::progress::Progress;
use super::record::{Arrival, RobotSeekRecord, SeekState};
use super::settings::SourceSeeking;
use super::source_watch::SourceWatch;
use super::steering::{SpatialCourse, Steering};
use crate::navigation::{Asking, NavigationMap, Neighbourhood, PlaceOnMap};

const POLL: Timer = Timer(0);
const CONTROL: Timer = Timer(1);

/// A robot does not begin before it has heard so many nodes.
const LEAST_NODES: usize = 3;
/// Radius of the arc on which a robot finds out how the map is turned (m): wide beside the errors of received powers.
const ARC_RADIUS_M: f64 = 4.0;

/// A robot: it polls the nodes around it, works out the field where it is, and drives to where that has the level sought,
/// or to the source.
#[derive(Debug)]
pub struct SeekRobot {
    settings: Arc<SourceSeeking>,
    map: Arc<NavigationMap>,
    network: NetworkId,
    speed_m_per_s: f64,
    place: PlaceOnMap,
    /// The nodes that answered the latest poll.
    neighbourhood: Neighbourhood,
    /// Where the nodes of the poll before it said that the robot was, on the map (m).
    centroid: Option<Position>,
    readings: Readings,
    /// Number of the latest poll, and where the robot was then by its odometry.
    asking: Asking,
    polled_at: Option<Position>,
    /// With ideal polls: when its place was fixed last, and whether each node in range had a reading.
    fixed: Option<SimTime>,
    has_heard_all: bool,
    steering: Steering,
    mode: Mode,
    /// The obstacle that it left last, and when.
    left: Option<(Boundary, SimTime)>,
    watch: ArrivalWatch,
    source_watch: SourceWatch,
    progress: Progress,
    record: RobotSeekRecord,
}

#[derive(Clone, Copy, Debug)]
enum Mode {
    Waiting,
    /// It drives along a wide arc until it knows how the map is turned.
    Orienting,
    Seeking,
    Avoiding(Boundary),
    /// It turns on the spot, and then goes on round an obstacle into this direction (rad).
    Turning(Boundary, f64),
    /// It drives to a random place (m, by odometry), until it is there or has driven so far (m).
    Wandering(Position, f64),
    Arrived,
}

/// What it knows at an instant.
#[derive(Clone, Copy, Debug)]
struct Outlook {
    pose: Pose,
    /// On the map (m).
    place: Option<Position>,
    field: FieldEstimate,
}

impl SeekRobot {
    /// A robot that drives at `speed_m_per_s` and uses `network`.
    #[must_use]
    pub fn new(
        settings: Arc<SourceSeeking>,
        map: Arc<NavigationMap>,
        network: NetworkId,
        speed_m_per_s: f64,
    ) -> Self {
        Self {
            steering: Steering::new(&settings.guidance, speed_m_per_s),
            place: PlaceOnMap::new(map.frame()),
            settings,
            map,
            network,
            speed_m_per_s,
            neighbourhood: Neighbourhood::default(),
            centroid: None,
            readings: Readings::default(),
            asking: Asking::default(),
            polled_at: None,
            fixed: None,
            has_heard_all: false,
            mode: Mode::Waiting,
            left: None,
            watch: ArrivalWatch::default(),
            source_watch: SourceWatch::default(),
            progress: Progress::default(),
            record: RobotSeekRecord::default(),
        }
    }

    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> RobotSeekRecord {
        let circles = self.settings.goal.then == AfterArrival::Circle && self.has_arrived_often_enough();
        let state = match self.mode {
            Mode::Waiting => SeekState::Waiting,
            Mode::Orienting => SeekState::Orienting,
            Mode::Seeking if circles => SeekState::Circling,
            Mode::Seeking => SeekState::Seeking,
            Mode::Avoiding(_) | Mode::Turning(..) => SeekState::Avoiding,
            Mode::Wandering(..) => SeekState::Wandering,
            Mode::Arrived => SeekState::Arrived,
        };
        RobotSeekRecord { state, ..self.record }
    }

    fn has_arrived_often_enough(&self) -> bool {
        self.record.arrivals.len() >= self.settings.goal.arrivals as usize
    }

    /// Length of the way between two decisions (m).
    fn step_m(&self) -> f64 {
        self.speed_m_per_s * self.settings.control.as_secs_f64()
    }

    /// Looks at what it knows, and drives on.
    fn decide(&mut self, port: &mut Port<'_>) {
        self.hear_all(port);
        if matches!(self.mode, Mode::Waiting) {
            if !self.has_heard_enough() {
                port.after(self.settings.control, CONTROL);
                return;
            }
            self.mode = Mode::Orienting;
        }
        if matches!(self.mode, Mode::Orienting) {
            if self.place.to_map(port.pose().position).is_none() {
                self.orient(port);
                return;
            }
            self.mode = Mode::Seeking;
            self.record.oriented = Some(port.now());
        }
        let Some(outlook) = self.look(port) else {
            port.after(self.settings.control, CONTROL);
            return;
        };
        if !self.has_arrived_often_enough() && self.arrives(&outlook, port.now()) {
            self.arrive(outlook, port);
            if matches!(self.mode, Mode::Arrived) {
                return;
            }
        }
        if self.should_wander(&outlook)
            && let Some(goal) = self.random_place(port)
        {
            self.record.wandered += 1;
            self.mode = Mode::Wandering(goal, outlook.pose.position.distance_m(goal));
        }
        match self.mode {
            Mode::Wandering(goal, way_m) => self.wander(goal, way_m, outlook, port),
            Mode::Avoiding(boundary) => self.go_round(boundary, outlook, port),
            Mode::Turning(boundary, direction) => {
                self.mode = Mode::Avoiding(boundary);
                self.step(direction, outlook, port);
            }
            Mode::Waiting | Mode::Orienting | Mode::Seeking | Mode::Arrived => self.seek(outlook, port),
        }
    }

    /// Drives on along an arc. An obstacle in the way is behind it after a quarter turn or two.
    fn orient(&mut self, port: &mut Port<'_>) {
        let turn_rate = (self.speed_m_per_s / ARC_RADIUS_M).min(self.settings.turn_rate_max_rad_per_s);
        if let Driving::Over(_) = port.steer(self.settings.control, turn_rate) {
            port.drive_arc(0.0, FRAC_PI_2);
            port.after(self.settings.control, CONTROL);
        }
    }

    /// It is where it wanted to be. Without a source to remove, this is what is left of an earlier one, and it drives on.
    fn arrive(&mut self, Outlook { pose, place, field }: Outlook, port: &mut Port<'_>) {
        let reach_m = self.settings.goal.remove_within_m;
        let removed = reach_m.map_or(0, |reach_m| port.remove_sources(reach_m));
        if reach_m.is_some() && removed == 0 {
            return self.steering.restart();
        }
        self.record.removed += removed;
        let value = field.value;
        self.record.arrivals.push(Arrival { time: port.now(), value, place, odometry: pose.position, removed });
        if self.has_arrived_often_enough() && self.settings.goal.then == AfterArrival::Stop {
            self.mode = Mode::Arrived;
            port.finish();
        } else {
            self.steering.restart();
        }
    }

    /// Drives on where nothing is in the way.
    fn seek(&mut self, outlook: Outlook, port: &mut Port<'_>) {
        let span = self.settings.control;
        let span_s = span.as_secs_f64();
        let course_rad = self.course_rad(&outlook);
        let (step_m, turn_rate_max) = (self.step_m(), self.settings.turn_rate_max_rad_per_s);
        let slope = outlook.place.zip(outlook.field.gradient).map(|(place, slope)| self.by_odometry(place, slope));
        let driving = match &mut self.steering {
            Steering::Gradient { gain_per_s, .. } => {
                let heading_rad = outlook.pose.heading_rad;
                let rate =
                    course_rad.map_or(0.0, |course| turn_rate(heading_rad, course, *gain_per_s, turn_rate_max));
                self.record.turned_rad += (rate * span_s).abs();
                port.steer(span, rate)
            }
            Steering::LevelSet(steering) => {
                let time_s = port.now().as_secs_f64();
                let turn_rate = steering.turn_rate(time_s, &outlook.field, slope, self.speed_m_per_s, span_s);
                self.record.turned_rad += (turn_rate * span_s).abs();
                match &mut steering.space {
                    None => port.steer(span, turn_rate),
                    Some(SpatialCourse { torsion_per_m, frame }) => {
                        let step = frame.advance(step_m, turn_rate / self.speed_m_per_s, *torsion_per_m);
                        port.drive(outlook.pose.position + step)
                    }
                }
            }
        };
        if let Driving::Over(end) = driving {
            self.ended(end, port);
        }
    }

    /// A drive is over.
    fn ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        match end {
            DriveEnd::Arrived => self.decide(port),
            DriveEnd::Blocked(contact) => {
                self.record.blocked += 1;
                port.log_contact(port.now(), contact);
                if !matches!(self.mode, Mode::Orienting) {
                    self.meet(port);
                }
                port.after(self.settings.control, CONTROL);
            }
        }
    }
}

impl Application for SeekRobot {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Some(heading_rad) = self.settings.start_heading_rad {
            port.drive_arc(0.0, heading_rad - port.pose().heading_rad);
        }
        self.steering.take_over(port.pose().heading_rad);
        self.ask(port);
        let begin = match self.settings.poll.access {
            Access::Ideal => Duration::ZERO,
            Access::Frames { interval, .. } => interval,
        };
        port.after(begin, CONTROL);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match (timer, self.mode) {
            (_, Mode::Arrived) => {}
            (POLL, _) => self.ask(port),
            _ => self.decide(port),
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        self.hear(delivery, port);
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        self.ended(end, port);
    }
}
