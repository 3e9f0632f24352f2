//! The heights at which a robot may stop that decides on the way.

use sextant_channel::Position;

/// No robot is expected to climb farther than this in a survey (m).
const LONGEST_CLIMB_M: f64 = 1e5;

/// The heights from `low_m` to `high_m` that are within so many steps of `start`.
pub(crate) fn within_steps(start: Position, [low_m, high_m]: [f64; 2], steps: u32, step_m: f64) -> [f64; 2] {
    let most_m = (f64::from(steps) * step_m).min(LONGEST_CLIMB_M);
    [low_m.max(start.z_m - most_m).min(start.z_m), high_m.min(start.z_m + most_m).max(start.z_m)]
}
