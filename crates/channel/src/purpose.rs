//! What the channel draws random numbers for. Never renumber: each number belongs to one purpose of the whole program.

use sextant_kernel::Purpose;

/// Shadowing of a link.
pub(crate) const SHADOWING: Purpose = Purpose::new(4);
/// Gain ripple of the sectors of an antenna.
pub(crate) const GAIN_RIPPLE: Purpose = Purpose::new(20);
/// Errors of measured ranges.
pub(crate) const RANGING: Purpose = Purpose::new(35);
/// Biases of nodes in measured ranges.
pub(crate) const RANGE_BIAS: Purpose = Purpose::new(36);
/// Fading of links.
pub(crate) const FADING: Purpose = Purpose::new(50);
/// Bursts of loss on links.
pub(crate) const BURSTS: Purpose = Purpose::new(51);
