//! How a robot finds its way among obstacles that it has to discover.

use std::f64::consts::TAU;

use sextant_channel::{Bounds, Position};
use sextant_sim::Port;

use super::config::PathRule;
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
    hull_m: f64,
    cells: CellMap,
}

impl Wayfinder {
    /// For a robot whose hull has the radius `hull_m`, among nodes within `nodes`.
    pub(super) fn new(rule: PathRule, hull_m: f64, nodes: Bounds) -> Self {
        Self { rule, hull_m, cells: CellMap::new(nodes.grown(MARGIN_M), CELL_M, hull_m) }
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
        match self.rule {
            PathRule::AStar => {
                let ways = NEAR_M.into_iter().find_map(|near_m| self.cells.way(from, to, near_m));
                ways.unwrap_or_default()
            }
            PathRule::Greedy => {
                let step_m = step_m.min(from.distance_m(to));
                self.cells.greedy_step(from, to, step_m).into_iter().collect()
            }
        }
    }
}
