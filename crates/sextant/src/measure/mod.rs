//! The summary of a map: its properties, and its errors if the truth is known.

mod axes;
mod outline;
mod placement;
mod subject;
mod truth;

pub use axes::axes;
pub use outline::outline;
pub use placement::Placement;
pub use subject::Subject;
pub use truth::{Dimensions, NodeSectors, Truth, displacement, in_world, measure};
