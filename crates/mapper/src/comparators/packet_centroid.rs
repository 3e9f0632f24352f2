//! Centroids of the stops that heard a node, weighted by the packets that they received.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, SettingError, Watch};

use super::weight_power;
use crate::each_node::EachNode;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::parts::{FixedLaw, LogParts, PartEstimator, PartsError};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The packet centroid as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PacketCentroidConfig {
    /// Each stop weighs the share of the packets that it received to this power: above 0, at most 100.
    pub power: f64,
}

impl Default for PacketCentroidConfig {
    fn default() -> Self {
        Self { power: 3.0 }
    }
}

/// The centroid of the stops that heard a node, each weighted by a power of the share of the node's packets that it
/// received. It needs no model of radio, and is hard to beat where walls decide who hears whom. It has no regions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacketCentroid {
    power: f64,
}

impl PacketCentroid {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "packet-centroid";

    /// The kinds of knowledge that it uses.
    pub(crate) const USES: &'static [KnowledgeKind] = &[KnowledgeKind::RobotReceptions];

    /// The centroid with this power of the shares.
    pub(crate) const fn with_power(power: f64) -> Self {
        Self { power }
    }

    /// The map of the nodes in `log`.
    #[must_use]
    pub fn map(&self, log: &ReceptionLog) -> TopologyMap {
        let places = (0..log.node_count()).map(|node| self.place(log, NodeId::from_index(node))).collect();
        TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World)
    }

    /// The place of `node`; `None` if it was never heard.
    pub(crate) fn place(&self, log: &ReceptionLog, node: NodeId) -> Option<Position> {
        let heard = || {
            let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
            receptions.map(|reception| {
                let share = f64::from(reception.received) / f64::from(reception.sent);
                (log.stops()[reception.stop as usize].position, share)
            })
        };
        // Relative to the greatest share, so that no weight underflows.
        let most = heard().map(|(_, share)| share).fold(0.0, f64::max);
        let weighted = heard().map(|(place, share)| (place, libm::pow(share / most, self.power)));
        let (sum, total) = weighted
            .fold((Position::ORIGIN, 0.0), |(sum, total), (place, weight)| (sum + place * weight, total + weight));
        (total > 0.0).then(|| sum * (1.0 / total))
    }
}

impl TryFrom<PacketCentroidConfig> for PacketCentroid {
    type Error = SettingError;

    fn try_from(PacketCentroidConfig { power }: PacketCentroidConfig) -> Result<Self, SettingError> {
        Ok(Self { power: weight_power("power", power)? })
    }
}

impl Estimator for PacketCentroid {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        Self::USES
    }

    fn by_parts(&self) -> Option<&dyn PartEstimator> {
        Some(self)
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        _: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        Ok((self.map(knowledge.log), None))
    }
}

impl PartEstimator for PacketCentroid {
    fn fix<'a>(
        &'a self,
        _: &dyn LogParts,
        knowledge: &'a Knowledge<'a>,
        _: &dyn Watch,
    ) -> Result<Box<dyn FixedLaw + 'a>, PartsError> {
        Ok(Box::new(EachNode { estimator: *self, knowledge }))
    }
}

impl EstimatorSettings for PacketCentroidConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "packet-centroid",
        rank: 2,
        description: "The mean of the stops that heard a node, weighted by a power of the share of packets that they received",
        settings: "{}",
    });

    const BY_PARTS: bool = true;

    fn mapper(self) -> Result<Mapper, SettingError> {
        PacketCentroid::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Reception, Stop};

    use super::*;

    #[test]
    fn weights_are_powers_of_the_shares_received() {
        let stop = |x_m| Stop::at(Position::new(x_m, 0.0, 0.0));
        let heard = |stop, received| Reception::heard(NodeId(0), stop, received, 8);
        let names = vec!["heard".to_owned(), "unheard".to_owned()];
        let log =
            ReceptionLog::new(names, vec![stop(0.0), stop(9.0), stop(50.0)], vec![heard(0, 8), heard(1, 4)], vec![]);
        let log = log.unwrap();
        for (power, x_m) in [(1.0, 3.0), (3.0, 1.0), (100.0, 0.0)] {
            let map = PacketCentroid::try_from(PacketCentroidConfig { power }).unwrap().map(&log);
            assert!((map.estimates[0].as_ref().unwrap().position.x_m - x_m).abs() < 1e-9, "power {power}");
            assert_eq!(map.unmapped(), 1);
        }
        assert!(PacketCentroid::try_from(PacketCentroidConfig { power: 0.0 }).is_err());
    }
}
