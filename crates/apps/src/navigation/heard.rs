//! The nodes that a robot has heard lately.

use std::collections::BTreeMap;

use sextant_channel::{Db, Dbm, Position};
use sextant_kernel::{SimTime, StationId};

/// Nodes that a lateration needs at least, and its iterations (Levenberg 1944, Marquardt 1963).
const LEAST_LATERATION: usize = 4;
const ITERATIONS: usize = 8;
/// Squared distances that are not resolved, as shares of the squared spread of the nodes, one after the other.
const FLOORS: [f64; 3] = [1.0, 0.1, 0.01];
/// Loss over a natural logarithm of squared distance (dB): `5 n / ln 10` with the path loss exponent n = 3, between free
/// space and trees. Another exponent changes all errors by the same factor.
const SLOPE_DB: f64 = 5.0 * 3.0 / std::f64::consts::LN_10;

/// An error (dB), and its derivatives along x and y (dB/m).
type LinkRow = (f64, [f64; 2]);

/// What a robot heard last of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeardNode {
    /// The place of the node on the map (m).
    pub place: Position,
    /// Received power less transmit power.
    pub gain: Db,
    /// Received power.
    pub rssi: Dbm,
    /// When.
    pub time: SimTime,
}

/// The nodes that a robot has heard lately.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbourhood {
    heard: BTreeMap<StationId, HeardNode>,
}

impl Neighbourhood {
    /// A node was heard.
    pub(crate) fn hear(&mut self, station: StationId, heard: HeardNode) {
        self.heard.insert(station, heard);
    }

    /// The nodes, by station.
    pub(crate) fn nodes(&self) -> impl ExactSizeIterator<Item = (StationId, &HeardNode)> {
        self.heard.iter().map(|(&station, heard)| (station, heard))
    }

    /// The place of the robot on the map as the mean of those of the nodes, weighted by the ratio of received and
    /// transmit power (thesis, equation of the robot's coordinates, chapters 6 and 7). The ratio is linear: one in
    /// decibels would grow with the distance. `None` if no node was heard.
    #[must_use]
    pub(crate) fn centroid(&self) -> Option<Position> {
        // Relative to the strongest one, so that no weight underflows.
        let strongest = self.heard.values().map(|heard| heard.gain.0).max_by(f64::total_cmp)?;
        let weigh = |heard: &HeardNode| Db(heard.gain.0 - strongest).to_factor();
        let total: f64 = self.heard.values().map(weigh).sum();
        let sum = self.heard.values().fold(Position::ORIGIN, |sum, heard| sum + heard.place * weigh(heard));
        Some(sum * (1.0 / total))
    }

    /// The place of the robot on the map whose distances to the nodes explain the received powers best: least squares
    /// in decibels with the law of log-distance path loss, whose constant is fitted, so that the scale of the map does not
    /// matter. It is not drawn inside at the border of the network, as the centroid is. In the plane; the height is that
    /// of the centroid. `None` if fewer than four nodes were heard.
    #[must_use]
    pub(crate) fn lateration(&self) -> Option<Position> {
        if self.heard.len() < LEAST_LATERATION {
            return None;
        }
        let start = self.centroid()?;
        let count = self.heard.len() as f64;
        let spread = |heard: &HeardNode| (heard.place - start).dot(heard.place - start);
        let spread_m2 = self.heard.values().map(spread).sum::<f64>() / count;
        if spread_m2 <= 0.0 {
            return None;
        }
        // Near a node the loss has a pole, and poles are traps on the way: first they are blunt, then sharper.
        let place = FLOORS.into_iter().fold(start, |place, floor| self.fitted(place, floor * spread_m2));
        // With few nodes and much fading, the least squares may lie far away.
        let (offset, most) = (place - start, 2.0 * spread_m2.sqrt());
        let length = offset.length_m();
        Some(if length > most { start + offset * (most / length) } else { place })
    }

    /// The place of least squares that is found from `start`; squared distances are not resolved below `floor` (m²).
    fn fitted(&self, start: Position, floor: f64) -> Position {
        let count = self.heard.len() as f64;
        let errors_at = |place: Position| -> Vec<LinkRow> {
            let row = |heard: &HeardNode| {
                let (x, y) = (place.x_m - heard.place.x_m, place.y_m - heard.place.y_m);
                let square = x * x + y * y + floor;
                // 10 n log10(d) = 5 n log10(d²), with the derivative of log(d²) = 2 (x, y) / d².
                let slope = 2.0 * SLOPE_DB / square;
                (heard.gain.0 + SLOPE_DB * libm::log(square), [slope * x, slope * y])
            };
            let mut rows: Vec<_> = self.heard.values().map(row).collect();
            let total = |sum: [f64; 3], &(error, [x, y]): &LinkRow| [sum[0] + error, sum[1] + x, sum[2] + y];
            let [error, x, y] = rows.iter().fold([0.0; 3], total).map(|sum| sum / count);
            for row in &mut rows {
                *row = (row.0 - error, [row.1[0] - x, row.1[1] - y]);
            }
            rows
        };
        let cost = |rows: &[LinkRow]| rows.iter().map(|row| row.0 * row.0).sum::<f64>();
        let (mut place, mut rows) = (start, errors_at(start));
        let mut damping = 1e-2;
        for _ in 0..ITERATIONS {
            let (mut xx, mut xy, mut yy, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
            for &(error, [x, y]) in &rows {
                xx += x * x;
                xy += x * y;
                yy += y * y;
                bx -= x * error;
                by -= y * error;
            }
            let (xx, yy) = (xx * (1.0 + damping), yy * (1.0 + damping));
            let determinant = xx * yy - xy * xy;
            if determinant <= 0.0 {
                break;
            }
            let step = Position::new((bx * yy - by * xy) / determinant, (by * xx - bx * xy) / determinant, 0.0);
            let moved = errors_at(place + step);
            if cost(&moved) < cost(&rows) {
                (place, rows) = (place + step, moved);
                damping *= 0.3;
            } else {
                damping *= 10.0;
            }
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(x_m: f64, gain_db: f64) -> HeardNode {
        HeardNode { place: Position::new(x_m, 0.0, 0.0), gain: Db(gain_db), rssi: Dbm(gain_db), time: SimTime::ZERO }
    }

    #[test]
    fn a_node_ten_decibels_stronger_weighs_ten_times_as_much() {
        let mut neighbourhood = Neighbourhood::default();
        assert_eq!(neighbourhood.centroid(), None);
        neighbourhood.hear(StationId(0), heard(0.0, -400.0));
        neighbourhood.hear(StationId(1), heard(11.0, -390.0));
        assert!((neighbourhood.centroid().unwrap().x_m - 10.0).abs() < 1e-9);
    }

    #[test]
    fn lateration_finds_a_robot_outside_its_neighbours() {
        // Nodes on one side of the robot, on a map of another scale.
        let robot = Position::new(-1.0, 2.0, 0.0);
        let mut neighbourhood = Neighbourhood::default();
        for i in 0..24_u32 {
            let node = Position::new(f64::from(i % 5), f64::from(i / 5), 0.0);
            let gain = Db(-40.0 - 30.0 * libm::log10(node.distance_m(robot)));
            let heard = HeardNode { place: node * 0.2, gain, rssi: Dbm(gain.0), time: SimTime::ZERO };
            neighbourhood.hear(StationId(i), heard);
        }
        let found = neighbourhood.lateration().unwrap() * 5.0;
        assert!(found.distance_m(robot) < 0.3, "{found:?}");
        assert!(neighbourhood.centroid().unwrap().x_m * 5.0 > 0.0, "the centroid is among the nodes");
    }
}
