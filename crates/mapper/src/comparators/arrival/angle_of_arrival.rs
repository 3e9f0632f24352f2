//! Angulation: a node is where the directions of its sectors cross.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use sextant_channel::{Reception, ReceptionLog, Wedge};
use sextant_kernel::{NodeId, SettingError, Watch};

use crate::comparators::lateration::{Bearing, MeasuredAngle, angulate};
use crate::comparators::node_by_node;
use crate::error::MapError;
use crate::estimator::{AnyLog, Estimator, EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::EstimatorFindings;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// Angulation as written in a scenario. It has no settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AngleOfArrivalConfig {}

/// A node is where the middles of the sectors cross in which it was received, by [`angulate`]: the maximum of the likelihood of normal
/// errors whose standard deviation is that of a direction anywhere in the sector (its width over √12).
///
/// Appendix A of the thesis measures angles at the node, between anchors; a robot with an array measures them at its stops,
/// whose places and headings are known, so that two stops are enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AngleOfArrival;

impl AngleOfArrival {
    /// The algorithm's name in tables and topics.
    pub const NAME: &'static str = "angle-of-arrival";

    /// The map. Nodes whose directions do not cross are not placed.
    ///
    /// # Errors
    /// [`MapError::Missing`] if the log has no sectors or not their directions; [`MapError::Interrupted`].
    pub fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let log = knowledge.log;
        let missing = |what, remedy| MapError::Missing { algorithm: Self::NAME, what, remedy };
        let nodes = log.node_count();
        if log.receptions().is_empty() {
            return Ok(TopologyMap::of_places(Self::NAME, vec![None; nodes], CoordinateFrame::World));
        }
        if log.receptions().sectors().is_none() {
            return Err(missing("the antenna sector of each reception", "a log has it in the column `sector`"));
        }
        let table = log.sectors().ok_or_else(|| {
            missing("the directions of the antenna sectors", "a log has them in `sectors.csv` or `antenna.toml`")
        })?;
        let wedges: BTreeMap<u8, Wedge> =
            table.iter().filter_map(|sector| Some((sector.sector, sector.wedge().ok()?))).collect();
        let in_space = knowledge.dimensions() == 3;
        let operations = log.stops().len() as f64;
        let places = node_by_node(Self::NAME, nodes, operations, watch, |node| {
            angulate(&bearings(log, &wedges, NodeId::from_index(node), in_space)).ok()
        })?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

/// The directions of `node` at the stops that received it.
fn bearings(log: &ReceptionLog, wedges: &BTreeMap<u8, Wedge>, node: NodeId, in_space: bool) -> Vec<Bearing> {
    let bearing = |reception: Reception| {
        let wedge = *wedges.get(&reception.sector.filter(|_| reception.received > 0)?)?;
        let stop = &log.stops()[reception.stop as usize];
        let azimuth_rad =
            wedge.azimuth_from_rad + 0.5 * wedge.azimuth_width_rad + stop.heading_rad.unwrap_or_default();
        let has_direction = wedge.azimuth_width_rad < TAU;
        has_direction.then(|| Bearing {
            from: stop.position,
            azimuth: within(azimuth_rad, wedge.azimuth_width_rad),
            elevation: elevation(wedge).filter(|_| in_space),
        })
    };
    log.of(node).iter().filter_map(bearing).collect()
}

/// The elevation of a sector; `None` if it reaches straight up or down.
fn elevation(wedge: Wedge) -> Option<MeasuredAngle> {
    let [low, high] = wedge.elevation_rad;
    (low > -FRAC_PI_2 && high < FRAC_PI_2).then(|| within(0.5 * (low + high), high - low))
}

/// An angle anywhere in an interval of this width.
fn within(middle_rad: f64, width_rad: f64) -> MeasuredAngle {
    MeasuredAngle { rad: middle_rad, sigma_rad: width_rad / 12.0_f64.sqrt() }
}

impl Estimator for AngleOfArrival {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::RobotReceptions]
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        self.map(knowledge, watch).map(|map| (map, None))
    }

    fn counts_packets(&self) -> bool {
        false
    }
}

impl EstimatorSettings for AngleOfArrivalConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: AngleOfArrival::NAME,
        rank: 13,
        description: "Where the directions of the antenna sectors cross in which a node was received",
        settings: "{}",
    });

    fn mapper(self) -> Result<Mapper, SettingError> {
        Ok(Mapper::new(AngleOfArrival))
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{EvenSectorsConfig, Position, SectorConfig, SectorTable, Stop};

    use super::*;
    use crate::algorithm::AlgorithmConfig;

    /// Ten by ten stops, whose robot is turned by `turn_rad` more at each, receive nodes in the sector where they are.
    fn log(nodes: &[Position], turn_rad: Option<f64>) -> ReceptionLog {
        let layout =
            EvenSectorsConfig { azimuth_sectors: 16, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
        let stop = |i: u32| Stop {
            heading_rad: turn_rad.map(|turn_rad| turn_rad * f64::from(i)),
            ..Stop::at(Position::new(f64::from(2 * (i % 10)), f64::from(2 * (i / 10)), 0.5))
        };
        let stops: Vec<Stop> = (0..100).map(stop).collect();
        let table = SectorTable::try_from(layout).unwrap();
        let has = |sector: &SectorConfig, apart: Position, turn_rad: f64| {
            let wedge = sector.wedge().unwrap();
            let azimuth = libm::atan2(apart.y_m, apart.x_m) - turn_rad;
            (azimuth - wedge.azimuth_from_rad).rem_euclid(TAU) < wedge.azimuth_width_rad
        };
        let mut receptions = Vec::new();
        for (node, &place) in nodes.iter().enumerate() {
            for (stop, at) in (0..).zip(&stops) {
                let turn_rad = at.heading_rad.unwrap_or(0.0);
                let sector = table.iter().find(|sector| has(sector, place - at.position, turn_rad));
                receptions.push(Reception {
                    sector: sector.map(|sector| sector.sector),
                    ..Reception::heard(NodeId::from_index(node), stop, 1, 1)
                });
            }
        }
        let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
        let log = ReceptionLog::new(names, stops, receptions, vec![]).unwrap();
        log.with_sectors(table).unwrap()
    }

    #[test]
    fn a_node_is_where_its_sectors_cross_also_if_the_robot_turns() {
        let nodes = [Position::new(7.3, 9.1, 0.5), Position::new(15.2, 4.4, 0.5)];
        for turn_rad in [None, Some(0.7)] {
            let mapper = Mapper::try_from(AlgorithmConfig::AngleOfArrival(AngleOfArrivalConfig {})).unwrap();
            let map = mapper.map(&log(&nodes, turn_rad)).unwrap();
            for (found, node) in map.positions().iter().zip(nodes) {
                assert!(found.unwrap().distance_m(node) < 0.2, "{found:?} not {node}");
            }
        }
    }

    #[test]
    fn a_log_without_sectors_is_refused() {
        let with = log(&[Position::ORIGIN], None);
        let mut receptions = with.receptions().to_vec();
        receptions.iter_mut().for_each(|reception| reception.sector = None);
        let without = ReceptionLog::new(with.names().to_vec(), with.stops().to_vec(), receptions, vec![]).unwrap();
        let refused = Mapper::new(AngleOfArrival).map(&without).unwrap_err().to_string();
        assert!(refused.contains("angle-of-arrival") && refused.contains("`sector`"), "{refused}");
    }
}
