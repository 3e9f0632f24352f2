//! How much more places err than a law of independent packets says, where neighbouring stops have something in common.

use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::NodeId;

use crate::numerics::halves::halve;
use crate::posterior::Estimate;
use crate::topology_map::TopologyMap;

/// At most so many nodes are looked at.
const NODES: usize = 64;
/// The stops that tell where a node is are cut into so many blocks of neighbours; a node with fewer stops tells nothing.
const BLOCKS: usize = 12;
/// A share of packets counts as at least so far from 0 and 1.
const LEAST_SHARE: f64 = 0.02;
/// Stops that receive less than this share of the packets of a node, and heard none, tell nothing.
const FAINT: f64 = 1e-4;
/// A node counts at most by this many times what independent packets tell, and so many times is the largest factor.
const MOST: f64 = 25.0;

/// The factor on the variances of `map`, at least 1, with which they hold the errors that a law of independent packets does not
/// know of: the robust covariance of a maximum of the likelihood over that of the law, where blocks of neighbouring stops are
/// independent of each other (White 1982; Liang and Zeger 1986). `share` is the share of packets that arrives from a place at a
/// stop (its number comes with it).
pub(crate) fn factor(
    log: &ReceptionLog,
    map: &TopologyMap,
    share: impl Fn(Position, usize, &Stop) -> f64 + Sync,
) -> f64 {
    let placed: Vec<(usize, &Estimate)> =
        map.estimates.iter().enumerate().filter_map(|(node, estimate)| Some((node, estimate.as_ref()?))).collect();
    let every = placed.len().div_ceil(NODES).max(1);
    let of_nodes: Vec<Option<[f64; 2]>> = placed
        .par_iter()
        .step_by(every)
        .map(|&(node, estimate)| {
            BlocksOfNode::of(log, NodeId::from_index(node), estimate, &share)?.found_and_expected()
        })
        .collect();
    let (found, expected) = of_nodes
        .into_iter()
        .flatten()
        .fold((0.0, 0.0), |(found, all), [own, expected]| (found + own.min(MOST * expected), all + expected));
    if expected > 0.0 { (found / expected).clamp(1.0, MOST) } else { 1.0 }
}

/// What a stop tells of the place of a node.
struct StopScore {
    place: Position,
    /// The gradient of the log-likelihood (1/m).
    score: Vector2<f64>,
    /// Its covariance under the law (1/m²).
    information: Matrix2<f64>,
}

/// What blocks of neighbouring stops tell of the place of a node.
struct BlocksOfNode {
    blocks: Vec<(Vector2<f64>, Matrix2<f64>)>,
    /// The inverse of all information (m²).
    inverse: Matrix2<f64>,
}

impl BlocksOfNode {
    fn of(
        log: &ReceptionLog,
        node: NodeId,
        estimate: &Estimate,
        share: &impl Fn(Position, usize, &Stop) -> f64,
    ) -> Option<Self> {
        let covariance = estimate.covariance?;
        let deviation_m = (0.5 * (covariance[0][0] + covariance[1][1])).sqrt();
        let mut listed = log.of(node).iter().peekable();
        let mut stops: Vec<StopScore> = Vec::new();
        for (number, stop) in log.stops().iter().enumerate() {
            // Of several receptions of a stop, in sectors, the first one counts.
            let mut own = None;
            while let Some(next) = listed.next_if(|reception| reception.stop as usize == number) {
                own = own.or(Some(next));
            }
            let (received, sent) = own.map_or((0, 1), |reception| (reception.received, reception.sent));
            let at = |x_m: f64, y_m: f64| share(estimate.position + Position::new(x_m, y_m, 0.0), number, stop);
            if sent == 0 || (received == 0 && at(0.0, 0.0) < FAINT) {
                continue;
            }
            let [east, west] = [at(deviation_m, 0.0), at(-deviation_m, 0.0)];
            let [north, south] = [at(0.0, deviation_m), at(0.0, -deviation_m)];
            let gradient = Vector2::new(east - west, north - south) / (2.0 * deviation_m);
            if gradient.norm() > 0.0 {
                let mean = (0.25 * (east + west + north + south)).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
                let single = mean * (1.0 - mean);
                let (received, sent) = (f64::from(received), f64::from(sent));
                let score = gradient * ((received - sent * mean) / single);
                let information = gradient * gradient.transpose() * (sent / single);
                stops.push(StopScore { place: stop.position, score, information });
            }
        }
        Self::of_stops(&stops)
    }

