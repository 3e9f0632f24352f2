//! Places of a survey that its robots cannot have been at, because a receiver without a fix writes 0, 0.
//!
//! Of latitudes and longitudes the degrees tell, before they become metres: the first fix is the origin of the plane.

use super::finding::Finding;
use super::survey::Survey;
use crate::place::without_fix::{SEVERAL, is_origin, without_fix_m};

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
    use sextant_channel::{Position, ReceptionLog};
    use sextant_kernel::SimTime;

    use super::super::survey::Points;
    use super::*;
    use crate::LocalPlane;
    use crate::place::without_fix::{TimedPlace, leave_out};

    /// Rows of one robot, one each `step_s` (s).
    fn rows(step_s: u64, places: impl IntoIterator<Item = [f64; 2]>) -> Vec<TimedPlace> {
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
