//! A sweep: one lane after another in one direction, until lanes hear nothing.

use sextant_channel::Position;

use super::knowledge::Knowledge;
use super::lane::{Cut, HEARING_STOPS, Lane};
use super::rules::Rules;
use super::settings::Settings;
use super::task::{SurveyStep, SurveyTask};
use super::view::{Move, View};

/// Number of consecutive silent lanes that end a sweep. One is enough if it covers the whole lane before it.
const EMPTY_LANES: u32 = 2;
/// The same for a sweep that begins outside the reach of the network.
const EMPTY_LANES_OUTSIDE: u32 = 8;
/// Offset of a further sweep from the last one, as a share of the lane spacing. It is the golden section, so that the
/// lanes of many sweeps do not coincide.
const AGAIN: f64 = 0.381_966;

/// The current sweep and its current lane.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    pub(super) lane: Lane,
    /// Direction from one lane to the next: 1 for east, -1 for west.
    pub(super) direction: f64,
    /// Where the first lane of the layer began (m).
    pub(super) start: Position,
    /// Number of finished sweeps of this layer.
    pub(super) finished: u32,
    /// First stop of this sweep.
    first_stop: usize,
    /// Number of consecutive silent lanes.
    empty_lanes: u32,
    /// Number of consecutive silent lanes that end this sweep.
    empty_lanes_to_end: u32,
    /// Where obstacles cut lanes short.
    cuts: Vec<Cut>,
}

impl Sweep {
    /// The first sweep, eastward from `start`.
    pub(super) fn first(start: Position) -> Self {
        Self {
            lane: Lane::FIRST,
            direction: 1.0,
            start,
            finished: 0,
            first_stop: 0,
            empty_lanes: 0,
            empty_lanes_to_end: EMPTY_LANES,
            cuts: Vec::new(),
        }
    }

    /// Begins the first lane where a node was heard.
    pub(super) fn begin(&mut self, here: Position, knowledge: &Knowledge) -> SurveyStep {
        self.start = here;
        self.begin_lane(here, knowledge)
    }

    /// Begins the first sweep of another layer.
    pub(super) fn begin_layer(&mut self, here: Position, knowledge: &Knowledge) -> SurveyStep {
        self.start = here;
        self.finished = 0;
        self.begin_side(Lane::FIRST, here, knowledge)
    }

    /// Begins the sweep of the other side of a layer, where its first lane began. The first lane is the part behind
    /// the start.
    pub(super) fn begin_other_side(&mut self, here: Position, knowledge: &Knowledge) -> SurveyStep {
        self.direction = -self.direction;
        self.begin_side(Lane::SOUTHWARD, here, knowledge)
    }

    fn begin_side(&mut self, lane: Lane, here: Position, knowledge: &Knowledge) -> SurveyStep {
        self.first_stop = knowledge.stops();
        self.empty_lanes_to_end = EMPTY_LANES;
        self.lane = lane;
        self.begin_lane(here, knowledge)
    }

    /// Begins a sweep in the other direction from here. If lanes were driven there before, the new lanes lie between
    /// them.
    pub(super) fn begin_back(&mut self, here: Position, knowledge: &Knowledge, rules: &Rules) -> SurveyTask {
        self.direction = -self.direction;
        self.first_stop = knowledge.stops();
        let is_outside = self.finished > 1;
        self.empty_lanes_to_end = if is_outside { EMPTY_LANES_OUTSIDE } else { EMPTY_LANES };
        let aside = if self.direction < 0.0 { AGAIN } else { 1.0 - AGAIN };
        let ahead_m = if is_outside { aside * rules.settings.lane_spacing_m } else { 0.0 };
        SurveyTask::Shift { from: here - Position::new(self.direction * ahead_m, 0.0, 0.0) }
    }

    /// Ends the sweep.
    pub(super) fn end(&mut self) {
        self.finished += 1;
        self.empty_lanes = 0;
        self.cuts.clear();
    }

    /// Begins the next lane.
    pub(super) fn begin_lane(&mut self, here: Position, knowledge: &Knowledge) -> SurveyStep {
        self.lane = self.lane.next(here, knowledge.stops().saturating_sub(1));
        self.count_stop(here, knowledge);
        SurveyStep::Begin(SurveyTask::Lane)
    }

