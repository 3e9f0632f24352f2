//! The reception profile that a known channel implies.

use sextant_channel::{
    ChannelConfig, ChannelLaw, CorrelationConfig, Db, Dbm, LogDistanceConfig, PathLossConfig, ShadowingConfig,
};
use sextant_kernel::SettingError;

use super::DEFAULT_FLOOR;
use super::cell::averaged_over_cell;
use super::limits::above_0_to_1;
use crate::profile::table::TableProfile;

/// The profile of a known channel as written in a scenario. In a scenario, absent values come from its radio, channel
/// and traffic. Elsewhere, the first four values are required.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChannelProfileConfig {
    /// Path loss exponent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub exponent: Option<f64>,
    /// Standard deviation of shadowing (dB).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sigma_db: Option<f64>,
    /// Transmit power at the reference distance (dBm).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub tx_power_dbm: Option<f64>,
    /// Least power at which packets are received (dBm).
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sensitivity_dbm: Option<f64>,
    /// Hard communication radius (m). If absent, there is none.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub max_range_m: Option<f64>,
    /// Distance at which the transmit power is given (m); 1 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub reference_distance_m: Option<f64>,
    /// Below this distance the path loss is constant (m); 0.1 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub min_distance_m: Option<f64>,
    /// Loss in proportion to the distance, on top (dB/km): gases of the air; 0 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub gas_db_per_km: Option<f64>,
    /// Carrier at which known obstacles absorb (GHz); 2.45 if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub carrier_ghz: Option<f64>,
    /// Share of the strong enough packets that survive collisions; above 0, at most 1.
    #[cfg_attr(feature = "config", serde(default = "default_delivery"))]
    pub delivery: f64,
    /// Mean number of packets that a node sends while the robot listens at a stop. The curve is then the probability
    /// of hearing at least one of them, and a stop counts as one packet. If absent, the curve is the probability of
    /// receiving each packet.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub packets_per_stop: Option<f64>,
    /// Whether the probability at a vertex is averaged over its grid cell. If not, a hard radius may rule out the
    /// vertices nearest to a node, where the node itself is only just in range.
    #[cfg_attr(feature = "config", serde(default = "default_cell_average"))]
    pub cell_average: bool,
    /// Whether the map knows the obstacles of the world. If so, the probability at a vertex includes what the
    /// obstacles on the straight line to each stop absorb.
    #[cfg_attr(feature = "config", serde(default))]
    pub obstacles: ObstacleUse,
    /// Lowest probability of a reception, at any distance.
    #[cfg_attr(feature = "config", serde(default = "super::default_floor"))]
    pub floor: f64,
    /// Highest probability of a reception, at any distance.
    #[cfg_attr(feature = "config", serde(default = "super::default_ceiling"))]
    pub ceiling: f64,
}

/// Whether a map knows the obstacles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ObstacleUse {
    /// It knows no obstacles.
    #[default]
    Unknown,
    /// It knows all obstacles. Only possible in a simulation.
    #[cfg(feature = "obstacles")]
    Known,
}

impl ObstacleUse {
    /// Whether it knows no obstacles.
    #[cfg(feature = "config")]
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
    pub(crate) fn is_unknown(&self) -> bool {
        *self == Self::Unknown
    }
}

fn default_delivery() -> f64 {
    1.0
}

fn default_cell_average() -> bool {
    true
}

impl Default for ChannelProfileConfig {
    /// No value given, all packets delivered, averaged over the grid cell.
    fn default() -> Self {
        Self {
            exponent: None,
            sigma_db: None,
            tx_power_dbm: None,
            sensitivity_dbm: None,
            max_range_m: None,
            reference_distance_m: None,
            min_distance_m: None,
            gas_db_per_km: None,
            carrier_ghz: None,
            delivery: default_delivery(),
            packets_per_stop: None,
            cell_average: default_cell_average(),
            obstacles: ObstacleUse::default(),
            floor: DEFAULT_FLOOR,
            ceiling: 1.0 - DEFAULT_FLOOR,
        }
    }
}

