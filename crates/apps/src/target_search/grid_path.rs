//! A robot's way round the obstacles that it has met.

use sextant_channel::{Bounds, Position};

use crate::a_star::{self, DIAGONAL, Graph, Path, STEP, SquareLattice};
use crate::route::{distance_to_drive_m, number, pulled_straight, whole};

/// Maximum number of cells. If there would be more, they are made larger.
const MAX_CELLS: f64 = 250_000.0;
/// The largest ratio of the length of a way on the lattice to the straight line, 1 / cos 22.5°, rounded up.
const DETOUR: f64 = 1.0824;
/// How many cells a robot in a blocked cell may drive straight to a free one.
const ESCAPE: isize = 2;

/// Square cells over the field, in the plane, and those that a robot cannot enter. Unknown cells are free.
#[derive(Clone, Debug)]
pub(crate) struct CellMap {
    /// Centre of cell 0.
    first: Position,
    cell_m: f64,
    lattice: SquareLattice,
    hull_m: f64,
    is_blocked: Vec<bool>,
    contacts: Vec<Position>,
}

impl CellMap {
    /// Cells of `cell_m` over `field`, for a robot whose hull has the radius `hull_m`. If that would be more than
    /// 250 000, they are larger.
    ///
    /// # Panics
    /// If `cell_m` is not positive.
    #[must_use]
    pub(crate) fn new(field: Bounds, cell_m: f64, hull_m: f64) -> Self {
        assert!(cell_m > 0.0, "the width of a cell must be positive");
        let size = field.max - field.min;
        let count = |length_m: f64, cell_m: f64| (length_m / cell_m).ceil().max(1.0);
        let mut cell_m = cell_m;
        while count(size.x_m, cell_m) * count(size.y_m, cell_m) > MAX_CELLS {
            cell_m *= 1.25;
        }
        let lattice = SquareLattice { columns: whole(count(size.x_m, cell_m)), rows: whole(count(size.y_m, cell_m)) };
        let first = field.min + Position::new(0.5 * cell_m, 0.5 * cell_m, 0.0);
        let is_blocked = vec![false; lattice.vertices()];
        Self { first, cell_m, lattice, hull_m, is_blocked, contacts: Vec::new() }
    }

    /// Learns a point on an obstacle. Cells are blocked whose centres are so near that a robot on its way from one
    /// centre to the next would touch the point. A point near a known one tells nothing new.
    pub(crate) fn add_contact(&mut self, contact: Position) {
        let near_m = 0.25 * self.cell_m;
        if self.contacts.iter().any(|known| known.distance_m(contact) <= near_m) {
            return;
        }
        self.contacts.push(contact);
        // The middle of a diagonal step of √2 cells is nearer to the point than its ends, by Pythagoras.
        let keep_m = (self.hull_m * self.hull_m + 0.5 * self.cell_m * self.cell_m).sqrt();
        let corner = Position::new(keep_m, keep_m, 0.0);
        let (west, south) = self.lattice.column_and_row(self.cell(contact - corner));
        let (east, north) = self.lattice.column_and_row(self.cell(contact + corner));
        for row in south..=north {
            for column in west..=east {
                let cell = row * self.lattice.columns + column;
                if level_distance_m(self.center(cell), contact) < keep_m {
                    self.is_blocked[cell] = true;
                }
            }
        }
    }

    /// Whether the robot knows that it cannot stand at `place`. Places outside the field belong to the nearest cell.
    #[cfg(test)]
    pub(crate) fn is_blocked(&self, place: Position) -> bool {
        self.is_blocked[self.cell(place)]
    }

    /// Places to drive to, in order, on a shortest way through free cells from `from` to a free cell whose centre is
    /// at most `tolerance_m`, or 0.71 cells, from `to`, which is in the field; `None` if there is none. The last place
    /// is `to` itself if nothing known is in its way. Steps go to the eight neighbours, but not diagonally past a
    /// blocked cell; corners that are not needed are then removed. The height is that of `from`. A robot in a blocked
    /// cell first drives to a free one nearby.
    #[must_use]
    pub(crate) fn way(&self, from: Position, to: Position, tolerance_m: f64) -> Option<Vec<Position>> {
        let to = Position { z_m: from.z_m, ..to };
        if self.is_clear(from, to) {
            return Some(vec![to]);
        }
        let path = self.path(from, to, tolerance_m)?;
        let centers = path.vertices.iter().skip(1).map(|&cell| Position { z_m: from.z_m, ..self.center(cell) });
        let mut way: Vec<_> = std::iter::once(from).chain(centers).collect();
        if way.last().is_some_and(|&last| self.is_clear(last, to)) {
            way.push(to);
        }
        Some(pulled_straight(&way, |a, b| self.is_clear(a, b)))
    }

