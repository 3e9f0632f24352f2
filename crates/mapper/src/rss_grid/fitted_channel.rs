//! A channel that was estimated from a log.

/// A channel that was estimated from the strengths and silences of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedChannel {
    /// Path loss exponent.
    pub exponent: f64,
    /// Mean strength over the reference distance (dBm).
    pub tx_power_dbm: f64,
    /// The reference distance (m).
    pub reference_distance_m: f64,
    /// Standard deviation of the strengths (dB).
    pub sigma_db: f64,
    /// Least strength at which packets are received (dBm).
    pub sensitivity_dbm: f64,
    /// Probability that a link that is strong enough is silent all the same: packets are lost for other reasons.
    pub loss: f64,
    /// Number of rounds.
    pub rounds: u32,
    /// Whether the last round changed the channel by less than its tolerances.
    pub converged: bool,
}
