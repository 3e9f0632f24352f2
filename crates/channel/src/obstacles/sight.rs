//! What is seen among obstacles.

use crate::geometry::position::Position;
use crate::geometry::shape::{Gaze, LEVEL_M};
use crate::geometry::span::Span;
use crate::obstacles::field::ObstacleField;

/// Shares of a way that are nearer to each other than this are the same.
const SAME_SHARE: f64 = 1e-13;

impl ObstacleField {
    /// The parts of the straight way from `from` to `to` that are seen from `eye`: those without a solid obstacle on the
    /// straight line to the eye. Each part has the shares of the way at which it begins and ends, from 0 to 1; they are in
    /// order and do not touch. A line in the floor of an obstacle is hidden; one that only touches the obstacle is free.
    ///
    /// The ends are worked out from the edges and the tangents of the obstacles, so no part is missed.
    #[must_use]
    pub fn views(&self, eye: Position, from: Position, to: Position) -> Vec<[f64; 2]> {
        let gaze = Gaze { eye, from, to };
        let reach_m = eye.distance_m(from).max(eye.distance_m(to));
        let mut shares = Vec::new();
        for obstacle in self.along(Span::new(from, to), reach_m + LEVEL_M) {
            self.obstacles()[obstacle].shape().sight_changes(&gaze, &mut shares);
        }
        if shares.is_empty() {
            return vec![[0.0, 1.0]];
        }
        shares.retain(|share| *share > SAME_SHARE && *share < 1.0 - SAME_SHARE);
        shares.extend([0.0, 1.0]);
        shares.sort_unstable_by(f64::total_cmp);
        shares.dedup_by(|later, earlier| *later - *earlier < SAME_SHARE);
        let mut views: Vec<[f64; 2]> = Vec::new();
        for part in shares.windows(2) {
            let &[start, end] = part else { continue };
            if self.blocking(eye, gaze.at(f64::midpoint(start, end))).is_some() {
                continue;
            }
            match views.last_mut() {
                Some(before) if before[1] >= start => before[1] = end,
                _ => views.push([start, end]),
            }
        }
        views
    }
}
