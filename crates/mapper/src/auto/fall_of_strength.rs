//! How strengths fall with the distance from the places of a map.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::Position;

use super::folds::Fold;
use crate::topology_map::TopologyMap;

/// Distances are at least this (m).
const NEAREST_M: f64 = 0.1;
/// What is predicted scatters at least by this (dB).
const LEAST_DB: f64 = 0.5;
/// Weight of no slope at all, in pairs: few pairs do not tell one.
const RIDGE: f64 = 1e-3;

/// The strengths that an estimator without a law of strengths would predict from its places: they fall with the logarithm of
/// the distance and with what obstacles absorb, differ from node to node, and scatter independently.
#[derive(Clone, Debug)]
pub(super) struct FallOfStrength {
    /// Strength at 1 m (dBm), its fall per unit of the logarithm of the distance, and per unit of absorption (dB).
    law: Vector3<f64>,
    /// What is the node's own (dB).
    offsets: Vec<f64>,
    deviation_db: f64,
    /// Mean and deviation of all strengths (dBm, dB).
    all: (f64, f64),
}

impl FallOfStrength {
    /// The fall of the strengths that were received at the stops outside `fold`; `None` if there are none.
    pub(super) fn of(
        fold: &Fold<'_>,
        map: &TopologyMap,
        absorbed: &dyn Fn(Position, Position) -> f64,
    ) -> Option<Self> {
        let mut rows: Vec<(usize, Vector3<f64>, f64)> = Vec::new();
        let mut strengths = Vec::new();
        for (node, estimate) in map.estimates.iter().enumerate() {
            for (pair, rssi_dbm) in fold.others(node).filter_map(|pair| Some((pair, pair.rssi_dbm?))) {
                strengths.push(rssi_dbm);
                if let Some(place) = estimate.as_ref().map(|estimate| estimate.position) {
                    let row = row(place.distance_m(pair.stop.position), absorbed(place, pair.stop.position));
                    rows.push((node, row, rssi_dbm));
                }
            }
        }
        if strengths.is_empty() {
            return None;
        }
        let all = moments(strengths.iter().copied());
        let mut offsets = vec![0.0; map.estimates.len()];
        let mut law = Vector3::new(all.0, 0.0, 0.0);
        let mut deviation_db = all.1;
        for _ in 0..3 {
            let mut normal = Matrix3::identity() * RIDGE;
            let mut right = Vector3::new(RIDGE * all.0, 0.0, 0.0);
            for (node, row, rssi_dbm) in &rows {
                normal += row * row.transpose();
                right += row * (rssi_dbm - offsets[*node]);
            }
            law = normal.cholesky().map_or(law, |factor| factor.solve(&right));
            let mut sums = vec![(0.0, 0.0); offsets.len()];
            for (node, row, rssi_dbm) in &rows {
                sums[*node].0 += rssi_dbm - row.dot(&law);
                sums[*node].1 += 1.0;
            }
            // An offset is drawn towards none by its own scatter over the nodes.
            let means = sums.iter().filter(|sum| sum.1 > 0.0).map(|sum| sum.0 / sum.1);
            let between = moments(means).1.max(LEAST_DB);
            let ratio = deviation_db * deviation_db / (between * between);
            for (offset, (sum, count)) in offsets.iter_mut().zip(sums) {
                *offset = sum / (count + ratio);
            }
            let errors = rows.iter().map(|(node, row, rssi_dbm)| rssi_dbm - row.dot(&law) - offsets[*node]);
            let squares: f64 = errors.map(|error| error * error).sum();
            let freedom = (rows.len() as f64 - offsets.len() as f64 - 3.0).max(1.0);
            deviation_db = if rows.is_empty() { all.1 } else { (squares / freedom).sqrt() }.max(LEAST_DB);
        }
        Some(Self { law, offsets, deviation_db, all })
    }

    /// Density of a strength (1/dB) for a link from a node over a distance (m) through what absorbs; for a link of which nothing
    /// is known, that of all links.
    pub(super) fn density(&self, link: Option<(usize, f64, f64)>, rssi_dbm: f64) -> f64 {
        let (mean, deviation_db) = match link {
            Some((node, distance_m, absorbed)) => {
                (self.law.dot(&row(distance_m, absorbed)) + self.offsets[node], self.deviation_db)
            }
            None => self.all,
        };
        crate::numerics::normal::density((rssi_dbm - mean) / deviation_db) / deviation_db
    }
}

fn row(distance_m: f64, absorbed: f64) -> Vector3<f64> {
    Vector3::new(1.0, -libm::log(distance_m.max(NEAREST_M)), -absorbed)
}

/// Mean and standard deviation, at least [`LEAST_DB`].
fn moments(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for value in values {
        count += 1.0;
        sum += value;
        squares += value * value;
    }
    let mean = if count > 0.0 { sum / count } else { 0.0 };
    (mean, (squares / f64::max(count, 1.0) - mean * mean).max(0.0).sqrt().max(LEAST_DB))
}
