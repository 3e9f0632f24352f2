//! The application of a robot that searches targets.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use sextant_channel::{Bounds, Position};
use sextant_kernel::{SimTime, StationId};
use sextant_sim::{Application, Delivery, DriveEnd, Estimate, NetworkId, Port, Pose, RobotBody, TargetId, Timer};

use super::config::{Aim, OwnPlaceRule, SearchMotion, WithoutNews};
use super::driver::Driver;
use super::gradient_pilot::GradientPilot;
use super::idle::Idle;
use super::interception::Pursuit;
use super::message::{Detection, Message};
use super::outbox::Outbox;
use super::prober::Prober;
use super::record::{RobotSearchRecord, SearchStep};
use super::settings::{Detarsk, Method, TargetSearch};
use super::sightings::Sighting;
use super::team::Team;
use super::tracker::Tracker;
use crate::navigation::{Asking, HeardNode, MapFrame, NavigationMap, Neighbourhood, PlaceOnMap, Request};

/// The timer of the next step.
const STEP: Timer = Timer(1);
/// The timer of the next look whether a target is within reach.
const REACH: Timer = Timer(2);

/// How often a robot looks whether a target is within reach, at least.
const REACH_INTERVAL: Duration = Duration::from_millis(100);
/// Between two looks it drives at most this share of the reach, so that it passes no target that is nearer than 0.97 of it.
const REACH_SHARE: f64 = 0.5;
/// How often a robot that waits for a round looks whether it has come.
const WAIT_INTERVAL: Duration = Duration::from_millis(20);
/// Share of a step in which robots begin.
const PHASE_SHARE: f64 = 0.1;
/// Share of a step in which nodes answer a poll.
const WINDOW_SHARE: f64 = 0.6;
/// The neighbourhood, as a multiple of the way of the robot in one step: V + ε with ε = V/2 (thesis, information
/// gathering).
const NEIGHBOURHOOD_STEPS: f64 = 1.5;
/// Answers from which the robot learns where it is on the map.
const RELIABLE: usize = 8;
/// How far ahead an interception is looked for.
const HORIZON: Duration = Duration::from_secs(120);
const SCAN: Duration = Duration::from_millis(200);

/// A robot that searches targets.
#[derive(Debug)]
pub struct SearchRobot {
    settings: Arc<TargetSearch>,
    map: Arc<NavigationMap>,
    network: NetworkId,
    speed_m_per_s: f64,
    targets: usize,
    duration: Duration,
    place: PlaceOnMap,
    neighbourhood: Neighbourhood,
    asking: Asking,
    /// Where it was by odometry when it sent the last request.
    asked_at: Option<Pose>,
    pilot: Pilot,
    /// When it ended its latest step, and whether it stands since then.
    stepped: SimTime,
    is_waiting: bool,
    /// When the search for each target may start.
    alarms: BTreeMap<TargetId, SimTime>,
    team: Team,
    driver: Driver,
    idle: Idle,
    prober: Prober,
    outbox: Outbox,
    record: RobotSearchRecord,
}

/// How it works out where to drive.
#[derive(Debug)]
enum Pilot {
    Detarsk { method: Detarsk, trackers: BTreeMap<TargetId, Tracker> },
    PseudoGradient(GradientPilot),
}

/// Where a robot drives next.
#[derive(Clone, Copy, Debug)]
struct Plan {
    target: TargetId,
    predicted: Position,
    goal: Position,
    latest: SimTime,
}

impl SearchRobot {
    /// A robot with this body in a team of `team` robots that search `targets` targets for `duration` at most.
    #[must_use]
    pub fn new(
        settings: Arc<TargetSearch>,
        map: Arc<NavigationMap>,
        network: NetworkId,
        body: &RobotBody,
        team: usize,
        targets: usize,
        duration: Duration,
    ) -> Self {
        let pilot = match &settings.method {
            Method::Detarsk(method) => Pilot::Detarsk { method: method.clone(), trackers: BTreeMap::new() },
            Method::PseudoGradient(method) => Pilot::PseudoGradient(GradientPilot::new(method.clone())),
        };
        let place = PlaceOnMap::new(map.frame());
        let step_m = body.speed_m_per_s * settings.step.as_secs_f64();
        let driver = Driver::new(settings.path, settings.motion, body.radius_m, step_m);
        let idle = Idle::new(settings.before, 0, team);
        Self {
            settings,
            map,
            network,
            speed_m_per_s: body.speed_m_per_s,
            targets,
            duration,
            place,
            neighbourhood: Neighbourhood::default(),
            asking: Asking::default(),
            asked_at: None,
            pilot,
            stepped: SimTime::ZERO,
            is_waiting: false,
            alarms: BTreeMap::new(),
            team: Team::new(team),
            driver,
            idle,
            prober: Prober::default(),
            outbox: Outbox::new(network),
            record: RobotSearchRecord::default(),
        }
    }

