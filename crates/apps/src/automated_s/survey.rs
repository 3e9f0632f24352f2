//! The automated S path.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{CommandOutcome, Controller, Ending, RobotCommand, Situation};

use super::knowledge::Knowledge;
use super::lane::{Cut, HEARING_STOPS, Lane};
use super::layers::Layer;
use super::settings::{AutomatedSConfig, Settings};
use super::trip::Trip;
use crate::Surroundings;
use crate::area::Area;

/// Changes of task between two commands, at most: more would be a bug, and end the survey.
const MAX_CHANGES: u32 = 64;
/// Lanes in a row that hear nobody, and end a sweep; one that covers all of the lane before it is enough.
pub(super) const EMPTY_LANES: u32 = 2;
/// Share of the lane spacing within which a stop covers a place.
pub(super) const COVERED: f64 = 0.75;

/// A survey in lanes along y that works without a map (thesis, appendix C.1.2).
///
/// The robot drives a step, listens, and drives on, until an obstacle is in its way or it hears nobody. Then it moves
/// over to the next lane and comes back on that. Where an obstacle cut a lane short, it fills in the part behind it as
/// soon as a later lane has passed the obstacle. If nodes are missing when a lane has heard nobody, it goes on at the
/// other side of its start; then it visits what it passed by. In space it does so layer by layer, upwards and then
/// downwards, with stops on the climbs: it leaves a layer where it heard many nodes, and turns at the ceiling, at the
/// floor, and where it hears nobody after a climb.
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
    pub(super) lane: Lane,
    /// Direction of the lanes' order along x: 1 east, -1 west.
    pub(super) sweep: f64,
    /// Sweeps finished.
    pub(super) sweeps: u32,
    /// First stop of this sweep.
    pub(super) sweep_began: usize,
    /// Lanes in a row that heard nobody.
    pub(super) empty_lanes: u32,
    /// Lanes in a row that heard nobody after which a sweep is over.
    pub(super) empty_lanes_to_end: u32,
    /// Where obstacles cut lanes short.
    pub(super) cuts: Vec<Cut>,
    pub(super) layer: Layer,
    pub(super) area: Option<Area>,
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
    /// Up or down to another layer.
    Climb { to_z_m: f64 },
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

impl AutomatedS {
    /// The survey that `config` describes, for a robot that starts in `surroundings` and knows nothing else of them.
    ///
    /// # Errors
    /// If a value is outside its domain, or the robot starts outside its area or beyond floor or ceiling.
    pub fn plan(config: &AutomatedSConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        let settings = Settings::try_from(config)?;
        let start = surroundings.start;
        if let Some(layers) = settings.layers.filter(|layers| !layers.holds(start.z_m)) {
            let (key, limit_m) = layers.limit_beyond(start.z_m);
            let found = format!("{limit_m}, beyond which the robot starts at z = {} m", start.z_m);
            return Err(SettingError::new(key, found, "a height that leaves room for the start").within("layers"));
        }
        let area = config.area.as_ref().map(|area| Area::round_start("area", area, surroundings)).transpose()?;
        Ok(Self {
            settings,
            knowledge: Knowledge::default(),
            task: Task::Search { side: 0, from: Position::ORIGIN },
            lane: Lane::FIRST,
            sweep: 1.0,
            sweeps: 0,
            sweep_began: 0,
            empty_lanes: 0,
            empty_lanes_to_end: EMPTY_LANES,
            cuts: Vec::new(),
            layer: Layer::first(start.z_m),
            area,
            is_blocked: false,
            start,
            steps: 0,
        })
    }
}

