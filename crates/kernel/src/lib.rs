//! The kernel of Sextant: what all stages share. It knows nothing about radios.
//!
//! Goes in: instants, events, a seed. Comes out: events in a defined order ([`EventQueue`]),
//! random numbers with an address ([`Seed`]), identities ([`NodeId`], [`StationId`], [`RobotId`]); and how long work is watched ([`Watch`]).
//! Exponentials and logarithms of many numbers at once are in [`maths`].
//!
//! ```
//! use sextant_kernel::{EventQueue, Rank, SimTime, StationId};
//! use std::time::Duration;
//!
//! let mut queue = EventQueue::new();
//! let instant = SimTime::ZERO + Duration::from_micros(320);
//! queue.push(instant, Rank::new(4, StationId(7)), "start of CCA");
//! queue.push(instant, Rank::new(1, StationId(9)), "end of transmission");
//! assert_eq!(queue.pop(), Some((instant, "end of transmission")));
//! ```

mod file_form;
mod files;
pub mod maths;
mod node;
mod queue;
mod random;
mod robot;
mod setting;
mod station;
pub mod text;
mod time;
mod watch;

pub use file_form::{FileForm, root_of_xml, seen};
pub use files::{Files, LARGEST_FILE, is_within, read_at_most, read_text_at_most};
pub use node::NodeId;
pub use queue::{EventKey, EventQueue, Rank};
pub use random::{Draws, Purpose, Seed, Stream};
pub use robot::RobotId;
pub use setting::{SettingError, SettingProblem};
pub use station::StationId;
pub use time::SimTime;
pub use watch::{Interrupted, Unreported, Unwatched, Watch, Work};
