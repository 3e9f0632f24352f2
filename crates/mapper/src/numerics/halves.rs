//! Places in an order in which neighbours follow each other.

use sextant_channel::Position;

/// Puts the numbers of `places` into an order in which neighbours follow each other: they are cut into halves by their wider axis
/// in the plane again and again.
pub(crate) fn halve(part: &mut [usize], places: &[Position]) {
    if part.len() < 2 {
        return;
    }
    let along = |place: usize, axis: usize| <[f64; 3]>::from(places[place])[axis];
    let width_m = |axis: usize| {
        let ends = part.iter().map(|&place| along(place, axis));
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let axis = usize::from(width_m(0) < width_m(1));
    part.sort_by(|&a, &b| along(a, axis).total_cmp(&along(b, axis)).then(a.cmp(&b)));
    let (low, high) = part.split_at_mut(part.len() / 2);
    halve(low, places);
    halve(high, places);
}
