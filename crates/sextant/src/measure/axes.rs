//! Whether a map and the true places differ by their axes: swapped, mirrored, or in other units.

use sextant_channel::Position;
use sextant_mapper::{Reflection, Similarity};

use sextant_logs::doctor::Finding;

/// An alignment that explains the errors leaves at most this share of them, of at least so many nodes.
const EXPLAINED: f64 = 0.4;
const LEAST: usize = 5;
/// The errors that it leaves are at most this share of the spread of the true places: a poor map is not excused by its axes.
const MOST_LEFT: f64 = 0.15;
/// Origins differ if the middles are at least so far apart (m), and so many times as far as the errors that are left.
const APART_M: f64 = 1.0;
const APART: f64 = 5.0;
/// Units that are mistaken for metres, and what a metre is in them.
const UNITS: [(f64, &str); 4] =
    [(100.0, "centimetres"), (1000.0, "millimetres"), (1.0 / 0.3048, "feet"), (1e-3, "kilometres")];
/// A scale is that of a unit if it differs by at most this factor; a scale within this factor of 1 is 1.
const SAME: f64 = 1.25;
/// An axis is turned onto another if the cosine between them is at least this.
const ALONG: f64 = 0.94;

/// What is odd if a similarity brings the mapped `places` far closer to `truth`, both by node. In the plane. If the path is the odometry
/// of a file with the name `odometry`, its drift may be why.
#[must_use]
pub(crate) fn axes(
    truth: &[Option<Position>],
    places: &[Option<Position>],
    odometry: Option<&str>,
) -> Option<Finding> {
    let flat = |place: Position| Position::new(place.x_m, place.y_m, 0.0);
    let pair = |(truth, place): (&Option<Position>, &Option<Position>)| Some((flat((*place)?), flat((*truth)?)));
    let pairs: Vec<(Position, Position)> = truth.iter().zip(places).filter_map(pair).collect();
    if pairs.len() < LEAST {
        return None;
    }
    let error_m = |of: &dyn Fn(Position) -> Position| {
        let mut errors: Vec<f64> = pairs.iter().map(|&(place, truth)| of(place).distance_m(truth)).collect();
        errors.sort_by(f64::total_cmp);
        errors[errors.len() / 2]
    };
    let before_m = error_m(&|place| place);
    let best = Similarity::fit(&pairs, Reflection::Allowed).ok()?;
    let after_m = error_m(&|place| best.apply(place));
    // The mirror image must be needed, not only be allowed.
    let is_needed = |best: &Similarity| match Similarity::fit(&pairs, Reflection::Forbidden) {
        Ok(kept) if mirrors(best) => after_m < EXPLAINED * error_m(&|place| kept.apply(place)),
        _ => true,
    };
    if after_m > EXPLAINED * before_m || after_m > MOST_LEFT * spread_m(&pairs) || !is_needed(&best) {
        return None;
    }
    let apart = pairs.iter().fold(Position::ORIGIN, |sum, &(place, truth)| sum + (truth - place));
    let apart_m = apart.length_m() / pairs.len() as f64;
    let is_moved = apart_m >= APART_M.max(APART * after_m);
    let (what, remedy) = described(&best, is_moved.then_some(apart_m))?;
    // Drift turns and moves a map, and neither mirrors it nor changes its unit.
    let drift = odometry.filter(|_| !mirrors(&best) && is_near(best.scale, 1.0));
    let cost = "the errors against the true positions are those of the axes, not of the map".to_owned();
    let (cost, remedy) = match drift {
        None => (cost, remedy),
        Some(name) => (
            format!("if so, {cost}; but the path is the odometry of {name}, whose drift turns and moves a map alike"),
            format!("{remedy}; or take the drift off (`estimate_path`, with places of nodes in `known`)"),
        ),
    };
    Some(Finding {
        check: "axes",
        odd: format!(
            "the places of the log and the true positions seem to differ by their axes: {what} ({before_m:.2} m becomes \
             {after_m:.2} m in the median of {} nodes)",
            pairs.len()
        ),
        cost,
        remedy,
    })
}

/// The median distance of true places from their middle (m); the true place is the second of a pair.
fn spread_m(pairs: &[(Position, Position)]) -> f64 {
    let sum = pairs.iter().fold(Position::ORIGIN, |sum, &(_, truth)| sum + truth);
    let middle = sum * (1.0 / pairs.len() as f64);
    let mut away: Vec<f64> = pairs.iter().map(|(_, truth)| truth.distance_m(middle)).collect();
    away.sort_by(f64::total_cmp);
    away[away.len() / 2]
}

