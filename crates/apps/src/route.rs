//! The way round obstacles: a shortest path on a lattice, with its needless corners removed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use sextant_channel::{Bounds, Position};

/// Length of a step of the lattice in the integer units of cost.
const STEP: u64 = 1_000_000;
/// Length of a diagonal step, √2 steps.
const DIAGONAL: u64 = 1_414_214;
/// Maximum number of vertices of the lattice. If there would be more, the step is made longer.
const MAX_VERTICES: f64 = 1e6;
/// The cost of a vertex to which no way is known.
const UNKNOWN: u64 = u64::MAX;

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
    /// lattice. The search is A* with moves to eight neighbours at the height of `from` (Hart, Nilsson and Raphael
    /// 1968); corners that are not needed are then removed.
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
        let mut cost = vec![UNKNOWN; lattice.columns * lattice.rows];
        let mut before = vec![usize::MAX; cost.len()];
        let mut open = BinaryHeap::new();
        cost[lattice.start] = 0;
        open.push(Reverse((lattice.least_cost(lattice.start, to, reach_m), 0, lattice.start)));
        while let Some(Reverse((_, spent, vertex))) = open.pop() {
            if spent > cost[vertex] {
                continue;
            }
            let place = lattice.place(vertex);
            if place.distance_m(to) <= reach_m && passable(place, to) {
                let mut way = vec![to, place];
                let mut vertex = vertex;
                while before[vertex] != usize::MAX {
                    vertex = before[vertex];
                    way.push(lattice.place(vertex));
                }
                way.reverse();
                return Some(pulled_straight(&way, passable));
            }
            for (neighbour, step) in lattice.neighbours(vertex) {
                let total = spent + step;
                if total < cost[neighbour] && passable(place, lattice.place(neighbour)) {
                    cost[neighbour] = total;
                    before[neighbour] = vertex;
                    open.push(Reverse((total + lattice.least_cost(neighbour, to, reach_m), total, neighbour)));
                }
            }
        }
        None
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
    columns: usize,
    rows: usize,
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
        Self { from, step_m, columns, rows, start: whole(south) * columns + whole(west) }
    }

    fn place(&self, vertex: usize) -> Position {
        let (column, row) = (vertex % self.columns, vertex / self.columns);
        let (west, south) = (self.start % self.columns, self.start / self.columns);
        let (east, north) = (number(column) - number(west), number(row) - number(south));
        self.from + Position::new(east * self.step_m, north * self.step_m, 0.0)
    }

    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = (usize, u64)> {
        const MOVES: [(isize, isize, u64); 8] = [
            (1, 0, STEP),
            (0, 1, STEP),
            (-1, 0, STEP),
            (0, -1, STEP),
            (1, 1, DIAGONAL),
            (-1, 1, DIAGONAL),
            (-1, -1, DIAGONAL),
            (1, -1, DIAGONAL),
        ];
        let (column, row, columns, rows) = (vertex % self.columns, vertex / self.columns, self.columns, self.rows);
        MOVES.into_iter().filter_map(move |(east, north, step)| {
            let column = column.checked_add_signed(east).filter(|&column| column < columns)?;
            let row = row.checked_add_signed(north).filter(|&row| row < rows)?;
            Some((row * columns + column, step))
        })
    }

    /// A lower bound of the remaining cost: the straight line without the last drive.
    fn least_cost(&self, vertex: usize, to: Position, reach_m: f64) -> u64 {
        let left_m = (self.place(vertex).distance_m(to) - reach_m).max(0.0);
        whole(left_m / self.step_m * 1e6) as u64
    }
}

/// The way without corners that are not needed, and without its first place.
fn pulled_straight(way: &[Position], passable: impl Fn(Position, Position) -> bool) -> Vec<Position> {
    let mut corners = Vec::new();
    let mut here = 0;
    while here + 1 < way.len() {
        here = (here + 2..way.len()).rev().find(|&there| passable(way[here], way[there])).unwrap_or(here + 1);
        corners.push(way[here]);
    }
    corners
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
