//! Purposes of the random draws of mappers. Never change a number: each belongs to one purpose in the whole program.

use sextant_kernel::Purpose;

/// Choices of mappers: starts, landmarks, samples.
pub(crate) const MAPPER: Purpose = Purpose::new(8);
