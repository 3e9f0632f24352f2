//! The messages of packets that go over several hops.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// A hop of a packet that goes over several: what its header says, for a packet of the packet trace.
#[derive(Clone, PartialEq, prost::Message)]
pub struct HopMessage {
    /// Identity of the packet of the trace: it is one hop.
    #[prost(uint64, tag = "1")]
    pub packet: u64,
    /// Index of the station that had the packet first.
    #[prost(uint32, tag = "2")]
    pub origin: u32,
    /// Its number there, of 16 bits.
    #[prost(uint32, tag = "3")]
    pub number: u32,
    /// Hops before this one.
    #[prost(uint32, tag = "4")]
    pub hops: u32,
    /// Index of the station where it should arrive; absent if that may be any sink.
    #[prost(uint32, optional, tag = "5")]
    pub target: Option<u32>,
    /// When its origin had it (ns of simulated time): before it waited in the queues of stations.
    #[prost(uint64, tag = "6")]
    pub origin_offered_ns: u64,
}

/// A node in the tree at the end.
#[derive(Clone, PartialEq, prost::Message)]
pub struct TreeEdgeMessage {
    /// Index of the node.
    #[prost(uint32, tag = "1")]
    pub node: u32,
    /// Name of its parent, a node or a sink; empty without one.
    #[prost(string, tag = "2")]
    pub parent: String,
    /// Hops to a sink along the parents; absent without a way.
    #[prost(uint32, optional, tag = "3")]
    pub depth: Option<u32>,
    /// Expected transmissions of a packet to the parent; absent if they are not known.
    #[prost(double, optional, tag = "4")]
    pub etx: Option<f64>,
    /// How often it changed its parent.
    #[prost(uint32, tag = "5")]
    pub changes: u32,
    /// Index of its parent among the stations, nodes first and then sinks; absent without one.
    #[prost(uint32, optional, tag = "6")]
    pub parent_station: Option<u32>,
    /// When the node died, by a fault or of an empty battery (ns since the start); absent if it lives.
    #[prost(uint64, optional, tag = "7")]
    pub died_ns: Option<u64>,
}

recorded! {
    "sextant_routing.proto";
    HopMessage = "Hop": [
        "packet" = 1 Uint64, "origin" = 2 Uint32, "number" = 3 Uint32, "hops" = 4 Uint32, "target" = 5 OptionalUint32,
        "origin_offered_ns" = 6 Uint64,
    ];
    TreeEdgeMessage = "TreeEdge": [
        "node" = 1 Uint32, "parent" = 2 String, "depth" = 3 OptionalUint32, "etx" = 4 OptionalDouble,
        "changes" = 5 Uint32, "parent_station" = 6 OptionalUint32, "died_ns" = 7 OptionalUint64,
    ];
}
