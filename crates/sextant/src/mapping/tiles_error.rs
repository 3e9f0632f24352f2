//! Errors of maps tile by tile.

use std::path::PathBuf;

use sextant_recording::output::store::NumberRange;

/// Why a log cannot be mapped tile by tile.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TilesError {
    /// The log is of a form that is read only as a whole.
    #[error(
        "`{}` cannot be read tile by tile: tiles are made of receptions; logs that can: the recording of a run, and a folder with \
         stops.csv and receptions.csv", .path.display()
    )]
    Form {
        /// The log.
        path: PathBuf,
    },
    /// Tiles smaller than the reach: neighbouring tiles would have the same receptions over and over.
    #[error(
        "{tiles} tiles are about {side_m:.1} m wide, less than the reach of {reach_m:.1} m within which stops hear a node; allowed: \
         1 to {most} tiles, at least {reach_m:.1} m wide"
    )]
    Small {
        /// The number of tiles.
        tiles: usize,
        /// How wide they are, about (m).
        side_m: f64,
        /// How far nodes are heard (m).
        reach_m: f64,
        /// The largest number of tiles.
        most: usize,
    },
    /// The memory is too small, and more tiles would not help or were not asked for.
    #[error(
        "{tiles} tiles need about {} MB of memory: {} MB for {stops} stops and {nodes} nodes, and {} MB for the largest tile; \
         free: {} MB; {remedy}",
        .fixed_bytes.saturating_add(*.tile_bytes).div_ceil(1_000_000), .fixed_bytes.div_ceil(1_000_000),
        .tile_bytes.div_ceil(1_000_000), .free_bytes / 1_000_000
    )]
    Memory {
        /// The number of tiles.
        tiles: usize,
        /// Memory that does not depend on the tiles (octets).
        fixed_bytes: u64,
        /// Number of stops.
        stops: usize,
        /// Number of nodes.
        nodes: usize,
        /// Memory for the largest tile (octets).
        tile_bytes: u64,
        /// Memory to use (octets).
        free_bytes: u64,
        /// What would help.
        remedy: String,
    },
    /// The temporary file cannot be written.
    #[error("the tiles cannot be written to the temporary file `{}`: {why}; they need {} MB there; nothing was kept", .path.display(), .bytes.div_ceil(1_000_000))]
    Write {
        /// The file.
        path: PathBuf,
        /// Its size when complete, about (octets).
        bytes: u64,
        /// The system's answer.
        why: String,
    },
    /// The temporary file cannot be read.
    #[error("a tile cannot be read from the temporary file `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The log has no such tiles.
    #[error("there are no tiles {found}; the log has the tiles 0..{tiles}")]
    NoSuchTiles {
        /// The tiles that are asked for.
        found: NumberRange,
        /// Number of tiles.
        tiles: usize,
    },
    /// A tile that is kept cannot be read or written.
    #[error("`{}` cannot be used as a finished tile: {why}", .path.display())]
    Kept {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The log has other receptions than when it was read first.
    #[error("the log has changed while it was read; map it once more when nobody writes to it")]
    Changed,
    /// Maps of several networks are asked for.
    #[error(
        "the map `{map}` is of network `{network}`: tiles are those of one network; choose one with `network={network}`"
    )]
    Networks {
        /// The map.
        map: String,
        /// Its network.
        network: String,
    },
}

impl TilesError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Write { .. } | Self::Read { .. })
    }
}
