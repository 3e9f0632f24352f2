//! Centroids of the stops that received a node, weighted by signal strength.

use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch};

use crate::comparators::Comparator;
use crate::comparators::{node_by_node, weight_power};
use crate::error::MapError;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::log_facts::strengths::{Strength, all_strengths};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The RSSI centroid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RssiCentroidConfig {
    /// Each stop weighs the power that it received, in milliwatts, to this power g: above 0, at most 100. With a path-loss
    /// exponent n, the weight is the distance to the power −n g.
    pub g: f64,
}

impl Default for RssiCentroidConfig {
    fn default() -> Self {
        Self { g: DEFAULT_G }
    }
}

/// The best of 0.25, 0.5, 1 and 2 on logs of real links: distances to the power −5 where power falls with their power 2.5.
pub(super) const DEFAULT_G: f64 = 2.0;

/// The centroid of the stops that received a node, each weighted by a power of the received power: the weighted centroid
/// localisation of Blumenthal, Grossmann, Golatowski and Timmermann (2007), whose weights `1/d^g` become powers of the
/// received power under any log-distance law (Pivato, Palopoli and Petri 2011).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RssiCentroid {
    g: f64,
}

impl Comparator for RssiCentroid {
    const NAME: &'static str = "rssi-centroid";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotRssi]
    }

    /// The map. Nodes that were never heard with a strength are not placed.
    ///
    /// # Errors
    /// [`MapError::Missing`] if the log has no strengths; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let nodes = all_strengths(Self::NAME, knowledge.log)?;
        let operations = 20.0 * knowledge.log.stops().len() as f64;
        let places = node_by_node(Self::NAME, nodes.len(), operations, watch, |node| centroid(&nodes[node], self.g))?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

/// The centroid of the places weighted by the received powers to the power `g`; `None` without strengths.
pub(crate) fn centroid(strengths: &[Strength], g: f64) -> Option<Position> {
    // Relative to the greatest power, so that no sum underflows.
    let greatest_dbm = strengths.iter().map(|strength| strength.rssi_dbm).reduce(f64::max)?;
    let (mut sum, mut total) = (Position::ORIGIN, 0.0);
    for strength in strengths {
        let weight = libm::pow(10.0, 0.1 * g * (strength.rssi_dbm - greatest_dbm));
        sum = sum + strength.place * weight;
        total += weight;
    }
    Some(sum * (1.0 / total))
}

impl TryFrom<RssiCentroidConfig> for RssiCentroid {
    type Error = SettingError;

    fn try_from(RssiCentroidConfig { g }: RssiCentroidConfig) -> Result<Self, SettingError> {
        Ok(Self { g: weight_power("g", g)? })
    }
}

impl EstimatorSettings for RssiCentroidConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "rssi-centroid",
        rank: 7,
        description: "The mean of the stops that received a node, weighted by signal strength",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        RssiCentroid::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{log_of, map};
    use super::*;
    use crate::algorithm::AlgorithmConfig;

    #[test]
    fn weights_are_powers_of_the_received_power() {
        let places = [0.0, 11.0, 101.0].map(|x_m| Position::new(x_m, 0.0, 0.0));
        // 10 dB less is a tenth of the power.
        let law = |stop: Position| (stop.x_m < 50.0).then_some(-300.0 - 10.0 * stop.x_m / 11.0);
        let log = log_of(&places, &[&law]);
        for (g, x_m) in [(1.0, 1.0), (2.0, 11.0 / 101.0), (100.0, 0.0)] {
            let map = map(AlgorithmConfig::RssiCentroid(RssiCentroidConfig { g }), &log);
            let found = map.estimates[0].as_ref().unwrap().position;
            assert!((found.x_m - x_m).abs() < 1e-9, "g {g}: {found}");
        }
        for g in [0.0, 101.0, f64::NAN] {
            let refused = RssiCentroid::try_from(RssiCentroidConfig { g }).unwrap_err().to_string();
            assert!(refused.contains("a number above 0, at most 100"), "{refused}");
        }
    }
}
