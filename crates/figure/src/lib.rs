//! Figures of a recording as SVG or PNG files, for papers and web pages.
//!
//! There is one [`Figure`] of the network with the survey, one of the sectors at a stop, and one of the targets. Each
//! recorded instant of a field has one, each application and its time series, each map, and each likelihood surface.
//! The tree of packets over several hops has those of [`of_tree`]. Further ones are the distribution of each kind of error, the sector displacement, and the neighbour scattering in
//! a map that the nodes computed. A recorded packet trace has those of [`of_packets`]. Maps that were computed just now have three more: regions of 95 % and names, the
//! reception curve against the data, and the residual of each stop. Stops to drive to next have [`of_next_stops`]. The same recording gives the same bytes. The
//! colours can be distinguished with any
//! colour vision: those of Okabe and Ito for categories, and viridis (darker for larger) for numbers.
//!
//! ```no_run
//! use std::path::Path;
//! use sextant_figure::{FileFormat, Source, all};
//! use sextant_recording::{read_world, read_log};
//!
//! let recording = Path::new("circular.mcap");
//! let (run, drawn) = (read_log(recording)?, read_world(recording)?);
//! let source = Source {
//!     title: "circular",
//!     log: run.log(),
//!     drawn: &drawn,
//!     sector_displacements: &run.sector_displacements(),
//!     claimed_obstacles: &run.claimed_obstacles(),
//! };
//! for figure in all(&source) {
//!     figure.write(Path::new("."), FileFormat::Svg)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod layout;
mod paint;
mod pictures;
mod plot;

pub use layout::Layout;
pub use paint::file::{Figure, FileFormat};
pub use pictures::antenna::of_antenna;
pub use pictures::gallery::{all, all_of_maps};
pub use pictures::maps::estimated::{EstimatedMap, Model, ReceptionCurve};
pub use pictures::maps::next_stops::{PlannedStop, of_next_stops};
pub use pictures::networks::trees::of_tree;
pub use pictures::packets::{PacketSource, TimeWindow, of_packets};
pub use pictures::source::Source;
pub use plot::bars::Bars;
pub use plot::curves::{Curves, Series};