    /// The next place by the rule that the thesis prints (Gunathillake 2018, section 6.3.3): of the eight places at
    /// `step_m` from `from`, the free one with the least F = G + H. G is the length of the step, the same for all, and
    /// H the straight line to `to`, so that obstacles can trap the robot. Among equals (to the micrometre), the first one
    /// counter-clockwise from the x axis. `None` if no place is free.
    #[must_use]
    pub(crate) fn greedy_step(&self, from: Position, to: Position, step_m: f64) -> Option<Position> {
        let places = (0..8_u8).map(|k| {
            let azimuth_rad = f64::from(k) * std::f64::consts::FRAC_PI_4;
            from + Position::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0) * step_m
        });
        let free = places.filter(|&place| self.is_clear(from, place));
        free.min_by_key(|&place| whole(1e6 * level_distance_m(place, to) + 0.5))
    }

    fn path(&self, from: Position, to: Position, tolerance_m: f64) -> Option<Path> {
        let tolerance_m = tolerance_m.max(std::f64::consts::FRAC_1_SQRT_2 * self.cell_m);
        let start = self.cell(from);
        a_star::shortest(&Trip { map: self, from, start, to, tolerance_m }, start)
    }

    /// Whether the robot can drive from `a` to `b` without touching a known point. It may leave one that it touches.
    fn is_clear(&self, a: Position, b: Position) -> bool {
        self.contacts.iter().all(|&contact| {
            let contact = Position { z_m: a.z_m, ..contact };
            let (from_m, to_m) = (a.distance_m(contact), b.distance_m(contact));
            distance_to_drive_m(contact, a, b) >= self.hull_m.min(from_m) && (to_m >= self.hull_m || to_m >= from_m)
        })
    }

    /// The cell that holds `place`, or the nearest one.
    fn cell(&self, place: Position) -> usize {
        let index = |offset_m: f64, count: usize| whole(offset_m / self.cell_m + 0.5).min(count - 1);
        let offset = place - self.first;
        index(offset.y_m, self.lattice.rows) * self.lattice.columns + index(offset.x_m, self.lattice.columns)
    }

    fn center(&self, cell: usize) -> Position {
        let (column, row) = self.lattice.column_and_row(cell);
        self.first + Position::new(number(column), number(row), 0.0) * self.cell_m
    }
}

/// A search for a way.
struct Trip<'a> {
    map: &'a CellMap,
    from: Position,
    /// The cell of `from`.
    start: usize,
    to: Position,
    tolerance_m: f64,
}

impl Trip<'_> {
    fn is_escape(&self, from: usize) -> bool {
        from == self.start && self.map.is_blocked[from]
    }

    /// Cells near the start, and the costs of driving there.
    fn escapes(&self) -> impl Iterator<Item = (usize, u64)> {
        let lattice = self.map.lattice;
        let (column, row) = lattice.column_and_row(self.start);
        let offsets = (-ESCAPE..=ESCAPE).flat_map(|north| (-ESCAPE..=ESCAPE).map(move |east| (east, north)));
        offsets.filter_map(move |(east, north)| {
            let column = column.checked_add_signed(east).filter(|&column| column < lattice.columns)?;
            let row = row.checked_add_signed(north).filter(|&row| row < lattice.rows)?;
            let (x, y) = (east.unsigned_abs() as u64, north.unsigned_abs() as u64);
            Some((row * lattice.columns + column, STEP * x.abs_diff(y) + DIAGONAL * x.min(y)))
        })
    }
}

