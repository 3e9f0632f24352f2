//! Links of IEEE 802.15.4 with time-slotted channel hopping (TSCH).
//!
//! A station takes an event only for slots in which it sends. Who could hear a frame is woken when it begins; slots in which a
//! station listens and nobody sends to it are counted by its schedule, without an event.

mod cell_history;
mod cells;
mod links;
mod plan;
mod settings;
mod stack;
mod usage;

pub(crate) use links::Links;
pub use plan::CellFault;
pub use settings::Tsch;
pub(super) use settings::Tsch as Settings;
