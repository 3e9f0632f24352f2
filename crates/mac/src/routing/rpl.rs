//! RPL, the routing protocol for networks of low power and with losses (RFC 6550), without i/o: ranks ([`Rank`]), what a
//! station learns of a link ([`LinkStatistics`]), objective functions ([`Objective`]), the place of a station in a tree
//! ([`Dodag`]), its registration with those above ([`Registration`]), ways down ([`RouteTable`]), and octets
//! ([`Message`], [`Datagram`]).
//!
//! Goes in: messages that a station heard, what became of its frames, and the time. Comes out: its parent and rank, and what
//! is to be done ([`Action`]). Numbers and rules are those of Contiki-NG (its folder `rpl-lite`, commit 01809bb4), where
//! RFC 6550 leaves them open.
//!
//! A station that hears a root, and knows the link well enough, is one hop below it:
//!
//! ```
//! use sextant_kernel::{SimTime, StationId};
//! use sextant_mac::routing::rpl::{Dio, Dodag, DodagSettings, LinkOutcome, Rank};
//!
//! let (root, node) = (StationId(9), StationId(1));
//! let mut dodag = Dodag::of_node(node, DodagSettings::default());
//! dodag.heard(root, &Dio { root, rank: Rank(256), dtsn: 0 }, SimTime::ZERO);
//! for s in 1..=4 {
//!     dodag.sent(root, 1, LinkOutcome::Acknowledged, SimTime::from_secs(s));
//! }
//! assert_eq!((dodag.parent(), dodag.rank()), (Some(root), Rank(512)));
//! ```

mod address;
mod datagram;
mod dodag;
mod frame;
mod link;
mod message;
mod neighbours;
mod objective;
mod rank;
mod registration;
mod route_table;
mod settings;

pub use datagram::{
    Content, Datagram, Direction, HOP_LIMIT, LEAST_DATA_OCTETS, OptionFlags, RplOption, SourceRoute,
    source_route_octets,
};
pub use dodag::{Action, Dodag, Stage};
pub use frame::{RplFrame, local_octets};
pub use link::{ETX_UNIT, LinkOutcome, LinkStatistics};
pub use message::{Dao, DaoAck, DaoStatus, Dio, DioConfiguration, Message};
pub use objective::{Mrhof, Objective, StepOfRank};
pub use rank::Rank;
pub use registration::Registration;
pub use route_table::{Learned, RouteTable, TableFull};
pub use settings::{DodagSettings, Downward, Probing};
