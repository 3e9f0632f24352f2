//! What robots draw random numbers for. Never renumber: each number belongs to one purpose of the whole program.

use sextant_kernel::Purpose;

/// Decisions of robots.
pub(crate) const ROBOT: Purpose = Purpose::new(7);
