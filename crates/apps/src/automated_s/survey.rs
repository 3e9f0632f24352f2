//! The automated S path.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{Command, Controller, Ending, Outcome, Situation};

use super::knowledge::Knowledge;
use super::settings::{AfterLanes, AutomatedSConfig, Settings, Until};

/// Hearing stops that a lane needs before silence ends it early: one lost packet at its start does not.
const HEARING_STOPS: u32 = 3;
/// Changes of task between two commands, at most: more would be a bug, and end the survey.
const MAX_CHANGES: u32 = 64;
/// New ways looked for on one trip, at most.
const MAX_REPLANS: u32 = 32;
/// How often the robot comes back for one node, in packets wanted.
const RETURNS_PER_PACKET: u32 = 2;
/// Lanes in a row that hear nobody, and end a sweep; one that covers all of the lane before it is enough.
const EMPTY_LANES: u32 = 2;
/// The same for a sweep that begins out of reach of the network.
const EMPTY_LANES_OUTSIDE: u32 = 8;
/// Share of the lane spacing within which a stop covers a place.
const COVERED: f64 = 0.75;
/// The same on a closer look.
const CLOSELY_COVERED: f64 = 0.375;

/// A survey in lanes along y that works without a map (thesis, appendix C.1.2).
///
/// The robot drives a step, listens, and drives on, until an obstacle is in its way or it hears nobody. Then it moves
/// over to the next lane and comes back on that. Where an obstacle cut a lane short, it fills in the part behind it as
/// soon as a later lane has passed the obstacle. If nodes are missing when a lane has heard nobody, it goes on at the
/// other side of its start; then it visits what it passed by.
///
/// Where the pseudo code of the thesis cannot work, this departs from it: the loop runs *until* all packets are
/// received; each obstacle is registered by itself, for both headings, and forgotten once it is covered; the step
/// between lanes has a length of its own; parts of lanes that were driven before are not driven again; the number of
/// steps is capped.
#[derive(Clone, Debug)]
pub struct AutomatedS {
    settings: Settings,
    knowledge: Knowledge,
    task: Task,
    lane: Lane,
    /// Direction of the lanes' order along x: 1 east, -1 west.
    sweep: f64,
    /// Sweeps finished.
    sweeps: u32,
    /// First stop of this sweep.
    sweep_began: usize,
    /// Lanes in a row that heard nobody.
    empty_lanes: u32,
    /// Lanes in a row that heard nobody after which a sweep is over.
    empty_lanes_to_end: u32,
    /// Where obstacles cut lanes short.
    cuts: Vec<Cut>,
    /// An obstacle was met, and a stop was made first.
    is_blocked: bool,
    start: Position,
    steps: u32,
}

/// What the robot is doing.
#[derive(Clone, Debug, PartialEq)]
enum Task {
    /// Nobody was heard yet: a square spiral. Its side, and where that began.
    Search { side: u32, from: Position },
    /// Along y.
    Lane,
    /// Over to the next lane; where it left the last.
    Shift { from: Position },
    /// Back along a lane from which there was no way over, in search of one.
    Retreat,
    /// To the lane at `x_m` that an obstacle cut short.
    Behind { x_m: f64, from: Position },
    /// Elsewhere.
    Travel(Trip),
    /// Over.
    Finish(Ending),
}

/// A trip past known obstacles.
#[derive(Clone, Debug, PartialEq)]
struct Trip {
    goal: Position,
    /// The way that is left, the next place last.
    way: Vec<Position>,
    replans: u32,
    then: Goal,
}

/// Why the robot travels.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Goal {
    /// To sweep the other side of the start.
    OtherSide,
    /// To listen at a place passed by, or again.
    Check,
}

/// The lane that is being driven.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lane {
    /// 1 north, -1 south.
    heading: f64,
    start_y_m: f64,
    first_stop: usize,
    hearing_stops: u32,
    silent_run: u32,
    /// Least and greatest y of its stops that heard somebody [m].
    audible_m: Option<(f64, f64)>,
    /// The same of the lane before.
    audible_before_m: Option<(f64, f64)>,
}

