//! How much of the strengths of nodes the distances of a map explain.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Nearer than this a place is not known (m).
const LEAST_M: f64 = 0.5;
/// Fewer strengths of a node say nothing of its distances.
const LEAST: usize = 3;

/// Sums over the strengths of a node: of the squares of the logarithms of distance, of their products with the strengths, and of the
/// squares of the strengths, all about their means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct NodeSums {
    pub(super) logs: f64,
    pub(super) with_levels: f64,
    pub(super) levels: f64,
}

impl NodeSums {
    /// The sums of each node of `log` that has one of the `places`, and distances that differ.
    pub(super) fn of_map(log: &ReceptionLog, places: &[Option<Position>]) -> Vec<Self> {
        let of_node = |node: usize| Self::of(log, NodeId::from_index(node), (*places.get(node)?)?);
        (0..log.node_count()).filter_map(of_node).collect()
    }

    fn of(log: &ReceptionLog, node: NodeId, place: Position) -> Option<Self> {
        let heard = log.of(node);
        let heard = heard.iter().filter(|row| row.received > 0);
        let point = |stop: u32| libm::log10(log.stops()[stop as usize].position.distance_m(place).max(LEAST_M));
        let points: Vec<[f64; 2]> = heard.filter_map(|row| Some([point(row.stop), row.rssi_dbm?])).collect();
        let share = 1.0 / points.len() as f64;
        let mean = points.iter().fold([0.0; 2], |mean, [x, y]| [mean[0] + x * share, mean[1] + y * share]);
        let sums = points.iter().fold(Self::default(), |sums, [x, y]| {
            let (x, y) = (x - mean[0], y - mean[1]);
            Self { logs: sums.logs + x * x, with_levels: sums.with_levels + x * y, levels: sums.levels + y * y }
        });
        (points.len() >= LEAST && sums.logs > 0.0).then_some(sums)
    }

    /// Those of all nodes together.
    pub(super) fn total(nodes: &[Self]) -> Self {
        nodes.iter().fold(Self::default(), |sum, one| Self {
            logs: sum.logs + one.logs,
            with_levels: sum.with_levels + one.with_levels,
            levels: sum.levels + one.levels,
        })
    }
}

/// The share of the variance of strengths beyond a level of each node that one fall with the logarithm of distance explains, 0 to 1;
/// `None` if no node tells it.
pub(super) fn explained(nodes: &[NodeSums]) -> Option<f64> {
    let NodeSums { logs, with_levels, levels } = NodeSums::total(nodes);
    let along = with_levels.min(0.0);
    (logs > 0.0 && levels > 0.0).then(|| along * along / (logs * levels))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::tests::{NODES, changed, draw, good, node};

    #[test]
    fn distances_explain_strengths_of_a_law_and_none_that_were_mixed() {
        let log = good();
        let share = |log: &ReceptionLog| {
            let places: Vec<Option<Position>> = (0..NODES).map(|number| Some(node(number))).collect();
            explained(&NodeSums::of_map(log, &places)).unwrap()
        };
        assert!((0.6..0.95).contains(&share(&log)), "{}", share(&log));
        let mixed = changed(
            &log,
            |stop| stop,
            |row| {
                let level = -60.0 + 6.0 * draw(30, [row.node.0.into(), row.stop.into()]);
                sextant_channel::Reception { rssi_dbm: row.rssi_dbm.map(|_| level), ..row }
            },
        );
        assert!(share(&mixed) < 0.05, "{}", share(&mixed));
        assert_eq!(explained(&[]), None);
    }
}
