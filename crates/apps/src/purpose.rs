//! Purposes of the random draws of robots. Never change a number: each belongs to one purpose in the whole program.

use sextant_kernel::Purpose;

/// Decisions of robots.
pub(crate) const ROBOT: Purpose = Purpose::new(7);
/// Particles that follow a target.
pub(crate) const SEARCH: Purpose = Purpose::new(25);