/// Where an obstacle cut a lane short (`obstacleRegistry` of the thesis).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cut {
    heading: f64,
    place: Position,
}

/// How the last move went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Move {
    Free,
    Blocked,
}

impl TryFrom<&AutomatedSConfig> for AutomatedS {
    type Error = SettingError;

    fn try_from(config: &AutomatedSConfig) -> Result<Self, SettingError> {
        Ok(Self {
            settings: Settings::try_from(config)?,
            knowledge: Knowledge::default(),
            task: Task::Search { side: 0, from: Position::ORIGIN },
            lane: Lane { heading: 1.0, start_y_m: 0.0, first_stop: 0, hearing_stops: 0, silent_run: 0, audible_m: None, audible_before_m: None },
            sweep: 1.0,
            sweeps: 0,
            sweep_began: 0,
            empty_lanes: 0,
            empty_lanes_to_end: EMPTY_LANES,
            cuts: Vec::new(),
            is_blocked: false,
            start: Position::ORIGIN,
            steps: 0,
        })
    }
}

impl Controller for AutomatedS {
    fn decide(&mut self, situation: &Situation<'_>) -> Command {
        let here = situation.position;
        let Settings { step_m, lane_spacing_m, silent_below_nodes, .. } = self.settings;
        let last_move = match situation.outcome {
            Outcome::Started => {
                self.start = here;
                self.task = Task::Search { side: 0, from: here };
                return Command::Listen;
            }
            Outcome::Arrived if self.passes_by(here) => Move::Free,
            Outcome::Arrived => return Command::Listen,
            Outcome::Blocked(contact) => {
                self.knowledge.note_contact(situation, contact, 2.0 * lane_spacing_m);
                let is_new = !self.knowledge.was_near(here, 0.5 * step_m, 0..self.knowledge.stops());
                if is_new && !matches!(self.task, Task::Travel(_)) {
                    self.is_blocked = true;
                    return Command::Listen;
                }
                Move::Blocked
            }
            Outcome::Listened(heard) => {
                self.knowledge.note_stop(situation, heard, lane_spacing_m, silent_below_nodes);
                if self.task == Task::Lane {
                    self.count_stop(here);
                }
                if self.is_complete() {
                    return Command::Finish(Ending::Complete);
                }
                if std::mem::take(&mut self.is_blocked) { Move::Blocked } else { Move::Free }
            }
        };
        if self.steps >= self.settings.max_steps {
            return Command::Finish(Ending::StepsExhausted);
        }
        self.steps += 1;
        self.proceed(situation, last_move)
    }
}

impl AutomatedS {
    /// Whether the robot need not listen here: on its way somewhere, or back where it has been.
    fn passes_by(&self, here: Position) -> bool {
        match &self.task {
            Task::Travel(trip) => !trip.way.is_empty(),
            Task::Retreat => self.knowledge.was_near(here, 0.5 * self.settings.step_m, 0..self.knowledge.stops()),
            _ => false,
        }
    }

    /// The next command: tasks follow one another until one gives it.
    fn proceed(&mut self, situation: &Situation<'_>, last_move: Move) -> Command {
        let here = situation.position;
        let mut last_move = last_move;
        for _ in 0..MAX_CHANGES {
            let command = match self.task.clone() {
                Task::Search { side, from } => self.search(here, side, from, last_move),
                Task::Lane => self.drive_lane(situation, last_move),
                Task::Shift { from } => self.shift(here, from, last_move),
                Task::Retreat => self.retreat(situation, last_move),
                Task::Behind { x_m, from } => self.go_behind(here, x_m, from, last_move),
                Task::Travel(trip) => self.travel(situation, trip, last_move),
                Task::Finish(ending) => Some(Command::Finish(ending)),
            };
            if let Some(command) = command {
                return command;
            }
            last_move = Move::Free;
        }
        Command::Finish(Ending::Stuck)
    }

    fn drive(here: Position, east_m: f64, north_m: f64) -> Option<Command> {
        Some(Command::Drive(here + Position::new(east_m, north_m, 0.0)))
    }

