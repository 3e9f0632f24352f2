//! Maps tile by tile: logs of any size, with memory for the stops, the nodes and one tile.
//!
//! A first pass over the log counts what was heard of each node and where. Nodes are then divided into tiles, rectangles of the
//! plane with about the same number of receptions. A second pass puts each reception into the tile of its node, in a
//! temporary file. A tile has all stops, so it overlaps with all others, and a node is mapped as in one piece.

mod budget;
mod census;
mod kept;
mod pipeline;
mod plan;
mod row;
mod spill;
mod survey;
mod tile_count;
mod tiled_log;

pub use kept::KeptTiles;
pub use pipeline::{TileFolders, Tiling, make_tiles, map_tiles};
pub use survey::{Survey, survey};
pub use tile_count::{TileCount, UnknownTileCount};
