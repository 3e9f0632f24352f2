//! Purposes of the random draws of mappers. Never change a number: each belongs to one purpose in the whole program.

use sextant_kernel::Purpose;

/// Choices of mappers: starts, landmarks, samples.
pub(crate) const MAPPER: Purpose = Purpose::new(8);
/// Pairs of nodes that are tried when maps of robots are stitched.
pub(crate) const STITCHING: Purpose = Purpose::new(31);
