//! The way round obstacles: a shortest path on a lattice, with its needless corners removed.

use sextant_channel::{Bounds, Position};

use crate::a_star::{self, Graph, SquareLattice};

/// Maximum number of vertices of the lattice. If there would be more, the step is made longer.
const MAX_VERTICES: f64 = 1e6;

/// Where to search for a way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// The way stays within these bounds in x and y. If an end lies outside, the bounds are enlarged to hold it.
    pub(crate) bounds: Bounds,
    /// Step of the lattice (m).
    pub(crate) step_m: f64,
    /// The last drive is straight to the goal, from a vertex that is at most this far from the goal (m).
    pub(crate) reach_m: f64,
}

impl Search {
    /// Places to drive to, in order; the last is `to`. Each drive is `passable`. `None` if there is no way on the
    /// lattice. The search is A* with moves to eight neighbours at the height of `from`; corners that are not needed
    /// are then removed.
    pub(crate) fn way(
        &self,
        from: Position,
        to: Position,
        passable: impl Fn(Position, Position) -> bool,
    ) -> Option<Vec<Position>> {
        if passable(from, to) {
            return Some(vec![to]);
        }
        let lattice = Lattice::new(self, from, to);
        let reach_m = self.reach_m.max(1.5 * lattice.step_m);
        let round = WayRound { lattice: &lattice, to, reach_m, passable: &passable };
        let vertices = a_star::shortest(&round, lattice.start)?.vertices;
        let mut way: Vec<_> = vertices.into_iter().map(|vertex| lattice.place(vertex)).collect();
        way.push(to);
        Some(pulled_straight(&way, passable))
    }
}

impl Search {
    /// As [`way`](Self::way), but between two heights. The way round obstacles is at the height of `to` if the robot
    /// can climb to it where it is, otherwise at the height of `from`.
    pub(crate) fn way_over(
        &self,
        from: Position,
        to: Position,
        passable: impl Fn(Position, Position) -> bool,
    ) -> Option<Vec<Position>> {
        if passable(from, to) {
            return Some(vec![to]);
        }
        let climb = Position { z_m: to.z_m, ..from };
        if climb != from && passable(from, climb) {
            let mut way = self.way(climb, to, passable)?;
            way.insert(0, climb);
            return Some(way);
        }
        let foot = Position { z_m: from.z_m, ..to };
        let mut way = self.way(from, foot, &passable)?;
        if foot != to {
            way.push(to);
            return passable(foot, to).then_some(way);
        }
        Some(way)
    }
}

/// A square lattice with a vertex at the start.
struct Lattice {
    /// Exact place of the vertex `start`.
    from: Position,
    step_m: f64,
    square: SquareLattice,
    start: usize,
}

impl Lattice {
    fn new(search: &Search, from: Position, to: Position) -> Self {
        let ends = Bounds { min: from, max: from }.union(Bounds { min: to, max: to });
        let Bounds { min, max } = search.bounds.union(ends);
        let area_m2 = (max.x_m - min.x_m) * (max.y_m - min.y_m);
        let step_m = search.step_m.max((area_m2 / MAX_VERTICES).sqrt());
        let steps = |length_m: f64| (length_m / step_m).ceil();
        let (west, south) = (steps(from.x_m - min.x_m), steps(from.y_m - min.y_m));
        let columns = whole(west + steps(max.x_m - from.x_m)) + 1;
        let rows = whole(south + steps(max.y_m - from.y_m)) + 1;
        let square = SquareLattice { columns, rows };
        Self { from, step_m, square, start: whole(south) * columns + whole(west) }
    }

    fn place(&self, vertex: usize) -> Position {
        let (column, row) = self.square.column_and_row(vertex);
        let (west, south) = self.square.column_and_row(self.start);
        let (east, north) = (number(column) - number(west), number(row) - number(south));
        self.from + Position::new(east * self.step_m, north * self.step_m, 0.0)
    }
}

/// The search for a way round obstacles on a lattice.
struct WayRound<'a, P> {
    lattice: &'a Lattice,
    to: Position,
    reach_m: f64,
    passable: &'a P,
}

impl<P: Fn(Position, Position) -> bool> Graph for WayRound<'_, P> {
    fn vertices(&self) -> usize {
        self.lattice.square.vertices()
    }

    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = (usize, u64)> {
        self.lattice.square.neighbours(vertex)
    }

    fn is_passable(&self, from: usize, to: usize) -> bool {
        (self.passable)(self.lattice.place(from), self.lattice.place(to))
    }

    /// The straight line without the last drive.
    fn least_cost(&self, vertex: usize) -> u64 {
        let left_m = (self.lattice.place(vertex).distance_m(self.to) - self.reach_m).max(0.0);
        whole(left_m / self.lattice.step_m * 1e6) as u64
    }

    fn is_goal(&self, vertex: usize) -> bool {
        let place = self.lattice.place(vertex);
        place.distance_m(self.to) <= self.reach_m && (self.passable)(place, self.to)
    }
}

/// The way without corners that are not needed, and without its first place.
pub(crate) fn pulled_straight(way: &[Position], passable: impl Fn(Position, Position) -> bool) -> Vec<Position> {
    let mut corners = Vec::new();
    let mut here = 0;
    while here + 1 < way.len() {
        here = (here + 2..way.len()).rev().find(|&there| passable(way[here], way[there])).unwrap_or(here + 1);
        corners.push(way[here]);
    }
    corners
}

/// Distance from `p` to the drive from `a` to `b` (m).
pub(crate) fn distance_to_drive_m(p: Position, a: Position, b: Position) -> f64 {
    let along = b - a;
    let length2 = along.dot(along);
    let share = if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_m(a + along * share)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cast from f64 saturates")]
pub(crate) fn whole(number: f64) -> usize {
    number as usize
}

pub(crate) fn number(steps: usize) -> f64 {
    steps as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a drive passes a wall from (0, -4) to (0, 4) without touching it.
    fn past_the_wall(a: Position, b: Position) -> bool {
        let crosses = (a.x_m <= 0.0) != (b.x_m <= 0.0);
        let share = a.x_m / (a.x_m - b.x_m);
        !crosses || (a.y_m + share * (b.y_m - a.y_m)).abs() > 4.0
    }

    fn search(half_m: f64) -> Search {
        let corner = Position::new(half_m, half_m, 0.0);
        Search { bounds: Bounds { min: corner * -1.0, max: corner }, step_m: 0.25, reach_m: 0.0 }
    }

    #[test]
    fn the_way_round_a_wall_is_as_long_as_two_straight_lines() {
        let (from, to) = (Position::new(-3.0, 0.0, 0.0), Position::new(3.1, 0.0, 0.0));
        let way = search(6.0).way(from, to, past_the_wall).expect("a way");
        let mut length_m = 0.0;
        let mut here = from;
        for &place in &way {
            assert!(past_the_wall(here, place));
            length_m += here.distance_m(place);
            here = place;
        }
        assert_eq!(here, to);
        let shortest_m = 5.0 + 4_f64.hypot(3.1);
        assert!(length_m >= shortest_m && length_m < 1.05 * shortest_m, "{length_m} for {shortest_m}");
    }

    #[test]
    fn there_is_no_way_through_a_wall_from_border_to_border() {
        let (from, to) = (Position::new(-3.0, 0.0, 0.0), Position::new(3.0, 0.0, 0.0));
        assert_eq!(search(3.9).way(from, to, past_the_wall), None);
        let straight = Position::new(-3.0, 3.0, 0.0);
        assert_eq!(search(3.9).way(from, straight, past_the_wall), Some(vec![straight]));
    }
}
