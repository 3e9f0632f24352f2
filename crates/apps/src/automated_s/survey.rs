//! The automated S path.

use sextant_channel::Position;
use sextant_kernel::SettingError;
use sextant_sim::{CommandOutcome, Controller, Ending, RobotCommand, Situation};

use super::check;
use super::knowledge::Knowledge;
use super::layers::Layer;
use super::rules::Rules;
use super::settings::{AfterLanes, AutomatedSConfig, Settings, Until};
use super::shift;
use super::sweep::Sweep;
use super::task::{SurveyStep, SurveyTask};
use super::trip::{Goal, Trip};
use super::view::{Move, View};
use crate::area::Area;
use crate::surroundings::Surroundings;

/// Maximum number of task changes between two commands. More would be a bug, and end the survey.
const MAX_CHANGES: u32 = 64;

/// A survey in lanes along y, without a map (thesis, appendix C.1.2).
///
/// The robot drives a step and listens, again and again, until it meets an obstacle or hears nothing. Then it moves
/// over to the next lane and drives back along that. Where an obstacle cut a lane short, the robot covers the part
/// behind the obstacle as soon as a later lane has passed it. If nodes are missing when a whole lane has heard
/// nothing, the robot continues on the other side of its start. Then it visits places that it passed. In space it
/// does this layer by layer, first upwards, then downwards, with stops during the climbs. It leaves a layer at a
/// place where it heard many nodes. It turns at the ceiling, at the floor, and where it hears nothing after a climb.
///
/// The pseudo code of the thesis does not work in some places. There, this code differs: the loop runs *until* all
/// packets are received; each obstacle is recorded separately, for both headings, and forgotten when it is covered;
/// the distance between lanes is a separate setting; parts of lanes are not driven twice; the number of steps is
/// limited.
#[derive(Clone, Debug)]
pub struct AutomatedS {
    rules: Rules,
    knowledge: Knowledge,
    sweep: Sweep,
    layer: Layer,
    task: SurveyTask,
    /// Whether the robot met an obstacle and stopped to listen before it reacts.
    is_blocked: bool,
    steps: u32,
}

impl AutomatedS {
    /// The survey that `config` describes, for a robot that starts in `surroundings`. The robot uses its start only,
    /// not the obstacles.
    ///
    /// # Errors
    /// If a value is invalid, or the robot starts outside its area or beyond floor or ceiling.
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
            rules: Rules { settings, area },
            knowledge: Knowledge::default(),
            sweep: Sweep::first(start),
            layer: Layer::first(start.z_m),
            task: SurveyTask::Search { side: 0, from: Position::ORIGIN },
            is_blocked: false,
            steps: 0,
        })
    }
}

impl Controller for AutomatedS {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        let here = situation.position;
        let Settings { step_m, lane_spacing_m, max_steps, .. } = self.rules.settings;
        let last_move = match situation.outcome {
            CommandOutcome::Started => {
                self.task = SurveyTask::Search { side: 0, from: here };
                return RobotCommand::Listen;
            }
            CommandOutcome::Arrived if self.passes_by(here) => Move::Free,
            CommandOutcome::Arrived => return RobotCommand::Listen,
            CommandOutcome::Blocked(contact) => {
                self.knowledge.note_contact(situation, contact, 2.0 * lane_spacing_m);
                let is_new = !self.knowledge.was_near(here, 0.5 * step_m, 0..self.knowledge.stops());
                if is_new && !matches!(self.task, SurveyTask::Travel(_)) {
                    self.is_blocked = true;
                    return RobotCommand::Listen;
                }
                Move::Blocked
            }
            CommandOutcome::Listened(heard) => {
                self.knowledge.note_stop(situation, heard, &self.rules);
                if self.task == SurveyTask::Lane {
                    self.sweep.count_stop(here, &self.knowledge);
                }
                if self.is_complete() {
                    return RobotCommand::Finish(Ending::Complete);
                }
                if std::mem::take(&mut self.is_blocked) { Move::Blocked } else { Move::Free }
            }
        };
        if self.steps >= max_steps {
            return RobotCommand::Finish(Ending::StepsExhausted);
        }
        self.steps += 1;
        self.proceed(situation, last_move)
    }
}

