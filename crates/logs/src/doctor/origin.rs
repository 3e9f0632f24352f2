//! Places at x = y = 0 in metres that no robot drove to: rows of a receiver without a fix.
//!
//! That 0, 0 is far from all other places is not enough: odometry starts there, and so does a survey that is measured from its
//! base. It must be beyond any drive, or the robot must have jumped there and away again, or be there in several rows between
//! others. Of latitudes and longitudes the degrees tell, before they become metres: the first fix is the origin of the plane.

use sextant_channel::Position;

use super::finding::Finding;
use super::node_fit::plane_m;
use super::survey::{Place, Survey};

/// Farther than this (m), and so many times the extent of the other places, no robot drives between two of them.
const BEYOND_M: f64 = 5_000.0;
const BEYOND: f64 = 20.0;
/// A leg is a jump if it is faster than this (m/s) and so many times as fast as usual.
const JUMP: f64 = 3.0;
const JUMP_TIMES: f64 = 10.0;
/// Rows at 0, 0 between other ones, or before or after them if the robot jumped: one alone says nothing.
const SEVERAL: usize = 2;

/// Whether a place is at x = y = 0.
pub(crate) fn is_origin(place: Position) -> bool {
    place.x_m.abs() <= 0.0 && place.y_m.abs() <= 0.0
}

