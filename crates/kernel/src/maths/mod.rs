//! Mathematics for hot loops.
//!
//! Exponentials and logarithms have no branches, so that the compiler works on several numbers at once. The results are those of the method of FreeBSD's library (Sun Microsystems 1993), within one unit in the last place, and the same
//! on every machine: they need no instruction that some processors lack, and no fused multiplication.

mod cholesky;
mod exponential;
mod logarithm;

pub use cholesky::{cholesky, cholesky_watched, solve_lower};
pub use exponential::{exp, exp_each};
pub use logarithm::{ln, ln_each, ln_each_single};

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