impl AutomatedS {
    /// Whether the robot need not listen here, because it is on a trip or has listened here before.
    fn passes_by(&self, here: Position) -> bool {
        match &self.task {
            SurveyTask::Travel(trip) => trip.is_under_way(),
            SurveyTask::Retreat => {
                self.knowledge.was_near(here, 0.5 * self.rules.settings.step_m, 0..self.knowledge.stops())
            }
            _ => false,
        }
    }

    /// Whether the survey is complete: all packets are heard, and the sweep is finished if the settings require it.
    fn is_complete(&self) -> bool {
        let Settings { layers, until, packets_per_node, .. } = self.rules.settings;
        let is_swept = if layers.is_some() { self.layer.is_last() } else { self.sweep.finished > 0 };
        (is_swept || until == Until::Heard) && self.knowledge.heard_all(packets_per_node)
    }

    /// The next command. Runs one task after another until one gives a command.
    fn proceed(&mut self, situation: &Situation<'_>, last_move: Move) -> RobotCommand {
        let mut last_move = last_move;
        for _ in 0..MAX_CHANGES {
            let view = View { situation, last_move, rules: &self.rules, knowledge: &self.knowledge };
            let sweep = &mut self.sweep;
            let step = match self.task.clone() {
                SurveyTask::Search { side, from } => self.search(situation, side, from, last_move),
                SurveyTask::Lane => sweep.drive_lane(&view),
                SurveyTask::Shift { from } => shift::shift(sweep, &view, from),
                SurveyTask::Retreat => shift::retreat(sweep, &view),
                SurveyTask::Behind { x_m, from } => shift::go_behind(sweep, &view, x_m, from),
                SurveyTask::Climb { to_z_m } => self.climb(situation, to_z_m, last_move),
                SurveyTask::Travel(trip) => self.travel(situation, trip, last_move),
                SurveyTask::Finish(ending) => return RobotCommand::Finish(ending),
            };
            self.task = match step {
                SurveyStep::Drive(place) => return RobotCommand::Drive(place),
                SurveyStep::Begin(task) => task,
                SurveyStep::EndSweep => self.after_sweep(situation),
            };
            last_move = Move::Free;
        }
        RobotCommand::Finish(Ending::Stuck)
    }

