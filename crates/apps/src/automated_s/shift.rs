//! Leaving a lane: over to the next one, back to find a way over, or to the part behind an obstacle.

use sextant_channel::Position;

use super::sweep::Sweep;
use super::task::{SurveyStep, SurveyTask};
use super::view::{Move, View};

/// Drives over to the next lane. If the way is blocked, the robot goes back along this lane to find another way.
pub(super) fn shift(sweep: &mut Sweep, view: &View<'_>, from: Position) -> SurveyStep {
    let here = view.here();
    let (step_m, lane_m) = (view.rules.settings.step_m, view.rules.settings.lane_spacing_m);
    let done_m = (here.x_m - from.x_m).abs();
    let left_m = lane_m - done_m;
    let is_done = left_m <= 0.01 * step_m;
    let place = here + Position::new(sweep.direction * view.rules.stride_m(left_m), 0.0, 0.0);
    let is_stopped = view.last_move == Move::Blocked;
    let is_at_border = !is_done && !view.rules.allow(place);
    let least_m = if is_at_border { 0.5 * lane_m } else { 0.99 * step_m };
    if is_done || (is_stopped || is_at_border) && done_m >= least_m {
        sweep.lane.heading = -sweep.lane.heading;
        return sweep.begin_lane(here, view.knowledge);
    }
    if done_m < 0.01 * step_m && !has_room_over(sweep, view) {
        return if has_way_over(sweep, view) { SurveyStep::Begin(SurveyTask::Retreat) } else { SurveyStep::EndSweep };
    }
    if is_stopped || is_at_border { SurveyStep::Begin(SurveyTask::Retreat) } else { SurveyStep::Drive(place) }
}

/// Whether the area extends from this place at least half the way to the next lane.
fn has_room_over(sweep: &Sweep, view: &View<'_>) -> bool {
    let half_m = sweep.direction * 0.5 * view.rules.settings.lane_spacing_m;
    view.rules.allow(view.here() + Position::new(half_m, 0.0, 0.0))
}

/// Whether the area extends from any stop of this lane all the way to the next lane.
fn has_way_over(sweep: &Sweep, view: &View<'_>) -> bool {
    let over = Position::new(sweep.direction * view.rules.settings.lane_spacing_m, 0.0, 0.0);
    view.knowledge.visits[sweep.lane.first_stop..].iter().any(|visit| view.rules.allow(visit.place + over))
}

/// Drives back along the lane to a place with a way over to the next one. If there is none up to the end of the lane,
/// the sweep ends.
pub(super) fn retreat(sweep: &Sweep, view: &View<'_>) -> SurveyStep {
    let here = view.here();
    let (step_m, lane_m) = (view.rules.settings.step_m, view.rules.settings.lane_spacing_m);
    let over = Position::new(sweep.direction * lane_m, 0.0, 0.0);
    if view.rules.allow(here + over) && view.situation.clearance_m(over, lane_m) >= lane_m {
        return SurveyStep::Begin(SurveyTask::Shift { from: here });
    }
    let back = -sweep.lane.heading;
    if view.last_move == Move::Blocked || sweep.lane.left_of_network_m(here.y_m, back) < -step_m {
        return SurveyStep::EndSweep;
    }
    SurveyStep::Drive(here + Position::new(0.0, back * step_m, 0.0))
}

/// Drives to the lane at `x_m` that an obstacle cut short (`obstacleRegistry` of the thesis). The drive began at
/// `from`.
pub(super) fn go_behind(sweep: &mut Sweep, view: &View<'_>, x_m: f64, from: Position) -> SurveyStep {
    let here = view.here();
    let step_m = view.rules.settings.step_m;
    let left_m = (here.x_m - x_m).abs();
    let is_there = left_m <= 0.01 * step_m;
    let place = here + Position::new(-sweep.direction * view.rules.stride_m(left_m), 0.0, 0.0);
    if is_there || view.last_move == Move::Blocked || !view.rules.allow(place) {
        if is_there || here.distance_m(from) < step_m {
            sweep.forget_cut(x_m);
        }
        return sweep.begin_lane(here, view.knowledge);
    }
    SurveyStep::Drive(place)
}