    /// The same with this number in its team: robots share the map before a target is detected.
    #[must_use]
    pub(super) fn with_number(self, number: usize) -> Self {
        let idle = Idle::new(self.settings.before, number, self.team.size());
        Self { idle, ..self }
    }

    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> RobotSearchRecord {
        let fallbacks = match &self.pilot {
            Pilot::Detarsk { trackers, .. } => trackers.values().map(Tracker::fallbacks).sum(),
            Pilot::PseudoGradient(_) => 0,
        };
        let blocked = self.driver.blocked();
        RobotSearchRecord { sent: self.outbox.counts, fallbacks, blocked, ..self.record }
    }

    /// Length on the map of one metre.
    fn scale(&self) -> f64 {
        self.place.scale().unwrap_or(1.0)
    }

    /// Asks the nodes around.
    fn ask(&mut self, port: &mut Port<'_>) {
        let radius_m = match &self.settings.method {
            Method::Detarsk(method) => method.neighbourhood_m,
            Method::PseudoGradient(_) => None,
        };
        let radius_m = radius_m.unwrap_or(self.scale() * (NEIGHBOURHOOD_STEPS * self.driver.step_m()));
        let pose = port.pose();
        self.asked_at = Some(pose);
        // In whole steps it knows where it decides next, and asks the nodes around there.
        let there = self.driver.bound_for().filter(|_| self.is_discrete()).unwrap_or(pose.position);
        let place = self.place.to_map(there);
        let asked = self.asking.whom(self.map.frame(), place, radius_m, &self.neighbourhood);
        self.neighbourhood = Neighbourhood::default();
        let window = self.settings.step.mul_f64(WINDOW_SHARE);
        let request = Request { number: self.asking.next_poll(), window, asked };
        self.outbox.broadcast(&Message::Request(request), port);
    }

    /// The poll is over: works out where the robot is on the map.
    fn locate(&mut self, port: &mut Port<'_>) -> Option<Position> {
        let pose = port.pose();
        let centroid = self.neighbourhood.centroid();
        let is_reliable = self.neighbourhood.nodes().len() >= RELIABLE;
        if let (Some(asked), true, Some(fix)) = (self.asked_at, is_reliable, self.neighbourhood.lateration()) {
            // The answers came while it drove on: in the mean, halfway.
            self.place.fix((asked.position + pose.position) * 0.5, fix);
        }
        let fused = self.place.to_map(pose.position);
        let place = match self.settings.own_place {
            OwnPlaceRule::Fused => fused,
            OwnPlaceRule::ReceivedPower => centroid.or(fused),
        }?;
        port.tell(Estimate::OwnPlace(place));
        Some(place)
    }

    /// What it is going to do.
    fn plan(&mut self, place: Position, port: &mut Port<'_>) -> Option<Plan> {
        let now = port.now();
        let scale = self.scale();
        let settings = Arc::clone(&self.settings);
        let is_open = |target: &TargetId, alarms: &BTreeMap<TargetId, SimTime>, team: &Team| {
            alarms.get(target).is_some_and(|start| *start <= now) && !team.captured().contains(target)
        };
        match &mut self.pilot {
            Pilot::Detarsk { method, trackers } => {
                let pursuit = Pursuit {
                    start: place,
                    speed_m_per_s: scale * self.speed_m_per_s,
                    reach_m: scale * settings.capture_m,
                    horizon: HORIZON,
                    scan: SCAN,
                };
                let mut plans = BTreeMap::new();
                let mut times_s = BTreeMap::new();
                for (&target, tracker) in trackers.iter_mut() {
                    if method.doubt.is_some() && !self.team.captured().contains(&target) {
                        tracker.update(scale);
                        if let Some(since) = tracker.since() {
                            self.alarms.entry(target).or_insert(since + settings.start_delay);
                        }
                    }
                    if !is_open(&target, &self.alarms, &self.team) {
                        continue;
                    }
                    if method.doubt.is_none() {
                        tracker.update(scale);
                    }
                    let predicted = tracker.predict(now);
                    port.tell(Estimate::TargetPlace { target, place: predicted });
                    let meeting = pursuit.earliest(|after| tracker.predict(now + after));
                    let goal = match (method.aim, meeting) {
                        (Aim::Interception, Some(meeting)) => meeting.place,
                        _ => predicted,
                    };
                    let turns_back = method.without_news == WithoutNews::Back && !tracker.has_news();
                    let newest = turns_back.then(|| tracker.newest_place());
                    let is_away = |newest: &Position| place.distance_m(*newest) > scale * self.driver.step_m();
                    let goal = newest.filter(is_away).unwrap_or(goal);
                    times_s.insert(target, meeting.map_or(HORIZON, |meeting| meeting.after).as_secs_f64());
                    plans.insert(target, Plan { target, predicted, goal, latest: tracker.latest() });
                }
                self.team.tell(&times_s, &mut self.outbox, port);
                let target = self.team.choose(port.station(), &times_s, now)?;
                plans.get(&target).copied()
            }
            Pilot::PseudoGradient(pilot) => {
                let open = pilot.targets().filter(|target| is_open(target, &self.alarms, &self.team));
                let nearest = open.filter_map(|target| {
                    let node = pilot.choose(target)?;
                    Some((target, node, pilot.value(target, node)?))
                });
                let (target, node, _) = nearest.min_by(|a, b| a.2.total_cmp(&b.2))?;
                let goal = self.map.place(port.node(node)?)?;
                port.tell(Estimate::TargetPlace { target, place: goal });
                Some(Plan { target, predicted: goal, goal, latest: now })
            }
        }
    }