    /// Drives a square spiral until a node is heard. Its turns are one lane spacing apart.
    fn search(&mut self, situation: &Situation<'_>, side: u32, from: Position, last_move: Move) -> SurveyStep {
        let here = situation.position;
        if self.knowledge.hears_somebody() {
            self.layer = Layer::first(here.z_m);
            return self.sweep.begin(here, &self.knowledge);
        }
        let Settings { step_m, lane_spacing_m, .. } = self.rules.settings;
        let side_m = f64::from(side / 2 + 1) * lane_spacing_m;
        let left_m = side_m - here.distance_m(from);
        let (east, north) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][(side % 4) as usize];
        let place = here + Position::new(east, north, 0.0) * self.rules.stride_m(left_m);
        if last_move == Move::Blocked || left_m <= 0.01 * step_m || !self.rules.allow(place) {
            return SurveyStep::Begin(SurveyTask::Search { side: side + 1, from: here });
        }
        SurveyStep::Drive(place)
    }

    /// Climbs up or down to the layer at `to_z_m`, with stops on the way.
    fn climb(&mut self, situation: &Situation<'_>, to_z_m: f64, last_move: Move) -> SurveyStep {
        let here = situation.position;
        let left_m = to_z_m - here.z_m;
        if last_move == Move::Blocked || left_m.abs() <= 0.01 * self.rules.settings.step_m {
            return self.enter_layer(situation);
        }
        SurveyStep::Drive(Position { z_m: here.z_m + self.rules.stride_m(left_m.abs()).copysign(left_m), ..here })
    }

    /// Begins the layer at this height. If nothing is heard here, or the climb was blocked, there is no layer in this
    /// direction.
    fn enter_layer(&mut self, situation: &Situation<'_>) -> SurveyStep {
        let here = situation.position;
        let Some(layers) = self.rules.settings.layers else { return SurveyStep::Begin(self.task.clone()) };
        if self.layer.is_left(here, &layers) && self.knowledge.hears_somebody() {
            self.layer.enter(here);
            return self.sweep.begin_layer(here, &self.knowledge);
        }
        SurveyStep::Begin(if self.layer.turn_down() {
            self.leave_layer(situation)
        } else {
            self.after_layers(situation)
        })
    }

    /// Continues a trip. At its end, begins what the trip was made for.
    fn travel(&mut self, situation: &Situation<'_>, mut trip: Trip, last_move: Move) -> SurveyStep {
        let view = View { situation, last_move, rules: &self.rules, knowledge: &self.knowledge };
        if let Some(place) = trip.next(&view) {
            self.task = SurveyTask::Travel(trip);
            return SurveyStep::Drive(place);
        }
        let here = situation.position;
        match trip.then {
            Goal::OtherSide if self.rules.settings.layers.is_some() => {
                self.sweep.begin_other_side(here, &self.knowledge)
            }
            Goal::OtherSide => SurveyStep::Begin(self.sweep.begin_back(here, &self.knowledge, &self.rules)),
            Goal::Climb { to_z_m } => SurveyStep::Begin(SurveyTask::Climb { to_z_m }),
            Goal::Check => {
                self.knowledge.give_up_opening(trip.goal);
                SurveyStep::Begin(self.check(situation))
            }
        }
    }

    /// What to do after a sweep. The first sweep of a layer leads to the nearer border, because the robot enters a
    /// layer near the place where it left the last one.
    fn after_sweep(&mut self, situation: &Situation<'_>) -> SurveyTask {
        self.sweep.end();
        let is_first = self.sweep.finished == 1;
        if self.is_complete() {
            return SurveyTask::Finish(Ending::Complete);
        }
        let checks = self.rules.settings.after_lanes == AfterLanes::Check;
        let is_bounded = self.rules.settings.layers.is_some() || self.rules.area.is_some();
        if !is_bounded && checks && !(is_first && check::misses_nodes(&self.knowledge, &self.rules)) {
            return self.check(situation);
        }
        if is_first && let Some(trip) = self.trip_to_other_side(situation) {
            return SurveyTask::Travel(trip);
        }
        if self.rules.settings.layers.is_some() {
            self.leave_layer(situation)
        } else if self.rules.area.is_none() {
            self.sweep.begin_back(situation.position, &self.knowledge, &self.rules)
        } else if checks {
            self.check(situation)
        } else {
            SurveyTask::Finish(Ending::Complete)
        }
    }

    /// A trip back to where the first lane began; `None` if no way is known.
    fn trip_to_other_side(&self, situation: &Situation<'_>) -> Option<Trip> {
        let view = View { situation, last_move: Move::Free, rules: &self.rules, knowledge: &self.knowledge };
        Trip::plan(&view, self.sweep.start, Goal::OtherSide)
    }

    /// Begins the trip to the next layer.
    fn leave_layer(&mut self, situation: &Situation<'_>) -> SurveyTask {
        let view = View { situation, last_move: Move::Free, rules: &self.rules, knowledge: &self.knowledge };
        let trip = self.rules.settings.layers.and_then(|layers| self.layer.leave(&view, &layers));
        trip.map_or_else(|| self.after_layers(situation), SurveyTask::Travel)
    }

    /// What to do when all layers are swept.
    fn after_layers(&mut self, situation: &Situation<'_>) -> SurveyTask {
        if self.is_complete() {
            SurveyTask::Finish(Ending::Complete)
        } else if self.rules.settings.after_lanes == AfterLanes::Check {
            self.check(situation)
        } else {
            SurveyTask::Finish(self.ending_with_misses())
        }
    }

    /// Drives to a place where missing nodes may be heard.
    fn check(&mut self, situation: &Situation<'_>) -> SurveyTask {
        let trip = check::next_trip(&mut self.knowledge, &self.rules, situation);
        trip.map_or_else(|| SurveyTask::Finish(self.ending_with_misses()), SurveyTask::Travel)
    }

    /// How a survey ends if packets are missing and no place is left to visit. A robot with an area has finished its
    /// area.
    fn ending_with_misses(&self) -> Ending {
        if self.rules.area.is_some() { Ending::Complete } else { Ending::Stuck }
    }
}
