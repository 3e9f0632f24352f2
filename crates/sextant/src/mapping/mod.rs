//! The pipeline of `map`: computes maps from a recording or from the log of a real robot.

mod contents;
mod error;
mod figures;
mod input;
mod logs;
mod map_log;
mod notes;
mod pipeline;
mod prior;
pub mod tiles;
mod tiles_error;

pub use contents::{Contents, SectorContents};
pub use error::MapLogError;
pub use figures::{drawn, figures};
pub use input::Input;
pub use logs::MapLogs;
pub use map_log::{LogMap, map_log};
pub use pipeline::{ComputedMap, map, map_files};
pub use prior::place_prior;
pub use tiles_error::TilesError;