    /// A step: works out where it is and where the target is, and drives there.
    fn step(&mut self, port: &mut Port<'_>) {
        let place = self.locate(port);
        if let Some(place) = place.filter(|_| self.map.frame() == MapFrame::Robot || !self.is_lost()) {
            if let Some(plan) = self.plan(place, port) {
                let Plan { target, predicted, goal, latest } = plan;
                let time = port.now();
                self.record.started.get_or_insert(time);
                self.record.steps.push(SearchStep { time, place, target, predicted, goal, latest });
                self.set_out(place, goal, port);
            } else if let Some(nearest) = self.nearest(place).filter(|&nearest| self.is_outside(place, nearest)) {
                // It is outside the network, where no station can reach it.
                self.set_out(place, nearest, port);
            } else if let Some(goal) = self.idle_goal(place) {
                self.set_out(place, goal, port);
            }
        } else {
            let answers = self.neighbourhood.nodes().len();
            let next = self.prober.next(answers, RELIABLE, self.driver.step_m(), port);
            self.driver.go_straight(next, port);
        }
        self.ask(port);
    }

    /// Where it drives while there is nothing to search.
    fn idle_goal(&mut self, place: Position) -> Option<Position> {
        let near_m = self.scale() * self.settings.capture_m;
        self.idle.goal(place, near_m, self.map.places().iter().copied().flatten())
    }

    /// The place of the nearest node on the map.
    fn nearest(&self, place: Position) -> Option<Position> {
        let places = self.map.places().iter().copied().flatten();
        places.min_by(|a, b| a.distance_m(place).total_cmp(&b.distance_m(place)))
    }

    /// Whether it has to drive to the network: a robot that drives before a detection knows its way where nodes are few.
    /// In whole steps it goes no nearer to a node that is not half a step away.
    fn is_outside(&self, place: Position, nearest: Position) -> bool {
        let network = self.map.bounds().grown(self.scale() * self.settings.capture_m);
        let stays = self.is_discrete() && place.distance_m(nearest) <= 0.5 * self.scale() * self.driver.step_m();
        self.is_lost() && !stays && !(self.idle.drives() && network.contains(place))
    }

    /// Whether too few nodes answered to tell where it is.
    fn is_lost(&self) -> bool {
        self.neighbourhood.nodes().len() < RELIABLE
    }

    /// Drives from `place` to `goal`, both on the map.
    fn set_out(&mut self, place: Position, goal: Position, port: &mut Port<'_>) {
        let (Some(from), Some(to)) = (self.place.to_odometry(place), self.place.to_odometry(goal)) else { return };
        // What counts is the way from where it is on the map: its odometry may believe in another place.
        let here = port.pose().position;
        let to = Position { z_m: here.z_m, ..here + (to - from) };
        let Bounds { min, max } = self.map.bounds();
        let corners = [(min.x_m, min.y_m), (min.x_m, max.y_m), (max.x_m, min.y_m), (max.x_m, max.y_m)];
        let corners = corners.map(|(x_m, y_m)| self.place.to_odometry(Position::new(x_m, y_m, min.z_m)));
        let Some(nodes) = Bounds::of(corners.into_iter().flatten()) else { return };
        self.driver.set_out(to, nodes, port);
    }

    /// Whether it captures targets only at the ends of steps.
    fn is_discrete(&self) -> bool {
        self.settings.motion == SearchMotion::Discrete
    }

