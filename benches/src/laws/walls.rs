//! Walls take away, nothing adds.

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::site::HALL_M;
use super::survey::{Listening, SHADOWING, SURROUNDINGS, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "walls";

/// Walls in the hall.
const WALLS: u64 = 9;

/// A straight wall between two places.
pub(super) type Wall = [Position; 2];

/// Walls at random places, along the sides of the hall, each of which takes 5 to 12 dB from every link through it.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let draw = |wall, which| seed.uniform(SURROUNDINGS, [wall, which, 0]);
    let walls: Vec<(Wall, f64)> = (0..WALLS)
        .map(|wall| {
            let from = Position::new(HALL_M[0] * draw(wall, 0), HALL_M[1] * draw(wall, 1), 0.0);
            let length_m = 4.0 + 8.0 * draw(wall, 2);
            let along =
                if wall % 2 == 0 { Position::new(length_m, 0.0, 0.0) } else { Position::new(0.0, length_m, 0.0) };
            ([from, from + along], 5.0 + 7.0 * draw(wall, 3))
        })
        .collect();
    let strength = |node: usize, stop: usize| {
        let link = [site.nodes[node], site.stops[stop]];
        let loss_db: f64 = walls.iter().filter(|(wall, _)| cross(link, *wall)).map(|(_, loss_db)| loss_db).sum();
        site.mean_dbm(node, stop) - loss_db + 2.0 * site.normal(SHADOWING, node, stop)
    };
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}

/// Whether two straight lines between places cross, seen from above.
pub(super) fn cross(a: [Position; 2], b: [Position; 2]) -> bool {
    let side = |[from, to]: [Position; 2], place: Position| {
        (to.x_m - from.x_m) * (place.y_m - from.y_m) - (to.y_m - from.y_m) * (place.x_m - from.x_m)
    };
    let are_apart = |line: [Position; 2], [one, other]: [Position; 2]| side(line, one) * side(line, other) < 0.0;
    are_apart(a, b) && are_apart(b, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_only_between_their_ends() {
        let wall = [Position::new(2.0, -1.0, 0.0), Position::new(2.0, 3.0, 0.0)];
        let link = |y_m| [Position::new(0.0, y_m, 0.0), Position::new(5.0, y_m, 0.0)];
        assert!(cross(link(0.0), wall) && !cross(link(4.0), wall));
        assert!(!cross([Position::ORIGIN, Position::new(1.0, 0.0, 0.0)], wall));
    }
}