impl Controller for AutomatedS {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        let here = situation.position;
        let Settings { step_m, lane_spacing_m, .. } = self.settings;
        let last_move = match situation.outcome {
            CommandOutcome::Started => {
                self.task = Task::Search { side: 0, from: here };
                return RobotCommand::Listen;
            }
            CommandOutcome::Arrived if self.passes_by(here) => Move::Free,
            CommandOutcome::Arrived => return RobotCommand::Listen,
            CommandOutcome::Blocked(contact) => {
                self.knowledge.note_contact(situation, contact, 2.0 * lane_spacing_m);
                let is_new = !self.knowledge.was_near(here, 0.5 * step_m, 0..self.knowledge.stops());
                if is_new && !matches!(self.task, Task::Travel(_)) {
                    self.is_blocked = true;
                    return RobotCommand::Listen;
                }
                Move::Blocked
            }
            CommandOutcome::Listened(heard) => {
                let Self { settings, area, knowledge, .. } = self;
                let allowed = |place: Position| is_allowed(settings, area.as_ref(), place);
                knowledge.note_stop(situation, heard, settings, allowed);
                if self.task == Task::Lane {
                    self.count_stop(here);
                }
                if self.is_complete() {
                    return RobotCommand::Finish(Ending::Complete);
                }
                if std::mem::take(&mut self.is_blocked) { Move::Blocked } else { Move::Free }
            }
        };
        if self.steps >= self.settings.max_steps {
            return RobotCommand::Finish(Ending::StepsExhausted);
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
    fn proceed(&mut self, situation: &Situation<'_>, last_move: Move) -> RobotCommand {
        let here = situation.position;
        let mut last_move = last_move;
        for _ in 0..MAX_CHANGES {
            let command = match self.task.clone() {
                Task::Search { side, from } => self.search(here, side, from, last_move),
                Task::Lane => self.drive_lane(situation, last_move),
                Task::Shift { from } => self.shift(situation, from, last_move),
                Task::Retreat => self.retreat(situation, last_move),
                Task::Behind { x_m, from } => self.go_behind(here, x_m, from, last_move),
                Task::Climb { to_z_m } => self.climb(situation, to_z_m, last_move),
                Task::Travel(trip) => self.travel(situation, trip, last_move),
                Task::Finish(ending) => Some(RobotCommand::Finish(ending)),
            };
            if let Some(command) = command {
                return command;
            }
            last_move = Move::Free;
        }
        RobotCommand::Finish(Ending::Stuck)
    }

    pub(super) fn drive(here: Position, east_m: f64, north_m: f64) -> Option<RobotCommand> {
        Some(RobotCommand::Drive(here + Position::new(east_m, north_m, 0.0)))
    }

    /// Whether the robot may stop at `place`.
    pub(super) fn allows(&self, place: Position) -> bool {
        is_allowed(&self.settings, self.area.as_ref(), place)
    }

    /// The length of the next step of `left_m`: no step is a sliver.
    pub(super) fn stride(&self, left_m: f64) -> f64 {
        if left_m < 1.5 * self.settings.step_m { left_m } else { self.settings.step_m }
    }

    /// Drives a square spiral, a lane's distance between its turns, until somebody is heard.
    fn search(&mut self, here: Position, side: u32, from: Position, last_move: Move) -> Option<RobotCommand> {
        if self.knowledge.hears_somebody() {
            self.start = here;
            self.layer = Layer::first(here.z_m);
            self.begin_lane(here);
            return None;
        }
        let side_m = f64::from(side / 2 + 1) * self.settings.lane_spacing_m;
        let left_m = side_m - here.distance_m(from);
        let (east, north) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][(side % 4) as usize];
        let place = here + Position::new(east, north, 0.0) * self.stride(left_m);
        if last_move == Move::Blocked || left_m <= 0.01 * self.settings.step_m || !self.allows(place) {
            self.task = Task::Search { side: side + 1, from: here };
            return None;
        }
        Some(RobotCommand::Drive(place))
    }

    pub(super) fn begin_lane(&mut self, here: Position) {
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

    fn drive_lane(&mut self, situation: &Situation<'_>, last_move: Move) -> Option<RobotCommand> {
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
        let place = here + Position::new(0.0, heading * self.settings.step_m, 0.0);
        if is_silent && (self.lane.hearing_stops >= HEARING_STOPS || is_beyond)
            || self.was_driven(here)
            || !self.allows(place)
        {
            self.end_lane(situation);
            return None;
        }
        Some(RobotCommand::Drive(place))
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
}

/// Whether the robot may stop at `place`.
fn is_allowed(settings: &Settings, area: Option<&Area>, place: Position) -> bool {
    settings.layers.is_none_or(|layers| layers.holds(place.z_m)) && area.is_none_or(|area| area.contains(place))
}
