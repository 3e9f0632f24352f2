//! A path of odometry in the frame of known places of nodes: turned and shifted as a whole.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, Watch};

use super::drive::{BelievedMap, EstimatedPath};
use super::report::FrameOfNodes;
use crate::error::MapError;
use crate::posterior::Concern;

impl EstimatedPath {
    /// The path as odometry has it, turned and shifted so that nodes which ranges place on it are at their `known` places; `None` if
    /// fewer than two of them are placed.
    pub(super) fn framed(&self, believed: &BelievedMap, known: &[(NodeId, Position)]) -> Option<Self> {
        let placed = |&(node, place): &(NodeId, Position)| {
            let estimate = believed.map.estimates[node.index()].as_ref()?;
            let variance = estimate.covariance.map_or(0.0, |covariance| 0.5 * (covariance[0][0] + covariance[1][1]));
            (estimate.concern != Some(Concern::TooFew)).then_some((estimate.position, place, variance))
        };
        let pairs: Vec<(Position, Position, f64)> = known.iter().filter_map(placed).collect();
        if pairs.len() < 2 {
            return None;
        }
        let count = pairs.len() as f64;
        let middle = |of: fn(&(Position, Position, f64)) -> Position| {
            pairs.iter().fold(Position::ORIGIN, |sum, pair| sum + of(pair)) * (1.0 / count)
        };
        let (from, to) = (middle(|pair| pair.0), middle(|pair| pair.1));
        // Least squares in the plane (Umeyama 1991, without a scale).
        let (mut along, mut across, mut square) = (0.0, 0.0, 0.0);
        for &(place, known, _) in &pairs {
            let (a, b) = (place - from, known - to);
            along += a.x_m * b.x_m + a.y_m * b.y_m;
            across += a.x_m * b.y_m - a.y_m * b.x_m;
            square += a.x_m * a.x_m + a.y_m * a.y_m;
        }
        if square <= 0.0 {
            return None;
        }
        let turn_rad = libm::atan2(across, along);
        let (sin, cos) = libm::sincos(turn_rad);
        let turned = |at: Position| Position::new(cos * at.x_m - sin * at.y_m, sin * at.x_m + cos * at.y_m, at.z_m);
        let shift = to - turned(from);
        let variance = pairs.iter().map(|pair| pair.2).sum::<f64>() / count;
        let mut path = self.clone();
        for pose in &mut path.poses {
            let place = turned(pose.believed) + shift;
            let apart = pose.believed - from;
            // What the frame is unsure by there.
            let unsure = variance * (1.0 / count + (apart.x_m * apart.x_m + apart.y_m * apart.y_m) / square);
            pose.position = Position { z_m: pose.believed.z_m, ..place };
            pose.turn_rad = turn_rad;
            pose.covariance = [[unsure, 0.0], [0.0, unsure]];
        }
        path.fit.framed = Some(FrameOfNodes { turn_rad, shift_m: [shift.x_m, shift.y_m] });
        Some(path)
    }

    /// The path, or the believed one in the frame of known places if that is not moved and contradicts none of them.
    pub(super) fn checked(
        mut self,
        log: &ReceptionLog,
        believed: &BelievedMap,
        known: &[(NodeId, Position)],
        watch: &dyn Watch,
    ) -> Result<Self, MapError> {
        self.fit.contradicted = self.contradicted(log, known, watch)?;
        if self.fit.is_moved() || self.fit.contradicted.is_empty() {
            return Ok(self);
        }
        if let Some(mut framed) = self.framed(believed, known) {
            framed.fit.contradicted = framed.contradicted(log, known, watch)?;
            if framed.fit.contradicted.is_empty() {
                return Ok(framed);
            }
        }
        Ok(self)
    }
}
