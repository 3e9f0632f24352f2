//! TSCH as written in a scenario.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::TimeslotConfig;

/// Time-slotted channel hopping (TSCH) of IEEE 802.15.4, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TschConfig {
    /// When stations may send and listen.
    pub schedule: ScheduleConfig,
    /// The numbers of the radio channels, in the order of the hops; if absent, the sequence of 16 channels of the standard at
    /// 2450 MHz, and all channels elsewhere. With one channel nothing hops. `radio.channel` is not set beside it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hopping: Option<Vec<u8>>,
    /// Further transmissions of a frame without acknowledgement (macMaxFrameRetries): 0 to 15.
    #[serde(default = "default_max_retries")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 15)))]
    pub max_retries: u8,
    /// Back-off exponent after the first failure in a shared cell (macMinBE): 0 to max_be. Contiki-NG has 2 in these terms.
    #[serde(default = "default_min_be")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 8)))]
    pub min_be: u8,
    /// Largest back-off exponent (macMaxBE): at most 8.
    #[serde(default = "default_max_be")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 8)))]
    pub max_be: u8,
    /// Frames that wait for each neighbour, and for all together, that under way included; one more is lost: 1 to 10000.
    #[serde(default = "default_queue_frames")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 10000)))]
    pub queue_frames: u16,
    /// What happens when within a slot.
    #[serde(default)]
    pub timeslot: TimeslotConfig,
    /// Enhanced beacons, by which nodes join and correct their clocks; none are sent if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beacons: Option<BeaconsConfig>,
    /// How nodes join and keep the time.
    #[serde(default)]
    pub synchronisation: SynchronisationConfig,
}

const fn default_max_retries() -> u8 {
    3
}

const fn default_min_be() -> u8 {
    1
}

const fn default_max_be() -> u8 {
    7
}

const fn default_queue_frames() -> u16 {
    16
}

/// When stations may send and listen, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum ScheduleConfig {
    /// The minimal schedule of 6TiSCH (RFC 8180): one cell in each slotframe, which all stations share.
    Minimal(MinimalConfig),
    /// Orchestra: cells by the numbers of the stations, without negotiation.
    Orchestra(OrchestraConfig),
    /// MSF, the minimal scheduling function of 6TiSCH (RFC 9033): stations agree with their parents on as many cells as they use.
    Msf(MsfConfig),
    /// The cells of each station, as a list or a file.
    Own(OwnScheduleConfig),
}

/// The minimal schedule of 6TiSCH, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MinimalConfig {
    /// Length of the slotframe (slots): 1 to 65535. A length that has no factor in common with the number of channels hops over
    /// all of them.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub slotframe: u16,
}

impl Default for MinimalConfig {
    fn default() -> Self {
        Self { slotframe: 101 }
    }
}

/// Orchestra, as written in a scenario. Defaults are those of Contiki-NG.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct OrchestraConfig {
    /// Length of the slotframe of enhanced beacons (slots): 1 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub beacon_slotframe: u16,
    /// Length of the slotframe of frames between two stations (slots): 1 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub unicast_slotframe: u16,
    /// Length of the slotframe that all share (slots): 1 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub shared_slotframe: u16,
    /// Who owns the cells between two stations.
    pub unicast: UnicastConfig,
}

impl Default for OrchestraConfig {
    fn default() -> Self {
        Self { beacon_slotframe: 397, unicast_slotframe: 17, shared_slotframe: 31, unicast: UnicastConfig::default() }
    }
}

/// Who owns the cells between two stations, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum UnicastConfig {
    /// Each station listens in one cell, in which all others may send to it.
    #[default]
    ReceiverBased,
    /// Each station sends in one cell, in which those listen to which it may send: sinks to all nodes, and nodes to their children
    /// in a tree that is known before the start.
    SenderBased,
}

/// MSF, as written in a scenario. Names and defaults are those of RFC 9033, table 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MsfConfig {
    /// Length of its three slotframes (SLOTFRAME_LENGTH, slots): 3 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 65535)))]
    pub slotframe: u16,
    /// So many cells to the parent go by between two decisions (MAX_NUMCELLS): 4 to 10000. Fewer follow a changing load faster.
    #[cfg_attr(feature = "schema", schemars(range(min = 4, max = 10000)))]
    pub max_num_cells: u16,
    /// If more of these cells were used, one more is asked for (LIM_NUMCELLSUSED_HIGH): up to max_num_cells.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 10000)))]
    pub lim_num_cells_used_high: u16,
    /// If fewer of these cells were used, one is given up (LIM_NUMCELLSUSED_LOW): up to lim_num_cells_used_high.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 10000)))]
    pub lim_num_cells_used_low: u16,
}

impl Default for MsfConfig {
    fn default() -> Self {
        Self { slotframe: 101, max_num_cells: 100, lim_num_cells_used_high: 75, lim_num_cells_used_low: 25 }
    }
}

/// A schedule of one's own, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct OwnScheduleConfig {
    /// Length of the slotframe (slots): 1 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub slotframe: u16,
    /// The cells.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub cells: Vec<CellConfig>,
    /// A CSV file with more cells: columns `node`, `peer`, `timeslot`, `channel_offset` and `options`, as in `cells`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
}

/// A cell of a schedule of one's own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CellConfig {
    /// The node or sink whose cell it is; `*` for all.
    pub node: String,
    /// The node or sink to which it sends, or that it hears; `*` for all.
    pub peer: String,
    /// The slot: from 0, below the length of the slotframe.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 65534)))]
    pub timeslot: u16,
    /// What its channel has beyond the number of the slot: from 0.
    #[serde(default)]
    pub channel_offset: u16,
    /// What it is for: one or more of `transmit`, `receive`, `shared`, `timekeeping`, separated by blanks.
    pub options: String,
}

/// Enhanced beacons, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct BeaconsConfig {
    /// Longest time between the beacons of a station (s): 0.01 to 100000. Each time is drawn from 75 to 100 % of it.
    pub interval_s: f64,
}

impl Default for BeaconsConfig {
    fn default() -> Self {
        Self { interval_s: 16.0 }
    }
}

/// How nodes join and keep the time, as written in a scenario. It matters if `radio.clock_ppm` is not 0 or nodes scan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SynchronisationConfig {
    /// How nodes come into the network.
    pub joining: JoiningConfig,
    /// A node that has corrected its clock for so long by nothing that it heard sends an empty frame to its time source (s): 0.1
    /// to 100000. Never if clocks are exact.
    pub keep_alive_s: f64,
    /// After so long without a correction a node has lost the network, and scans (s): above `keep_alive_s`, to 1000000.
    pub lost_after_s: f64,
}

impl Default for SynchronisationConfig {
    fn default() -> Self {
        Self { joining: JoiningConfig::default(), keep_alive_s: 12.0, lost_after_s: 120.0 }
    }
}

/// How nodes come into the network, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum JoiningConfig {
    /// They are in it from the start.
    #[default]
    AtStart,
    /// They listen on one channel after the other until they hear an enhanced beacon.
    ByScan,
}
