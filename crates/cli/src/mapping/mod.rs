//! The pipeline of `map`: computes maps from a recording or from the log of a real robot.

mod input;
mod pipeline;

pub use input::Input;
pub use pipeline::map;
