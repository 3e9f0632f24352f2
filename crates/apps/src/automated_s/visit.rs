//! A stop, as the robot remembers it.

use sextant_channel::Position;

/// A stop, as the robot remembers it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Visit {
    pub(super) place: Position,
    /// Nodes heard.
    pub(super) audible: usize,
    pub(super) is_silent: bool,
    /// Free distance upwards and downwards, at most to the next layer (m); 0 if there are no layers.
    pub(super) clear_m: [f64; 2],
}

impl Visit {
    /// Free distance upwards if `up` is 1, downwards if it is -1 (m).
    pub(super) fn clear_towards_m(&self, up: f64) -> f64 {
        if up > 0.0 { self.clear_m[0] } else { self.clear_m[1] }
    }
}
