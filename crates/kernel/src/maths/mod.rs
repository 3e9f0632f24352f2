//! Mathematics for hot loops.
//!
//! Exponentials and logarithms have no branches, so that the compiler works on several numbers at once: on as many as the widest
//! vectors of the processor hold. The results are those of the method of FreeBSD's library (Sun Microsystems 1993), within one unit in the
//! last place, and the same on every machine: no multiplication is fused with an addition.

mod cholesky;
mod exponential;
mod logarithm;
mod mills;
mod shifted;

use fearless_simd::{Level, dispatch};

pub use cholesky::{cholesky, cholesky_watched, solve_lower};
pub use exponential::{exp, exp_each};
pub use logarithm::{ln, ln_each, ln_each_single};
pub use mills::{PER_ROOT_OF_TAU, mills_ratio};
pub use shifted::{InverseProducts, ShiftedMatrices};

/// Does `work` with the widest vectors of this processor. A closure of more than a few operations needs `#[inline(always)]`, and so do the
/// functions that it calls: what is compiled by itself has usual vectors. Its results are the same
/// with all vectors: no operation is moved or fused.
#[inline]
pub fn with_widest_vectors<R>(work: impl FnOnce() -> R) -> R {
    dispatch!(Level::new(), _simd => work())
}

/// The logarithm of 2 in two parts. The first has so few digits that a multiple by an exponent is exact.
const LN_2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fee0_0000), f64::from_bits(0x3dea_39ef_3579_3c76)];

/// Values of functions that are exact but for rounding.
#[cfg(test)]
mod exact {
    /// How many numbers of double precision lie between two of the same sign.
    pub(super) fn ulps(a: f64, b: f64) -> u64 {
        a.to_bits().abs_diff(b.to_bits())
    }
}
