//! Where a station believes to be.

use sextant_channel::Position;

/// Where a station believes to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Belief {
    /// The place (m).
    pub place: Position,
    /// Covariance of x, y and z (m²), if the station knows how sure it is and tells it.
    pub covariance: Option<[[f64; 3]; 3]>,
}

impl Belief {
    /// A place that is known exactly.
    #[must_use]
    pub(crate) fn exact(place: Position) -> Self {
        Self { place, covariance: None }
    }

    /// Octets that it takes in a message.
    pub(super) fn octets(&self) -> usize {
        if self.covariance.is_some() { 36 } else { 12 }
    }

    /// Standard deviation along the axis that is known worst among x, y and z (m); `None` without a covariance.
    #[must_use]
    pub(crate) fn greatest_sigma_m(&self) -> Option<f64> {
        let covariance = self.covariance?;
        let variance = (0..3).map(|axis| covariance[axis][axis]).fold(0.0, f64::max);
        Some(variance.max(0.0).sqrt())
    }
}
