//! The gains of sectors among known obstacles: what comes by all known ways, relative to a straight way in the open without gain.

use std::f64::consts::LN_10;

use sextant_channel::Position;
use sextant_kernel::maths::{exp, ln};

use super::gain_map::{Directions, GainMap};
use super::sight::{NEAREST_M, Pose, Turn};
use super::ways::{KnownWays, Way};

/// Least power of a sector, as a gain: none at all.
const NONE: f64 = 1e-12;
/// Decibels in a natural logarithm.
const DB: f64 = 10.0 / LN_10;
/// Ways that rise more are not seen by the sectors of the horizon.
const LEVEL: f64 = 0.02;

/// The gains of an antenna with known ways.
#[derive(Clone, Copy)]
pub(super) struct WayGains<'a> {
    pub(super) map: &'a GainMap,
    pub(super) ways: &'a KnownWays,
    /// How the antenna is turned on the robot.
    pub(super) mount: Turn,
    /// Exponent of the path loss.
    pub(super) exponent: f64,
}

/// A place as it is seen from a stop.
#[derive(Clone, Copy)]
pub(super) struct SeenPlace<'a> {
    /// The number of the stop.
    pub(super) stop: usize,
    pub(super) robot: &'a Pose,
    pub(super) place: Position,
}

impl WayGains<'_> {
    /// Sets the gain of each sector (dB), without its ripple, and how much of it was reflected, as a share.
    pub(super) fn towards(&self, seen: SeenPlace<'_>, gains_db: &mut [f64], reflected: &mut [f64]) {
        let SeenPlace { stop, robot, place } = seen;
        let straight = self.ways.straight(stop, place);
        let straight_m = straight.length_m.max(NEAREST_M);
        gains_db.fill(0.0);
        let cell = |way: &Way| self.map.directions().cell(robot.seen(way.direction, self.mount));
        self.map.add_powers(cell(&straight), exp(-straight.loss_db / DB), gains_db);
        reflected.copy_from_slice(gains_db);
        self.ways.each_reflected(stop, place, |way| {
            if self.map.directions() == Directions::Horizon && way.direction.z_m.abs() > LEVEL {
                return;
            }
            let weight = exp(-way.loss_db / DB - self.exponent * ln(way.length_m / straight_m));
            self.map.add_powers(cell(&way), weight, gains_db);
        });
        for (gain, share) in gains_db.iter_mut().zip(reflected) {
            let power = gain.max(NONE);
            *share = 1.0 - share.max(NONE).min(power) / power;
            *gain = DB * ln(power);
        }
    }
}
