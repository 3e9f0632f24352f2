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
/// Above what the others say a strength is wrong from this on, below only from that on: it may be behind a wall (dB).
const ABOVE_DB: f64 = 15.0;
const BELOW_DB: f64 = 25.0;
/// So many strengths that are not wrong are found in a log, on average.
const FALSE_ALARMS: f64 = 0.02;
/// What is known of the deviation of strengths before there are any: shadowing in usual surroundings (dB; ITU-R P.1411, P.1238),
/// and by how many strengths.
const USUAL_DB: f64 = 5.0;
const AS_MANY: f64 = 10.0;
/// Squares of the others that are greater by so many of their variance are not likely.
const LIKELY: f64 = 9.0;
/// Parameters of a fit: a place, a level and a slope.
const PARAMETERS: usize = 4;
/// Places that are tried: cells of a grid, which goes beyond the stops by a share of their diagonal, and the strongest stops.
const CELLS: f64 = 20.0;
const MARGIN: f64 = 0.25;
const STRONGEST: usize = 20;
/// No node is nearer to a stop (m, and in steps of the grid).
const LEAST_M: f64 = 0.3;
const NEAREST: f64 = 0.35;
/// Places beside a stop are tried in so many directions, each circle so much wider than the last, to so many steps of the grid.
const DIRECTIONS: u8 = 8;
const WIDER: f64 = 1.6;
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
    let least_evidence = libm::log(log.receptions().len() as f64 / FALSE_ALARMS);
    let mut gross = Vec::new();
    while levels.len() >= LEAST && gross.len() < most {
        let Some((number, above_db)) = worst(&levels, least_evidence) else { break };
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

/// The strength that contradicts the others most, if one does by this evidence (nats), and by how much (dB).
fn worst(levels: &[Level], least_evidence: f64) -> Option<(usize, f64)> {
    let suspects = suspects(levels);
    if suspects.is_empty() {
        return None;
    }
    let (vertices, step_m) = vertices(levels);
    let regression = Regression::of(levels, LEAST_M.min(NEAREST * step_m));
    let fits: Vec<Vec<Alone>> = vertices.iter().map(|&vertex| regression.at(vertex, &suspects)).collect();
    let judged = suspects.iter().enumerate().filter_map(|(column, &number)| {
        let of_grid = fits.iter().map(|fit| fit[column]);
        // A node beside a stop may be far stronger there than anywhere else.
        let beside = regression.beside(number, NEAR * step_m);
        let Suspicion { evidence, above_db } =
            Suspicion::of(&of_grid.chain(beside).collect::<Vec<_>>(), levels.len())?;
        let far_db = if above_db > 0.0 { ABOVE_DB } else { BELOW_DB };
        (above_db.abs() > far_db && evidence > least_evidence).then_some((number, above_db, evidence))
    });
    judged.max_by(|a, b| a.2.total_cmp(&b.2)).map(|(number, above_db, _)| (number, above_db))
}

/// What speaks against a strength.
struct Suspicion {
    /// By how much the strengths are more probable if this one is wrong (nats), from the best place with it and without it.
    evidence: f64,
    /// How much it is above what the others say at the likely place that explains it best (dB).
    above_db: f64,
}

impl Suspicion {
    /// The ratio of likelihoods of a strength that is shifted (Cook and Weisberg 1982, section 2.2), with the variance integrated
    /// out under what is known of it. As its place is free both times, a place that is uncertain accuses no strength.
    fn of(fits: &[Alone], levels: usize) -> Option<Self> {
        let least = |of: fn(&Alone) -> f64| fits.iter().map(of).fold(f64::INFINITY, f64::min);
        let (all, without) = (least(|fit| fit.all), least(|fit| fit.without));
        let freedom = (levels - 1 - PARAMETERS) as f64;
        let likely = without * (1.0 + LIKELY / freedom);
        let above_db = fits.iter().filter(|fit| fit.without <= likely).map(|fit| fit.above_db);
        let above_db = above_db.min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        let known = without + AS_MANY * USUAL_DB * USUAL_DB;
        let evidence = 0.5 * (freedom + AS_MANY) * libm::log1p((all - without).max(0.0) / known);
        without.is_finite().then_some(Self { evidence, above_db })
    }
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

/// The regression of strengths on the logarithms of their distances from a place. Squares of errors (dB²) are infinite where
/// strengths rise with the distance.
struct Regression<'a> {
    levels: &'a [Level],
    mean_dbm: f64,
    least_m: f64,
}

/// The regression from one place, of all strengths and without one.
#[derive(Clone, Copy)]
struct Alone {
    /// Squares of all.
    all: f64,
    /// Squares of the others.
    without: f64,
    /// How much the one is above them (dB).
    above_db: f64,
}

impl<'a> Regression<'a> {
    fn of(levels: &'a [Level], least_m: f64) -> Self {
        let mean_dbm = levels.iter().map(|level| level.dbm).sum::<f64>() / levels.len() as f64;
        Self { levels, mean_dbm, least_m }
    }

    /// From `vertex`, without each suspect in turn.
    fn at(&self, vertex: Position, suspects: &[usize]) -> Vec<Alone> {
        let mut logs: Vec<f64> =
            self.levels.iter().map(|level| level.place.distance_m(vertex).max(self.least_m)).collect();
        ln_each(&mut logs);
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        logs.iter_mut().for_each(|log| *log -= mean);
        let over = |number: usize| self.levels[number].dbm - self.mean_dbm;
        let squares = logs.iter().map(|log| log * log).sum::<f64>().max(1e-12);
        let slope = logs.iter().enumerate().map(|(number, log)| log * over(number)).sum::<f64>() / squares;
        let error = |number: usize| over(number) - slope * logs[number];
        let sum: f64 = (0..logs.len()).map(|number| error(number) * error(number)).sum();
        let all = if slope < 0.0 { sum } else { f64::INFINITY };
        let without = |&number: &usize| {
            // What a strength draws to itself (leverage), and the fit without it.
            let log = logs[number];
            let left = (1.0 - 1.0 / count - log * log / squares).max(1e-9);
            let above_db = error(number) / left;
            let falls = slope - log * above_db / squares < 0.0;
            let others = if falls { (sum - error(number) * above_db).max(1e-9) } else { f64::INFINITY };
            Alone { all, without: others, above_db }
        };
        suspects.iter().map(without).collect()
    }

    /// From places around the stop of one strength, up to `most_m` from it, without this strength.
    fn beside(&self, number: usize, most_m: f64) -> impl Iterator<Item = Alone> + '_ {
        let stop = self.levels[number].place;
        let radii = std::iter::successors(Some(self.least_m), |radius_m| Some(WIDER * radius_m));
        let place = move |radius_m: f64, direction: u8| {
            let (sine, cosine) = libm::sincos(f64::from(direction) * std::f64::consts::TAU / f64::from(DIRECTIONS));
            stop + Position::new(cosine, sine, 0.0) * radius_m
        };
        let circles = radii.take_while(move |radius_m| *radius_m <= most_m);
        let places = circles.flat_map(move |radius_m| (0..DIRECTIONS).map(move |at| place(radius_m, at)));
        places.flat_map(move |vertex| self.at(vertex, &[number]))
    }
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
    #[test]
    fn the_nearest_stop_of_a_wide_grid_is_not_wrong_where_its_node_may_be_beside_it() {
        // Of thousands of nodes with exponent 3 and shadowing of 6 and 4 dB, stops 15 m apart: those whose strongest stop, 1.4 and 4.7 m
        // away, is farthest above what the others say alone. Places (m) and strengths (dBm).
        let near = [
            (110, 5, -79.8),
            (125, 5, -83.1),
            (125, 20, -83.1),
            (125, 35, -81.2),
            (140, 5, -88.0),
            (140, 20, -87.0),
            (140, 35, -86.0),
            (155, 5, -54.6),
            (155, 20, -79.6),
            (155, 35, -80.4),
            (155, 50, -85.7),
        ];
        let farther = [
            (5, 95, -87.0),
            (5, 110, -83.0),
            (5, 125, -84.0),
            (20, 80, -88.0),
            (20, 95, -86.0),
            (20, 110, -84.0),
            (20, 125, -84.0),
            (20, 140, -86.0),
            (35, 95, -85.0),
            (35, 110, -65.0),
            (35, 125, -73.0),
            (35, 140, -75.0),
            (50, 95, -89.0),
            (50, 110, -84.0),
            (50, 125, -78.0),
            (50, 140, -84.0),
            (65, 95, -88.0),
            (65, 125, -89.0),
        ];
        let log = |rows: &[(i32, i32, f64)]| {
            let stop = |&(x, y, _): &(i32, i32, f64)| Stop::at(Position::new(x.into(), y.into(), 0.0));
            let row = |(number, &(.., dbm)): (u32, &(i32, i32, f64))| Reception {
                rssi_dbm: Some(dbm),
                ..Reception::heard(NodeId(0), number, 10, 10)
            };
            let receptions = (0..).zip(rows).map(row).collect();
            ReceptionLog::new(vec!["n".into()], rows.iter().map(stop).collect(), receptions, Vec::new()).unwrap()
        };
        assert_eq!(gross_strengths(&log(&near)), []);
        assert_eq!(gross_strengths(&log(&farther)), []);
        // A digit that is lost at the edge of where the node is heard is found still.
        let mut wrong = farther;
        wrong[16].2 = -8.8;
        assert!(matches!(gross_strengths(&log(&wrong))[..], [GrossStrength { stop: 16, .. }]));
    }
}
