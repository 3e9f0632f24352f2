//! The link budget: everything that changes the power between two antennas.

use sextant_kernel::{Seed, StationId};

use crate::{ChannelLaw, Db, Dbm, ObstacleField, Position, Shadowing};

/// A radio channel in a world of obstacles: `P_rx = P_tx - L(d) - L_obstacles + X` (thesis eq. 3.15).
/// Reciprocal: every result is the same, bit for bit, if the two ends are exchanged.
#[derive(Clone, Debug)]
pub struct Channel {
    law: ChannelLaw,
    shadowing: Shadowing,
    obstacles: ObstacleField,
}

impl Channel {
    /// The channel with this `law` among `obstacles`, which absorb as at the carrier of the law; its shadowing is drawn
    /// from `seed`.
    #[must_use]
    pub fn new(law: ChannelLaw, obstacles: ObstacleField, seed: Seed) -> Self {
        let obstacles = match law.carrier_ghz() {
            Some(carrier_ghz) => obstacles.at_carrier(Some(carrier_ghz)),
            None => obstacles,
        };
        Self { law, shadowing: Shadowing::new(*law.shadowing(), seed), obstacles }
    }

    /// The law of the channel without obstacles.
    #[must_use]
    #[inline]
    pub fn law(&self) -> &ChannelLaw {
        &self.law
    }

    /// The obstacles, whether they absorb or not.
    #[must_use]
    #[inline]
    pub fn obstacles(&self) -> &ObstacleField {
        &self.obstacles
    }

    /// Loss by the obstacles between two places; zero if obstacles do not absorb.
    #[must_use]
    #[inline]
    pub fn obstacle_loss(&self, from: Position, to: Position) -> Db {
        if self.law.obstacles_attenuate() { self.obstacles.loss(from, to) } else { Db(0.0) }
    }

    /// Mean received power (mean of the decibels) at the transmit power `tx`; `None` beyond the hard radius.
    #[must_use]
    #[inline]
    pub fn mean_power(&self, tx: Dbm, from: Position, to: Position) -> Option<Dbm> {
        let distance_m = from.distance_m(to);
        if distance_m > self.law.max_range_m() {
            return None;
        }
        Some(tx - self.law.path_loss().loss(distance_m) - self.obstacle_loss(from, to))
    }

    /// Gain by shadowing between station `a` at `pa` and station `b` at `pb` for packet number `packet`.
    #[must_use]
    pub fn shadowing(&self, a: StationId, pa: Position, b: StationId, pb: Position, packet: u64) -> Db {
        self.shadowing.gain(a, pa, b, pb, packet)
    }

    /// Power at which station `b` receives packet number `packet` if `a` sends it with `tx`;
    /// `None` beyond the hard radius.
    #[must_use]
    pub fn received_power(
        &self,
        tx: Dbm,
        a: StationId,
        pa: Position,
        b: StationId,
        pb: Position,
        packet: u64,
    ) -> Option<Dbm> {
        self.mean_power(tx, pa, pb).map(|mean| mean + self.shadowing(a, pa, b, pb, packet))
    }
}
