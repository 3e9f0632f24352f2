//! Places of stops in single precision, a few side by side.

use sextant_channel::Position;
use wide::f32x4;

use super::single::single;

/// Stops taken together.
pub(super) const LANES: usize = 4;

/// The place of stops that only fill up a vector (m); it is beyond any range.
const NOWHERE: f32 = 1e18;

/// Places by coordinate, a few side by side.
#[derive(Debug, Default)]
pub(super) struct PlaceLanes {
    pub(super) coordinates: Vec<[f32x4; 3]>,
    pub(super) count: usize,
}

impl PlaceLanes {
    /// Takes `places` as seen from `middle`.
    pub(super) fn set<'p>(&mut self, places: impl Iterator<Item = &'p Position>, middle: Position) {
        self.coordinates.clear();
        self.count = 0;
        let mut block = [[NOWHERE; LANES]; 3];
        for (i, &place) in places.enumerate() {
            for (axis, value) in <[f64; 3]>::from(place - middle).into_iter().enumerate() {
                block[axis][i % LANES] = single(value);
            }
            if i % LANES == LANES - 1 {
                self.coordinates.push(block.map(f32x4::from));
                block = [[NOWHERE; LANES]; 3];
            }
            self.count = i + 1;
        }
        if !self.count.is_multiple_of(LANES) {
            self.coordinates.push(block.map(f32x4::from));
        }
    }

    /// Number of places that only fill up a vector.
    pub(super) fn filling(&self) -> f64 {
        (self.coordinates.len() * LANES - self.count) as f64
    }
}
