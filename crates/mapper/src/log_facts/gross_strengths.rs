//! Single strengths that no place of their node explains beside its others.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;
use sextant_kernel::maths::ln_each;

use crate::numerics::halves::halve;

/// A strength that contradicts the others of its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrossStrength {
    /// The node.
    pub node: NodeId,
    /// The stop that heard it.
    pub stop: u32,
    /// The strength (dBm).
    pub rssi_dbm: f64,
    /// How much it is above what the others say, at the place that explains it best (dB); negative below.
    pub above_db: f64,
    /// Number of the others.
    pub others: usize,
}

/// Fewer strengths of a node do not tell which of them is wrong; of so many, one may be.
const LEAST: usize = 10;
const FOR_EACH: usize = 20;
/// A strength is suspected if it differs so much from the median of so many strengths on both sides, by an order of neighbours.
const SUSPECT_DB: f64 = 15.0;
const BESIDE: usize = 2;
/// A strength above all others is wrong if it is so much above them, and so many deviations; one below them may be behind a wall.
const ABOVE: (f64, f64) = (15.0, 5.0);
const BELOW: (f64, f64) = (25.0, 8.0);
/// Squares of the others that are greater by so many of their variance are not likely, and not possible.
const LIKELY: f64 = 9.0;
const POSSIBLE: f64 = 25.0;
/// Parameters of a fit: a place, a level and a slope.
const PARAMETERS: usize = 4;
/// Places that are tried: cells of a grid, which goes beyond the stops by a share of their diagonal, and the strongest stops.
const CELLS: f64 = 20.0;
const MARGIN: f64 = 0.25;
const STRONGEST: usize = 20;
/// A vertex stands for places so far from it, and so near to others, in steps of the grid.
const NEAREST: f64 = 0.35;
const NEAR: f64 = 1.5;

/// The gross strengths of all nodes of `log`.
#[must_use]
pub fn gross_strengths(log: &ReceptionLog) -> Vec<GrossStrength> {
    (0..log.node_count()).flat_map(|node| of_node(log, NodeId::from_index(node))).collect()
}

/// Those of `node`: a law of the logarithm of the distance is fitted to the others, from all places.
pub(crate) fn of_node(log: &ReceptionLog, node: NodeId) -> Vec<GrossStrength> {
    let heard = log.of(node).iter().filter(|reception| reception.received > 0);
    let mut levels: Vec<Level> = heard
        .filter_map(|reception| {
            let place = log.stops()[reception.stop as usize].position;
            Some(Level { stop: reception.stop, place, dbm: reception.rssi_dbm? })
        })
        .collect();
    let most = (levels.len() / FOR_EACH).max(1);
    let mut gross = Vec::new();
    while levels.len() >= LEAST && gross.len() < most {
        let Some((number, above_db)) = worst(&levels) else { break };
        let Level { stop, dbm, .. } = levels.remove(number);
        gross.push(GrossStrength { node, stop, rssi_dbm: dbm, above_db, others: levels.len() });
    }
    gross
}

#[derive(Clone, Copy)]
struct Level {
    stop: u32,
    place: Position,
    dbm: f64,
}

/// The strengths that differ from those beside them.
fn suspects(levels: &[Level]) -> Vec<usize> {
    let places: Vec<Position> = levels.iter().map(|level| level.place).collect();
    let mut order: Vec<usize> = (0..levels.len()).collect();
    halve(&mut order, &places);
    let is_odd = |at: usize| {
        let around = at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(order.len());
        let mut beside: Vec<f64> =
            around.filter(|&other| other != at).map(|other| levels[order[other]].dbm).collect();
        beside.sort_by(f64::total_cmp);
        let [low, high] = [(beside.len() - 1) / 2, beside.len() / 2].map(|middle| beside[middle]);
        (levels[order[at]].dbm - 0.5 * (low + high)).abs() > SUSPECT_DB
    };
    let mut odd: Vec<usize> = (0..order.len()).filter(|&at| is_odd(at)).map(|at| order[at]).collect();
    odd.sort_unstable();
    odd
}

/// The strength that contradicts the others most, if one does, and by how much (dB).
fn worst(levels: &[Level]) -> Option<(usize, f64)> {
    let suspects = suspects(levels);
    if suspects.is_empty() {
        return None;
    }
    let (vertices, step_m) = vertices(levels);
    let mean_dbm = levels.iter().map(|level| level.dbm).sum::<f64>() / levels.len() as f64;
    // For each vertex and suspect: squares of the others (dB²), and how much the suspect is above them (dB).
    let fits: Vec<Vec<(f64, f64)>> =
        vertices.iter().map(|&vertex| without_each(levels, &suspects, mean_dbm, vertex, NEAREST * step_m)).collect();
    let freedom = (levels.len() - 1 - PARAMETERS) as f64;
    let judged = suspects.iter().enumerate().filter_map(|(column, &number)| {
        let least = fits.iter().map(|fit| fit[column].0).fold(f64::INFINITY, f64::min);
        let within = |variances: f64| {
            let most = least * (1.0 + variances / freedom);
            vertices.iter().zip(&fits).filter(move |(_, fit)| fit[column].0 <= most)
        };
        let deviation_db = (least / freedom).sqrt().max(1e-6);
        let above_db = within(LIKELY).map(|(_, fit)| fit[column].1).min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let place = levels[number].place;
        let (far_db, deviations) = if above_db > 0.0 { ABOVE } else { BELOW };
        // A node beside a stop may be far stronger there than anywhere else.
        let may_be_beside =
            above_db > 0.0 && within(POSSIBLE).any(|(vertex, _)| vertex.distance_m(place) <= NEAR * step_m);
        let is_gross = above_db.abs() > far_db.max(deviations * deviation_db) && !may_be_beside;
        (least.is_finite() && is_gross).then_some((number, above_db, above_db.abs() / deviation_db))
    });
    judged.max_by(|a, b| a.2.total_cmp(&b.2)).map(|(number, above_db, _)| (number, above_db))
}

