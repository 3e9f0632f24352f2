//! Links that change in time and over fractions of a wavelength: fading ([`Fading`]), bursts of loss ([`Bursts`]), and
//! links as they were measured ([`LinkTrace`]).
//!
//! All are pure functions of seed, link, places, radio channel and time, so the order of questions changes nothing. A
//! link is a pair of stations: both directions have the same value, bit for bit.

pub(crate) mod bursts;
pub(crate) mod config;
mod kept;
pub(crate) mod law;
pub(crate) mod process;
pub(crate) mod trace;
mod waves;

use sextant_kernel::{Purpose, Seed, StationId};

/// The address of a pair of stations, whichever of them is named first.
fn pair(a: StationId, b: StationId) -> u64 {
    (u64::from(a.0.min(b.0)) << 32) | u64::from(a.0.max(b.0))
}

/// The draws of one pair of stations for one purpose.
#[derive(Clone, Copy, Debug)]
struct PairDraws {
    seed: Seed,
    purpose: Purpose,
    pair: u64,
}

impl PairDraws {
    /// A number uniform in (0, 1) at the rest of the address.
    fn uniform(self, word: u64, kind: u64) -> f64 {
        self.seed.uniform(self.purpose, [self.pair, word, kind])
    }

    /// A standard normal number there.
    fn normal(self, word: u64, kind: u64) -> f64 {
        self.seed.normal(self.purpose, [self.pair, word, kind])
    }
}
