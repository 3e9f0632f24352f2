//! The ground on which a robot drives: places that it can get to, and the ways between them.

use sextant_channel::{Bounds, ObstacleField, Position};
use sextant_kernel::{Interrupted, Watch};

use crate::a_star::{self, Graph, STEP, SquareLattice};
use crate::route::{number, pulled_straight, whole};

/// Step of the lattice of ways among obstacles (m): robots pass doors.
const FINE_M: f64 = 0.25;
/// The most vertices of the lattice. If there would be more, the step is made longer.
const MAX_VERTICES: f64 = 60_000.0;
/// The robot gets onto the lattice at one of so many free vertices nearest to it.
const NEAREST: usize = 200;
/// Lengths that differ by less are equal (m).
const EQUAL_M: f64 = 1e-9;

/// What is known of the ground.
#[derive(Clone, Copy)]
pub struct Terrain<'a> {
    /// A box that holds all places to stop at (m).
    pub bounds: Bounds,
    /// Whether the robot may stop at a place in the box.
    pub is_inside: &'a (dyn Fn(Position) -> bool + Sync),
    /// What stands on the ground.
    pub obstacles: &'a ObstacleField,
    /// Radius of the hull of the robot (m).
    pub radius_m: f64,
    /// Distance of neighbouring places to stop at (m), above 0.
    pub step_m: f64,
}

impl std::fmt::Debug for Terrain<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Terrain").field("bounds", &self.bounds).field("step_m", &self.step_m).finish_non_exhaustive()
    }
}

/// Why there is no ground to drive on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GroundError {
    /// The robot is in an obstacle.
    #[error("the robot is at {found}; allowed: {allowed}")]
    Start {
        /// Where it is.
        found: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// No place can be got to.
    #[error("none of the places can be got to from ({:.1}, {:.1}) m: obstacles are in all ways", .from.x_m, .from.y_m)]
    Enclosed {
        /// Where the robot is.
        from: Position,
    },
    /// The work was ended.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Places that a robot can get to, and the ways between them.
#[derive(Debug)]
pub struct Ground<'a> {
    terrain: Terrain<'a>,
    start: Position,
    square: SquareLattice,
    step_m: f64,
    /// The directions that are passable from each vertex, as bits; no vertex if all are.
    passable: Vec<u8>,
    /// Where the robot gets onto the lattice.
    entry: usize,
    /// Places to stop at, and their vertices.
    places: Vec<Position>,
    vertices: Vec<usize>,
    /// Whether each straight line is a way.
    is_open: bool,
}

impl<'a> Ground<'a> {
    /// The ground of a robot that is at `start`. A lattice of places to stop at has the step of the terrain; among obstacles the lattice
    /// of ways is finer.
    ///
    /// # Errors
    /// If the robot cannot get to any place, or `watch` ends the work.
    pub fn new(terrain: Terrain<'a>, start: Position, watch: &dyn Watch) -> Result<Self, GroundError> {
        if let Some((found, allowed)) = terrain.obstacles.fault(start) {
            return Err(GroundError::Start { found, allowed });
        }
        let size = terrain.bounds.max - terrain.bounds.min;
        let finest_m = (size.x_m * size.y_m / MAX_VERTICES).sqrt();
        let wanted_m = if terrain.obstacles.is_empty() { terrain.step_m } else { FINE_M.min(terrain.step_m) };
        let every = whole(terrain.step_m / wanted_m.max(finest_m)).max(1);
        let step_m = (terrain.step_m / number(every)).max(finest_m);
        let count = |length_m: f64| whole((length_m / step_m).floor()) + 1;
        let square = SquareLattice { columns: count(size.x_m), rows: count(size.y_m) };
        let mut ground = Self {
            terrain,
            start,
            square,
            step_m,
            passable: Vec::new(),
            entry: 0,
            places: Vec::new(),
            vertices: Vec::new(),
            is_open: false,
        };
        let mut free = Vec::with_capacity(square.vertices());
        for vertex in 0..square.vertices() {
            if vertex % square.columns == 0 {
                watch.check()?;
            }
            free.push(ground.is_free(ground.place(vertex)));
        }
        ground.is_open = terrain.obstacles.is_empty() && free.iter().all(|&is_free| is_free);
        if !ground.is_open {
            ground.passable = ground.passable_directions(&free, watch)?;
        }
        ground.entry = ground.entry(&free).ok_or(GroundError::Enclosed { from: start })?;
        let costs = ground.ways_of_vertices_m(ground.entry);
        for vertex in (0..square.vertices()).filter(|&vertex| free[vertex] && costs[vertex].is_finite()) {
            let (column, row) = square.column_and_row(vertex);
            let is_place = |at: usize, count: usize| at % every == (every / 2).min((count - 1) / 2);
            if is_place(column, square.columns) && is_place(row, square.rows) {
                ground.places.push(ground.place(vertex));
                ground.vertices.push(vertex);
            }
        }
        if ground.places.is_empty() {
            return Err(GroundError::Enclosed { from: start });
        }
        Ok(ground)
    }