    /// Counts the last stop as part of the lane.
    pub(super) fn count_stop(&mut self, here: Position, knowledge: &Knowledge) {
        if knowledge.hears_somebody() {
            self.lane.count_hearing(here);
        } else {
            self.lane.count_silent();
        }
    }

    /// Continues along the lane.
    pub(super) fn drive_lane(&mut self, view: &View<'_>) -> SurveyStep {
        let here = view.here();
        let heading = self.lane.heading;
        let settings = &view.rules.settings;
        if view.last_move == Move::Blocked {
            self.cuts.push(Cut { heading, place: here });
            return self.end_lane(view);
        }
        if let Some(x_m) = self.uncovered_behind(view) {
            return SurveyStep::Begin(SurveyTask::Behind { x_m, from: here });
        }
        let is_silent = self.lane.silent_run >= settings.silent_stops_to_turn;
        let is_beyond = self.lane.left_of_network_m(here.y_m, heading) <= 0.0;
        let place = here + Position::new(0.0, heading * settings.step_m, 0.0);
        if is_silent && (self.lane.hearing_stops >= HEARING_STOPS || is_beyond)
            || self.was_driven(view)
            || !view.rules.allow(place)
        {
            return self.end_lane(view);
        }
        SurveyStep::Drive(place)
    }

    /// Whether the rest of the lane was driven before in this sweep.
    fn was_driven(&self, view: &View<'_>) -> bool {
        let here = view.here();
        let Settings { step_m, .. } = view.rules.settings;
        let earlier = self.first_stop..self.lane.first_stop.max(self.first_stop);
        let mut ahead_m = step_m;
        let last_m = self.lane.left_of_network_m(here.y_m, self.lane.heading).max(2.0 * step_m);
        while ahead_m <= last_m {
            let place = here + Position::new(0.0, self.lane.heading * ahead_m, 0.0);
            if !view.knowledge.was_near(place, 0.5 * step_m, earlier.clone()) {
                return false;
            }
            ahead_m += step_m;
        }
        true
    }

    /// Ends the lane: moves over to the next one, or ends the sweep if the network lies behind.
    fn end_lane(&mut self, view: &View<'_>) -> SurveyStep {
        let was_empty = self.lane.hearing_stops == 0;
        if was_empty {
            self.empty_lanes += 1;
        } else {
            (self.empty_lanes, self.empty_lanes_to_end) = (0, EMPTY_LANES);
        }
        let missed_m = self.lane.left_of_network_m(self.lane.start_y_m, -self.lane.heading);
        let was_whole = missed_m <= view.rules.settings.lane_spacing_m && self.empty_lanes_to_end == EMPTY_LANES;
        if was_empty && (was_whole || self.empty_lanes >= self.empty_lanes_to_end) {
            SurveyStep::EndSweep
        } else {
            SurveyStep::Begin(SurveyTask::Shift { from: view.here() })
        }
    }

    /// The x of a lane that an obstacle cut short, if this lane has just passed the obstacle and can see that lane
    /// (`coverObstacles` of the thesis).
    fn uncovered_behind(&self, view: &View<'_>) -> Option<f64> {
        let here = view.here();
        let Settings { step_m, lane_spacing_m: lane_m, .. } = view.rules.settings;
        let is_behind = |cut: &&Cut| {
            let back_m = self.direction * (here.x_m - cut.place.x_m);
            let beyond_m = self.lane.heading * (here.y_m - cut.place.y_m);
            cut.heading * self.lane.heading > 0.0
                && beyond_m > 0.0
                && back_m >= step_m
                && back_m <= 4.0 * lane_m
                && !view.knowledge.was_near(
                    Position { y_m: here.y_m, ..cut.place },
                    view.rules.covered_lane_m(),
                    self.first_stop..view.knowledge.stops(),
                )
                && view.situation.clearance_m(Position::new(-self.direction, 0.0, 0.0), back_m) >= back_m
        };
        Some(self.cuts.iter().find(is_behind)?.place.x_m)
    }

    /// Forgets the obstacle that cut the lane at `x_m` short, because the part behind it is covered or cannot be
    /// reached.
    pub(super) fn forget_cut(&mut self, x_m: f64) {
        let heading = self.lane.heading;
        self.cuts.retain(|cut| (cut.place.x_m - x_m).abs() > 1e-6 || cut.heading * heading < 0.0);
    }
}
