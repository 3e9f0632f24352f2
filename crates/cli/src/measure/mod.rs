//! From maps to the summary: what a map says of itself, and how good it is.

mod outline;
mod truth;

pub use outline::outline;
pub use truth::{Truth, in_world, measure};
