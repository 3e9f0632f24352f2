//! A tree of RPL, checked.

use std::time::Duration;

use sextant_kernel::SettingError;
use sextant_mac::routing::Trickle;
use sextant_mac::routing::rpl::{DioConfiguration, DodagSettings, Downward, Mrhof, Objective, Probing, StepOfRank};

use super::config::{MrhofConfig, ObjectiveConfig, RankErrors, RplConfig, RplMode, StepOfRankConfig};

/// What all stations know of RPL, checked.
#[derive(Clone, Debug)]
pub(in crate::routing) struct RplPlan {
    pub(in crate::routing) dodag: DodagSettings,
    pub(in crate::routing) configuration: DioConfiguration,
    pub(in crate::routing) trickle: Trickle,
    pub(in crate::routing) dis_interval: Duration,
    pub(in crate::routing) dao_delay: Duration,
    /// How often a DAO is sent until it is answered; zero: no answers are asked for.
    pub(in crate::routing) dao_tries: u8,
    pub(in crate::routing) dao_retry: Duration,
    /// How long ways down last.
    pub(in crate::routing) lifetime: Duration,
    /// Time between probes; `None` if links are not tried.
    pub(in crate::routing) probing: Option<Duration>,
    pub(in crate::routing) route_table: usize,
    pub(in crate::routing) rank_errors: RankErrors,
}

impl TryFrom<&RplConfig> for RplPlan {
    type Error = SettingError;

    fn try_from(config: &RplConfig) -> Result<Self, SettingError> {
        let span = |key: &str, found: f64, low: f64, high: f64| {
            SettingError::in_range(key, found, low, high).map(Duration::from_secs_f64)
        };
        let min_hop_rank_increase = whole("min_hop_rank_increase", config.min_hop_rank_increase, 1, 4096)?;
        let shortest = span("dio_min_s", config.dio_min_s, 0.001, 1000.0)?;
        let doublings = whole("dio_doublings", config.dio_doublings.into(), 0, 20)?;
        let dao_tries = whole("dao_tries", config.dao_tries.into(), 0, 100)?;
        let lifetime_min = whole("route_lifetime_min", config.route_lifetime_min.into(), 3, 254)?;
        let probing = match config.probing_interval_s {
            0.0 => None,
            found => Some(
                span("probing_interval_s", found, 1.0, 1e5)
                    .map_err(|error| SettingError::new("probing_interval_s", error.found(), "0, or 1 to 100000"))?,
            ),
        };
        let objective = objective(&config.objective).map_err(|error| error.within("objective"))?;
        let downward = match config.mode {
            RplMode::None => Downward::Unknown,
            RplMode::NonStoring => Downward::ByRoot,
            RplMode::Storing => Downward::ByStations,
        };
        let mode = match config.mode {
            RplMode::None => 0,
            RplMode::NonStoring => 1,
            RplMode::Storing => 2,
        };
        // The greatest power of two that is not longer.
        let interval_min = u8::try_from(shortest.as_millis().max(1).ilog2()).expect("below 128");
        #[expect(clippy::cast_possible_truncation, reason = "the ranges are checked")]
        let [doublings, dao_tries, lifetime_min] = [doublings, dao_tries, lifetime_min].map(|number| number as u8);
        Ok(Self {
            dodag: DodagSettings {
                objective,
                min_hop_rank_increase,
                max_rank_increase: config.max_rank_increase,
                downward,
                probing: if probing.is_some() { Probing::On } else { Probing::Off },
            },
            configuration: DioConfiguration {
                mode,
                doublings,
                interval_min,
                redundancy: config.dio_redundancy,
                max_rank_increase: config.max_rank_increase,
                min_hop_rank_increase,
                objective: objective.code(),
                lifetime_min,
            },
            trickle: Trickle::new(shortest, shortest * (1 << doublings)).with_redundancy(config.dio_redundancy),
            dis_interval: span("dis_interval_s", config.dis_interval_s, 1.0, 1e5)?,
            dao_delay: span("dao_delay_s", config.dao_delay_s, 0.1, 1e3)?,
            dao_tries,
            dao_retry: span("dao_retry_s", config.dao_retry_s, 0.1, 1e3)?,
            lifetime: Duration::from_secs(60 * u64::from(lifetime_min)),
            probing,
            route_table: whole("route_table", config.route_table, 1, u16::MAX)?.into(),
            rank_errors: config.rank_errors,
        })
    }
}

fn objective(config: &ObjectiveConfig) -> Result<Objective, SettingError> {
    match config {
        ObjectiveConfig::Of0(of0) => Ok(Objective::Of0(match of0.step_of_rank {
            StepOfRankConfig::Constant => StepOfRank::Constant,
            StepOfRankConfig::Etx => StepOfRank::Etx,
        })),
        ObjectiveConfig::Mrhof(mrhof) => mrhof_of(mrhof).map_err(|error| error.within("mrhof")),
    }
}

fn mrhof_of(config: &MrhofConfig) -> Result<Objective, SettingError> {
    let hysteresis_time_s = SettingError::in_range("hysteresis_time_s", config.hysteresis_time_s, 0.0, 1e5)?;
    Ok(Objective::Mrhof(Mrhof {
        hysteresis: whole("hysteresis", config.hysteresis, 0, 32_768)?,
        hysteresis_time: Duration::from_secs_f64(hysteresis_time_s),
        max_link_metric: whole("max_link_metric", config.max_link_metric, 128, 1280)?,
        max_path_cost: whole("max_path_cost", config.max_path_cost, 256, 65_000)?,
    }))
}

/// A whole number in a range.
fn whole(key: &str, found: u16, low: u16, high: u16) -> Result<u16, SettingError> {
    let is_in = (low..=high).contains(&found);
    if is_in { Ok(found) } else { Err(SettingError::new(key, found, format!("{low} to {high}"))) }
}
