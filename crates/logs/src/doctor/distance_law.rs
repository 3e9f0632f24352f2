//! Whether distances explain the strengths of a log: quick and rough, for checks.
//!
//! A law of distances with shared shadowing is compared with shadowing alone, each with the shadowing that suits it best
//! (empirical Bayes over a small table). What counts is what they say of a quarter of the stops of a node after the other
//! three: the evidence of all minus that of the others.

use rayon::prelude::*;
use sextant_channel::ReceptionLog;
use sextant_kernel::NodeId;

use super::evidence::{NodeField, Shadowing};
use super::lattice::Lattice;
use super::node_strengths::{NodeStrengths, floors};

/// Nodes and floors with fewer stops say nothing; of more stops and nodes so many are used.
const LEAST_STOPS: usize = 12;
const MOST_STOPS: usize = 60;
const MOST_NODES: usize = 24;
/// Shadowing that is tried: what stops share and what each has alone (dB), and the range as a share of the extent.
const SHARED_DB: [f64; 5] = [1.5, 3.0, 5.0, 8.0, 12.0];
const ALONE_DB: [f64; 3] = [1.0, 2.0, 4.0];
const RANGES: [f64; 3] = [0.03, 0.1, 0.3];
/// So many have one range.
const OF_RANGE: usize = SHARED_DB.len() * ALONE_DB.len();

/// What the strengths of a log say of distances.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DistanceLaw {
    /// Shadowing about the law.
    pub(super) shadowing: Shadowing,
    /// How much better it predicts stops that are left out than shadowing alone does (nats a link), and the standard error.
    pub(super) gain: f64,
    pub(super) gain_error: f64,
    /// Where nodes may be, in all of the survey.
    pub(super) lattice: Lattice,
}

/// The stops of a node by quarter of the area in which it was heard.
struct Quarters {
    field: NodeField,
    of_stop: Vec<usize>,
}

impl DistanceLaw {
    /// What `log` says; `None` if it has too few strengths, or all its stops are at one place.
    pub(super) fn of(log: &ReceptionLog) -> Option<Self> {
        let lattice = Lattice::around(log.stops().iter().map(|stop| stop.position))?;
        let floors = floors(log);
        let heard = |node| NodeStrengths::of(log, NodeId::from_index(node), &floors, [LEAST_STOPS, MOST_STOPS]);
        let all: Vec<NodeStrengths> = (0..log.node_count()).flat_map(heard).collect();
        let every = all.len().div_ceil(MOST_NODES).max(1);
        let nodes: Vec<Quarters> = all.iter().step_by(every).map(|heard| Quarters::new(heard, &lattice)).collect();
        if nodes.is_empty() {
            return None;
        }
        let tried = tried(median(nodes.iter().map(|node| node.field.lattice.extent_m).collect()));
        let evidence: Vec<Vec<[f64; 2]>> = nodes.par_iter().map(|node| node.evidence(&tried)).collect();
        let best = |of: usize| {
            let total = |at: usize| evidence.iter().map(|node| node[at][of]).sum::<f64>();
            (0..tried.len()).max_by(|&a, &b| total(a).total_cmp(&total(b))).map(|at| tried[at])
        };
        let (shadowing, alone) = (best(0)?, best(1)?);
        let gains: Vec<Vec<(f64, f64)>> = nodes.par_iter().map(|node| node.gains(shadowing, alone)).collect();
        let gains: Vec<(f64, f64)> = gains.into_iter().flatten().collect();
        let links: f64 = gains.iter().map(|(_, links)| links).sum();
        let gain = gains.iter().map(|(gain, _)| gain).sum::<f64>() / links;
        let spread: f64 = gains.iter().map(|(of_block, links)| (of_block - gain * links).powi(2)).sum();
        let law = Self { shadowing, gain, gain_error: spread.sqrt() / links, lattice };
        (law.gain.is_finite() && gains.len() > 1).then_some(law)
    }
}

/// The median of values, of which there is one at least: the upper one of two in the middle.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    crate::median::median(&mut values).expect("there is one at least")
}

