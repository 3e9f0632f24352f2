//! Settings of maps that are computed in the nodes.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::{SettingError, SimTime};
use sextant_mapper::{AnchorSilence, DirectionRule, EstimateKind, OwnPlace, OwnPlaceConfig, PlaceModel};

use super::schedule::{BeaconWindow, Schedule};

/// Settings of a map that is computed in the nodes, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DistributedMappingConfig {
    /// Name of the map in tables and recordings; `dmmtm-ss` if absent, with mobile anchors `dmmtm-hs`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Name of the network over which nodes exchange messages; the first one if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// How long the mobile anchors drive before the static ones begin (s). Required with mobile anchors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mobile_phase_s: Option<f64>,
    /// Length of a window in which all stations send their messages of one kind (s). Each sends at a random instant of
    /// the first three quarters.
    #[serde(default = "default_window_s")]
    pub window_s: f64,
    /// How often each message is sent in its window.
    #[serde(default = "one")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 100)))]
    pub repeats: u32,
    /// Radius of communication: neighbours that lie farther away by the coordinates are scattered (m).
    pub range_m: f64,
    /// A node becomes an anchor if at most this share of its neighbours is scattered.
    #[serde(default = "default_new_anchor_below")]
    pub new_anchor_below: f64,
    /// The coordinates of a node are bad if more than this share of its neighbours is scattered.
    #[serde(default = "default_bad_above")]
    pub bad_above: f64,
    /// A node does not become an anchor while the standard deviation of its place is above this times the square root
    /// of the iteration (m). It is the largest of those along x, y and z. So those that know their places best join
    /// first.
    /// Any deviation will do if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub new_anchor_sigma_m: Option<f64>,
    /// An anchor gives up its place, and works it out as other nodes do, if less than this share of its bearings
    /// agree on how its antenna is turned. Then the place is wrong, or the antenna has moved. It needs at least four
    /// bearings. No anchor
    /// does so if absent. Needs `directions = "intervals"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doubt_below: Option<f64>,
    /// Most iterations.
    #[serde(default = "default_max_iterations")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 1000)))]
    pub max_iterations: u32,
    /// How an anchor works out the directions of its sectors.
    #[serde(default)]
    pub directions: DirectionRule,
    /// What the strengths of the sectors in which a message was heard tell of the direction.
    #[serde(default)]
    pub bearings: BearingSource,
    /// What messages say about a place.
    #[serde(default)]
    pub exchange: Exchange,
    /// Which nodes compute their place again in an iteration.
    #[serde(default)]
    pub recompute: Recompute,
    /// How a node computes its place.
    pub place: OwnPlaceConfig,
}

/// What the strengths of the sectors in which a message was heard tell of the direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum BearingSource {
    /// The best sector (thesis, chapter 5).
    #[default]
    BestSector,
    /// The direction that fits the strengths of all sectors by the pattern of the antenna, and how sure it is. Needs sectors
    /// and `place.model = "soft"`.
    Pattern(PatternBearings),
}

/// Directions by the pattern of an antenna.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PatternBearings {
    /// Standard deviation of the strength of a sector (dB): noise, and what an antenna differs by from the pattern.
    pub error_db: f64,
}

impl Default for PatternBearings {
    fn default() -> Self {
        Self { error_db: 1.0 }
    }
}

/// What messages say about a place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Exchange {
    /// Only the coordinates (thesis, chapter 5).
    #[default]
    Coordinates,
    /// The coordinates and their covariance: stations are weighed by how well they know their place. The estimate must be
    /// the posterior mean.
    Posterior,
}

/// Which nodes compute their place again in an iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Recompute {
    /// Those with bad coordinates or none (thesis, chapter 5).
    #[default]
    Bad,
    /// All that are not anchors and have heard of more anchors since.
    All,
}

fn default_window_s() -> f64 {
    1.0
}

fn one() -> u32 {
    1
}

fn default_new_anchor_below() -> f64 {
    0.1
}

fn default_bad_above() -> f64 {
    0.2
}

fn default_max_iterations() -> u32 {
    10
}

/// Most windows and repeats, so that numbers of timers fit.
const MOST_ITERATIONS: u32 = 1000;
const MOST_REPEATS: u32 = 100;

/// Settings of a map that is computed in the nodes, checked.
#[derive(Clone, Debug)]
pub struct DistributedMapping {
    pub(super) mobile_phase: Duration,
    pub(super) window: Duration,
    pub(super) repeats: u32,
    pub(super) range_m: f64,
    pub(super) new_anchor_below: f64,
    pub(super) bad_above: f64,
    pub(super) new_anchor_sigma_m: Option<f64>,
    pub(super) doubt_below: Option<f64>,
    pub(super) max_iterations: u32,
    pub(super) directions: DirectionRule,
    bearings: BearingSource,
    pub(super) exchange: Exchange,
    pub(super) recompute: Recompute,
    /// Whether anchors pass on the places of others, so that nodes know whom they have not heard.
    pub(super) passes_on: bool,
    pub(super) place: OwnPlace,
}

