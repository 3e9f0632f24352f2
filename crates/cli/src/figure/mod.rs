//! Figures of a run for papers and pages: from a recording to pictures, SVG or PNG.
//!
//! Goes in: the reception log of a recording and what it shows in space. Comes out: a [`Figure`] each of the network
//! with the survey, of every map, of the distribution of all maps' errors, and of every likelihood surface. The same
//! recording gives the same bytes. Colours are told apart with any colour vision: Okabe and Ito's for kinds, viridis,
//! darker for more, for numbers.
//!
//! ```no_run
//! use std::path::Path;
//! use sextant::figure::{self, FileFormat, Source};
//! use sextant::recording::{read_drawn, read_log};
//!
//! let recording = Path::new("circular.mcap");
//! let (run, drawn) = (read_log(recording)?, read_drawn(recording)?);
//! for figure in figure::all(&Source { title: "circular", log: &run.log, drawn: &drawn }) {
//!     figure.write(Path::new("."), FileFormat::Svg)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod axes;
mod curves;
mod distribution;
mod file;
mod gallery;
mod likelihood;
mod map;
mod network;
mod paint;
mod palette;
mod picture;
mod sheet;
mod silhouette;
mod source;
mod ticks;
mod view;

pub use curves::{Curves, Series};
pub use file::{Figure, FileFormat};
pub use gallery::all;
pub use source::Source;
