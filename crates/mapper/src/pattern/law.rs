//! How packets are received and sectors are named through an antenna whose gains are known.

use super::report_law::ReportLaw;
use crate::numerics::normal::Normal;

/// Least probability that a packet is received or missed: no single packet rules a place out.
const LEAST: f64 = 0.005;

/// The law of a listener with a known antenna.
///
/// A packet over a distance d is received with the probability `p Φ((A + G − 10 n lg d) / σ)`: G is the greatest gain of
/// all sectors in the direction of the node, A the margin of the link budget at 1 m, n the exponent of the path loss, σ the
/// standard deviation of what a distance does not tell, and p the share of packets that arrive over a good link. Of the
/// sectors, a node names the one that it hears best; the strengths have normal errors.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternLaw {
    /// A: the margin of the link budget at 1 m without antenna gain (dB).
    pub margin_db: f64,
    /// Strength of a link at the node over 1 m without antenna gain (dB): how strong a sector is that nodes name or report.
    pub level_db: f64,
    /// n: exponent of the path loss.
    pub exponent: f64,
    /// σ: standard deviation of the power of a link (dB).
    pub sigma_db: f64,
    /// p: share of packets that arrive over a good link.
    pub delivery: f64,
    /// Standard deviation of the error of the strength of a sector (dB).
    pub noise_db: f64,
    /// How far the antenna is turned from what the log says, counterclockwise (rad).
    pub yaw_rad: f64,
    /// By how much the gain of each sector differs from the pattern (dB), by the order of identities.
    pub ripple_db: Vec<f64>,
    /// What nodes report of all sectors.
    pub reports: ReportLaw,
}

impl PatternLaw {
    /// A law to begin with, for a margin at 1 m and the least strength that is received (dB).
    pub(super) fn guess(margin_db: f64, least_db: f64, sectors: usize) -> Self {
        Self {
            margin_db,
            level_db: margin_db + least_db,
            exponent: 2.0,
            sigma_db: 5.0,
            delivery: 0.8,
            noise_db: 1.0,
            yaw_rad: 0.0,
            ripple_db: vec![0.0; sectors],
            reports: ReportLaw::guess(),
        }
    }

    /// The standard score of a link of this gain (dB) over a distance of so many decades of a metre.
    #[inline]
    pub(super) fn score(&self, gain_db: f64, decades: f64) -> f64 {
        (self.margin_db + gain_db - 10.0 * self.exponent * decades) / self.sigma_db
    }

    /// The probability that a packet is received over a link of this gain (dB) and distance (decades of a metre).
    #[inline]
    pub(super) fn heard(&self, normal: &Normal, gain_db: f64, decades: f64) -> f64 {
        (self.delivery * normal.below(self.score(gain_db, decades))).clamp(LEAST, 1.0 - LEAST)
    }

    /// The distance beyond which a link of this gain receives as good as nothing (m).
    pub(super) fn reach_m(&self, gain_db: f64) -> f64 {
        libm::pow(10.0, (self.margin_db + gain_db + 2.5 * self.sigma_db) / (10.0 * self.exponent))
    }

    /// The largest change from `other` of what tells how far nodes are heard and which sectors they name (dB). Of the
    /// sectors it is the usual one.
    pub(super) fn change_db(&self, other: &Self) -> f64 {
        let square: f64 = self.ripple_db.iter().zip(&other.ripple_db).map(|(a, b)| (a - b) * (a - b)).sum();
        let changes = [
            (square / self.ripple_db.len().max(1) as f64).sqrt(),
            self.margin_db - other.margin_db,
            self.level_db - other.level_db,
            self.sigma_db - other.sigma_db,
            self.noise_db - other.noise_db,
            10.0 * (self.exponent - other.exponent),
            10.0 * (self.delivery - other.delivery),
            (self.yaw_rad - other.yaw_rad).to_degrees(),
        ];
        changes.into_iter().map(f64::abs).fold(0.0, f64::max)
    }
}
