//! Baselines that place each node by itself, from the signal strengths that the robot measured.

mod gaussian_process;
mod log_distance;
mod rssi_centroid;
mod strongest_stop;

pub use gaussian_process::{GaussianProcess, GaussianProcessConfig};
pub(crate) use gaussian_process::{Process, strongest_first};
pub use log_distance::{LogDistance, LogDistanceConfig};
pub(crate) use rssi_centroid::centroid;
pub use rssi_centroid::{RssiCentroid, RssiCentroidConfig};
pub(crate) use strongest_stop::strongest_place;
pub use strongest_stop::{StrongestStop, StrongestStopConfig};

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, Reception, ReceptionLog, Stop};
    use sextant_kernel::{NodeId, Unwatched};

    use super::*;
    use crate::algorithm::AlgorithmConfig;
    use crate::estimator::Mapper;
    use crate::knowledge::Knowledge;
    use crate::topology_map::TopologyMap;

    /// The log of nodes that stops at `places` received with these strengths (dBm).
    pub(super) fn log_of(places: &[Position], nodes: &[&dyn Fn(Position) -> Option<f64>]) -> ReceptionLog {
        let stop = |position: &Position| Stop::at(*position);
        let receptions = nodes.iter().enumerate().flat_map(|(node, law)| {
            (0..).zip(places).filter_map(move |(stop, place)| {
                let rssi_dbm = Some(law(*place)?);
                let node = NodeId::from_index(node);
                Some(Reception { rssi_dbm, ..Reception::heard(node, stop, 1, 1) })
            })
        });
        let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
        ReceptionLog::new(names, places.iter().map(stop).collect(), receptions.collect(), vec![]).unwrap()
    }

    /// A square of 7 by 7 stops, 2 m apart.
    pub(super) fn square() -> Vec<Position> {
        (0..49).map(|i| Position::new(2.0 * f64::from(i % 7), 2.0 * f64::from(i / 7), 0.0)).collect()
    }

    pub(super) fn map(config: AlgorithmConfig, log: &ReceptionLog) -> TopologyMap {
        Mapper::try_from(config).unwrap().map(log).unwrap()
    }

    fn all() -> [AlgorithmConfig; 4] {
        [
            AlgorithmConfig::StrongestStop(StrongestStopConfig {}),
            AlgorithmConfig::RssiCentroid(RssiCentroidConfig::default()),
            AlgorithmConfig::LeastSquares(LogDistanceConfig::default()),
            AlgorithmConfig::GaussianProcess(GaussianProcessConfig {}),
        ]
    }

    #[test]
    fn a_log_without_strengths_is_refused_and_a_node_without_them_is_not_mapped() {
        let known = |_: Position| Some(-50.0);
        let log = log_of(&square(), &[&known, &known]);
        let without = |all: bool| {
            let receptions = log.receptions().iter().map(|reception| {
                let is_kept = !all && reception.node == NodeId(0);
                Reception { rssi_dbm: reception.rssi_dbm.filter(|_| is_kept), ..reception }
            });
            ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions.collect(), vec![]).unwrap()
        };
        for config in all() {
            let mapper = Mapper::try_from(config).unwrap();
            let refused = mapper.map(&without(true)).unwrap_err().to_string();
            assert!(refused.contains(mapper.name()) && refused.contains("`rssi_dbm`"), "{refused}");
            let map = mapper.map(&without(false)).unwrap();
            assert_eq!((map.algorithm, map.unmapped()), (mapper.name(), 1));
            assert!(map.estimates[0].is_some() && map.estimates[1].is_none());
        }
    }

    #[test]
    fn a_node_that_one_stop_heard_is_at_that_stop() {
        let place = Position::new(4.0, 6.0, 0.0);
        let log = log_of(&square(), &[&|stop: Position| (stop.distance_m(place) < 0.1).then_some(-70.0)]);
        for config in all() {
            let map = map(config, &log);
            let found = map.estimates[0].as_ref().unwrap().position;
            assert!(found.distance_m(place) < 1e-9, "{}: {found}", map.algorithm);
        }
    }

    #[test]
    fn an_empty_log_has_an_empty_map() {
        let log = ReceptionLog::new(vec![], vec![], vec![], vec![]).unwrap();
        for config in all() {
            let mapper = Mapper::try_from(config).unwrap();
            let (map, learned) = mapper.map_and_learn(Knowledge::from(&log), &Unwatched).unwrap();
            assert!(map.estimates.is_empty() && learned.is_none());
        }
    }
}
