//! The memory of a node that computes its place in place.

use super::evidence::{AnchorEvidence, KnownAnchor};

/// A number in single precision, or an index of a vertex (octets).
const NUMBER: usize = 4;
/// The packets of an anchor (octets).
const PACKETS: usize = 2;

/// Octets of the evidence: places, packets, sectors (begin, width, two elevations, deviation) and covariances (six
/// different values).
pub(super) fn of_evidence(evidence: &AnchorEvidence<'_>) -> usize {
    let one = |anchor: &KnownAnchor| {
        3 * NUMBER + PACKETS + anchor.sector.map_or(0, |_| 5 * NUMBER) + anchor.covariance.map_or(0, |_| 6 * NUMBER)
    };
    evidence.heard.iter().chain(&evidence.silent).map(one).sum()
}

/// Octets of the vertices of highest likelihood and of that likelihood.
pub(super) fn of_peak(ties: u32) -> usize {
    NUMBER * (1 + ties as usize)
}

/// Octets of the sums of weights, of weighted places and of their products.
pub(super) fn of_moments() -> usize {
    NUMBER * (1 + 3 + 6)
}

/// Octets of the weights of a grid.
pub(super) fn of_grid(vertices: usize) -> usize {
    NUMBER * vertices
}