/// How far x = y = 0 is from the nearest of the other places of `robots`, if rows there are those of a receiver without a fix.
/// The places of each robot are in metres, in the order of time.
pub(crate) fn without_fix_m(robots: &[Vec<Place>]) -> Option<f64> {
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
fn usual_speed(robots: &[Vec<Place>]) -> Option<f64> {
    let legs = robots.iter().flat_map(|places| places.windows(2));
    let legs = legs.filter(|leg| leg.iter().all(|(_, place)| !is_origin(*place)));
    let mut speeds: Vec<f64> = legs.filter_map(speed).filter(|speed| *speed > 0.0).collect();
    let middle = speeds.len() / 2;
    speeds.sort_by(f64::total_cmp);
    speeds.get(middle).copied()
}

/// The speed of a leg (m/s); `None` if no time passed.
fn speed(leg: &[Place]) -> Option<f64> {
    let span_s = leg[1].0.saturating_since(leg[0].0).as_secs_f64();
    (span_s > 0.0).then(|| plane_m(leg[0].1, leg[1].1) / span_s)
}

/// Whether the robot that was at `places` cannot have been at 0, 0 where they say so.
fn was_never_there(places: &[Place], usual: Option<f64>) -> bool {
    let is_jump =
        |leg: &[Place]| speed(leg).zip(usual).is_some_and(|(speed, usual)| speed > JUMP.max(JUMP_TIMES * usual));
    let is_timed = |leg: &[Place]| speed(leg).is_some();
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
pub(crate) fn leave_out<T>(rows: &mut Vec<T>, place: impl Fn(&T) -> Place) -> usize {
    let before = rows.len();
    let places: Vec<Place> = rows.iter().map(&place).collect();
    if without_fix_m(&[places]).is_some() {
        rows.retain(|row| !is_origin(place(row).1));
    }
    before - rows.len()
}

/// What is odd of the places of a survey.
pub(super) fn finding(survey: &Survey<'_>) -> Option<Finding> {
    let all = || survey.robots.iter().flatten();
    let count = all().filter(|(_, place)| is_origin(*place)).count();
    let where_found = match survey.plane {
        // The origin of the plane is the first fix itself; others that are far from 0, 0 are refused when they are read.
        Some(plane) => {
            let is_zero =
                [plane.origin().lat_deg, plane.origin().lon_deg].iter().all(|angle_deg| angle_deg.abs() <= 0.0);
            (is_zero && count >= SEVERAL).then(|| "at latitude 0 and longitude 0".to_owned())?
        }
        None => format!("at x = y = 0, {:.0} m from all others", without_fix_m(&survey.robots)?),
    };
    let (what, are) = (survey.points.noun(), if count == 1 { "is" } else { "are" });
    Some(Finding {
        check: "no-fix",
        odd: format!("{count} of {} {what} {are} {where_found}: receivers without a fix write 0, 0", all().count()),
        cost: "what was heard there counts as heard that far away".to_owned(),
        remedy: "option `skip_no_fix` leaves these rows out and counts them".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use sextant_channel::ReceptionLog;
    use sextant_kernel::SimTime;

    use super::super::survey::Points;
    use super::*;
    use crate::LocalPlane;

    /// Rows of one robot, one each `step_s` (s).
    fn rows(step_s: u64, places: impl IntoIterator<Item = [f64; 2]>) -> Vec<Place> {
        let timed = |(number, [x, y]): (u64, [f64; 2])| {
            (SimTime::from_nanos(number * step_s * 1_000_000_000), Position::new(x, y, 0.0))
        };
        (0..).zip(places).map(timed).collect()
    }

    fn told(step_s: u64, places: impl IntoIterator<Item = [f64; 2]>, plane: Option<&LocalPlane>) -> Option<Finding> {
        let log = ReceptionLog::new(Vec::new(), Vec::new(), Vec::new(), Vec::new()).unwrap();
        finding(&Survey { robots: vec![rows(step_s, places)], points: Points::Stops, plane, log: &log })
    }

    fn is_odd(step_s: u64, places: impl IntoIterator<Item = [f64; 2]>) -> bool {
        told(step_s, places, None).is_some()
    }

    /// A hall of 20 by 10 m whose corner is at x, y.
    fn hall(x: f64, y: f64) -> Vec<[f64; 2]> {
        (0..33_u8).map(|i| [x + 2.0 * f64::from(i % 11), y + 5.0 * f64::from(i / 11)]).collect()
    }

    /// The rows of the hall with zeros before row `at`.
    fn with_zeros(hall: &[[f64; 2]], zeros: usize, at: usize) -> Vec<[f64; 2]> {
        [&hall[..at], &vec![[0.0; 2]; zeros], &hall[at..]].concat()
    }

    #[test]
    fn zeros_beyond_any_drive_are_rows_without_a_fix() {
        let utm = hall(500_000.0, 5_500_000.0);
        for (zeros, at) in [(3, 0), (3, 12), (1, 0), (1, 12), (1, 33)] {
            assert!(
                is_odd(10, with_zeros(&utm, zeros, at)) && is_odd(0, with_zeros(&utm, zeros, at)),
                "{zeros} {at}"
            );
        }
        assert!(!is_odd(10, utm));
        let found = told(0, with_zeros(&hall(5e5, 0.0), 3, 5), None).unwrap();
        assert!(found.odd.starts_with("3 of 36 stops are at x = y = 0, 500000 m from all others"), "{found}");
        assert!(found.remedy.starts_with("option `skip_no_fix`"), "{found}");
    }

    #[test]
    fn a_survey_that_starts_or_ends_at_its_base_has_a_fix_there() {
        let far = hall(100.0, 40.0);
        for step_s in [0, 30, 300] {
            assert!(!is_odd(step_s, with_zeros(&far, 1, 0)), "the start, a row each {step_s} s");
            assert!(!is_odd(step_s, with_zeros(&far, 1, 33)), "the end");
            let both = [vec![[0.0; 2]], far.clone(), vec![[0.0; 2]]].concat();
            assert!(!is_odd(step_s, both), "both");
        }
        assert!(!is_odd(0, with_zeros(&far, 1, 12)), "one row between, without times");
        assert!(!is_odd(1, hall(0.0, 0.0)) && !is_odd(1, with_zeros(&hall(1.0, 1.0), 3, 9)), "near the others");
        // A robot that charges at its base for an hour in the middle.
        assert!(!is_odd(300, with_zeros(&far, 12, 12)));
    }

    #[test]
    fn the_first_of_several_fixes_is_one_unless_it_is_at_zero_degrees() {
        let (somewhere, nowhere) = (LocalPlane::new(50.0, 3.0, 0.0), LocalPlane::new(0.0, 0.0, 0.0));
        let path = with_zeros(&hall(300.0, 40.0), 4, 0);
        assert_eq!(told(1, path.clone(), Some(&somewhere)), None);
        let found = told(1, path, Some(&nowhere)).unwrap();
        assert!(found.odd.starts_with("4 of 37 stops are at latitude 0 and longitude 0: receivers"), "{found}");
    }

    #[test]
    fn odometry_that_rests_at_its_start_has_a_fix_there() {
        let rest = std::iter::repeat_n([0.0; 2], 50);
        let drive = (0..400_u16).map(|step| [0.1 * f64::from(step), 0.0]);
        assert!(!is_odd(1, rest.chain(drive)));
    }

    #[test]
    fn jumps_to_zero_and_back_are_rows_without_a_fix() {
        // 108 m in one second, where the robot drives at 2 m/s.
        let far = hall(100.0, 40.0);
        assert!(is_odd(1, with_zeros(&far, 1, 12)) && is_odd(1, with_zeros(&far, 5, 12)));
        assert!(is_odd(1, with_zeros(&far, 2, 0)), "a receiver that starts without a fix");
        assert!(is_odd(0, with_zeros(&far, 2, 12)), "several rows between others, without times");
        let mut left = rows(1, with_zeros(&far, 5, 12));
        assert_eq!((leave_out(&mut left, |row| *row), left.len()), (5, 33));
        let mut kept = rows(30, with_zeros(&far, 1, 0));
        assert_eq!((leave_out(&mut kept, |row| *row), kept.len()), (0, 34));
    }
}
