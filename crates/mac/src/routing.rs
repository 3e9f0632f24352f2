//! Routing over several hops, without i/o: the octets of its packets ([`Packet`]), the quality of links
//! ([`LinkEstimate`]), when to send beacons ([`Trickle`]), the tree that beacons build ([`Collection`]), and packets that
//! come twice ([`Seen`]), ways down from the root ([`SourceRoutes`]), packets in pieces ([`fragment`]), and RPL ([`rpl`]).
//!
//! Goes in: beacons and packets that a station heard, and what became of the frames that it sent. Comes out: its parent,
//! the expected number of transmissions to the root, and whether its beacons must come sooner. The tree is that of CTP
//! (Gnawali, Fonseca, Jamieson, Moss, Levis, Collection Tree Protocol, SenSys 2009; numbers as in its implementation in
//! TinyOS).
//!
//! After three beacons a node knows its way:
//!
//! ```
//! use sextant_kernel::StationId;
//! use sextant_mac::routing::{Beacon, Collection};
//!
//! let (root, node) = (StationId(9), StationId(1));
//! let mut tree = Collection::of_node(node, 1.5);
//! for number in 0..3 {
//!     tree.heard(root, &Beacon { parent: None, cost: Some(0.0), number, pulls: false });
//! }
//! assert_eq!((tree.parent(), tree.cost()), (Some(root), Some(1.0)));
//! ```

mod collection;
mod estimate;
pub mod fragment;
mod neighbours;
mod packet;
pub mod rpl;
mod seen;
mod source_routes;
mod trickle;

pub use collection::{Collection, Reaction};
pub use estimate::LinkEstimate;
pub use packet::{BEACON_OCTETS, Beacon, Data, Down, HEADER_OCTETS, MAX_STATIONS, Packet, down_octets};
pub use seen::{Repeat, Seen};
pub use source_routes::SourceRoutes;
pub use trickle::Trickle;

/// Links with more expected transmissions are not used.
pub const MOST_LINK_ETX: f64 = 5.0;

/// A packet that has been sent over so many hops is dropped.
pub const HOP_LIMIT: u8 = 64;
