//! A tree of RPL as written in a scenario.

use serde::{Deserialize, Serialize};

/// A tree that the stations build by RPL (RFC 6550), as written in a scenario. Numbers that are absent are those of Contiki-NG,
/// but for the least increase of the rank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RplConfig {
    /// What makes one parent better than another.
    pub objective: ObjectiveConfig,
    /// Who knows ways down: `non_storing`, `storing` or `none`.
    pub mode: RplMode,
    /// Least increase of the rank over a hop (MinHopRankIncrease), which is the rank of the root too: 1 to 4096. Contiki-NG
    /// has 128 with `mrhof`, so that a rank is the number of expected transmissions; RFC 6550 has 256.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 4096)))]
    pub min_hop_rank_increase: u16,
    /// A node uses no neighbour whose rank is greater by more than that than the least rank that the node had
    /// (MaxRankIncrease): 0 to 65535, where 0 is no limit.
    pub max_rank_increase: u16,
    /// Shortest interval of DIOs (s), at the start and after a change: 0.001 to 1000. RFC 6550 has 0.008.
    pub dio_min_s: f64,
    /// How often the interval of DIOs doubles: 0 to 20. RFC 6550 has 20.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 20)))]
    pub dio_doublings: u8,
    /// A DIO is left out if so many were heard in its interval: 0 to 255, where 0 is never. RFC 6550 has 10.
    pub dio_redundancy: u8,
    /// A node without a parent asks for DIOs (DIS) after this time (s), and again: 1 to 100000. Each wait is drawn in 50 to 150 %.
    pub dis_interval_s: f64,
    /// Time from another parent to the DAO (s): 0.1 to 1000. Each wait is drawn in 50 to 150 %.
    pub dao_delay_s: f64,
    /// How often a DAO is sent until it is answered: 0 to 100. With 0 no answer is asked for, and ways are refreshed after
    /// half of their time.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    pub dao_tries: u8,
    /// Time until a DAO without an answer is sent again (s): 0.1 to 1000. Each wait is drawn in 50 to 150 %.
    pub dao_retry_s: f64,
    /// How long ways down last (min): 3 to 254. They are refreshed one to two minutes before.
    #[cfg_attr(feature = "schema", schemars(range(min = 3, max = 254)))]
    pub route_lifetime_min: u8,
    /// Time between probes of links (s): 0, or 1 to 100000. Each wait is drawn in 50 to 150 %. With 0 links are not tried before
    /// they are used.
    pub probing_interval_s: f64,
    /// With `storing`: ways down that a node can keep, one for each node below it: 1 to 65535.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 65535)))]
    pub route_table: u16,
    /// What becomes of a packet that meets a wrong rank for the second time: `forward` or `drop`.
    pub rank_errors: RankErrors,
}

/// What makes one parent better than another, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum ObjectiveConfig {
    /// Objective function zero (RFC 6552): the least rank.
    Of0(Of0Config),
    /// Minimum rank with hysteresis (RFC 6719), by expected transmissions (ETX).
    Mrhof(MrhofConfig),
}

/// Objective function zero, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Of0Config {
    /// By how many least increases of the rank a hop counts: `constant` or `etx`.
    pub step_of_rank: StepOfRankConfig,
}

/// By how many least increases of the rank a hop counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StepOfRankConfig {
    /// By 3, over any link of at most four expected transmissions.
    #[default]
    Constant,
    /// By 3 ETX - 2, from 1 to 9, as RFC 8180 has it.
    Etx,
}

/// Minimum rank with hysteresis, as written in a scenario. Costs are expected transmissions in 128ths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MrhofConfig {
    /// A node changes its parent for another one if its way costs less by at least this number of 128ths: 0 to 32768.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 32768)))]
    pub hysteresis: u16,
    /// It also does if that one was better for longer than this time (s): 0 to 100000.
    pub hysteresis_time_s: f64,
    /// Links that cost more 128ths are not used: 128 to 1280.
    #[cfg_attr(feature = "schema", schemars(range(min = 128, max = 1280)))]
    pub max_link_metric: u16,
    /// Ways that cost more 128ths are not used: 256 to 65000.
    #[cfg_attr(feature = "schema", schemars(range(min = 256, max = 65000)))]
    pub max_path_cost: u16,
}

/// Who knows ways down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RplMode {
    /// The root, which writes the whole way into packets.
    #[default]
    NonStoring,
    /// Each node those below it, in a table.
    Storing,
    /// Nobody: packets go to a sink only.
    None,
}

/// What becomes of a packet that meets a wrong rank for the second time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RankErrors {
    /// It is sent on, as by Contiki-NG.
    #[default]
    Forward,
    /// It is dropped, as RFC 6550 has it (11.2.2.2).
    Drop,
}

impl Default for RplConfig {
    fn default() -> Self {
        Self {
            objective: ObjectiveConfig::Mrhof(MrhofConfig::default()),
            mode: RplMode::default(),
            min_hop_rank_increase: 256,
            max_rank_increase: 2048,
            dio_min_s: 4.096,
            dio_doublings: 8,
            dio_redundancy: 0,
            dis_interval_s: 30.0,
            dao_delay_s: 4.0,
            dao_tries: 5,
            dao_retry_s: 5.0,
            route_lifetime_min: 30,
            probing_interval_s: 90.0,
            route_table: 300,
            rank_errors: RankErrors::default(),
        }
    }
}

impl Default for MrhofConfig {
    fn default() -> Self {
        Self { hysteresis: 192, hysteresis_time_s: 600.0, max_link_metric: 512, max_path_cost: 32_768 }
    }
}
