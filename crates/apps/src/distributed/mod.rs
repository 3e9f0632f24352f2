//! Maps that are computed in the nodes (Gunathillake 2018, chapter 5): DMmTM with static anchors, and with mobile
//! anchors too.
//!
//! Each node works out its own place from the packets that it received. All that it knows of others came in messages
//! over the MAC; `message.rs` has their layout.
//!
//! 1. **Mobile anchors**, if there are any, drive and tell at each stop their place and the directions of their
//!    sectors, from all sectors.
//! 2. **Directions.** Static anchors know their places but not the directions of their sectors. Each sweeps a PLACE.
//!    Anchors that heard it sweep a REPORT: in which sector they heard whom best. From the reports each anchor works
//!    out how its antenna is turned.
//! 3. **Information gathering.** Anchors sweep a BEACON: place and directions. Nodes listen in all directions and keep
//!    the best sector of each anchor.
//! 4. **Information mapping.** A node computes the likelihood of its place on a grid.
//! 5. **Node filtration.** Nodes tell their COORDINATES. A node that sees its neighbours within the radius of
//!    communication becomes an anchor, once and for all, and joins by PLACE, REPORT and BEACON; one that does not, or
//!    that has no place, computes again with the new anchors. All nodes act at the same instants, so the order of the
//!    nodes does not matter. This repeats until no node is bad, or as often as allowed.
//!
//! An anchor whose bearings contradict each other can give up its place (`doubt_below`): then it was put up elsewhere than it
//! was told, and works out its place as the other nodes do.
//!
//! Without sectors (IEEE 802.15.4) there is no REPORT, nor a PLACE unless beacons pass on the places of other anchors, and
//! the distance alone is evidence.

mod belief;
mod config;
mod filtration;
mod message;
mod mobile_anchor;
mod neighbours;
mod node;
mod outbox;
mod patterns;
mod record;
mod schedule;

pub use config::{BearingSource, DistributedMapping, DistributedMappingConfig, Exchange, PatternBearings, Recompute};
pub use filtration::Category;
pub use mobile_anchor::MobileAnchor;
pub use node::{MappingNode, NodeAntenna};
pub use patterns::Patterns;
pub use record::{MappingRecord, MappingRole, MessageCounts};
