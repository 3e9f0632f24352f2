//! The message types of Sextant. Field numbers are permanent: a new field gets a new number, and no field is renumbered.
//! `docs/recording.md` gives the meaning and the units of the fields.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use self::descriptor::Declaration;

/// Gives message types their stable names and their descriptors. The descriptors of one `file` are in each recording that
/// has a message of it, so a new message in an old file would change the bytes of recordings without that message.
macro_rules! recorded {
    ($file:literal; $($message:ident = $name:literal: [$($field:literal = $number:literal $kind:ident),+ $(,)?];)+) => {
        /// The declarations of the message types in the recording. The numbers are those of the structs above; tests
        /// compare them, and decode them with an independent reader.
        pub(in crate) const DECLARATIONS: &[Declaration] = &[$(Declaration {
            name: $name,
            fields: &[$(descriptor::Field { name: $field, number: $number, kind: descriptor::FieldKind::$kind }),+],
        }),+];

        $(impl Encode for $message {
            type Error = prost::EncodeError;

            fn get_schema() -> Option<Schema> {
                Some(Schema::new(
                    concat!("sextant.", $name),
                    "protobuf",
                    descriptor::file_set($file, DECLARATIONS),
                ))
            }

            fn get_message_encoding() -> String {
                "protobuf".to_owned()
            }

            fn encode(&self, buffer: &mut impl BufMut) -> Result<(), prost::EncodeError> {
                prost::Message::encode(self, buffer)
            }

            fn encoded_len(&self) -> Option<usize> {
                Some(prost::Message::encoded_len(self))
            }
        })+
    };
}

pub(super) mod applications;
mod battery;
pub(crate) mod descriptor;
pub(super) mod distributed;
pub(crate) mod names;
pub(super) mod networks;
pub(super) mod packets;
pub(super) mod parents;
pub(crate) mod phase;
pub(super) mod ranges;
pub(super) mod rhythm;
pub(super) mod routing;
pub(super) mod sector_gains;
pub(super) mod sector_snrs;
pub(crate) mod sensation;
pub(super) mod sensing;
pub(super) mod stop_receptions;

pub use applications::{ApplicationMessage, CaptureMessage, EstimateMessage};
pub use battery::BatteryMessage;
pub use distributed::MappedNodeMessage;
pub(crate) use networks::{NetworksMessage, SectorMessage};
pub use packets::{AssessmentMessage, PacketMessage, TransmissionMessage};
pub use parents::ParentChangeMessage;
pub(crate) use ranges::RangeMessage;
pub use rhythm::{CellMessage, CheckMessage};
pub use routing::{HopMessage, TreeEdgeMessage};
pub(crate) use sector_gains::SectorGainsMessage;
pub(crate) use sector_snrs::SectorSnrsMessage;
pub(crate) use sensing::SensedMessage;
pub use sensing::SensorsMessage;
pub(crate) use stop_receptions::StopReceptionsMessage;

/// Names of the nodes that the robot knows, heard or not, without positions.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct NodesMessage {
    /// Index of the first of `names`.
    #[prost(uint32, tag = "1")]
    pub(crate) first: u32,
    /// Names of the nodes `first`, `first + 1`, ...
    #[prost(string, repeated, tag = "2")]
    pub(crate) names: Vec<String>,
}

/// A place where a robot listened.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct StopMessage {
    /// Index of the stop in the recording, counted from 0 without gaps.
    #[prost(uint32, tag = "1")]
    pub(crate) stop: u32,
    /// When listening began (ns of simulated time).
    #[prost(uint64, tag = "2")]
    pub(crate) time_ns: u64,
    /// East (m).
    #[prost(double, tag = "3")]
    pub(crate) x_m: f64,
    /// North (m).
    #[prost(double, tag = "4")]
    pub(crate) y_m: f64,
    /// Up (m).
    #[prost(double, tag = "5")]
    pub(crate) z_m: f64,
    /// Name of the robot.
    #[prost(string, tag = "6")]
    pub(crate) robot: String,
    /// Number of the receptions of this stop, which follow it: as many `Reception` messages, or one `StopReceptions`. With
    /// it a reader detects an incomplete stop.
    #[prost(uint32, tag = "7")]
    pub(crate) receptions: u32,
    /// How the robot's antenna was turned, counterclockwise from x (rad), if its sectors turn with it.
    #[prost(double, optional, tag = "8")]
    pub(crate) heading_rad: Option<f64>,
}

/// The packets received from one node at one stop.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct ReceptionMessage {
    /// Index of the node.
    #[prost(uint32, tag = "1")]
    pub(crate) node: u32,
    /// Index of the stop.
    #[prost(uint32, tag = "2")]
    pub(crate) stop: u32,
    /// Packets received, at most `sent`.
    #[prost(uint32, tag = "3")]
    pub(crate) received: u32,
    /// Packets that the node is known to have sent while the robot listened. 0 received of 0 sent is no evidence.
    #[prost(uint32, tag = "4")]
    pub(crate) sent: u32,
    /// Antenna sector with the best reception, 0 to 255.
    #[prost(uint32, optional, tag = "5")]
    pub(crate) sector: Option<u32>,
    /// Mean received signal strength (dBm).
    #[prost(double, optional, tag = "6")]
    pub(crate) rssi_dbm: Option<f64>,
    /// Signal-to-noise ratio of the robot's own best packet, as the node reported it (dB).
    #[prost(double, optional, tag = "7")]
    pub(crate) snr_db: Option<f64>,
    /// Link quality of IEEE 802.15.4 at the mean received signal strength: 0 at the sensitivity, 255 at 40 dB or more above it.
    #[prost(uint32, optional, tag = "8")]
    pub(crate) lqi: Option<u32>,
}