/// Samples of the curve.
const SAMPLES: u32 = 2000;
/// A curve without a hard radius ends at this probability. The floor applies beyond.
const NEGLIGIBLE: f64 = 1e-3;

impl ChannelProfileConfig {
    /// The curve on a grid of `grid_step_m`; 0 for no grid.
    ///
    /// With q(d) the channel's own probability of a reception (see [`ChannelLaw::reception_probability`]), a packet
    /// arrives with probability `delivery · q(d)`. A stop at which n packets are sent hears at least one with
    /// probability `1 − (1 − delivery q)ⁿ`. n is one of the two whole numbers next to `packets_per_stop`, in the
    /// proportions that give this mean.
    pub(super) fn table(&self, grid_step_m: f64) -> Result<TableProfile, SettingError> {
        let link = self.link()?;
        let probability = |distance_m: f64| link.probability(distance_m, Db(0.0));
        let hard_m = link.law.max_range_m();
        let range_m = range(probability, hard_m).ok_or_else(|| {
            let allowed = format!("a power that is received at least once in {} packets", 1.0 / NEGLIGIBLE);
            SettingError::new("tx_power_dbm", link.tx.0, allowed)
        })?;
        let cell_m = if self.cell_average { grid_step_m } else { 0.0 };
        let whole_range_m = range_m + 0.5 * 3.0_f64.sqrt() * cell_m;
        let step_m = whole_range_m / f64::from(SAMPLES);
        let samples = (0..=SAMPLES).map(|i| {
            let distance_m = (step_m * f64::from(i)).min(whole_range_m);
            if cell_m > 0.0 {
                averaged_over_cell(probability, distance_m, cell_m)
            } else {
                // The last sample is exactly at the hard radius, in spite of rounding.
                probability(if i == SAMPLES { range_m } else { distance_m })
            }
        });
        TableProfile::new(step_m, samples.collect(), self.floor, self.ceiling)
    }

    /// The law of one link.
    pub(crate) fn link(&self) -> Result<KnownLink, SettingError> {
        let needed = |key, value: Option<f64>| {
            value.ok_or_else(|| SettingError::missing(key, "a number; in a scenario, that of its channel"))
        };
        let (tx, sensitivity) =
            (needed("tx_power_dbm", self.tx_power_dbm)?, needed("sensitivity_dbm", self.sensitivity_dbm)?);
        SettingError::finite("tx_power_dbm", tx)?;
        SettingError::finite("sensitivity_dbm", sensitivity)?;
        if let Some(carrier_ghz) = self.carrier_ghz {
            SettingError::in_range("carrier_ghz", carrier_ghz, 0.1, 1000.0)?;
        }
        let delivery = above_0_to_1("delivery", self.delivery)?;
        let packets = SettingError::positive("packets_per_stop", self.packets_per_stop.unwrap_or(1.0))?;
        let default = LogDistanceConfig::default();
        let config = ChannelConfig {
            environment: None,
            path_loss: Some(PathLossConfig::LogDistance(LogDistanceConfig {
                reference_loss_db: default.reference_loss_db,
                exponent: Some(needed("exponent", self.exponent)?),
                reference_distance_m: self.reference_distance_m.unwrap_or(default.reference_distance_m),
                min_distance_m: self.min_distance_m.unwrap_or(default.min_distance_m),
                gas_db_per_km: self.gas_db_per_km.unwrap_or(default.gas_db_per_km),
            })),
            shadowing: Some(ShadowingConfig {
                sigma_db: Some(needed("sigma_db", self.sigma_db)?),
                correlation: CorrelationConfig::PerPacket,
            }),
            max_range_m: self.max_range_m,
            reflections: None,
            obstacles_attenuate: false,
            fading: None,
            bursts: None,
        };
        let law = ChannelLaw::try_from(config).map_err(flat)?;
        Ok(KnownLink {
            law,
            #[cfg(feature = "obstacles")]
            carrier_ghz: self.carrier_ghz,
            tx: Dbm(tx),
            sensitivity: Dbm(sensitivity),
            delivery,
            packets,
        })
    }
}