/// All shadowings that are tried where nodes are heard over this extent (m), those of each range together.
fn tried(extent_m: f64) -> Vec<Shadowing> {
    let with = |share: f64, shared_db: f64| {
        ALONE_DB.map(|alone_db| Shadowing { shared_db, range_m: share * extent_m, alone_db })
    };
    RANGES.iter().flat_map(|&share| SHARED_DB.iter().flat_map(move |&shared_db| with(share, shared_db))).collect()
}

impl Quarters {
    fn new(heard: &NodeStrengths, lattice: &Lattice) -> Self {
        let (x, y) = (|stop: usize| heard.places[stop].x_m, |stop: usize| heard.places[stop].y_m);
        let middle = [median((0..heard.len()).map(x).collect()), median((0..heard.len()).map(y).collect())];
        let quarter = |stop: usize| 2 * usize::from(x(stop) >= middle[0]) + usize::from(y(stop) >= middle[1]);
        Self { field: NodeField::new(heard, lattice), of_stop: (0..heard.len()).map(quarter).collect() }
    }

    /// The evidence of all stops with a law and without one, for each shadowing that is tried.
    fn evidence(&self, tried: &[Shadowing]) -> Vec<[f64; 2]> {
        let of_range = |tried: &[Shadowing]| {
            let field = self.field.of_range(tried[0].range_m);
            let of = |one: &Shadowing| field.evidence(one.shared_db, one.alone_db).unwrap_or([f64::NEG_INFINITY; 2]);
            tried.iter().map(of).collect::<Vec<_>>()
        };
        tried.chunks(OF_RANGE).flat_map(of_range).collect()
    }

    fn law(&self, rows: &[usize], shadowing: Shadowing) -> f64 {
        let field = self.field.at(rows, self.field.covariance(rows, shadowing));
        field.map_or(f64::NEG_INFINITY, |field| field.of_first(rows.len()).one_place())
    }

    fn alone(&self, rows: &[usize], shadowing: Shadowing) -> f64 {
        self.field.without_law(rows, self.field.covariance(rows, shadowing)).unwrap_or(f64::NEG_INFINITY)
    }

    /// By how much a law with its `shadowing` predicts each quarter better than shadowing `alone`, and the stops there.
    fn gains(&self, shadowing: Shadowing, alone: Shadowing) -> Vec<(f64, f64)> {
        let all: Vec<usize> = (0..self.field.len()).collect();
        let of_all = self.law(&all, shadowing) - self.alone(&all, alone);
        let gain = |quarter: usize| {
            let others: Vec<usize> = all.iter().copied().filter(|&stop| self.of_stop[stop] != quarter).collect();
            let left_out = all.len() - others.len();
            let is_told = left_out > 0 && others.len() >= LEAST_STOPS / 3;
            is_told.then(|| (of_all - self.law(&others, shadowing) + self.alone(&others, alone), left_out as f64))
        };
        (0..4).filter_map(gain).collect()
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, Reception};

    use super::*;
    use crate::doctor::tests::{changed, draw, log_of, node};

    #[test]
    fn a_law_explains_strengths_in_a_field_much_larger_than_its_ranges_too() {
        // Nodes are heard over about 16 m; the field is 320 m wide.
        let place = |i: u32| Position::new(5.0 * f64::from(i % 64), 5.0 * f64::from(i / 64), 0.0);
        let places: Vec<Position> = (0..64 * 39).map(place).collect();
        let log = log_of(&places, |number, _| node(number) * 16.0);
        // Strengths that differ from the law by 2 dB, at each stop by itself.
        let level = |row: Reception| {
            let far_m = (node(row.node.0) * 16.0).distance_m(places[row.stop as usize]).max(0.3);
            -45.0 - 25.0 * libm::log10(far_m) + 2.0 * draw(9, [row.node.0.into(), row.stop.into()])
        };
        let lawful = |row: Reception| Reception { rssi_dbm: row.rssi_dbm.map(|_| level(row)), ..row };
        let law = DistanceLaw::of(&changed(&log, |stop| stop, lawful)).unwrap();
        assert!(law.gain > 0.1 && law.gain > 3.0 * law.gain_error, "{} ± {}", law.gain, law.gain_error);
    }
}
