//! How a robot finds its way among obstacles that it has to discover.

use std::f64::consts::TAU;

use sextant_channel::{Bounds, Position};
use sextant_sim::Port;

use super::config::{PathRule, SearchMotion};
use super::grid_path::CellMap;

/// Width of a cell of the robot's own map of obstacles (m).
const CELL_M: f64 = 0.5;
/// How far the field goes beyond the nodes (m).
const MARGIN_M: f64 = 10.0;
/// Directions of a scan by range sensors, and their range (m).
const RAYS: u32 = 48;
const RANGE_M: f64 = 5.0;
/// A robot that cannot get to its goal drives to a place so near to it (m).
const NEAR_M: [f64; 3] = [0.0, 2.0, 6.0];

/// How a robot finds its way among obstacles that it has to discover, all by odometry.
#[derive(Clone, Debug)]
pub(super) struct Wayfinder {
    rule: PathRule,
    motion: SearchMotion,
    hull_m: f64,
    cells: CellMap,
}

impl Wayfinder {
    /// For a robot whose hull has the radius `hull_m`, among nodes within `nodes`.
    pub(super) fn new(rule: PathRule, motion: SearchMotion, hull_m: f64, nodes: Bounds) -> Self {
        Self { rule, motion, hull_m, cells: CellMap::new(nodes.grown(MARGIN_M), CELL_M, hull_m) }
    }

    /// Learns what the range sensors see around the robot.
    pub(super) fn look_around(&mut self, port: &Port<'_>) {
        let here = port.pose().position;
        for ray in 0..RAYS {
            let azimuth_rad = TAU * f64::from(ray) / f64::from(RAYS);
            let direction = Position::new(libm::cos(azimuth_rad), libm::sin(azimuth_rad), 0.0);
            let free_m = port.clearance_m(direction, RANGE_M);
            if free_m < RANGE_M {
                self.cells.add_contact(here + direction * (free_m + self.hull_m));
            }
        }
    }

    /// Learns the point on an obstacle that ended a drive.
    pub(super) fn meet(&mut self, contact: Position) {
        self.cells.add_contact(contact);
    }

    /// Places to drive to, in order, from `from` to `to`, for a step of `step_m`.
    pub(super) fn way(&self, from: Position, to: Position, step_m: f64) -> Vec<Position> {
        match (self.motion, self.rule) {
            (SearchMotion::Continuous, PathRule::AStar) => self.shortest_way(from, to),
            (SearchMotion::Continuous, PathRule::Greedy) => {
                let step_m = step_m.min(from.distance_m(to));
                self.cells.greedy_step(from, to, step_m).into_iter().collect()
            }
            (SearchMotion::Discrete, rule) => {
                let ahead = match rule {
                    PathRule::AStar => along(from, &self.shortest_way(from, to), step_m),
                    PathRule::Greedy => to,
                };
                self.cells.greedy_step(from, ahead, step_m).into_iter().collect()
            }
        }
    }

    fn shortest_way(&self, from: Position, to: Position) -> Vec<Position> {
        NEAR_M.into_iter().find_map(|near_m| self.cells.way(from, to, near_m)).unwrap_or_default()
    }
}

/// The place that is `length_m` along a way from `from`, or its end.
fn along(from: Position, way: &[Position], length_m: f64) -> Position {
    let (mut here, mut left_m) = (from, length_m);
    for &next in way {
        let leg_m = here.distance_m(next);
        if leg_m >= left_m {
            return here + (next - here) * (left_m / leg_m);
        }
        left_m -= leg_m;
        here = next;
    }
    here
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, y_m: f64) -> Position {
        Position::new(x_m, y_m, 0.0)
    }

    #[test]
    fn a_place_along_a_way_is_counted_from_its_start() {
        let way = [at(3.0, 0.0), at(3.0, 4.0)];
        assert_eq!(along(at(0.0, 0.0), &way, 2.0), at(2.0, 0.0));
        assert_eq!(along(at(0.0, 0.0), &way, 5.0), at(3.0, 2.0));
        assert_eq!(along(at(0.0, 0.0), &way, 9.0), at(3.0, 4.0));
        assert_eq!(along(at(1.0, 1.0), &[], 9.0), at(1.0, 1.0));
    }

    #[test]
    fn discrete_steps_are_whole_and_in_one_of_eight_directions() {
        let field = Bounds { min: at(0.0, 0.0), max: at(40.0, 40.0) };
        let (from, to) = (at(20.0, 20.0), at(20.4, 21.0));
        for (rule, step_m) in [(PathRule::Greedy, 2.0), (PathRule::AStar, 2.0), (PathRule::AStar, 0.5)] {
            let way = Wayfinder::new(rule, SearchMotion::Discrete, 0.2, field).way(from, to, step_m);
            let expected = at(20.0, 20.0 + step_m);
            assert!(way.len() == 1 && way[0].distance_m(expected) < 1e-12, "{rule:?}: {way:?}");
        }
        // A continuous greedy robot goes no farther than its goal is.
        let greedy = Wayfinder::new(PathRule::Greedy, SearchMotion::Continuous, 0.2, field);
        assert!((greedy.way(from, to, 2.0)[0].distance_m(from) - from.distance_m(to)).abs() < 1e-12);
    }
}
