//! The messages of when radios are on by plan.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// A cell in the schedule of a station.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CellMessage {
    /// Index of the station: nodes come first, then robots, then sinks.
    #[prost(uint32, tag = "1")]
    pub station: u32,
    /// Name of the network; empty if there is one network without a name.
    #[prost(string, tag = "2")]
    pub network: String,
    /// Since when the station followed a schedule with the cell (ns of simulated time).
    #[prost(uint64, tag = "3")]
    pub from_ns: u64,
    /// Length of a slot (ns). Slot 0 begins at time 0.
    #[prost(uint64, tag = "4")]
    pub slot_ns: u64,
    /// Number of the slotframe: the lowest one counts in a slot with several cells.
    #[prost(uint32, tag = "5")]
    pub handle: u32,
    /// Length of the slotframe (slots).
    #[prost(uint32, tag = "6")]
    pub slotframe: u32,
    /// Number of the slot in the slotframe.
    #[prost(uint32, tag = "7")]
    pub timeslot: u32,
    /// What the radio channel has beyond the number of the slot.
    #[prost(uint32, tag = "8")]
    pub channel_offset: u32,
    /// `transmit`, `receive`, `shared` and `timekeeping`, separated by blanks.
    #[prost(string, tag = "9")]
    pub options: String,
    /// Index of the station that the cell is for; absent if it is for all.
    #[prost(uint32, optional, tag = "10")]
    pub peer: Option<u32>,
    /// Whether it is for enhanced beacons and nothing else.
    #[prost(bool, tag = "11")]
    pub beacons: bool,
    /// Until when it did (ns of simulated time); absent if it did at the end.
    #[prost(uint64, optional, tag = "12")]
    pub to_ns: Option<u64>,
}

/// The checks of the channel of a station that sleeps.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CheckMessage {
    /// Index of the station: nodes come first, then robots, then sinks.
    #[prost(uint32, tag = "1")]
    pub station: u32,
    /// Name of the network; empty if there is one network without a name.
    #[prost(string, tag = "2")]
    pub network: String,
    /// Start of the first check (ns of simulated time).
    #[prost(uint64, tag = "3")]
    pub first_ns: u64,
    /// From one check to the next (ns).
    #[prost(uint64, tag = "4")]
    pub interval_ns: u64,
    /// How long a check takes in which nobody sends (ns).
    #[prost(uint64, tag = "5")]
    pub length_ns: u64,
}

recorded! {
    "sextant_rhythm.proto";
    CellMessage = "Cell": [
        "station" = 1 Uint32, "network" = 2 String, "from_ns" = 3 Uint64, "slot_ns" = 4 Uint64, "handle" = 5 Uint32,
        "slotframe" = 6 Uint32, "timeslot" = 7 Uint32, "channel_offset" = 8 Uint32, "options" = 9 String,
        "peer" = 10 OptionalUint32, "beacons" = 11 Bool, "to_ns" = 12 OptionalUint64,
    ];
    CheckMessage = "Check": [
        "station" = 1 Uint32, "network" = 2 String, "first_ns" = 3 Uint64, "interval_ns" = 4 Uint64,
        "length_ns" = 5 Uint64,
    ];
}