    /// The length of the next step of `left_m`: no step is a sliver.
    fn stride(&self, left_m: f64) -> f64 {
        if left_m < 1.5 * self.settings.step_m { left_m } else { self.settings.step_m }
    }

    /// Drives a square spiral, a lane's distance between its turns, until somebody is heard.
    fn search(&mut self, here: Position, side: u32, from: Position, last_move: Move) -> Option<Command> {
        if self.knowledge.hears_somebody() {
            self.begin_lane(here);
            return None;
        }
        let side_m = f64::from(side / 2 + 1) * self.settings.lane_spacing_m;
        let left_m = side_m - here.distance_m(from);
        if last_move == Move::Blocked || left_m <= 0.01 * self.settings.step_m {
            self.task = Task::Search { side: side + 1, from: here };
            return None;
        }
        let stride_m = self.stride(left_m);
        let (east, north) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][(side % 4) as usize];
        Self::drive(here, east * stride_m, north * stride_m)
    }

    fn begin_lane(&mut self, here: Position) {
        self.task = Task::Lane;
        let is_known = self.lane.hearing_stops >= HEARING_STOPS;
        self.lane = Lane {
            heading: self.lane.heading,
            start_y_m: here.y_m,
            first_stop: self.knowledge.stops().saturating_sub(1),
            hearing_stops: 0,
            silent_run: 0,
            audible_m: None,
            audible_before_m: if is_known { self.lane.audible_m } else { self.lane.audible_before_m },
        };
        self.count_stop(here);
    }

    /// Counts the stop just made towards the lane.
    fn count_stop(&mut self, here: Position) {
        if self.knowledge.hears_somebody() {
            let (south, north) = self.lane.audible_m.unwrap_or((here.y_m, here.y_m));
            self.lane.audible_m = Some((south.min(here.y_m), north.max(here.y_m)));
            self.lane.hearing_stops += 1;
            self.lane.silent_run = 0;
        } else {
            self.lane.silent_run += 1;
        }
    }

    fn drive_lane(&mut self, situation: &Situation<'_>, last_move: Move) -> Option<Command> {
        let here = situation.position;
        let heading = self.lane.heading;
        if last_move == Move::Blocked {
            self.cuts.push(Cut { heading, place: here });
            self.end_lane(situation);
            return None;
        }
        if let Some(x_m) = self.uncovered_behind(situation) {
            self.task = Task::Behind { x_m, from: here };
            return None;
        }
        let is_silent = self.lane.silent_run >= self.settings.silent_stops_to_turn;
        let is_beyond = self.left_of_network_m(here.y_m, heading) <= 0.0;
        if is_silent && (self.lane.hearing_stops >= HEARING_STOPS || is_beyond) || self.was_driven(here) {
            self.end_lane(situation);
            return None;
        }
        Self::drive(here, 0.0, heading * self.settings.step_m)
    }

    /// How far this lane, or the one before, heard somebody beyond `y_m` towards `heading` [m].
    fn left_of_network_m(&self, y_m: f64, heading: f64) -> f64 {
        let audible = [self.lane.audible_m, self.lane.audible_before_m];
        let left_m = audible.into_iter().flatten().map(|(south, north)| if heading > 0.0 { north - y_m } else { y_m - south });
        left_m.reduce(f64::max).unwrap_or(0.0)
    }

    /// Whether all that is ahead on the lane was driven before on this sweep.
    fn was_driven(&self, here: Position) -> bool {
        let Settings { step_m, .. } = self.settings;
        let earlier = self.sweep_began..self.lane.first_stop.max(self.sweep_began);
        let mut ahead_m = step_m;
        let last_m = self.left_of_network_m(here.y_m, self.lane.heading).max(2.0 * step_m);
        while ahead_m <= last_m {
            let place = here + Position::new(0.0, self.lane.heading * ahead_m, 0.0);
            if !self.knowledge.was_near(place, 0.5 * step_m, earlier.clone()) {
                return false;
            }
            ahead_m += step_m;
        }
        true
    }

    /// Turns: over to the next lane, or, beyond the network, to what is left to do.
    fn end_lane(&mut self, situation: &Situation<'_>) {
        let was_empty = self.lane.hearing_stops == 0;
        if was_empty {
            self.empty_lanes += 1;
        } else {
            (self.empty_lanes, self.empty_lanes_to_end) = (0, EMPTY_LANES);
        }
        let missed_m = self.left_of_network_m(self.lane.start_y_m, -self.lane.heading);
        let was_whole = missed_m <= self.settings.lane_spacing_m && self.empty_lanes_to_end == EMPTY_LANES;
        if was_empty && (was_whole || self.empty_lanes >= self.empty_lanes_to_end) {
            self.end_sweep(situation);
        } else {
            self.task = Task::Shift { from: situation.position };
        }
    }

    fn shift(&mut self, here: Position, from: Position, last_move: Move) -> Option<Command> {
        let done_m = (here.x_m - from.x_m).abs();
        let left_m = self.settings.lane_spacing_m - done_m;
        let is_done = left_m <= 0.01 * self.settings.step_m;
        if is_done || (last_move == Move::Blocked && done_m >= 0.99 * self.settings.step_m) {
            self.lane.heading = -self.lane.heading;
            self.begin_lane(here);
            return None;
        }
        if last_move == Move::Blocked {
            self.task = Task::Retreat;
            return None;
        }
        Self::drive(here, self.sweep * self.stride(left_m), 0.0)
    }

    /// Back along the lane to where there is a way over; at its end the sweep is at its end.
    fn retreat(&mut self, situation: &Situation<'_>, last_move: Move) -> Option<Command> {
        let here = situation.position;
        let lane_m = self.settings.lane_spacing_m;
        if situation.clearance_m(Position::new(self.sweep, 0.0, 0.0), lane_m) >= lane_m {
            self.task = Task::Shift { from: here };
            return None;
        }
        if last_move == Move::Blocked || self.left_of_network_m(here.y_m, -self.lane.heading) < -self.settings.step_m {
            self.end_sweep(situation);
            return None;
        }
        Self::drive(here, 0.0, -self.lane.heading * self.settings.step_m)
    }

    /// The lane behind an obstacle, if this lane has just passed the obstacle and can see that lane
    /// (`coverObstacles` of the thesis).
    fn uncovered_behind(&self, situation: &Situation<'_>) -> Option<f64> {
        let here = situation.position;
        let lane_m = self.settings.lane_spacing_m;
        let is_behind = |cut: &&Cut| {
            let back_m = self.sweep * (here.x_m - cut.place.x_m);
            let beyond_m = self.lane.heading * (here.y_m - cut.place.y_m);
            cut.heading * self.lane.heading > 0.0
                && beyond_m > 0.0
                && back_m >= self.settings.step_m
                && back_m <= 4.0 * lane_m
                && !self.knowledge.was_near(
                    Position { y_m: here.y_m, ..cut.place },
                    COVERED * lane_m,
                    0..self.knowledge.stops(),
                )
                && situation.clearance_m(Position::new(-self.sweep, 0.0, 0.0), back_m) >= back_m
        };
        Some(self.cuts.iter().find(is_behind)?.place.x_m)
    }

    fn go_behind(&mut self, here: Position, x_m: f64, from: Position, last_move: Move) -> Option<Command> {
        let left_m = (here.x_m - x_m).abs();
        let is_there = left_m <= 0.01 * self.settings.step_m;
        if is_there || last_move == Move::Blocked {
            if is_there || here.distance_m(from) < self.settings.step_m {
                self.cuts.retain(|cut| (cut.place.x_m - x_m).abs() > 1e-6 || cut.heading * self.lane.heading < 0.0);
            }
            self.begin_lane(here);
            return None;
        }
        Self::drive(here, -self.sweep * self.stride(left_m), 0.0)
    }

    /// Whether all is done: packets, and the sweep if it is wanted to its end.
    fn is_complete(&self) -> bool {
        let is_swept = self.settings.until == Until::Heard || self.sweeps > 0;
        is_swept && self.knowledge.heard_all(self.settings.packets_per_node)
    }

    /// A sweep is over: what is left to do.
    fn end_sweep(&mut self, situation: &Situation<'_>) {
        self.sweeps += 1;
        self.empty_lanes = 0;
        self.cuts.clear();
        let is_first = self.sweeps == 1;
        if self.is_complete() {
            self.task = Task::Finish(Ending::Complete);
        } else if self.settings.after_lanes == AfterLanes::Check && !(is_first && self.misses_nodes()) {
            self.check(situation);
        } else if !(is_first && self.set_out(situation, self.start, Goal::OtherSide)) {
            self.begin_sweep(situation.position);
        }
    }

    /// Sweeps the other way from here. A sweep over lanes that were driven before runs between them.
    fn begin_sweep(&mut self, here: Position) {
        self.sweep = -self.sweep;
        self.sweep_began = self.knowledge.stops();
        let is_outside = self.sweeps > 1;
        self.empty_lanes_to_end = if is_outside { EMPTY_LANES_OUTSIDE } else { EMPTY_LANES };
        let ahead_m = if is_outside { 0.5 * self.settings.lane_spacing_m } else { 0.0 };
        self.task = Task::Shift { from: here - Position::new(self.sweep * ahead_m, 0.0, 0.0) };
    }

    /// Goes where packets of missing nodes may be had: places passed by if some were never heard, then those where
    /// they were heard best.
    fn check(&mut self, situation: &Situation<'_>) {
        let here = situation.position;
        let Settings { packets_per_node, lane_spacing_m, .. } = self.settings;
        while self.misses_nodes()
            && let Some(goal) = [COVERED, CLOSELY_COVERED]
                .into_iter()
                .find_map(|share| self.knowledge.nearest_opening(here, share * lane_spacing_m))
        {
            if self.set_out(situation, goal, Goal::Check) {
                return;
            }
            eprintln!("DBG no way from {here:?} to {goal:?}");
            self.knowledge.give_up_opening(goal);
        }
        while let Some(goal) = self.knowledge.place_to_listen_again(here, packets_per_node, self.returns()) {
            if self.set_out(situation, goal, Goal::Check) {
                return;
            }
        }
        self.task = Task::Finish(Ending::Stuck);
    }

    /// How often the robot comes back for one node.
    fn returns(&self) -> u32 {
        self.settings.packets_per_node.saturating_mul(RETURNS_PER_PACKET)
    }

    /// Whether there are nodes that no place known is good for.
    fn misses_nodes(&self) -> bool {
        self.knowledge.misses_nodes(self.settings.packets_per_node, self.returns())
    }

    /// Sets out for `goal`; `false` and no change if no way is known.
    fn set_out(&mut self, situation: &Situation<'_>, goal: Position, then: Goal) -> bool {
        let Some(way) = self.way(situation, goal) else { return false };
        eprintln!("DBG {:?} to {goal:?} way {way:?}", situation.position);
        self.task = Task::Travel(Trip { goal, way, replans: 0, then });
        true
    }

    /// A way to `goal`, the next place last.
    fn way(&self, situation: &Situation<'_>, goal: Position) -> Option<Vec<Position>> {
        let Settings { step_m, lane_spacing_m, .. } = self.settings;
        let mut way = self.knowledge.way(situation, goal, 0.5 * step_m, 2.0 * lane_spacing_m)?;
        way.reverse();
        Some(way)
    }

    fn travel(&mut self, situation: &Situation<'_>, mut trip: Trip, last_move: Move) -> Option<Command> {
        if last_move == Move::Blocked {
            trip.replans += 1;
            let way = if trip.replans > MAX_REPLANS { None } else { self.way(situation, trip.goal) };
            eprintln!("DBG replan {:?} {way:?}", situation.position);
            trip.way = way.unwrap_or_default();
        }
        if let Some(place) = trip.way.pop() {
            self.task = Task::Travel(trip);
            return Some(Command::Drive(place));
        }
        match trip.then {
            Goal::OtherSide => self.begin_sweep(situation.position),
            Goal::Check => {
                self.knowledge.give_up_opening(trip.goal);
                self.check(situation);
            }
        }
        None
    }
}
