//! Without the geometry library no ways are known but the straight ones.

use sextant_channel::Position;

use super::{KnownObstacles, Way};

/// The straight ways: there are no obstacles.
#[derive(Debug)]
pub(in crate::pattern) struct KnownWays(Vec<Position>);

impl KnownWays {
    pub(in crate::pattern) fn new(_: &KnownObstacles<'_>, stops: Vec<Position>, _: f64, _: [f64; 2]) -> Self {
        Self(stops)
    }

    pub(in crate::pattern) fn straight(&self, stop: usize, place: Position) -> Way {
        let apart = place - self.0[stop];
        let length_m = apart.length_m();
        let direction = if length_m > 0.0 { apart * (1.0 / length_m) } else { Position::new(1.0, 0.0, 0.0) };
        Way { direction, length_m, loss_db: 0.0 }
    }

    pub(in crate::pattern) fn each_reflected(&self, _: usize, _: Position, _: impl FnMut(Way)) {}
}
