//! The stop that received a node with the greatest strength.

use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch};

use crate::comparators::Comparator;
use crate::comparators::node_by_node;
use crate::error::MapError;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::log_facts::strengths::{Strength, all_strengths};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The strongest stop as written in a scenario. It has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StrongestStopConfig {}

/// A node is where its mean strength is greatest: the nearest neighbour in signal space of a survey without
/// fingerprints (Bahl and Padmanabhan 2000). If several stops share the greatest strength, as receivers that round or
/// saturate make them, it is in the middle of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrongestStop;

/// Strengths that differ by less are equal (dB).
const EQUAL_DB: f64 = 1e-9;

impl Comparator for StrongestStop {
    const NAME: &'static str = "strongest-stop";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotRssi]
    }

    /// The map. Nodes that were never heard with a strength are not placed.
    ///
    /// # Errors
    /// [`MapError::Missing`] if the log has no strengths; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let nodes = all_strengths(Self::NAME, knowledge.log)?;
        let stops = knowledge.log.stops().len() as f64;
        let places = node_by_node(Self::NAME, nodes.len(), stops, watch, |node| strongest_place(&nodes[node]))?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

/// The middle of the places with the greatest strength; `None` without strengths.
pub(crate) fn strongest_place(strengths: &[Strength]) -> Option<Position> {
    let greatest_dbm = strengths.iter().map(|strength| strength.rssi_dbm).reduce(f64::max)?;
    let (mut sum, mut count) = (Position::ORIGIN, 0.0);
    for strength in strengths.iter().filter(|strength| strength.rssi_dbm >= greatest_dbm - EQUAL_DB) {
        sum = sum + strength.place;
        count += 1.0;
    }
    Some(sum * (1.0 / count))
}

impl EstimatorSettings for StrongestStopConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "strongest-stop",
        rank: 6,
        description: "The stop that received a node with the greatest strength",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        Ok(Mapper::new(StrongestStop))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{log_of, map};
    use super::*;
    use crate::algorithm::AlgorithmConfig;

    #[test]
    fn a_node_is_at_its_strongest_stop_or_amid_equal_ones() {
        let places = [0.0, 1.0, 5.0, 9.0].map(|x_m| Position::new(x_m, 2.0 * x_m, 1.0));
        let one = |stop: Position| Some(-60.0 - (stop.x_m - 5.0).abs());
        let two = |stop: Position| Some(if stop.x_m < 2.0 { -40.0 } else { -41.0 });
        let map = map(AlgorithmConfig::StrongestStop(StrongestStopConfig {}), &log_of(&places, &[&one, &two]));
        let found = map.positions();
        assert_eq!(found, [Some(Position::new(5.0, 10.0, 1.0)), Some(Position::new(0.5, 1.0, 1.0))]);
    }
}
