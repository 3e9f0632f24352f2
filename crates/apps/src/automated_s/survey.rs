//! The automated S path.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{Command, Controller, Ending, Outcome, Situation};

use super::knowledge::Knowledge;
use super::lane::{Cut, HEARING_STOPS, Lane};
use super::settings::{AfterLanes, AutomatedSConfig, Settings, Until};
use super::trip::{Goal, Trip};

/// Changes of task between two commands, at most: more would be a bug, and end the survey.
const MAX_CHANGES: u32 = 64;
/// Lanes in a row that hear nobody, and end a sweep; one that covers all of the lane before it is enough.
const EMPTY_LANES: u32 = 2;
/// The same for a sweep that begins out of reach of the network.
const EMPTY_LANES_OUTSIDE: u32 = 8;
/// Share of the lane spacing by which a further sweep runs beside the one before: the golden section, so that all
/// lanes of many sweeps lie apart.
const AGAIN: f64 = 0.381_966;
/// Share of the lane spacing within which a stop covers a place.
pub(super) const COVERED: f64 = 0.75;

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
    pub(super) settings: Settings,
    pub(super) knowledge: Knowledge,
    pub(super) task: Task,
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
    /// Where the first lane began.
    pub(super) start: Position,
    steps: u32,
}

/// What the robot is doing.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Task {
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

/// How the last move went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
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
            lane: Lane::FIRST,
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
            self.start = here;
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
        self.lane = self.lane.next(here, self.knowledge.stops().saturating_sub(1));
        self.count_stop(here);
    }

    /// Counts the stop just made towards the lane.
    fn count_stop(&mut self, here: Position) {
        if self.knowledge.hears_somebody() {
            self.lane.count_hearing(here);
        } else {
            self.lane.count_silent();
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
        let is_beyond = self.lane.left_of_network_m(here.y_m, heading) <= 0.0;
        if is_silent && (self.lane.hearing_stops >= HEARING_STOPS || is_beyond) || self.was_driven(here) {
            self.end_lane(situation);
            return None;
        }
        Self::drive(here, 0.0, heading * self.settings.step_m)
    }

    /// Whether all that is ahead on the lane was driven before on this sweep.
    fn was_driven(&self, here: Position) -> bool {
        let Settings { step_m, .. } = self.settings;
        let earlier = self.sweep_began..self.lane.first_stop.max(self.sweep_began);
        let mut ahead_m = step_m;
        let last_m = self.lane.left_of_network_m(here.y_m, self.lane.heading).max(2.0 * step_m);
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
        let missed_m = self.lane.left_of_network_m(self.lane.start_y_m, -self.lane.heading);
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
        if last_move == Move::Blocked
            || self.lane.left_of_network_m(here.y_m, -self.lane.heading) < -self.settings.step_m
        {
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
                    self.sweep_began..self.knowledge.stops(),
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
    pub(super) fn begin_sweep(&mut self, here: Position) {
        self.sweep = -self.sweep;
        self.sweep_began = self.knowledge.stops();
        let is_outside = self.sweeps > 1;
        self.empty_lanes_to_end = if is_outside { EMPTY_LANES_OUTSIDE } else { EMPTY_LANES };
        let aside = if self.sweep < 0.0 { AGAIN } else { 1.0 - AGAIN };
        let ahead_m = if is_outside { aside * self.settings.lane_spacing_m } else { 0.0 };
        self.task = Task::Shift { from: here - Position::new(self.sweep * ahead_m, 0.0, 0.0) };
    }
}