/// The probability that a stop hears a node over a link of known length through known obstacles.
#[derive(Clone, Debug)]
pub(crate) struct KnownLink {
    law: ChannelLaw,
    #[cfg(feature = "obstacles")]
    carrier_ghz: Option<f64>,
    tx: Dbm,
    sensitivity: Dbm,
    delivery: f64,
    packets: f64,
}

impl KnownLink {
    /// A link of a node that sends with `tx` to a stop that receives above `sensitivity`: the share `delivery` of the strong
    /// enough packets survives, and `packets` are sent at a stop in the mean.
    #[cfg(feature = "obstacles")]
    pub(crate) fn new(law: ChannelLaw, [tx, sensitivity]: [Dbm; 2], delivery: f64, packets: f64) -> Self {
        Self { law, carrier_ghz: None, tx, sensitivity, delivery, packets }
    }

    /// Probability that a stop hears at least one packet over `distance_m` through obstacles with a total loss of
    /// `loss`; 0 beyond the hard radius of the channel.
    pub(crate) fn probability(&self, distance_m: f64, loss: Db) -> f64 {
        if distance_m > self.law.max_range_m() {
            return 0.0;
        }
        let q = self.law.reception_probability(self.tx, self.sensitivity, distance_m, loss);
        at_least_one(self.delivery * q, self.packets)
    }

    /// Carrier at which obstacles absorb (GHz).
    #[cfg(feature = "obstacles")]
    pub(crate) fn carrier_ghz(&self) -> Option<f64> {
        self.carrier_ghz
    }

    /// Distance beyond which almost nothing is received (m).
    #[cfg(feature = "obstacles")]
    pub(crate) fn reach_m(&self) -> f64 {
        self.law.reach_m(self.tx, self.sensitivity)
    }
}

/// Probability that at least one of the packets sent at a stop arrives, each with `q`: `1 − (1 − q)ⁿ`, where n is one
/// of the two whole numbers next to `packets`, in the proportions that give this mean.
#[expect(clippy::cast_possible_truncation, reason = "nobody sends 2^31 packets at a stop")]
fn at_least_one(q: f64, packets: f64) -> f64 {
    let few = packets as i32;
    assert!(few >= 0, "a number of packets");
    let more = packets - f64::from(few);
    let none = |n: i32| if n == 1 { 1.0 - q } else { libm::pow(1.0 - q, f64::from(n)) };
    if more > 0.0 { 1.0 - (1.0 - more) * none(few) - more * none(few + 1) } else { 1.0 - none(few) }
}

/// The distance at which a falling `probability` becomes negligible, at most `hard_m` (m); `None` if it is negligible
/// everywhere.
fn range(probability: impl Fn(f64) -> f64, hard_m: f64) -> Option<f64> {
    let (mut near, mut far) = (1e-3, 1e-3);
    if probability(near) <= NEGLIGIBLE {
        return None;
    }
    while probability(far) > NEGLIGIBLE && far < hard_m {
        near = far;
        far *= 2.0;
    }
    if far >= hard_m && probability(hard_m) > NEGLIGIBLE {
        return Some(hard_m);
    }
    for _ in 0..60 {
        let middle = 0.5 * (near + far);
        if probability(middle) > NEGLIGIBLE { near = middle } else { far = middle }
    }
    Some(far)
}

/// The error with the key as in this table.
fn flat(error: SettingError) -> SettingError {
    let key = error.key.rsplit('.').next().unwrap_or_default().to_owned();
    SettingError { key, ..error }
}