/// Whether two scales are one.
fn is_near(value: f64, of: f64) -> bool {
    value / of < SAME && of / value < SAME
}

fn mirrors(similarity: &Similarity) -> bool {
    let [[a, b, _], [c, d, _], _] = similarity.rotation;
    a * d - b * c < 0.0
}

/// What a similarity from the map to the truth does, and what undoes it; `None` if it is none that a mistake makes. Their
/// middles are `apart_m` from each other, if that is another origin.
fn described(similarity: &Similarity, apart_m: Option<f64>) -> Option<(String, String)> {
    let [[xx, xy, _], [yx, yy, _], _] = similarity.rotation;
    let is_along = |cosine: f64| cosine.abs() >= ALONG;
    let axes = if is_along(xx) && is_along(yy) {
        match (xx > 0.0, yy > 0.0) {
            (true, true) => None,
            (false, true) => Some(("x is mirrored", "change the sign of `x_m`")),
            (true, false) => Some(("y is mirrored", "change the sign of `y_m`")),
            (false, false) => Some(("both axes are reversed", "change the signs of `x_m` and `y_m`")),
        }
    } else if is_along(xy) && is_along(yx) {
        Some(match (xy > 0.0, yx > 0.0) {
            (true, true) => ("x and y are swapped", "swap the columns `x_m` and `y_m` (or `lat` and `lon`)"),
            (false, false) => {
                ("x and y are swapped and reversed", "swap the columns `x_m` and `y_m` and change both signs")
            }
            _ => ("the axes are turned by 90 degrees", "swap the columns `x_m` and `y_m` and change one sign"),
        })
    } else if mirrors(similarity) {
        Some(("one is a mirror image of the other, turned", "change the sign of `x_m`, and turn the places"))
    } else {
        let degrees = libm::atan2(yx, xx).to_degrees();
        (degrees.abs() > 15.0).then_some(("one is turned against the other", "turn the places into one frame"))
    };
    let scale = similarity.scale;
    let units = if is_near(scale, 1.0) {
        None
    } else {
        let log = UNITS.iter().find(|(in_a_metre, _)| is_near(1.0 / scale, *in_a_metre));
        let truth = UNITS.iter().find(|(in_a_metre, _)| is_near(scale, *in_a_metre));
        match (log, truth) {
            (Some((in_a_metre, name)), _) => Some((
                format!("the log seems to be in {name}"),
                format!("multiply the places of the log by {}", rounded(1.0 / in_a_metre)),
            )),
            (_, Some((in_a_metre, name))) => Some((
                format!("the true positions seem to be in {name}"),
                format!("multiply the true positions by {}", rounded(1.0 / in_a_metre)),
            )),
            _ if (0.5..=2.0).contains(&scale) => None,
            // No unit: the map is wrong.
            _ => return None,
        }
    };
    match (axes, units) {
        (Some((what, remedy)), None) => Some((what.to_owned(), remedy_of(remedy))),
        (Some((what, remedy)), Some((unit, factor))) => {
            Some((format!("{what}, and {unit}"), format!("{}, and {factor}", remedy_of(remedy))))
        }
        (None, Some((unit, factor))) => Some((unit, factor)),
        // A map that is shrunk towards its middle is a poor one.
        (None, None) if !is_near(scale, 1.0) => None,
        (None, None) => apart_m.map(|apart_m| {
            (format!("their origins are {apart_m:.0} m apart"), remedy_of("give both from one origin"))
        }),
    }
}

/// To four decimals.
fn rounded(factor: f64) -> f64 {
    (factor * 1e4).round() / 1e4
}

