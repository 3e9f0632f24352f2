//! The courses of robots, and whether two of them come near each other.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

/// Where a robot was when, in the order of time; between two instants it drives straight at constant speed.
pub(super) type Course = Vec<(SimTime, Position)>;

/// Frames that nodes had under way at the end of a course are over so much later.
const AFTERMATH: Duration = Duration::from_secs(1);

/// Whether two robots are ever within `apart_m` of each other while both are under way.
pub(super) fn meet(first: &Course, second: &Course, apart_m: f64) -> bool {
    let (Some(ends), Some(other_ends)) = (ends(first), ends(second)) else { return false };
    let (from, to) = (ends.0.max(other_ends.0), ends.1.min(other_ends.1) + AFTERMATH);
    let mut instants: Vec<SimTime> = (first.iter().chain(second).map(|&(time, _)| time))
        .filter(|time| (from..=to).contains(time))
        .chain([from, to])
        .collect();
    instants.sort_unstable();
    instants.windows(2).any(|span| {
        let apart = |time| at(second, time) - at(first, time);
        let (start, end) = (apart(span[0]), apart(span[1]));
        least_m(start, end) <= apart_m
    })
}

/// When a course begins and ends.
fn ends(course: &Course) -> Option<(SimTime, SimTime)> {
    Some((course.first()?.0, course.last()?.0))
}

/// Where a robot is at a time.
fn at(course: &Course, time: SimTime) -> Position {
    let next = course.partition_point(|&(known, _)| known <= time);
    let (before, place) = course[next.saturating_sub(1)];
    match course.get(next) {
        Some(&(after, there)) if next > 0 => {
            let share = (time - before).as_secs_f64() / (after - before).as_secs_f64();
            place + (there - place) * share
        }
        _ => place,
    }
}

/// Least distance from the origin of a point that moves straight from one place to another (m).
fn least_m(from: Position, to: Position) -> f64 {
    let way = to - from;
    let square = way.x_m * way.x_m + way.y_m * way.y_m + way.z_m * way.z_m;
    let toward = -(from.x_m * way.x_m + from.y_m * way.y_m + from.z_m * way.z_m);
    let share = if square > 0.0 { (toward / square).clamp(0.0, 1.0) } else { 0.0 };
    (from + way * share).length_m()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(points: &[(u64, f64, f64)]) -> Course {
        let point = |&(s, x, y)| (SimTime::ZERO + Duration::from_secs(s), Position::new(x, y, 0.0));
        points.iter().map(point).collect()
    }

    #[test]
    fn robots_that_pass_each_other_meet_and_those_that_follow_do_not() {
        let east = course(&[(0, 0.0, 0.0), (10, 10.0, 0.0)]);
        let west = course(&[(0, 10.0, 1.0), (10, 0.0, 1.0)]);
        assert!(meet(&east, &west, 1.01) && !meet(&east, &west, 0.99));
        // The same way, 20 s later: they never are there at once.
        let later = course(&[(20, 0.0, 0.0), (30, 10.0, 0.0)]);
        assert!(!meet(&east, &later, 5.0));
        let behind = course(&[(0, -3.0, 0.0), (10, 7.0, 0.0)]);
        assert!(meet(&east, &behind, 3.01) && !meet(&east, &behind, 2.99));
    }
}
