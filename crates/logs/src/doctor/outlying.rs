//! Stops that are far from all others: places such as -9999, -9999, which many tables write where they know none.

use sextant_channel::Position;

use super::distance_law::median;
use super::finding::Finding;
use super::survey::{Points, Survey};
use crate::place::distance::{extent_m, plane_m};
use crate::place::without_fix::is_origin;

/// Places are far from the others if they are so many times their extent away, and so far (m).
const TIMES: f64 = 5.0;
const LEAST_M: f64 = 20.0;
/// At most one in so many places is far off, or one; and at least so many others are left.
const ONE_IN: usize = 20;
const LEAST_OTHERS: usize = 4;

/// What is odd of stops that are far from all others. Those at x = y = 0 have a check of their own, because surveys start there.
pub(super) fn finding(survey: &Survey<'_>) -> Option<Finding> {
    if survey.points != Points::Stops {
        return None;
    }
    let stops: Vec<Position> = survey.robots.iter().flatten().map(|(_, place)| *place).collect();
    let Outlying { places, others } = Outlying::among(&stops)?;
    let nearest_m = |from: &Position| others.iter().map(|other| plane_m(*from, *other)).fold(f64::INFINITY, f64::min);
    let away_m = places.iter().map(nearest_m).fold(f64::INFINITY, f64::min);
    let count = stops.iter().filter(|stop| places.iter().any(|place| is_same(**stop, *place))).count();
    let (first, are) = (places[0], if count == 1 { "is" } else { "are" });
    let further = if places.len() > 1 { " and farther out" } else { "" };
    Some(Finding {
        check: "outlying-stops",
        odd: format!(
            "{count} of {} stops {are} at x = {} and y = {}{further}, {away_m:.0} m from all others, which are within {:.0} m",
            stops.len(),
            rounded(first.x_m),
            rounded(first.y_m),
            extent_m(others.iter().copied())
        ),
        cost: "what was heard there counts as heard that far away, and the map reaches that far".to_owned(),
        remedy: "correct these places, or remove the rows if the place is not known".to_owned(),
    })
}

/// Different places that are far off, from the nearest, and the others.
struct Outlying {
    places: Vec<Position>,
    others: Vec<Position>,
}

impl Outlying {
    fn among(stops: &[Position]) -> Option<Self> {
        let mut places: Vec<Position> = stops.iter().copied().filter(|place| !is_origin(*place)).collect();
        if places.is_empty() {
            return None;
        }
        let along = |of: fn(&Position) -> f64| median(places.iter().map(of).collect());
        let middle = Position::new(along(|place| place.x_m), along(|place| place.y_m), 0.0);
        let away_m = |place: &Position| plane_m(*place, middle);
        let order = |a: &Position, b: &Position| a.x_m.total_cmp(&b.x_m).then(a.y_m.total_cmp(&b.y_m));
        places.sort_by(|a, b| away_m(a).total_cmp(&away_m(b)).then_with(|| order(a, b)));
        places.dedup_by(|a, b| is_same(*a, *b));
        let most = (places.len() / ONE_IN).max(1);
        let least = places.len().saturating_sub(most).max(LEAST_OTHERS);
        let is_far = |&at: &usize| {
            let gap_m = away_m(&places[at]) - away_m(&places[at - 1]);
            gap_m > LEAST_M.max(TIMES * extent_m(places[..at].iter().copied()))
        };
        let first = (least..places.len()).find(is_far)?;
        let far = places.split_off(first);
        Some(Self { places: far, others: places })
    }
}

/// To a millimetre.
fn rounded(value_m: f64) -> f64 {
    (value_m * 1e3).round() / 1e3 + 0.0
}

fn is_same(a: Position, b: Position) -> bool {
    plane_m(a, b) <= 0.0
}

#[cfg(test)]
mod tests {
    use sextant_channel::ReceptionLog;
    use sextant_kernel::SimTime;

    use super::*;

    fn told(places: impl IntoIterator<Item = [f64; 2]>) -> Option<Finding> {
        let log = ReceptionLog::new(Vec::new(), Vec::new(), Vec::new(), Vec::new()).unwrap();
        let timed = |[x, y]: [f64; 2]| (SimTime::ZERO, Position::new(x, y, 0.0));
        let robots = vec![places.into_iter().map(timed).collect()];
        finding(&Survey { robots, points: Points::Stops, plane: None, log: &log })
    }

    /// A hall of 8 by 10 m.
    fn hall() -> Vec<[f64; 2]> {
        (0..33_u8).map(|i| [0.8 * f64::from(i % 11), 5.0 * f64::from(i / 11)]).collect()
    }

    #[test]
    fn stops_beyond_all_others_are_named_with_their_place() {
        assert_eq!(told(hall()), None);
        let found = told(hall().into_iter().chain([[-9999.0; 2]])).unwrap();
        assert!(
            found.odd.starts_with("1 of 34 stops is at x = -9999 and y = -9999, 14141 m from all others"),
            "{found}"
        );
        let found = told([[999.0; 2]; 3].into_iter().chain(hall())).unwrap();
        assert!(found.odd.starts_with("3 of 36 stops are at x = 999 and y = 999, 1"), "{found}");
    }

    #[test]
    fn a_base_and_a_second_site_are_no_outliers() {
        let far: Vec<[f64; 2]> = hall().iter().map(|[x, y]| [x + 500.0, y + 500.0]).collect();
        assert_eq!(told([[0.0; 2]].into_iter().chain(far.clone())), None, "a survey from its base");
        assert_eq!(told(hall().into_iter().chain(far.into_iter().take(8))), None, "two sites");
        assert_eq!(told(hall().into_iter().chain([[60.0, 10.0]])), None, "a stop in the yard");
        assert_eq!(told([[1.0, 1.0], [2.0, 1.0], [900.0, 0.0]]), None, "too few to tell");
    }
}
