//! Where a robot climbs from one layer to the next.

use sextant_channel::Position;

use super::visit::Visit;

/// Places are in one layer if their heights differ by less than this (m).
const LEVEL_M: f64 = 1e-3;
/// A stop is in the middle of a layer if it heard at least this share of the highest number of nodes heard at any
/// stop of the layer.
const IN_THE_MIDST: f64 = 0.75;

/// Where a robot with these `visits` leaves the layer at `z_m` by a climb of `climb_m`, and how far it can climb
/// there (m); `up` is 1 or -1. It is the nearest stop to `here`, among those in the middle of the layer, from which
/// the whole climb is free. If there is none, it is the nearest such stop among all that heard a node; if there is
/// none either, the stop with the longest free climb, provided that this is at least half of `climb_m`.
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
