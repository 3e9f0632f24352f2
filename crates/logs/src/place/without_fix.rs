//! Places at x = y = 0 in metres that no robot drove to: rows of a receiver without a fix.
//!
//! That 0, 0 is far from all other places is not enough: odometry starts there, and so does a survey that is measured from its
//! base. It must be beyond any drive, or the robot must have jumped there and away again, or be there in several rows between
//! others.

use sextant_channel::{Position, Stop};
use sextant_kernel::SimTime;

use super::distance::plane_m;
use crate::median::median;

/// Where a robot was at a time.
pub(crate) type TimedPlace = (SimTime, Position);

/// Farther than this (m), and so many times the extent of the other places, no robot drives between two of them.
const BEYOND_M: f64 = 5_000.0;
const BEYOND: f64 = 20.0;
/// A leg is a jump if it is faster than this (m/s) and so many times as fast as usual.
const JUMP: f64 = 3.0;
const JUMP_TIMES: f64 = 10.0;
/// Rows at 0, 0 between other ones, or before or after them if the robot jumped: one alone says nothing.
pub(crate) const SEVERAL: usize = 2;

/// Whether a place is at x = y = 0.
pub(crate) fn is_origin(place: Position) -> bool {
    place.x_m.abs() <= 0.0 && place.y_m.abs() <= 0.0
}

/// How far x = y = 0 is from the nearest of the other places of `robots`, if rows there are those of a receiver without a fix.
/// The places of each robot are in metres, in the order of time.
pub(crate) fn without_fix_m(robots: &[Vec<TimedPlace>]) -> Option<f64> {
    let all = || robots.iter().flatten().map(|(_, position)| *position);
    if !all().any(is_origin) {
        return None;
    }
    let others = || all().filter(|&place| !is_origin(place));
    let nearest_m = others().map(|place| plane_m(place, Position::ORIGIN)).fold(f64::INFINITY, f64::min);
    let [low, high] = others().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], at| {
        [[low[0].min(at.x_m), low[1].min(at.y_m)], [high[0].max(at.x_m), high[1].max(at.y_m)]]
    });
    let extent_m = libm::hypot(high[0] - low[0], high[1] - low[1]);
    if !(nearest_m.is_finite() && nearest_m > extent_m.max(1.0)) {
        return None;
    }
    let is_beyond = nearest_m > BEYOND_M && nearest_m > BEYOND * extent_m;
    let usual = usual_speed(robots);
    (is_beyond || robots.iter().any(|places| was_never_there(places, usual))).then_some(nearest_m)
}

/// The median speed between places that are not 0, 0 (m/s); `None` if there are no times, or no robot moved.
fn usual_speed(robots: &[Vec<TimedPlace>]) -> Option<f64> {
    let legs = robots.iter().flat_map(|places| places.windows(2));
    let legs = legs.filter(|leg| leg.iter().all(|(_, place)| !is_origin(*place)));
    let mut speeds: Vec<f64> = legs.filter_map(speed).filter(|speed| *speed > 0.0).collect();
    median(&mut speeds)
}

/// The speed of a leg (m/s); `None` if no time passed.
fn speed(leg: &[TimedPlace]) -> Option<f64> {
    let span_s = leg[1].0.saturating_since(leg[0].0).as_secs_f64();
    (span_s > 0.0).then(|| plane_m(leg[0].1, leg[1].1) / span_s)
}

/// Whether the robot that was at `places` cannot have been at 0, 0 where they say so.
fn was_never_there(places: &[TimedPlace], usual: Option<f64>) -> bool {
    let is_jump =
        |leg: &[TimedPlace]| speed(leg).zip(usual).is_some_and(|(speed, usual)| speed > JUMP.max(JUMP_TIMES * usual));
    let is_timed = |leg: &[TimedPlace]| speed(leg).is_some();
    let mut between = 0;
    let mut start = 0;
    for run in places.chunk_by(|a, b| is_origin(a.1) == is_origin(b.1)) {
        let end = start + run.len();
        let before = start.checked_sub(1).map(|before| &places[before..=start]);
        let after = places.get(end - 1..=end);
        start = end;
        if !is_origin(run[0].1) {
            continue;
        }
        match (before, after) {
            (Some(before), Some(after)) if is_jump(before) && is_jump(after) => return true,
            (Some(before), Some(after)) if !is_timed(before) || !is_timed(after) => between += run.len(),
            (None, Some(leg)) | (Some(leg), None) if run.len() >= SEVERAL && is_jump(leg) => return true,
            _ => {}
        }
    }
    between >= SEVERAL
}

/// Leaves out of `rows` those at x = y = 0, if the receiver had no fix there. `place` is that of a row; all rows are of one
/// robot. Returns how many.
pub(crate) fn leave_out<T>(rows: &mut Vec<T>, place: impl Fn(&T) -> TimedPlace) -> usize {
    let before = rows.len();
    let places: Vec<TimedPlace> = rows.iter().map(&place).collect();
    if without_fix_m(&[places]).is_some() {
        rows.retain(|row| !is_origin(place(row).1));
    }
    before - rows.len()
}

/// The places of `stops` by robot, in their order.
pub(crate) fn places_of<'a>(stops: impl IntoIterator<Item = &'a Stop>) -> Vec<Vec<TimedPlace>> {
    let mut robots: Vec<Vec<TimedPlace>> = Vec::new();
    for stop in stops {
        let robot = stop.robot.index();
        if robots.len() <= robot {
            robots.resize_with(robot + 1, Vec::new);
        }
        robots[robot].push((stop.time, stop.position));
    }
    robots
}
