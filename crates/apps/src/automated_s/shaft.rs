//! Where a robot climbs from one layer to the next.

use sextant_channel::Position;

use super::visit::Visit;

/// Places whose heights differ by less are in one layer (m).
const LEVEL_M: f64 = 1e-3;
/// A place is in the midst of a layer if it heard this share of the most nodes that any place there heard.
const IN_THE_MIDST: f64 = 0.75;

/// Where a robot with these `visits` leaves the layer at `z_m` by a climb of `climb_m` in the direction of `up`, 1 or -1:
/// the stop nearest to `here`, of those in the midst of the layer, from which the way is free, and how far (m). If it is
/// free from none of them, from any other stop that hears somebody, or at least half-way from the one from which it is
/// farthest.
pub(super) fn shaft(
    visits: &[Visit],
    here: Position,
    z_m: f64,
    climb_m: f64,
    up: f64,
    allowed: impl Fn(Position) -> bool,
) -> Option<(Position, f64)> {
    let in_layer = || {
        let hearing = visits.iter().filter(|visit| (visit.place.z_m - z_m).abs() < LEVEL_M && !visit.is_silent);
        hearing.filter(|visit| allowed(visit.place + Position::new(0.0, 0.0, up * climb_m)))
    };
    let nearest = |least: f64| {
        in_layer()
            .filter(|visit| as_f64(visit.audible) >= least && visit.clear_towards_m(up) >= climb_m)
            .min_by(|a, b| a.place.distance_m(here).total_cmp(&b.place.distance_m(here)))
    };
    let most = as_f64(in_layer().map(|visit| visit.audible).max()?);
    if let Some(visit) = nearest(IN_THE_MIDST * most).or_else(|| nearest(0.0)) {
        return Some((visit.place, climb_m));
    }
    let freest = in_layer().max_by(|a, b| a.clear_towards_m(up).total_cmp(&b.clear_towards_m(up)))?;
    let free_m = freest.clear_towards_m(up);
    (free_m >= 0.5 * climb_m).then_some((freest.place, free_m))
}

fn as_f64(nodes: usize) -> f64 {
    nodes as f64
}
