//! What a log says before any node is placed: who was heard and over which distance, at which heights and in which box a
//! node is to be sought, which antenna sectors count, and the signal strengths.

pub(crate) mod gross_strengths;
pub(crate) mod heights;
pub(crate) mod reach;
pub(crate) mod search_box;
pub(crate) mod sectors;
pub(crate) mod strengths;

pub use gross_strengths::{GrossStrength, gross_strengths};
pub use heights::{HeightReason, SoughtHeights};
pub use sectors::{SectorLayoutConfig, SectorModel, SectorTolerance, SectorsConfig, SilenceRule, SoftSectorsConfig};
