//! Where nodes and stops are.

use sextant_channel::Position;
use sextant_kernel::{Purpose, Seed};

use super::survey::{NODES, POWER};

/// A place with nodes and stops, and how power falls with distance there.
#[derive(Clone, Debug)]
pub(super) struct Site {
    pub(super) seed: Seed,
    pub(super) nodes: Vec<Position>,
    pub(super) stops: Vec<Position>,
    /// Path-loss exponent.
    pub(super) exponent: f64,
    /// Distance at which the mean strength is that which half of the packets need (m).
    pub(super) reach_m: f64,
}

/// Size of a hall (m).
pub(super) const HALL_M: [f64; 2] = [24.0, 18.0];
/// Lanes of the path through a hall, and stops in each.
const LANES: u32 = 6;
const PER_LANE: u32 = 8;

impl Site {
    /// A hall of 24 by 18 m with this many nodes, and an S path of 48 stops a metre or two from straight. Exponent (1.8 to
    /// 3.6) and reach (7 to 16 m) differ from seed to seed.
    pub(super) fn hall(seed: Seed, nodes: u32) -> Self {
        let stops = (0..LANES * PER_LANE).map(|stop| {
            let (lane, along) = (stop / PER_LANE, stop % PER_LANE);
            let along = f64::from(if lane % 2 == 0 { along } else { PER_LANE - 1 - along });
            let off = |axis| 0.6 * (seed.uniform(NODES, [u64::from(stop), axis, 1]) - 0.5);
            let x_m = (along + 0.5) / f64::from(PER_LANE) * HALL_M[0] + off(0);
            Position::new(x_m, (f64::from(lane) + 0.5) / f64::from(LANES) * HALL_M[1] + off(1), 0.0)
        });
        let stops: Vec<Position> = stops.collect();
        Self::of(seed, Self::within(seed, nodes, HALL_M), stops)
    }

    /// A site with these nodes and stops.
    pub(super) fn of(seed: Seed, nodes: Vec<Position>, stops: Vec<Position>) -> Self {
        let between = |low: f64, high: f64, which| low + (high - low) * seed.uniform(POWER, [which, 0, 0]);
        Self { seed, nodes, stops, exponent: between(1.8, 3.6, 0), reach_m: between(7.0, 16.0, 1) }
    }

    /// This many places in a rectangle of this size.
    pub(super) fn within(seed: Seed, nodes: u32, size_m: [f64; 2]) -> Vec<Position> {
        let along = |node, axis: usize| size_m[axis] * seed.uniform(NODES, [u64::from(node), axis as u64, 0]);
        (0..nodes).map(|node| Position::new(along(node, 0), along(node, 1), 0.0)).collect()
    }

    /// Mean strength by the law of the distance alone (dBm).
    pub(super) fn mean_dbm(&self, node: usize, stop: usize) -> f64 {
        let distance_m = self.nodes[node].distance_m(self.stops[stop]).max(0.3);
        super::survey::SENSITIVITY_DBM - 10.0 * self.exponent * libm::log10(distance_m / self.reach_m)
    }

    /// A standard normal number of a link.
    pub(super) fn normal(&self, purpose: Purpose, node: usize, stop: usize) -> f64 {
        self.seed.normal(purpose, [node as u64, stop as u64, 0])
    }
}
