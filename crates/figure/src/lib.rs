//! Figures of a recording as SVG or PNG files, for papers and web pages.
//!
//! There is one [`Figure`] of the network with the survey, one of the sectors at a stop, and one of the targets. Each
//! recorded instant of a field has one, each application and its time series, each map, and each likelihood surface.
//! Further ones are the distribution of each kind of error, the sector displacement, and the neighbour scattering in
//! a map that the nodes computed. A recorded packet trace has those of [`of_packets`]. Maps that were computed just now have three more: regions of 95 % and names, the
//! reception curve against the data, and the residual of each stop. The same recording gives the same bytes. The
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

mod antenna;
mod application;
mod application_curves;
mod axes;
mod bars;
mod cells;
mod claims;
mod contour;
mod crowded_map;
mod crowded_network;
mod curves;
mod density;
mod displacement;
mod distribution;
mod estimated;
mod estimated_map;
mod field;
mod file;
mod gallery;
mod labels;
mod layout;
mod likelihood;
mod map;
mod network;
mod packets;
mod paint;
mod palette;
mod picture;
mod reception_curve;
mod residuals;
mod scattering;
mod sectors;
mod sheet;
mod silhouette;
mod source;
mod targets;
mod ticks;
mod view;

pub use antenna::of_antenna;
pub use bars::Bars;
pub use curves::{Curves, Series};
pub use estimated::{EstimatedMap, Model, ReceptionCurve};
pub use file::{Figure, FileFormat};
pub use gallery::{all, all_of_maps};
pub use layout::Layout;
pub use packets::{PacketSource, Window, of_packets};
pub use source::Source;
