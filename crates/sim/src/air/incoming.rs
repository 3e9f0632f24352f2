//! A signal at the antenna of a receiver, and what disturbs it.

use sextant_channel::Milliwatts;
use sextant_kernel::SimTime;

use super::{ReceptionModel, ReceptionRules};
use crate::service::outcome::Deafness;

/// A signal at the antenna of a receiver that listens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incoming {
    pub(super) packet: u64,
    pub(super) power: Milliwatts,
    pub(super) preamble_end: SimTime,
    /// Whether it began while the receiver listened and was free, and is strong enough to be followed.
    pub(super) tracked: bool,
    /// Why the receiver cannot follow it: it was deaf when it began, or as good as off for what is no frame.
    pub(super) missed: Option<Deafness>,
    /// Whether it overlapped with another signal; with the model `overlap`, with another audible signal.
    pub(super) disturbed: bool,
    /// Smallest ratio of signal to interference and noise so far, as a factor.
    pub(super) least_sinr: f64,
    /// The same without noise.
    pub(super) least_sir: f64,
    /// Natural logarithm of the probability that no bit is wrong so far.
    pub(super) log_intact: f64,
}

/// A time during which the signals at a receiver stay the same, and the sum of their powers.
pub(super) struct Span {
    pub(super) since: SimTime,
    pub(super) now: SimTime,
    pub(super) total: Milliwatts,
}

impl Span {
    /// Ratio of a signal to all others and noise, as a factor.
    #[inline]
    pub(super) fn sinr(&self, power: Milliwatts, rules: &ReceptionRules) -> f64 {
        let mut rest = self.total + rules.noise;
        rest -= power;
        power.ratio(rest)
    }
}

impl Incoming {
    /// A tracked signal goes on through a time with its disturbances.
    #[inline]
    pub(super) fn suffer(&mut self, span: &Span, rules: &ReceptionRules) {
        let ratio = span.sinr(self.power, rules);
        self.least_sinr = self.least_sinr.min(ratio);
        match rules.model {
            ReceptionModel::SirThreshold { .. } => {
                let mut interference = span.total;
                interference -= self.power;
                self.least_sir = self.least_sir.min(sir(self.power, interference));
            }
            ReceptionModel::Ber => {
                let time = span.now.saturating_since(span.since.max(self.preamble_end));
                let bits = time.as_secs_f64() * rules.bit_rate_hz;
                self.log_intact += bits * libm::log1p(-(rules.bit_error_rate)(ratio));
            }
            ReceptionModel::Overlap | ReceptionModel::SinrThreshold { .. } => {}
        }
    }
}

/// Whether a signal alone makes the channel busy.
#[inline]
pub(super) fn is_strong(power: Milliwatts, rules: &ReceptionRules) -> bool {
    rules.carrier.is_some_and(|carrier| power >= carrier.signal)
}

/// Ratio of signal to interference, as a factor; what is left of rounding counts as none.
fn sir(power: Milliwatts, interference: Milliwatts) -> f64 {
    if interference.0 > 1e-9 * power.0 { power.ratio(interference) } else { f64::INFINITY }
}
