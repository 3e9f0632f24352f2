//! What a log does not tell of a node beyond all stops, or heard from few places.

use sextant_channel::Position;

use super::law::Law;
use super::links::{HeardLink, NodeLinks};
use super::posterior::{GridPosterior, HeardLinks};
use super::with_law::{ModelWithLaw, VERTICES};
use crate::posterior::{Concern, covariance};

/// A node at fewer places has more unknowns than it has places: its own and its power.
const LEAST_PLACES: usize = 4;
/// A place is far beyond all others if it is so many lengths of the fall of the density of nodes there.
const FAR: f64 = 2.0;
/// Places beyond all others tell the slope and the level of a node hardly: their deviations, as a share of the slope and in
/// decibels.
const SLOPE_SPREAD: f64 = 0.3;
const LEVEL_DB: f64 = 6.0;
/// Levels that are looked at, in deviations.
const LEVELS: [f64; 9] = [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0];
/// The strength of usual radios at one metre (dBm), its deviation (dB), the strength of a link without one (dBm), and the usual
/// path-loss exponent.
const AT_ONE_METRE_DBM: f64 = -45.0;
const DEVIATION_DB: f64 = 12.0;
const MEDIUM_DBM: f64 = -75.0;
const EXPONENT: f64 = 2.5;

type Covariance = [[f64; 3]; 3];

impl ModelWithLaw<'_> {
    /// The squares of how far `node` may be from its place if what the log hardly tells is free (m²), if that matters, and the
    /// concern about it beside its `concern`.
    pub(super) fn unknown(
        &self,
        node: &NodeLinks,
        evidence: &HeardLinks<'_>,
        posterior: &GridPosterior,
        concern: Option<Concern>,
    ) -> (Option<Covariance>, Option<Concern>) {
        if !self.window.is_guessed()[0] {
            return (None, concern);
        }
        if node.links.len() < LEAST_PLACES {
            return (self.within_strength(node, posterior.mean), Some(Concern::TooFew));
        }
        if concern != Some(Concern::AtEdge) && self.window.beyond(posterior.mean) < FAR {
            return (None, concern);
        }
        (Some(self.beyond_all_places(evidence, posterior.mean)), concern.or(Some(Concern::AtEdge)))
    }

    /// The same of a node whose slope and level are hardly told, and which may be anywhere within reach.
    fn beyond_all_places(&self, evidence: &HeardLinks<'_>, place: Position) -> Covariance {
        let [_, fine] = VERTICES[usize::from(self.is_spatial)];
        let grid = evidence.even_grid(self.window, fine);
        let law = Law { slope_spread: self.law.slope_spread.max(SLOPE_SPREAD), ..self.law };
        let deviation = self.hearing.receiver.map_or(law.spread(), |receiver| LEVEL_DB / receiver.fading_db);
        let levels = LEVELS.map(|level| (deviation * level, -0.5 * level * level));
        let wide = evidence.posterior_of_levels(&law, &grid, &levels);
        let apart = grid.vertices.iter().zip(&wide.shares).map(|(&vertex, &share)| (vertex - place, share));
        covariance(apart).map(|row| row.map(|entry| entry * self.inflation))
    }

    /// The same of a node of which only its strongest link is known: about as far from there as usual radios are at this strength.
    fn within_strength(&self, node: &NodeLinks, place: Position) -> Option<Covariance> {
        let heard = node.links.iter().filter(|link| link.received > 0);
        let strength_dbm = |link: &HeardLink| link.rssi_dbm.unwrap_or(MEDIUM_DBM);
        let strongest = heard.max_by(|a, b| strength_dbm(a).total_cmp(&strength_dbm(b)))?;
        // Logarithms of distances are normally distributed.
        let nats = std::f64::consts::LN_10 / (10.0 * EXPONENT);
        let usual_m = libm::exp(nats * (AT_ONE_METRE_DBM - strength_dbm(strongest)));
        let deviation = nats * DEVIATION_DB;
        let squared_m2 = usual_m * usual_m * libm::exp(2.0 * deviation * deviation);
        let mut around = covariance(std::iter::once((self.links.places[strongest.place] - place, 1.0)));
        let dimensions = if self.is_spatial { 3 } else { 2 };
        (0..dimensions).for_each(|axis| around[axis][axis] += squared_m2 / dimensions as f64);
        Some(around)
    }
}

/// The wider of two covariances in the plane.
pub(super) fn wider(own: Covariance, unknown: Option<Covariance>) -> Covariance {
    unknown.filter(|unknown| spread(unknown) > spread(&own)).unwrap_or(own)
}

/// The variance in the plane (m²).
fn spread(of: &Covariance) -> f64 {
    of[0][0] + of[1][1]
}
