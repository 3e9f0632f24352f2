//! The pipeline of `map`: computes maps from a recording or from the log of a real robot.

mod contents;
mod error;
#[cfg(feature = "figures")]
mod figures;
mod input;
mod logs;
mod map_log;
mod notes;
mod pipeline;
mod prior;
pub mod tiles;
mod tiles_error;
mod tracks;

pub use contents::{Contents, SectorContents};
pub use error::MapLogError;
#[cfg(feature = "figures")]
pub use figures::{drawn, figures};
pub use input::Input;
pub(crate) use logs::MapLogs;
pub use map_log::{LogMap, map_log};
pub use pipeline::{ComputedMap, map, map_files};
pub use prior::{place_prior, read_area};
pub use tiles_error::TilesError;
pub use tracks::{TrackJob, TrackSource, tracks};

pub use crate::measure::Dimensions;
