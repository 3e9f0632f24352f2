//! Routing over several hops: the packets of nodes go along a tree to a sink.
//!
//! The tree is given, or made of the shortest ways from the layout, or built by the beacons of the stations
//! ([`sextant_mac::routing`]), or by RPL ([`sextant_mac::routing::rpl`]). Each node has a queue of packets. It gives them one by one to its MAC, which waits for the
//! acknowledgement of the next station, and gives a packet again that was not acknowledged. All that a station knows of
//! others came in frames; see [`sextant_mac::routing::Packet`] for their octets.
//!
//! Goes in: a [`Routing`], that is settings and a tree among the stations of a setup. Comes out: a [`RoutingRecord`]: what
//! became of each packet, from where it was offered to where it goes, and of the tree.

mod config;
mod counts;
mod deliveries;
mod downward;
mod expected;
mod links;
mod outbox;
mod reassembly;
mod record;
mod router;
mod rpl;
mod rpl_router;
mod sending;
mod settings;
mod simulation;
mod source;
mod tree;
mod way;

pub use config::{
    CollectionConfig, FragmentsConfig, GivenTreeConfig, RoutedTo, RoutingConfig, ShortestTreeConfig, TreeConfig,
    TreeMetric,
};
pub use counts::{Counts, RplCounts};
pub use deliveries::Deliveries;
pub use record::{ParentChange, RoutedStation, RoutingRecord};
pub use rpl::{MrhofConfig, ObjectiveConfig, Of0Config, RankErrors, RplConfig, RplMode, StepOfRankConfig};
pub use settings::Routing;