impl Graph for Trip<'_> {
    fn vertices(&self) -> usize {
        self.map.lattice.vertices()
    }

    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = (usize, u64)> {
        let escapes = self.is_escape(vertex).then(|| self.escapes());
        let steps = escapes.is_none().then(|| self.map.lattice.neighbours(vertex));
        escapes.into_iter().flatten().chain(steps.into_iter().flatten())
    }

    fn is_passable(&self, from: usize, to: usize) -> bool {
        let is_free = |cell: usize| !self.map.is_blocked[cell];
        if self.is_escape(from) {
            let center = Position { z_m: self.from.z_m, ..self.map.center(to) };
            return is_free(to) && self.map.is_clear(self.from, center);
        }
        let lattice = self.map.lattice;
        let ((west, south), (east, north)) = (lattice.column_and_row(from), lattice.column_and_row(to));
        // The two cells beside a straight step are its ends.
        is_free(to) && is_free(north * lattice.columns + west) && is_free(south * lattice.columns + east)
    }

    /// The way without obstacles to the nearest place within the tolerance.
    fn least_cost(&self, vertex: usize) -> u64 {
        let off = self.map.center(vertex) - self.to;
        let (short_m, long_m) = (off.x_m.abs().min(off.y_m.abs()), off.x_m.abs().max(off.y_m.abs()));
        let left_m = (long_m - short_m) * STEP as f64 + short_m * DIAGONAL as f64;
        let tolerance_m = DETOUR * self.tolerance_m * STEP as f64;
        // A little less, for rounding.
        whole((left_m - tolerance_m) / self.map.cell_m * (1.0 - 1e-9)) as u64
    }

    fn is_goal(&self, vertex: usize) -> bool {
        !self.map.is_blocked[vertex] && level_distance_m(self.map.center(vertex), self.to) <= self.tolerance_m
    }
}

