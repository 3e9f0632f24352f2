//! How fast robots drive, by their places and times.

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::finding::Finding;
use super::node_fit::plane_m;

/// No robot, drone or car with a receiver is usually faster (m/s).
const FASTEST: f64 = 40.0;
/// A single leg is a jump if it is faster than this (m/s), so many times as fast as usual, longer than this (m), and longer
/// than this share of the extent of the path.
const JUMP: f64 = 15.0;
const JUMP_TIMES: f64 = 10.0;
const JUMP_M: f64 = 2.0;
const JUMP_SHARE: f64 = 0.02;
/// Nothing that drives is always slower (m/s).
const SLOWEST: f64 = 0.003;
/// A path has at least so many legs.
const LEAST: usize = 5;

/// Where a robot was at a time.
pub(crate) type Place = (SimTime, Position);

/// A straight line between two places.
struct Leg {
    from: Place,
    length_m: f64,
    span_s: f64,
}

/// What is odd of the speeds on `paths`. `what` are their points: poses, whose legs are drives, or stops, at which robots
/// stay.
pub(crate) fn finding(paths: &[Vec<Place>], what: &str) -> Option<Finding> {
    let of_pair = |pair: &[Place]| {
        let span_s = pair[1].0.saturating_since(pair[0].0).as_secs_f64();
        (span_s > 0.0).then(|| Leg { from: pair[0], length_m: plane_m(pair[0].1, pair[1].1), span_s })
    };
    let legs: Vec<Leg> =
        paths.iter().flat_map(|path| path.windows(2)).filter_map(of_pair).filter(|leg| leg.length_m > 0.0).collect();
    if legs.len() < LEAST {
        return None;
    }
    let mut speeds: Vec<f64> = legs.iter().map(|leg| leg.length_m / leg.span_s).collect();
    speeds.sort_by(f64::total_cmp);
    let usual = speeds[speeds.len() / 2];
    let high = speeds[speeds.len() * 9 / 10];
    if usual > FASTEST {
        return Some(Finding {
            check: "speed",
            odd: format!("the robot usually moves at {usual:.1} m/s between {what}"),
            cost:
                "the map is as many times too large as the path, or packets are placed far from where they were heard"
                    .to_owned(),
            remedy: format!("places need metres and times seconds: {}", unit(usual)),
        });
    }
    if what == POSES && high < SLOWEST {
        return Some(Finding {
            check: "speed",
            odd: format!("the robot moves at {high:.1e} m/s or less on nine tenths of its path"),
            cost: "the map is as many times too small as the path, or stops are far too long".to_owned(),
            remedy: "places need metres and times seconds: multiply places in kilometres by 1000, divide times in \
                     milliseconds by 1000"
                .to_owned(),
        });
    }
    jumps(&legs, usual, what)
}

/// The points of a path of which each robot has many a second.
pub(crate) const POSES: &str = "poses";

/// What is odd of single legs that are far too fast.
fn jumps(legs: &[Leg], usual: f64, what: &str) -> Option<Finding> {
    let along = |axis: fn(Position) -> f64| {
        let values = legs.iter().map(|leg| axis(leg.from.1));
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    let extent_m = libm::hypot(along(|at| at.x_m), along(|at| at.y_m));
    let is_jump = |leg: &&Leg| {
        leg.length_m / leg.span_s > JUMP.max(JUMP_TIMES * usual) && leg.length_m > JUMP_M.max(JUMP_SHARE * extent_m)
    };
    let fastest =
        legs.iter().filter(is_jump).max_by(|a, b| (a.length_m / a.span_s).total_cmp(&(b.length_m / b.span_s)))?;
    let count = legs.iter().filter(is_jump).count();
    Some(Finding {
        check: "speed",
        odd: format!(
            "the path jumps {count} times, by up to {:.1} m/s ({:.1} m in {:.2} s after {} s), where the robot usually moves \
             at {usual:.2} m/s",
            fastest.length_m / fastest.span_s,
            fastest.length_m,
            fastest.span_s,
            super::super::instant::format(fastest.from.0)
        ),
        cost: "what was heard near a jump is placed up to as far away from where it was heard".to_owned(),
        remedy: format!("remove the {what} that are outliers, or smooth the path (a robot cannot jump)"),
    })
}

/// The unit that explains a speed that is too high.
fn unit(usual: f64) -> &'static str {
    // A robot drives at about 0.7 m/s.
    let off = |times: f64| libm::log(usual / times / 0.7).abs();
    if off(100.0).min(off(1000.0)) > libm::log(10.0) {
        "check the units of both"
    } else if off(100.0) < off(1000.0) {
        "if the places are in centimetres, divide them by 100"
    } else {
        "if the places are in millimetres (or the times in thousands of seconds), divide them by 1000"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(step_m: f64, changed: impl Fn(usize, Position) -> Position) -> Vec<Vec<Place>> {
        let place = |i: usize| {
            let place = Position::new(step_m * (i as f64), 3.0, 0.0);
            (SimTime::from_nanos(i as u64 * 1_000_000_000), changed(i, place))
        };
        vec![(0..100).map(place).collect()]
    }

    #[test]
    fn a_path_in_centimetres_is_too_fast() {
        assert_eq!(finding(&drive(0.5, |_, at| at), POSES), None);
        assert_eq!(finding(&drive(25.0, |_, at| at), POSES), None, "a car");
        let found = finding(&drive(49.0, |_, at| at), POSES).unwrap();
        assert_eq!(found.odd, "the robot usually moves at 49.0 m/s between poses");
        assert!(found.remedy.contains("centimetres, divide them by 100"), "{found}");
        let found = finding(&drive(490.0, |_, at| at), POSES).unwrap();
        assert!(found.remedy.contains("millimetres") && found.remedy.contains("by 1000"), "{found}");
        let found = finding(&drive(5e-4, |_, at| at), POSES).unwrap();
        assert!(found.odd.contains("5.0e-4 m/s"), "{found}");
    }

    #[test]
    fn a_place_beside_the_path_is_a_jump() {
        let found =
            finding(&drive(0.5, |i, at| if i == 40 { at + Position::new(0.0, 49.0, 0.0) } else { at }), POSES);
        let found = found.unwrap();
        assert!(
            found.odd.starts_with("the path jumps 2 times, by up to 49.0 m/s (49.0 m in 1.00 s after"),
            "{found}"
        );
    }
}