impl DistributedMapping {
    /// What strengths tell of directions.
    #[must_use]
    pub fn bearings(&self) -> BearingSource {
        self.bearings
    }

    /// How long the mobile anchors drive.
    #[must_use]
    pub(crate) fn mobile_phase(&self) -> Duration {
        self.mobile_phase
    }

    /// When a map is computed at the latest: all iterations are over. `has_sectors` tells whether the network has them.
    ///
    /// # Panics
    /// Never: iterations end.
    #[must_use]
    pub fn longest(&self, has_sectors: bool) -> Duration {
        let schedule = self.schedule(has_sectors);
        let end = (0..).find(|&number| schedule.at(number).1 == BeaconWindow::End).expect("iterations end");
        schedule.start_of(end) - SimTime::ZERO
    }

    /// The windows. `has_sectors` tells whether the network has them.
    pub(super) fn schedule(&self, has_sectors: bool) -> Schedule {
        Schedule {
            start: SimTime::ZERO + self.mobile_phase,
            window: self.window,
            asks: has_sectors || self.passes_on,
            iterations: self.max_iterations,
        }
    }
}

impl TryFrom<&DistributedMappingConfig> for DistributedMapping {
    type Error = SettingError;

    fn try_from(config: &DistributedMappingConfig) -> Result<Self, SettingError> {
        let seconds = |key, value: f64| {
            let value = SettingError::in_range(key, value, 0.0, 1e6)?;
            Ok::<_, SettingError>(Duration::from_secs_f64(value))
        };
        let whole = |key: &str, value: u32, most: u32| {
            if (1..=most).contains(&value) {
                Ok(value)
            } else {
                Err(SettingError::new(key, value, format!("1 to {most}")))
            }
        };
        SettingError::positive("window_s", config.window_s)?;
        let new_anchor_below = SettingError::in_range("new_anchor_below", config.new_anchor_below, 0.0, 1.0)?;
        let bad_above = SettingError::in_range("bad_above", config.bad_above, 0.0, 1.0)?;
        if bad_above < new_anchor_below {
            let allowed = format!("at least {new_anchor_below}, the value of new_anchor_below");
            return Err(SettingError::new("bad_above", bad_above, allowed));
        }
        if let Some(sigma_m) = config.new_anchor_sigma_m {
            SettingError::positive("new_anchor_sigma_m", sigma_m)?;
        }
        if let Some(share) = config.doubt_below {
            SettingError::in_range("doubt_below", share, 0.0, 1.0)?;
            if config.directions != DirectionRule::Intervals {
                let with = "`directions = \"circular_mean\"`";
                return Err(SettingError::conflict("doubt_below", with, "set `directions = \"intervals\"`"));
            }
        }
        if let BearingSource::Pattern(PatternBearings { error_db }) = config.bearings {
            SettingError::positive("bearings.pattern.error_db", error_db)?;
            if config.place.model != PlaceModel::Soft {
                let with = "`place.model = \"wedge\"`, in which all directions of a sector are alike";
                return Err(SettingError::conflict("bearings.pattern", with, "set `place.model = \"soft\"`"));
            }
        }
        let place = OwnPlace::try_from(config.place.clone()).map_err(|error| error.within("place"))?;
        let needs_posterior = config.exchange == Exchange::Posterior || config.new_anchor_sigma_m.is_some();
        if needs_posterior && config.place.estimate != EstimateKind::PosteriorMean {
            let allowed =
                "`posterior_mean`, because `exchange = \"posterior\"` and `new_anchor_sigma_m` need a covariance";
            return Err(SettingError::new("place.estimate", "`argmax`", allowed));
        }
        Ok(Self {
            mobile_phase: seconds("mobile_phase_s", config.mobile_phase_s.unwrap_or(0.0))?,
            window: seconds("window_s", config.window_s)?,
            repeats: whole("repeats", config.repeats, MOST_REPEATS)?,
            range_m: SettingError::positive("range_m", config.range_m)?,
            new_anchor_below,
            bad_above,
            new_anchor_sigma_m: config.new_anchor_sigma_m,
            doubt_below: config.doubt_below,
            max_iterations: whole("max_iterations", config.max_iterations, MOST_ITERATIONS)?,
            directions: config.directions,
            bearings: config.bearings,
            exchange: config.exchange,
            recompute: config.recompute,
            passes_on: config.place.silence == AnchorSilence::Missed,
            place,
        })
    }
}