/// Distance in the plane (m).
fn level_distance_m(a: Position, b: Position) -> f64 {
    Position { z_m: 0.0, ..a - b }.length_m()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(x_m: f64, y_m: f64) -> Position {
        Position::new(x_m, y_m, 0.0)
    }

    /// Cells of 1 m from (0, 0) to (width, height).
    fn empty(width_m: f64, height_m: f64, hull_m: f64) -> CellMap {
        CellMap::new(Bounds { min: Position::ORIGIN, max: at(width_m, height_m) }, 1.0, hull_m)
    }

    /// The least cost from cell to cell: rounds of relaxation over all pairs of cells until nothing changes.
    fn relaxed(map: &CellMap, from: Position, to: Position, tolerance_m: f64) -> Option<u64> {
        let (columns, rows) = (map.lattice.columns as i64, map.lattice.rows as i64);
        let cell = |x: i64, y: i64| usize::try_from(y * columns + x).unwrap();
        let is_free =
            |x: i64, y: i64| (0..columns).contains(&x) && (0..rows).contains(&y) && !map.is_blocked[cell(x, y)];
        let mut cost = vec![u64::MAX; map.is_blocked.len()];
        cost[map.cell(from)] = 0;
        loop {
            let before = cost.clone();
            for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
                for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)] {
                    if cost[cell(x, y)] < u64::MAX
                        && is_free(x + dx, y)
                        && is_free(x, y + dy)
                        && is_free(x + dx, y + dy)
                    {
                        let step = if dx != 0 && dy != 0 { DIAGONAL } else { STEP };
                        let next = cell(x + dx, y + dy);
                        cost[next] = cost[next].min(cost[cell(x, y)] + step);
                    }
                }
            }
            if cost == before {
                break;
            }
        }
        let near = |&cell: &usize| map.center(cell).distance_m(to) <= tolerance_m && !map.is_blocked[cell];
        (0..cost.len()).filter(near).map(|cell| cost[cell]).min().filter(|&cost| cost < u64::MAX)
    }

    proptest! {
        #[test]
        fn the_path_costs_what_relaxation_says(
            blocked in prop::collection::vec(prop::bool::weighted(0.3), 132),
            (x, y) in (0.0..12.0_f64, 0.0..11.0_f64),
            (u, v) in (0.0..12.0_f64, 0.0..11.0_f64),
            tolerance_m in 0.0..3.0_f64,
        ) {
            let mut map = empty(12.0, 11.0, 0.2);
            map.is_blocked.copy_from_slice(&blocked);
            let (from, to) = (at(x, y), at(u, v));
            let start = map.cell(from);
            map.is_blocked[start] = false;
            let path = map.path(from, to, tolerance_m);
            let tolerance_m = tolerance_m.max(0.5_f64.sqrt());
            prop_assert_eq!(path.as_ref().map(|path| path.cost), relaxed(&map, from, to, tolerance_m));
            prop_assert_eq!(path, map.path(from, to, tolerance_m));
        }

        #[test]
        fn the_robot_touches_no_point_that_it_knows(
            contacts in prop::collection::vec((1.0..14.0_f64, 1.0..14.0_f64), 0..25),
        ) {
            let hull_m = 0.3;
            let mut map = empty(15.0, 15.0, hull_m);
            let (from, to) = (at(0.4, 0.4), at(14.5, 14.5));
            for &(x, y) in &contacts {
                map.add_contact(at(x, y));
            }
            if let Some(way) = map.way(from, to, 1.0) {
                let mut here = from;
                for there in way {
                    for &(x, y) in &contacts {
                        // A point near a known one is not learned: 0.25 cells.
                        let clear_m = distance_to_drive_m(at(x, y), here, there);
                        prop_assert!(clear_m >= hull_m - 0.25 - 1e-9, "{clear_m} at {x}, {y}");
                    }
                    for &contact in &map.contacts {
                        let clear_m = distance_to_drive_m(contact, here, there);
                        prop_assert!(clear_m >= hull_m - 1e-9, "{clear_m} at {contact}");
                    }
                    here = there;
                }
                prop_assert!(here.distance_m(to) <= 1.0);
            }
        }
    }

    /// A wall like a U that is open to the west, between the start and the goal.
    fn trap() -> CellMap {
        let mut map = empty(20.0, 20.0, 0.3);
        for step in 0..=40 {
            let along = 0.2 * f64::from(step);
            map.add_contact(at(12.0, 6.0 + along));
            map.add_contact(at(4.0 + along, 6.0));
            map.add_contact(at(4.0 + along, 14.0));
        }
        map
    }

    #[test]
    fn the_way_leads_out_of_a_trap_in_which_greedy_steps_stay() {
        let map = trap();
        let (from, to) = (at(8.5, 10.5), at(18.5, 10.5));
        let way = map.way(from, to, 0.5).expect("a way");
        let mut length_m = 0.0;
        let mut here = from;
        for &place in &way {
            length_m += here.distance_m(place);
            here = place;
        }
        assert_eq!(here, to);
        // Round the tip of an arm and the outer corner, at the hull's distance: no way is shorter than this.
        let shortest_m =
            from.distance_m(at(4.0, 6.0)) + at(4.0, 6.0).distance_m(at(12.0, 6.0)) + at(12.0, 6.0).distance_m(to);
        assert!(length_m > shortest_m && length_m < 1.15 * shortest_m, "{length_m} for {shortest_m}");
        let mut here = from;
        for _ in 0..200 {
            here = map.greedy_step(here, to, 0.5).expect("a free place");
        }
        assert!(here.x_m < 12.0, "{here}");
    }

    #[test]
    fn without_obstacles_the_way_is_straight_and_greedy_steps_arrive() {
        let map = empty(20.0, 20.0, 0.3);
        let (from, to) = (at(1.3, 2.2), at(15.0, 9.0));
        assert_eq!(map.way(from, to, 0.5), Some(vec![to]));
        let mut here = from;
        for _ in 0..40 {
            here = map.greedy_step(here, to, 0.5).expect("a free place");
        }
        assert!(here.distance_m(to) < 0.5, "{here}");
    }

    #[test]
    fn among_equal_steps_the_first_counter_clockwise_is_taken() {
        let step = empty(9.0, 9.0, 0.3).greedy_step(at(4.0, 4.0), at(4.0, 4.0), 1.0);
        assert_eq!(step, Some(at(5.0, 4.0)));
    }

    #[test]
    fn a_robot_close_to_a_wall_gets_away_from_it() {
        let mut map = empty(20.0, 20.0, 0.2);
        for step in 0..=100 {
            map.add_contact(at(0.2 * f64::from(step), 10.1));
        }
        // In the cell from y = 10 to 11, whose centre is 0.4 m from the wall.
        let from = at(10.5, 10.35);
        assert!(map.is_blocked(from));
        assert_eq!(map.way(from, at(10.5, 8.0), 0.5), None, "the wall divides the field");
        for to in [at(3.0, 18.0), at(18.0, 11.5)] {
            let way = map.way(from, to, 0.5).expect("a way");
            assert_eq!(way.last(), Some(&to));
        }
    }

    #[test]
    fn the_number_of_cells_is_bounded() {
        let map = CellMap::new(Bounds { min: Position::ORIGIN, max: at(1e6, 1e3) }, 0.1, 0.3);
        assert!(map.is_blocked.len() <= 250_000, "{}", map.is_blocked.len());
        assert!(map.cell_m > 0.1);
    }
}
