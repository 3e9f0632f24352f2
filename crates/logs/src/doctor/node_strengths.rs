//! The strengths of one node in the order of the survey, on one floor.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Stops whose heights differ by more than this, without a stop between, are on two floors (m).
const FLOOR_M: f64 = 2.0;

/// Where a node was heard on one floor, and how strong (dBm), in the order of the survey.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NodeStrengths {
    pub(super) stops: Vec<u32>,
    pub(super) places: Vec<Position>,
    pub(super) levels_dbm: Vec<f64>,
}

/// The floor of each stop of a log, from the lowest. What is between two floors a law of distances does not know, so each floor
/// is judged by itself.
pub(super) fn floors(log: &ReceptionLog) -> Vec<usize> {
    let heights: Vec<f64> = log.stops().iter().map(|stop| stop.position.z_m).collect();
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let mut floors = vec![0; heights.len()];
    for pair in order.windows(2) {
        floors[pair[1]] = floors[pair[0]] + usize::from(heights[pair[1]] - heights[pair[0]] > FLOOR_M);
    }
    floors
}

impl NodeStrengths {
    /// The strengths of a node on each of the `floors` of the stops, at least `least` on a floor and evenly chosen if there are
    /// more than `most`.
    pub(super) fn of(
        log: &ReceptionLog,
        node: NodeId,
        floors: &[usize],
        [least, most]: [usize; 2],
    ) -> impl Iterator<Item = Self> {
        let mut by_floor: Vec<Vec<(u32, f64)>> =
            vec![Vec::new(); floors.iter().max().map_or(0, |highest| highest + 1)];
        for heard in log.of(node).iter().filter(|row| row.received > 0) {
            if let Some(level_dbm) = heard.rssi_dbm.filter(|&level_dbm| level_dbm < 0.0) {
                by_floor[floors[heard.stop as usize]].push((heard.stop, level_dbm));
            }
        }
        by_floor.into_iter().filter(move |rows| rows.len() >= least).map(move |rows| {
            let every = rows.len().div_ceil(most).max(1);
            let (stops, levels_dbm): (Vec<u32>, Vec<f64>) = rows.into_iter().step_by(every).unzip();
            let places = stops.iter().map(|&stop| log.stops()[stop as usize].position).collect();
            Self { stops, places, levels_dbm }
        })
    }

    /// Number of stops.
    pub(super) fn len(&self) -> usize {
        self.stops.len()
    }
}
