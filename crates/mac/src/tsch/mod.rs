//! Time-slotted channel hopping (TSCH) of IEEE 802.15.4, without i/o: when a station may send and listen, and on which
//! channel; what it sends in a slot; how it backs off in shared cells; how its clock follows that of a neighbour.
//!
//! Goes in: the cells of a station ([`Schedule`]), the frames that it has, and what became of those that it sent. Comes out:
//! the next slot in which it sends ([`Sender::next`]), its channel ([`Hopping`]), the instant of that slot ([`SlotClock`]), and
//! the octets of its frames ([`frame`]). Slots in which a station has nothing to send are not stepped through: they are
//! counted ([`Schedule::listens_within`]).
//!
//! The default sequence of channels goes round in 16 slots; a slotframe of 101 slots therefore visits all of them:
//!
//! ```
//! use sextant_mac::Phy;
//! use sextant_mac::tsch::{Asn, Hopping};
//!
//! let hopping = Hopping::usual(Phy::Oqpsk2450);
//! assert_eq!((hopping.channel(Asn(0), 0), hopping.channel(Asn(101), 0)), (16, 15));
//! assert_eq!(hopping.channels_visited(101), 16);
//! ```

pub mod frame;

mod asn;
mod cell;
mod config;
mod hopping;
mod msf;
mod orchestra;
mod schedule;
mod sender;
mod settings;
mod six_p;
mod slot;
mod slot_clock;
mod timeslot;

pub use asn::Asn;
pub use cell::{Cell, CellOptions, CellPeer, Slotframe};
pub use config::{
    BeaconsConfig, CellConfig, JoiningConfig, MinimalConfig, MsfConfig, OrchestraConfig, OwnScheduleConfig,
    ScheduleConfig, SynchronisationConfig, TschConfig, UnicastConfig,
};
pub use hopping::Hopping;
pub use msf::{Autonomous, Ended, Msf, MsfRules, MsfUse};
pub use orchestra::{Orchestra, UnicastCells};
pub use schedule::{Heard, Rule, Schedule};
pub use sender::{Chance, Ending, Sender, Turn};
pub use settings::{BackoffExponents, ScheduleKind, Synchronisation, TschSettings};
pub use six_p::{CellPlace, ReturnCode, SixP, SixPBody, SixPCommand};
pub use slot::{SlotCounts, SlotKind};
pub use slot_clock::SlotClock;
pub use timeslot::{Timeslot, TimeslotConfig};