fn remedy_of(what: &str) -> String {
    format!("{what}, in the log or in the file of true positions")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes of a hall, and the errors of a map of them.
    fn nodes() -> Vec<(Position, Position)> {
        let node = |i: u8| {
            let (i, j) = (f64::from(i % 4), f64::from(i / 4));
            let truth = Position::new(2.0 + 5.0 * i + 0.7 * j, 1.0 + 3.1 * j + 0.3 * i * i, 1.5);
            (truth, Position::new(0.4 * libm::sin(7.0 * i + j), 0.4 * libm::cos(3.0 * j - i), 0.0))
        };
        (0..12).map(node).collect()
    }

    fn told(change: impl Fn(Position) -> Position) -> Option<Finding> {
        told_of(None, change)
    }

    fn told_of(odometry: Option<&str>, change: impl Fn(Position) -> Position) -> Option<Finding> {
        let nodes = nodes();
        let truth: Vec<_> = nodes.iter().map(|(truth, _)| Some(*truth)).collect();
        let places: Vec<_> = nodes.iter().map(|&(truth, error)| Some(change(truth + error))).collect();
        axes(&truth, &places, odometry)
    }

    #[test]
    fn each_mistake_of_axes_and_units_is_told_with_what_undoes_it() {
        assert_eq!(told(|at| at), None);
        type Change = fn(Position) -> Position;
        let cases: [(&str, &str, Change); 7] = [
            ("x and y are swapped", "swap the columns `x_m` and `y_m`", |at| Position::new(at.y_m, at.x_m, 0.0)),
            ("x is mirrored", "change the sign of `x_m`", |at| Position::new(-at.x_m, at.y_m, 0.0)),
            ("y is mirrored", "change the sign of `y_m`", |at| Position::new(at.x_m, -at.y_m, 0.0)),
            ("the log seems to be in centimetres", "the places of the log by 0.01", |at| at * 100.0),
            ("the log seems to be in millimetres", "the places of the log by 0.001", |at| at * 1000.0),
            ("the log seems to be in feet", "the places of the log by 0.3048", |at| at * (1.0 / 0.3048)),
            ("the true positions seem to be in feet", "the true positions by 0.3048", |at| at * 0.3048),
        ];
        for (what, remedy, change) in cases {
            let found = told(change).unwrap_or_else(|| panic!("{what} is not found"));
            assert!(found.odd.contains(what) && found.remedy.contains(remedy), "{found}");
        }
        let both = told(|at| Position::new(at.y_m, at.x_m, 0.0) * 100.0).unwrap();
        assert!(both.odd.contains("x and y are swapped, and the log seems to be in centimetres"), "{both}");
        let shifted = told(|at| at + Position::new(40.0, 30.0, 0.0)).unwrap();
        assert!(shifted.odd.contains("their origins are 50 m apart"), "{shifted}");
    }

    #[test]
    fn origins_are_told_only_if_they_are_clearly_apart() {
        assert_eq!(told(|at| at + Position::new(0.6, 0.6, 0.0)), None, "less than a metre");
        assert!(told(|at| at + Position::new(3.0, 3.0, 0.0)).is_some());
    }

    #[test]
    fn odometry_that_drifts_may_be_what_turns_and_moves_a_map() {
        let turned = |at: Position| Position::new(0.8 * at.x_m - 0.6 * at.y_m, 0.6 * at.x_m + 0.8 * at.y_m, 0.0);
        let moved = |at: Position| at + Position::new(40.0, 30.0, 0.0);
        for change in [turned as fn(Position) -> Position, moved] {
            let sure = told(change).unwrap();
            assert!(!sure.cost.starts_with("if so") && !sure.remedy.contains("`estimate_path`"), "{sure}");
            let doubtful = told_of(Some("odometry.csv"), change).unwrap();
            assert!(doubtful.cost.starts_with("if so") && doubtful.remedy.contains("`estimate_path`"), "{doubtful}");
        }
        // No drift swaps axes.
        let swapped = |at: Position| Position::new(at.y_m, at.x_m, 0.0);
        assert_eq!(told_of(Some("odometry.csv"), swapped), told(swapped));
    }

    #[test]
    fn a_scale_of_no_unit_and_large_errors_are_the_map() {
        let middle = Position::new(10.0, 6.0, 0.0);
        assert_eq!(told(|at| (at - middle) * 6.5), None, "no unit");
        // Reversed, with errors of 3 m: strengths without their sign.
        let reversed = |at: Position| {
            let angle = 12.9 * at.x_m + 78.2 * at.y_m;
            (middle - at) * 1.1 + middle + Position::new(5.0 * libm::sin(angle), 5.0 * libm::cos(1.7 * angle), 0.0)
        };
        assert_eq!(told(reversed), None, "reversed");
    }

    #[test]
    fn a_poor_map_is_not_taken_for_wrong_axes() {
        let poor = |seed: f64| {
            told(|at| {
                let angle = seed + 12.9 * at.x_m + 78.2 * at.y_m;
                Position::new(10.0 + 9.0 * libm::sin(angle), 6.0 + 5.0 * libm::cos(1.7 * angle), 0.0)
            })
        };
        assert!((0..40_u8).all(|seed| poor(f64::from(seed)).is_none()));
        // A map that is shrunk towards its middle is no other unit.
        assert_eq!(told(|at| (at - Position::new(10.0, 6.0, 0.0)) * 0.6 + Position::new(10.0, 6.0, 0.0)), None);
    }
}
