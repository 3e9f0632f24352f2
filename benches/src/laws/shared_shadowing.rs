//! Neighbouring stops and neighbouring nodes share their shadowing.

use std::f64::consts::TAU;

use sextant_channel::Position;
use sextant_kernel::Seed;

use super::survey::{Listening, SURROUNDINGS, none_lost, survey};
use super::{LawError, ReceptionLogAt, Site};

/// The name of the law.
pub(super) const NAME: &str = "shared-shadowing";

/// Waves whose sum is the field.
const WAVES: u64 = 96;
/// The correlation of the field falls to `exp(-1/2)` over this distance of stops or of nodes (m).
const LENGTH_M: f64 = 3.0;
/// Standard deviation of the field (dB).
const SIGMA_DB: f64 = 8.0;

/// A Gaussian field over the places of both ends of a link (Agrawal and Patwari 2009), drawn as a sum of plane waves.
pub(super) struct Field {
    waves: Vec<Wave>,
}

/// A wave over the places of both ends: its wave numbers at the node and at the stop (rad/m), and its phase.
struct Wave {
    at_node: [f64; 2],
    at_stop: [f64; 2],
    phase: f64,
}

impl Field {
    /// The field of a seed.
    pub(super) fn new(seed: Seed) -> Self {
        let number = |wave, axis| seed.normal(SURROUNDINGS, [wave, axis, 0]) / LENGTH_M;
        let wave = |wave| Wave {
            at_node: [number(wave, 0), number(wave, 1)],
            at_stop: [number(wave, 2), number(wave, 3)],
            phase: TAU * seed.uniform(SURROUNDINGS, [wave, 9, 0]),
        };
        Self { waves: (0..WAVES).map(wave).collect() }
    }

    /// The shadowing of the link between a node and a stop (dB).
    pub(super) fn at_db(&self, node: Position, stop: Position) -> f64 {
        let wave = |Wave { at_node: [ax, ay], at_stop: [bx, by], phase }: &Wave| {
            libm::cos(ax * node.x_m + ay * node.y_m + bx * stop.x_m + by * stop.y_m + phase)
        };
        let sum: f64 = self.waves.iter().map(wave).sum();
        SIGMA_DB * (2.0 / self.waves.len() as f64).sqrt() * sum
    }
}

/// Eight decibels of shadowing that links share.
pub(super) fn log(seed: Seed) -> Result<ReceptionLogAt, LawError> {
    let site = Site::hall(seed, 16);
    let field = Field::new(seed);
    let strength =
        |node: usize, stop: usize| site.mean_dbm(node, stop) + field.at_db(site.nodes[node], site.stops[stop]);
    Ok((survey(&site, Listening::default(), &strength, &none_lost)?, site.nodes))
}
