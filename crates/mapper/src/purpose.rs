//! What mappers draw random numbers for. Never renumber: each number belongs to one purpose of the whole program.

use sextant_kernel::Purpose;

/// Choices of mappers: starts, landmarks, samples.
pub(crate) const MAPPER: Purpose = Purpose::new(8);
