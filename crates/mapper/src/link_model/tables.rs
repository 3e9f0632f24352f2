//! Functions of the margin of a link: of the signal over what the receiver needs, in standard deviations of the fading.

use std::sync::LazyLock;

use crate::numerics::normal::{below, density};

/// Margins for which likelihoods are computed: the lowest, the distance between two, and their number.
pub(super) const LOWEST: f64 = -8.0;
pub(super) const STEP: f64 = 0.1;
pub(super) const MARGINS: usize = 281;
/// Functions of a margin m: the share of packets that are strong enough, the mean strength of what is received in excess of the threshold, and its variance, both in
/// units of the fading.
pub(super) struct CensoredTables {
    pub(super) margin: [f64; MARGINS],
    pub(super) reached: [f64; MARGINS],
    pub(super) excess: [f64; MARGINS],
    pub(super) variance: [f64; MARGINS],
}

pub(super) static TABLES: LazyLock<CensoredTables> = LazyLock::new(|| {
    let margin: [f64; MARGINS] = std::array::from_fn(|i| LOWEST + STEP * i as f64);
    // Moments of a normal variable that is cut off from below (the inverse Mills ratio).
    let reached = margin.map(below);
    let mills: [f64; MARGINS] = std::array::from_fn(|i| density(margin[i]) / reached[i].max(1e-300));
    let excess = std::array::from_fn(|i| margin[i] + mills[i]);
    let variance = std::array::from_fn(|i| (1.0 - mills[i] * (margin[i] + mills[i])).max(0.02));
    CensoredTables { margin, reached, excess, variance }
});