    /// Where the robot is (m).
    #[must_use]
    pub fn start(&self) -> Position {
        self.start
    }

    /// The places to stop at that the robot can get to (m).
    #[must_use]
    pub fn places(&self) -> &[Position] {
        &self.places
    }

    /// The way from one place to another, the last place of which is `to`.
    #[must_use]
    pub fn way(&self, from: Position, to: Position) -> Vec<Position> {
        let passable = |a: Position, b: Position| self.is_passable(a, b);
        if self.is_open || passable(from, to) {
            return vec![to];
        }
        let begin = if from == self.start { self.entry } else { self.vertex(from) };
        let search = Ways { ground: self, goal: Some(self.vertex(to)) };
        let path = a_star::shortest(&search, begin).map(|path| path.vertices).unwrap_or_default();
        let corners: Vec<Position> =
            std::iter::once(from).chain(path.into_iter().map(|vertex| self.place(vertex))).chain([to]).collect();
        let mut way = pulled_straight(&corners, passable);
        way.dedup_by(|a, b| a.distance_m(*b) < EQUAL_M);
        way
    }

    /// The way from the robot to each place (m).
    pub(super) fn ways_from_start_m(&self) -> Vec<f64> {
        if self.is_open {
            return self.places.iter().map(|place| place.distance_m(self.start)).collect();
        }
        let to_entry_m = self.start.distance_m(self.place(self.entry));
        let costs = self.ways_of_vertices_m(self.entry);
        self.vertices.iter().map(|&vertex| to_entry_m + costs[vertex]).collect()
    }

    /// The way from a place to each place (m).
    pub(super) fn ways_m(&self, place: usize) -> Vec<f64> {
        if self.is_open {
            return self.places.iter().map(|other| other.distance_m(self.places[place])).collect();
        }
        let costs = self.ways_of_vertices_m(self.vertices[place]);
        self.vertices.iter().map(|&vertex| costs[vertex]).collect()
    }

    /// The way from a vertex to each vertex (m), infinite where there is none.
    fn ways_of_vertices_m(&self, from: usize) -> Vec<f64> {
        let costs = a_star::costs(&Ways { ground: self, goal: None }, from);
        let scale_m = self.step_m / STEP as f64;
        costs.into_iter().map(|cost| cost.map_or(f64::INFINITY, |cost| cost as f64 * scale_m)).collect()
    }

    fn place(&self, vertex: usize) -> Position {
        let (column, row) = self.square.column_and_row(vertex);
        let min = self.terrain.bounds.min;
        let half_m = |size_m: f64, count: usize| 0.5 * (size_m - number(count - 1) * self.step_m);
        let size = self.terrain.bounds.max - min;
        let x_m = min.x_m + half_m(size.x_m, self.square.columns) + number(column) * self.step_m;
        let y_m = min.y_m + half_m(size.y_m, self.square.rows) + number(row) * self.step_m;
        Position::new(x_m, y_m, self.start.z_m)
    }

