//! Bins of the logarithm of distance, found without a logarithm.

use std::sync::LazyLock;

use sextant_channel::Position;

use super::evidence::LEAST_M;

/// Bins per tenfold distance, and in all.
const PER_DECADE: f64 = 40.0;
pub(super) const BINS: usize = 240;
/// Cells of the table over one octave of the squared distance: a cell holds at most one border of bins.
const CELL_BITS: u32 = 7;

/// The bins, which are the same for all logs.
pub(super) static DISTANCE_BINS: LazyLock<DistanceBins> = LazyLock::new(DistanceBins::new);

/// The bins of distances from [`LEAST_M`] on. What is nearer is in the first one, what is farther than all in the last one.
pub(super) struct DistanceBins {
    /// The bin in which each cell begins.
    first: Vec<u8>,
    /// The squared distances at which bins end (m²).
    ends: Vec<f64>,
}

impl DistanceBins {
    fn new() -> Self {
        let end = |bin: usize| LEAST_M * LEAST_M * libm::pow(10.0, 2.0 * (bin + 1) as f64 / PER_DECADE);
        let ends: Vec<f64> = (0..BINS - 1).map(end).collect();
        let last = ends.last().copied().unwrap_or(LEAST_M);
        let start = |cell: u64| f64::from_bits((cell + cell_of(LEAST_M * LEAST_M)) << (52 - CELL_BITS));
        let starts = (0..=cell_of(last) - cell_of(LEAST_M * LEAST_M)).map(start);
        let first = starts.map(|start| u8::try_from(ends.partition_point(|&end| end <= start)).unwrap_or(u8::MAX));
        Self { first: first.collect(), ends }
    }

    /// The bin of the distance of two places.
    #[inline]
    pub(super) fn of(&self, a: Position, b: Position) -> usize {
        let apart = a - b;
        let square = (apart.x_m * apart.x_m + apart.y_m * apart.y_m + apart.z_m * apart.z_m).max(LEAST_M * LEAST_M);
        let cell = cell_of(square) - cell_of(LEAST_M * LEAST_M);
        let Some(&bin) = self.first.get(usize::try_from(cell).unwrap_or(usize::MAX)) else { return BINS - 1 };
        let bin = usize::from(bin);
        bin + usize::from(self.ends.get(bin).is_some_and(|&end| end <= square))
    }

    /// The distance in the middle of a bin (m).
    pub(super) fn middle_m(bin: usize) -> f64 {
        LEAST_M * libm::pow(10.0, (bin as f64 + 0.5) / PER_DECADE)
    }
}

/// The number of the cell of a positive number: its exponent and the highest bits of its fraction.
#[inline]
fn cell_of(square: f64) -> u64 {
    square.to_bits() >> (52 - CELL_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::whole;

    #[test]
    fn bins_are_those_of_the_logarithm() {
        let bins = DistanceBins::new();
        for i in 0..40_000_u32 {
            // From a millimetre to ten thousand kilometres.
            let distance_m = 1e-3 * libm::pow(10.0, f64::from(i) * 2.5e-4 + 1e-6);
            let along = libm::log10(distance_m.max(LEAST_M) / LEAST_M) * PER_DECADE;
            let expected = whole(along).min(BINS - 1);
            assert_eq!(bins.of(Position::ORIGIN, Position::new(0.0, distance_m, 0.0)), expected, "{distance_m} m");
        }
        for bin in 0..BINS {
            assert_eq!(bins.of(Position::ORIGIN, Position::new(DistanceBins::middle_m(bin), 0.0, 0.0)), bin);
        }
    }
}
