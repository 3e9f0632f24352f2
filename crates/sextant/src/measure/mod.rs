//! The summary of a map: its properties, and its errors if the truth is known.

mod axes;
mod outline;
mod placement;
mod subject;
mod truth;

pub(crate) use axes::axes;
pub(crate) use placement::Placement;
pub(crate) use subject::Subject;
pub use truth::Dimensions;
pub(crate) use truth::{NodeSectors, Truth, displacement, in_world, measure};