/// A point of an obstacle that the range sensor of a robot detected.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct ContactMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub(crate) time_ns: u64,
    /// East (m).
    #[prost(double, tag = "2")]
    pub(crate) x_m: f64,
    /// North (m).
    #[prost(double, tag = "3")]
    pub(crate) y_m: f64,
    /// Up (m).
    #[prost(double, tag = "4")]
    pub(crate) z_m: f64,
}

/// The packets that one node received from another node or from an anchor.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct LinkMessage {
    /// Index of the node that heard.
    #[prost(uint32, tag = "1")]
    pub(crate) listener: u32,
    /// Index of the node that was heard.
    #[prost(uint32, tag = "2")]
    pub(crate) sender: u32,
    /// Packets received, at most `sent`.
    #[prost(uint32, tag = "3")]
    pub(crate) received: u32,
    /// Packets that the sender sent.
    #[prost(uint32, tag = "4")]
    pub(crate) sent: u32,
    /// Mean received signal strength (dBm).
    #[prost(double, optional, tag = "5")]
    pub(crate) rssi_dbm: Option<f64>,
}

/// A node that knows its position.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct AnchorMessage {
    /// Index of the node.
    #[prost(uint32, tag = "1")]
    pub(crate) node: u32,
    /// East (m).
    #[prost(double, tag = "2")]
    pub(crate) x_m: f64,
    /// North (m).
    #[prost(double, tag = "3")]
    pub(crate) y_m: f64,
    /// Up (m).
    #[prost(double, tag = "4")]
    pub(crate) z_m: f64,
}

/// A frame that was on air.
#[derive(Clone, PartialEq, prost::Message)]
pub struct FrameMessage {
    /// First symbol on air (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub start_ns: u64,
    /// Time on air (ns).
    #[prost(uint64, tag = "2")]
    pub airtime_ns: u64,
    /// Index of the station that sent it: nodes come first, then robots, then sinks.
    #[prost(uint32, tag = "3")]
    pub source: u32,
    /// The MAC frame, its check sequence included.
    #[prost(bytes = "vec", tag = "4")]
    pub mpdu: Vec<u8>,
    /// The best outcome at any robot or sink or, for a frame of one, at any node: `received`, `collided`, `weak`,
    /// `out_of_range` or `not_listened`.
    #[prost(string, tag = "5")]
    pub outcome: String,
    /// Received power at that station (dBm), if it was measured.
    #[prost(double, optional, tag = "6")]
    pub power_dbm: Option<f64>,
    /// Name of the network in which it was sent; empty if there is one network without a name.
    #[prost(string, tag = "7")]
    pub network: String,
    /// Why no receiver listened, if the outcome is `not_listened`: `transmitting`, `asleep` or `off`; empty otherwise.
    #[prost(string, tag = "8")]
    pub deafness: String,
}

/// One value of a time series.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct MetricMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub(crate) time_ns: u64,
    /// Name, ending in its unit: `path_length_m`.
    #[prost(string, tag = "2")]
    pub(crate) name: String,
    /// Value in the unit of `name`.
    #[prost(double, tag = "3")]
    pub(crate) value: f64,
}

/// All own messages.
pub(crate) fn declarations() -> impl Iterator<Item = &'static Declaration> {
    let all = [
        DECLARATIONS,
        applications::DECLARATIONS,
        battery::DECLARATIONS,
        distributed::DECLARATIONS,
        networks::DECLARATIONS,
        packets::DECLARATIONS,
        parents::DECLARATIONS,
        ranges::DECLARATIONS,
        rhythm::DECLARATIONS,
        routing::DECLARATIONS,
        sector_gains::DECLARATIONS,
        sector_snrs::DECLARATIONS,
        sensing::DECLARATIONS,
        stop_receptions::DECLARATIONS,
    ];
    all.into_iter().flatten()
}

recorded! {
    "sextant.proto";
    NodesMessage = "Nodes": ["first" = 1 Uint32, "names" = 2 Strings];
    StopMessage = "Stop": [
        "stop" = 1 Uint32, "time_ns" = 2 Uint64, "x_m" = 3 Double, "y_m" = 4 Double, "z_m" = 5 Double,
        "robot" = 6 String, "receptions" = 7 Uint32, "heading_rad" = 8 OptionalDouble,
    ];
    ReceptionMessage = "Reception": [
        "node" = 1 Uint32, "stop" = 2 Uint32, "received" = 3 Uint32, "sent" = 4 Uint32,
        "sector" = 5 OptionalUint32, "rssi_dbm" = 6 OptionalDouble, "snr_db" = 7 OptionalDouble,
        "lqi" = 8 OptionalUint32,
    ];
    ContactMessage = "Contact": ["time_ns" = 1 Uint64, "x_m" = 2 Double, "y_m" = 3 Double, "z_m" = 4 Double];
    FrameMessage = "Frame": [
        "start_ns" = 1 Uint64, "airtime_ns" = 2 Uint64, "source" = 3 Uint32, "mpdu" = 4 Bytes, "outcome" = 5 String,
        "power_dbm" = 6 OptionalDouble, "network" = 7 String, "deafness" = 8 String,
    ];
    MetricMessage = "Metric": ["time_ns" = 1 Uint64, "name" = 2 String, "value" = 3 Double];
    LinkMessage = "Link": [
        "listener" = 1 Uint32, "sender" = 2 Uint32, "received" = 3 Uint32, "sent" = 4 Uint32,
        "rssi_dbm" = 5 OptionalDouble,
    ];
    AnchorMessage = "Anchor": ["node" = 1 Uint32, "x_m" = 2 Double, "y_m" = 3 Double, "z_m" = 4 Double];
}