/// Places where the node may be, and the step of their grid (m).
fn vertices(levels: &[Level]) -> (Vec<Position>, f64) {
    let along = |axis: usize| levels.iter().map(move |level| <[f64; 3]>::from(level.place)[axis]);
    let ends = [0, 1].map(|axis| {
        along(axis).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    });
    let widths_m = ends.map(|[low, high]| high - low);
    let margin_m = MARGIN * libm::hypot(widths_m[0], widths_m[1]);
    let widths_m = widths_m.map(|width_m| (width_m + 2.0 * margin_m).max(1e-3));
    let step_m = (widths_m[0] * widths_m[1]).sqrt() / CELLS;
    let counts = widths_m.map(|width_m| crate::numerics::whole((width_m / step_m).round()).clamp(1, 400));
    let z_m = along(2).sum::<f64>() / levels.len() as f64;
    let at =
        |axis: usize, i: usize| ends[axis][0] - margin_m + widths_m[axis] * (i as f64 + 0.5) / counts[axis] as f64;
    let mut vertices: Vec<Position> =
        (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| Position::new(at(0, i), at(1, j), z_m))).collect();
    let mut strongest: Vec<&Level> = levels.iter().collect();
    strongest.sort_by(|a, b| b.dbm.total_cmp(&a.dbm));
    vertices.extend(strongest.iter().take(STRONGEST).map(|level| level.place));
    (vertices, step_m)
}

/// Of the regression of strengths on the logarithms of the distances from `vertex`, without each suspect in turn: the squares of
/// the others (dB²), infinite where they rise with the distance, and how much the suspect is above them (dB).
fn without_each(
    levels: &[Level],
    suspects: &[usize],
    mean_dbm: f64,
    vertex: Position,
    least_m: f64,
) -> Vec<(f64, f64)> {
    let mut logs: Vec<f64> = levels.iter().map(|level| level.place.distance_m(vertex).max(least_m)).collect();
    ln_each(&mut logs);
    let count = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / count;
    logs.iter_mut().for_each(|log| *log -= mean);
    let over = |number: usize| levels[number].dbm - mean_dbm;
    let squares = logs.iter().map(|log| log * log).sum::<f64>().max(1e-12);
    let slope = logs.iter().enumerate().map(|(number, log)| log * over(number)).sum::<f64>() / squares;
    let error = |number: usize| over(number) - slope * logs[number];
    let all: f64 = (0..logs.len()).map(|number| error(number) * error(number)).sum();
    let without = |&number: &usize| {
        // What a strength draws to itself (leverage), and the fit without it.
        let log = logs[number];
        let left = (1.0 - 1.0 / count - log * log / squares).max(1e-9);
        let above_db = error(number) / left;
        let falls = slope - log * above_db / squares < 0.0;
        (if falls { (all - error(number) * above_db).max(1e-9) } else { f64::INFINITY }, above_db)
    };
    suspects.iter().map(without).collect()
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Reception, Stop};
    use sextant_kernel::{Purpose, RobotId, Seed, SimTime};

    use super::*;

    /// What is gross of a node at `place`, heard from 8 by 6 stops 3 m apart with 3 dB of shadowing, if that of stop 30 is wrong.
    fn gross(place: Position, wrong_db: f64) -> Vec<GrossStrength> {
        let stop = |number: u32| Stop {
            robot: RobotId(0),
            time: SimTime::ZERO,
            position: Position::new(3.0 * f64::from(number % 8), 3.0 * f64::from(number / 8), 0.0),
            heading_rad: None,
        };
        let reception = |number: u32| {
            let distance_m = stop(number).position.distance_m(place).max(0.1);
            let shadowing_db = 3.0 * Seed(3).normal(Purpose::new(5), [u64::from(number), 0, 0]);
            let wrong_db = if number == 30 { wrong_db } else { 0.0 };
            let rssi_dbm = Some(-45.0 - 25.0 * distance_m.log10() + shadowing_db + wrong_db);
            Reception { node: NodeId(0), stop: number, received: 5, sent: 5, sector: None, rssi_dbm, snr_db: None }
        };
        let receptions = (0..48).map(reception).collect();
        let log = ReceptionLog::new(vec!["n".into()], (0..48).map(stop).collect(), receptions, Vec::new()).unwrap();
        gross_strengths(&log)
    }

    #[test]
    fn a_wrong_strength_is_found_and_a_strong_one_beside_a_stop_is_not_wrong() {
        for wrong_db in [30.0, 40.0, -50.0] {
            let found = gross(Position::new(4.0, 3.5, 0.0), wrong_db);
            assert!(matches!(found[..], [GrossStrength { stop: 30, others: 47, .. }]), "{wrong_db}: {found:?}");
            assert!((found[0].above_db - wrong_db).abs() < 12.0, "{found:?}");
        }
        assert_eq!(gross(Position::new(4.0, 3.5, 0.0), 0.0), []);
        // Stop 30 is at (18, 9): 0.1 m from the node it is 30 dB above its neighbours.
        assert_eq!(gross(Position::new(18.05, 9.05, 0.0), 0.0), []);
        assert_eq!(gross(Position::new(18.3, 9.2, 0.0), 0.0), []);
    }
}