    /// Blocks of about the same information.
    fn of_stops(stops: &[StopScore]) -> Option<Self> {
        if stops.len() < BLOCKS {
            return None;
        }
        let places: Vec<Position> = stops.iter().map(|stop| stop.place).collect();
        let mut order: Vec<usize> = (0..stops.len()).collect();
        halve(&mut order, &places);
        let inverse = stops.iter().map(|stop| stop.information).sum::<Matrix2<f64>>().try_inverse()?;
        let mut blocks = vec![(Vector2::zeros(), Matrix2::zeros()); BLOCKS];
        let mut before = 0.0;
        for number in order {
            let StopScore { score, information, .. } = &stops[number];
            // All stops together have a trace of 2.
            let own = 0.5 * (inverse * information).trace();
            let block = crate::numerics::whole(BLOCKS as f64 * (before + 0.5 * own)).min(BLOCKS - 1);
            before += own;
            blocks[block].0 += score;
            blocks[block].1 += information;
        }
        Some(Self { blocks, inverse })
    }

    /// Sum of the squares of the scores of blocks in units of the information, as found and as independent packets would have
    /// them: a place that fits best takes a part of each score with it.
    fn found_and_expected(&self) -> Option<[f64; 2]> {
        let (mut found, mut expected) = (0.0, 2.0);
        for (score, information) in &self.blocks {
            let own = self.inverse * information;
            found += score.dot(&(self.inverse * score));
            expected -= (own * own).trace();
        }
        (expected > 0.0).then_some([found, expected])
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::Reception;
    use sextant_kernel::{Purpose, RobotId, Seed, SimTime};

    use super::*;
    use crate::topology_map::CoordinateFrame;

    fn curve(distance_m: f64) -> f64 {
        1.0 / (1.0 + libm::exp(2.0 * (distance_m - 8.0)))
    }

    /// The factor of a log of 20 nodes and 400 stops 1 m apart, which have something in common over squares of `common_m`.
    fn found(common_m: u64, deviation: f64) -> f64 {
        let seed = Seed(7);
        let stop = |number: u32| Stop {
            robot: RobotId(0),
            time: SimTime::from_nanos(u64::from(number)),
            position: Position::new(f64::from(number % 20), f64::from(number / 20), 0.0),
            heading_rad: None,
        };
        let place = |node: u64| Position::new(5.0 + 0.5 * node as f64, 6.0 + 0.4 * node as f64, 0.0);
        let mut receptions = Vec::new();
        for node in 0..20_u32 {
            for number in 0..400_u32 {
                let at = stop(number).position;
                let square = [u64::from(node), u64::from(number % 20) / common_m, u64::from(number / 20) / common_m];
                let farther_m = deviation * seed.normal(Purpose::new(3), square);
                let share = curve(at.distance_m(place(u64::from(node))) + farther_m);
                let received =
                    u32::from(seed.uniform(Purpose::new(4), [u64::from(node), u64::from(number), 0]) < share);
                let (node, stop) = (NodeId(node), number);
                receptions.push(Reception {
                    node,
                    stop,
                    received,
                    sent: 1,
                    sector: None,
                    rssi_dbm: None,
                    snr_db: None,
                });
            }
        }
        let names = (0..20).map(|node| format!("n{node}")).collect();
        let log = ReceptionLog::new(names, (0..400).map(stop).collect(), receptions, Vec::new()).unwrap();
        let places = (0..20).map(|node| Some(place(node))).collect();
        let mut map = TopologyMap::of_places("a", places, CoordinateFrame::World);
        for estimate in map.estimates.iter_mut().flatten() {
            estimate.covariance = Some([[0.04, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0; 3]]);
        }
        factor(&log, &map, |place, _, stop| curve(place.distance_m(stop.position)))
    }

    #[test]
    fn places_err_more_where_neighbouring_stops_share_what_they_lose() {
        // Places are the true ones, so that nothing of the scores went into them: independent packets have a factor a little above 1.
        assert!(found(1, 0.0) < 1.4, "{}", found(1, 0.0));
        assert!(found(4, 1.5) > 1.3 * found(1, 1.5), "{} {}", found(4, 1.5), found(1, 1.5));
        assert!(found(4, 1.5) > 2.0, "{}", found(4, 1.5));
    }
}
