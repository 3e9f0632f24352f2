//! Reports: a run, the map of a robot's log, the table of a sweep or a reproduction as one HTML file for a browser.
//!
//! A [`Report`] is the document: its sections with their data. [`Report::to_html`] puts it with the code that shows it into
//! one file, which needs no network. The same document gives the same bytes.
//!
//! ```no_run
//! use std::path::Path;
//! use sextant_report::Report;
//!
//! let html = Report::of_recording(Path::new("circular.mcap"))?.to_html();
//! std::fs::write("circular.html", html)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod column;
mod document;
mod error;
mod frame;
mod log;
mod map;
mod missions;
mod page;
mod plane;
mod policy;
mod reproduction;
mod run;
mod survey;
mod sweep;
mod tables;
mod text;
mod tree;
mod world;

pub use column::Column;
pub use document::{DocumentKind, Origin, Report};
pub use error::ReportError;
pub use frame::Frame;
pub use map::{Map, NodeDetails, Snapshot};
pub use missions::{Captures, Predictions, ReportedMission, TimeSeries};
pub use page::live_page;
pub use plane::Plane;
pub use reproduction::{Claims, Reproduction};
pub use survey::{Contacts, Receptions, Sector, Stops, Survey};
pub use sweep::{MeasureOfMap, SweepColumn, SweepTable, SweepValues};
pub use tree::{ChosenParents, Deaths, Tree};
pub use world::{Body, Marks, PhaseSpan, Solid, Way, World};
