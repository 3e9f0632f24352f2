//! Constants that were learnt from logs of real robots.

/// How much the link model and other opinions count.
///
/// Learnt from 29 logs of 12 sites. `cargo run --release -p sextant-benches -- cross-validation` learns them again with each
/// site left out, and `docs/link-model.md` has its table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpinionConstants {
    /// Scale of the centroid by strengths, as a share of the usual length of a link.
    pub rssi_centroid: f64,
    /// That of the strongest stop.
    pub strongest: f64,
    /// That of the packet centroid.
    pub centroid: f64,
    /// Degrees of freedom of each of these opinions.
    pub freedom: f64,
    /// Power of each.
    pub power: f64,
    /// Degrees of freedom of the link model.
    pub links_freedom: f64,
    /// Least error of its places, as a share of the usual length of a link.
    pub links_error: f64,
    /// Gains of the law (nats) between which its power and the factor on the scales of the others grow.
    pub gains: [f64; 2],
    /// The power of the link model at these gains.
    pub links_power: [f64; 2],
    /// The factor on the scales of the others at these gains.
    pub wider: [f64; 2],
    /// Logarithm of that factor for each nat beyond.
    pub wider_a_nat: f64,
    /// The largest factor.
    pub widest: f64,
    /// The gain of a law for which no stops could be left out.
    pub unknown_gain: f64,
    /// Gains of the law between which the share of the log in it grows to 1; the rest is that of usual links.
    pub own_gains: [f64; 2],
    /// The least share.
    pub own_share: f64,
}

impl OpinionConstants {
    /// Those that `auto` uses.
    pub const LEARNT: Self = Self {
        rssi_centroid: 0.30,
        strongest: 0.29,
        centroid: 0.65,
        freedom: 2.0,
        power: 0.7,
        links_freedom: 3.0,
        links_error: 0.1,
        gains: [-0.15, 0.0],
        links_power: [0.2, 1.0],
        wider: [1.0, 2.0],
        wider_a_nat: 1.4,
        widest: 10.0,
        unknown_gain: -0.075,
        own_gains: [0.5, 1.0],
        own_share: 0.5,
    };

    /// The same, with scales and errors that are wider by a factor.
    #[must_use]
    pub fn wider_by(self, factor: f64) -> Self {
        Self {
            rssi_centroid: self.rssi_centroid * factor,
            strongest: self.strongest * factor,
            links_error: self.links_error * factor,
            ..self
        }
    }

    /// The share of a log in the law of its links, which has this `gain`.
    #[must_use]
    pub fn own_share_at(&self, gain: Option<f64>) -> f64 {
        self.own_share + (1.0 - self.own_share) * self.is_own_at(gain)
    }

    /// The scale of the distribution of the link model, as a share of its covariance, under a law with this `gain`. The variance of a
    /// law that is surely that of the log is the one that it tells; of others it is larger.
    pub(super) fn links_scale_at(&self, gain: Option<f64>) -> f64 {
        let as_told = (self.links_freedom - 2.0) / self.links_freedom;
        1.0 - (1.0 - as_told) * self.is_own_at(gain)
    }

    /// How surely the law is that of the log, from 0 to 1.
    fn is_own_at(&self, gain: Option<f64>) -> f64 {
        let [low, high] = self.own_gains;
        ((gain.unwrap_or(self.unknown_gain) - low) / (high - low)).clamp(0.0, 1.0)
    }
}