    /// A step is over. A robot that is guided round by round stands until it has heard the round of this step.
    fn end_step(&mut self, port: &mut Port<'_>) {
        let now = port.now();
        if !self.is_waiting {
            self.stepped = now;
            if self.is_discrete() && self.reach(port) {
                return;
            }
        }
        let waits = |pilot: &Pilot, stepped| match pilot {
            Pilot::PseudoGradient(pilot) => pilot.waits(stepped, now),
            Pilot::Detarsk { .. } => false,
        };
        self.is_waiting = self.record.started.is_some() && waits(&self.pilot, self.stepped);
        if self.is_waiting {
            self.driver.stand(port);
            port.after(WAIT_INTERVAL, STEP);
        } else {
            self.step(port);
            port.after(self.settings.step, STEP);
        }
    }

    /// The time until it looks again whether a target is within reach.
    fn until_next_look(&self) -> Duration {
        let driven_m = self.speed_m_per_s * REACH_INTERVAL.as_secs_f64();
        let most_m = REACH_SHARE * self.settings.capture_m;
        if driven_m > most_m { REACH_INTERVAL.mul_f64(most_m / driven_m) } else { REACH_INTERVAL }
    }

    /// Captures the targets within reach: a robot that waits, not before its search has started. Returns whether all are captured: then the search is over.
    fn reach(&mut self, port: &mut Port<'_>) -> bool {
        if self.record.started.is_some() || self.idle.drives() {
            for target in port.capture(self.settings.capture_m) {
                self.record.captured.push((target, port.now()));
                self.team.capture(target);
                self.team.tell(&BTreeMap::new(), &mut self.outbox, port);
            }
        }
        let is_over = self.team.captured().len() >= self.targets;
        if is_over {
            port.halt();
            port.finish();
        }
        is_over
    }

    fn alarm(&mut self, target: TargetId, first: (SimTime, Position), nodes: Option<u8>, port: &Port<'_>) {
        let start = first.0 + self.settings.start_delay;
        self.record.alarmed.get_or_insert(port.now());
        self.alarms.entry(target).or_insert(start);
        if let Pilot::Detarsk { method, trackers } = &mut self.pilot {
            let (sample, bounds) = (method.sample, self.map.bounds());
            let seed = port.seed();
            let tracker =
                (trackers.entry(target)).or_insert_with(|| Tracker::new(method, target, seed, sample, first, bounds));
            if let Some(nodes) = nodes {
                tracker.learn_told(first.0, first.1, nodes);
            }
        }
    }

    fn learn(&mut self, node: StationId, place: Position, detections: &[Detection], port: &Port<'_>) {
        let Pilot::Detarsk { method, trackers } = &mut self.pilot else { return };
        let (Some(node), now) = (port.node(node), port.now()) else { return };
        let mut by_target: BTreeMap<TargetId, Vec<Sighting>> = BTreeMap::new();
        for &Detection { target, entered, left } in detections {
            by_target.entry(target).or_default().push(Sighting { entered, left });
        }
        for (target, sightings) in by_target {
            let (sample, bounds) = (method.sample, self.map.bounds());
            let first = sightings.iter().map(|sighting| sighting.entered).min().unwrap_or(now);
            if method.doubt.is_none() {
                self.alarms.entry(target).or_insert(first + self.settings.start_delay);
            }
            let tracker = (trackers.entry(target))
                .or_insert_with(|| Tracker::new(method, target, port.seed(), sample, (first, place), bounds));
            tracker.learn(node, place, &sightings, now);
        }
    }
}

impl Application for SearchRobot {
    fn hears(&self) -> bool {
        true
    }

    fn has_task(&self) -> bool {
        true
    }

    fn started(&mut self, port: &mut Port<'_>) {
        port.listen(self.network, self.duration);
        // Robots do not ask all at once.
        port.after(self.settings.step.mul_f64(PHASE_SHARE * port.uniform(0)), STEP);
        if !self.is_discrete() {
            port.after(self.until_next_look(), REACH);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if timer == REACH {
            if !self.reach(port) {
                port.after(self.until_next_look(), REACH);
            }
        } else {
            self.end_step(port);
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        let now = port.now();
        match Message::read(delivery.payload) {
            Ok(Message::Answer(answer, detections)) => {
                self.record.answers += 1;
                let gain = delivery.rssi - answer.tx_power;
                self.neighbourhood
                    .hear(delivery.from, HeardNode { place: answer.place, gain, rssi: delivery.rssi, time: now });
                self.learn(delivery.from, answer.place, &detections, port);
            }
            Ok(Message::Alarm { target, time, place, nodes, .. }) => self.alarm(target, (time, place), nodes, port),
            Ok(Message::Claim { key, targets }) if key.origin != port.station() => {
                self.team.hear(key.origin, &targets, now);
            }
            Ok(Message::Gradient(gradient)) => {
                if let Pilot::PseudoGradient(pilot) = &mut self.pilot {
                    pilot.hear(delivery.from, &gradient, delivery.rssi, now);
                }
            }
            _ => {}
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        self.driver.ended(end, port);
    }
}