    /// The vertex of a place to stop at.
    fn vertex(&self, place: Position) -> usize {
        let at = self.places.iter().position(|other| *other == place);
        at.map_or(self.entry, |at| self.vertices[at])
    }

    fn is_free(&self, place: Position) -> bool {
        (self.terrain.is_inside)(place) && self.terrain.obstacles.distance_m(place) >= self.terrain.radius_m
    }

    /// Whether the robot can drive straight from `from` to `to`.
    fn is_passable(&self, from: Position, to: Position) -> bool {
        let steps = whole((2.0 * from.distance_m(to) / self.step_m).ceil()).max(1);
        let is_inside = |step: usize| (self.terrain.is_inside)(from + (to - from) * (number(step) / number(steps)));
        self.is_clear(from, to) && (0..=steps).all(|step| is_inside(step) || from == self.start)
    }

    /// Whether no obstacle is in the straight way from `from` to `to`.
    fn is_clear(&self, from: Position, to: Position) -> bool {
        let length_m = from.distance_m(to);
        let Terrain { obstacles, radius_m, .. } = self.terrain;
        length_m < EQUAL_M
            || obstacles.clearance_m(from, to - from, length_m, radius_m) >= length_m - EQUAL_M
                && obstacles.blocking(from, to).is_none()
    }

    fn passable_directions(&self, free: &[bool], watch: &dyn Watch) -> Result<Vec<u8>, Interrupted> {
        let mut passable = vec![0_u8; free.len()];
        for from in 0..free.len() {
            if from % self.square.columns == 0 {
                watch.check()?;
            }
            for (direction, to, _) in self.square.moves(from) {
                if free[from] && free[to] && self.is_clear(self.place(from), self.place(to)) {
                    passable[from] |= 1_u8 << direction;
                }
            }
        }
        Ok(passable)
    }

    /// Where the robot gets onto the lattice: at the nearest free vertex to which nothing is in the way.
    fn entry(&self, free: &[bool]) -> Option<usize> {
        let mut near: Vec<(f64, usize)> = (0..free.len())
            .filter(|&vertex| free[vertex])
            .map(|vertex| (self.place(vertex).distance_m(self.start), vertex))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // A robot that touches a wall may leave it.
        near.iter()
            .take(NEAREST)
            .map(|&(_, vertex)| vertex)
            .find(|&vertex| self.is_clear(self.start, self.place(vertex)))
    }
}

/// A search for ways on the lattice.
struct Ways<'a> {
    ground: &'a Ground<'a>,
    goal: Option<usize>,
}

impl Graph for Ways<'_> {
    fn vertices(&self) -> usize {
        self.ground.square.vertices()
    }

    fn neighbours(&self, vertex: usize) -> impl Iterator<Item = (usize, u64)> {
        let passable = self.ground.passable.get(vertex).copied().unwrap_or(u8::MAX);
        let moves = self.ground.square.moves(vertex);
        moves.filter(move |(direction, ..)| passable & (1_u8 << *direction) != 0).map(|(_, to, step)| (to, step))
    }

    fn is_passable(&self, _: usize, _: usize) -> bool {
        // Only neighbours to which the way is passable are told.
        true
    }

    fn least_cost(&self, vertex: usize) -> u64 {
        let Some(goal) = self.goal else { return 0 };
        let left_m = self.ground.place(vertex).distance_m(self.ground.place(goal));
        // A diagonal step costs a millionth more than √2 steps at most.
        whole(left_m / self.ground.step_m * STEP as f64) as u64
    }

    fn is_goal(&self, vertex: usize) -> bool {
        self.goal == Some(vertex)
    }
}
