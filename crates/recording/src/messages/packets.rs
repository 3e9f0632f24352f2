//! The messages of the packet trace.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// A packet that a station offered to its link, and what became of it.
#[derive(Clone, PartialEq, prost::Message)]
pub struct PacketMessage {
    /// Identity of the packet in the recording: counted from 0, in the order in which packets end.
    #[prost(uint64, tag = "1")]
    pub packet: u64,
    /// Name of the network; empty if there is one network without a name.
    #[prost(string, tag = "2")]
    pub network: String,
    /// Index of the station that offered it: nodes come first, then robots, then sinks.
    #[prost(uint32, tag = "3")]
    pub source: u32,
    /// `data`, `broadcast`, `sweep` or `answer`.
    #[prost(string, tag = "4")]
    pub kind: String,
    /// Number among the packets of this kind of its station, from 0.
    #[prost(uint32, tag = "5")]
    pub number: u32,
    /// Sequence number on the air, if it has one and was first in its queue.
    #[prost(uint32, optional, tag = "6")]
    pub sequence: Option<u32>,
    /// Index of the station to which it goes; absent if it goes to all.
    #[prost(uint32, optional, tag = "7")]
    pub destination: Option<u32>,
    /// Size of its frame with header and check sequence (octets).
    #[prost(uint32, tag = "8")]
    pub octets: u32,
    /// When it was offered (ns of simulated time).
    #[prost(uint64, tag = "9")]
    pub offered_ns: u64,
    /// Whether it counts in the summary: a node offered it after the warm-up.
    #[prost(bool, tag = "10")]
    pub counted: bool,
    /// When it was first in its queue (ns).
    #[prost(uint64, optional, tag = "11")]
    pub begun_ns: Option<u64>,
    /// Number of assessments of the channel.
    #[prost(uint32, tag = "12")]
    pub assessments: u32,
    /// Number of transmissions: copies in one attempt are one.
    #[prost(uint32, tag = "13")]
    pub transmissions: u32,
    /// How the link ended its work: `sent`, `acknowledged`, `no_acknowledgement`, `channel_access_failure`, `queue_full`,
    /// `died` or `pending`.
    #[prost(string, tag = "14")]
    pub end: String,
    /// When it did; the end of the simulation if `pending` (ns).
    #[prost(uint64, tag = "15")]
    pub ended_ns: u64,
    /// As what it counts in the summary: `received`, `lost_collision`, `lost_signal`, `out_of_range`, `not_listened`,
    /// `lost_channel_access`, `lost_queue`, `died` or `pending`.
    #[prost(string, tag = "16")]
    pub fate: String,
    /// Why no receiver listened, if the fate is `not_listened`: `transmitting`, `asleep` or `off`; empty otherwise.
    #[prost(string, tag = "17")]
    pub deafness: String,
    /// End of the first transmission that was received (ns).
    #[prost(uint64, optional, tag = "18")]
    pub delivered_ns: Option<u64>,
    /// Energy of the transmitter in its transmissions (J).
    #[prost(double, tag = "19")]
    pub tx_energy_j: f64,
}

/// A transmission of a packet.
#[derive(Clone, PartialEq, prost::Message)]
pub struct TransmissionMessage {
    /// Identity of the packet.
    #[prost(uint64, tag = "1")]
    pub packet: u64,
    /// Number of the attempt, from 0: copies of a frame in one attempt share it.
    #[prost(uint32, tag = "2")]
    pub attempt: u32,
    /// First symbol on air (ns of simulated time).
    #[prost(uint64, tag = "3")]
    pub start_ns: u64,
    /// Time on air (ns).
    #[prost(uint64, tag = "4")]
    pub airtime_ns: u64,
    /// The best outcome at a station that it is for: `received`, `collided`, `weak`, `out_of_range` or `not_listened`.
    #[prost(string, tag = "5")]
    pub outcome: String,
    /// Why no receiver listened, if the outcome is `not_listened`.
    #[prost(string, tag = "6")]
    pub deafness: String,
    /// Index of the station with that outcome, if it heard a signal.
    #[prost(uint32, optional, tag = "7")]
    pub receiver: Option<u32>,
    /// Power there (dBm).
    #[prost(double, optional, tag = "8")]
    pub power_dbm: Option<f64>,
    /// Least ratio of signal to interference and noise there while the receiver followed the frame (dB).
    #[prost(double, optional, tag = "9")]
    pub sinr_db: Option<f64>,
    /// Index of the station whose signal was the strongest other one there, if the frame collided with that of a station.
    #[prost(uint32, optional, tag = "10")]
    pub collided_with: Option<u32>,
    /// End of its acknowledgement, if that was received (ns).
    #[prost(uint64, optional, tag = "11")]
    pub acknowledged_ns: Option<u64>,
}

/// A clear channel assessment for a packet, with the backoff before it.
#[derive(Clone, PartialEq, prost::Message)]
pub struct AssessmentMessage {
    /// Identity of the packet.
    #[prost(uint64, tag = "1")]
    pub packet: u64,
    /// Start of the backoff (ns of simulated time); that of the assessment if none preceded it.
    #[prost(uint64, tag = "2")]
    pub backoff_ns: u64,
    /// Start of the assessment (ns).
    #[prost(uint64, tag = "3")]
    pub start_ns: u64,
    /// Whether it found the channel busy.
    #[prost(bool, tag = "4")]
    pub busy: bool,
}

recorded! {
    "sextant_packets.proto";
    PacketMessage = "Packet": [
        "packet" = 1 Uint64, "network" = 2 String, "source" = 3 Uint32, "kind" = 4 String, "number" = 5 Uint32,
        "sequence" = 6 OptionalUint32, "destination" = 7 OptionalUint32, "octets" = 8 Uint32, "offered_ns" = 9 Uint64,
        "counted" = 10 Bool, "begun_ns" = 11 OptionalUint64, "assessments" = 12 Uint32, "transmissions" = 13 Uint32,
        "end" = 14 String, "ended_ns" = 15 Uint64, "fate" = 16 String, "deafness" = 17 String,
        "delivered_ns" = 18 OptionalUint64, "tx_energy_j" = 19 Double,
    ];
    TransmissionMessage = "Transmission": [
        "packet" = 1 Uint64, "attempt" = 2 Uint32, "start_ns" = 3 Uint64, "airtime_ns" = 4 Uint64,
        "outcome" = 5 String, "deafness" = 6 String, "receiver" = 7 OptionalUint32, "power_dbm" = 8 OptionalDouble,
        "sinr_db" = 9 OptionalDouble, "collided_with" = 10 OptionalUint32, "acknowledged_ns" = 11 OptionalUint64,
    ];
    AssessmentMessage = "Assessment": [
        "packet" = 1 Uint64, "backoff_ns" = 2 Uint64, "start_ns" = 3 Uint64, "busy" = 4 Bool,
    ];
}
