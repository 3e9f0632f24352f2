//! Places at x = y = 0 that are far from all others: a receiver without a fix.

use sextant_channel::Position;

use super::finding::Finding;
use super::node_fit::plane_m;

/// Whether a place is at x = y = 0.
pub(crate) fn is_origin(place: Position) -> bool {
    place.x_m.abs() <= 0.0 && place.y_m.abs() <= 0.0
}

/// How far x = y = 0 is from the nearest of the other `places`, if that is farther than these are from each other.
pub(crate) fn far_m(places: impl Iterator<Item = Position> + Clone) -> Option<f64> {
    let others = places.filter(|&place| !is_origin(place));
    let nearest_m = others.clone().map(|place| plane_m(place, Position::ORIGIN)).fold(f64::INFINITY, f64::min);
    let [low, high] = others.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], at| {
        [[low[0].min(at.x_m), low[1].min(at.y_m)], [high[0].max(at.x_m), high[1].max(at.y_m)]]
    });
    let extent_m = libm::hypot(high[0] - low[0], high[1] - low[1]);
    (nearest_m.is_finite() && nearest_m > extent_m.max(1.0)).then_some(nearest_m)
}

/// Leaves out of `rows` those at x = y = 0, if that is far from all others. `place` is that of a row. Returns how many.
pub(crate) fn leave_out<T>(rows: &mut Vec<T>, place: impl Fn(&T) -> Position) -> usize {
    let before = rows.len();
    if far_m(rows.iter().map(&place)).is_some() {
        rows.retain(|row| !is_origin(place(row)));
    }
    before - rows.len()
}

/// What is odd of `places`, which are `what` (stops or poses) in metres.
pub(crate) fn finding(places: &[Position], what: &str) -> Option<Finding> {
    let count = places.iter().filter(|&&place| is_origin(place)).count();
    let far_m = far_m(places.iter().copied()).filter(|_| count > 0)?;
    Some(Finding {
        check: "no-fix",
        odd: format!(
            "{count} of {} {what} are at x = y = 0, {far_m:.0} m from all others: receivers without a fix write 0, 0",
            places.len()
        ),
        cost: "what was heard there counts as heard that far away".to_owned(),
        remedy: "option `skip_no_fix` leaves these rows out and counts them".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_far_from_all_others_are_rows_without_a_fix() {
        let grid = |x_m: f64| (0..20_u8).map(move |i| Position::new(x_m + f64::from(i), f64::from(i % 5), 0.0));
        let with_zeros = |x_m: f64| grid(x_m).chain([Position::ORIGIN; 3]).collect::<Vec<_>>();
        assert_eq!(finding(&with_zeros(1.0), "stops"), None, "a survey that begins at 0, 0");
        assert_eq!(finding(&grid(5e5).collect::<Vec<_>>(), "stops"), None);
        let found = finding(&with_zeros(5e5), "stops").unwrap();
        assert!(found.odd.starts_with("3 of 23 stops are at x = y = 0, 500000 m from all others"), "{found}");
        assert!(found.remedy.starts_with("option `skip_no_fix`"), "{found}");
    }
}
