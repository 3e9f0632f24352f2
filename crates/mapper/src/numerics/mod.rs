//! Mathematics that several estimators share, and limits of memory.

pub(crate) mod convex_hull;
pub(crate) mod decades;
pub(crate) mod golden_section;
pub(crate) mod halves;
mod isotonic;
pub(crate) mod least_squares;
mod median;
pub(crate) mod memory;
pub(crate) mod normal;
pub(crate) mod octahedron;
pub(crate) mod sums;
mod whole;

pub use convex_hull::hull as convex_hull;
pub use isotonic::never_rising;
pub(crate) use median::median;
pub(crate) use whole::whole;
