//! The pipeline of `map`: from a log, of a recording or of a real robot, to maps.

mod input;
mod pipeline;

pub use input::Input;
pub use pipeline::map;
