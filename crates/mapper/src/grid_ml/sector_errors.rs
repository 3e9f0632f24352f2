//! The error of the strengths by which nodes name sectors, estimated from a log.

use rayon::prelude::*;
use sextant_channel::ReceptionLog;

use crate::grid_ml::solver::{Moments, Solver};
use crate::lattice::Lattice;
use crate::log_facts::reach::{HeardNode, heard_nodes};

/// Standard deviations that are tried (dB).
const TRIED_DB: [f64; 6] = [0.5, 1.0, 2.0, 3.0, 5.0, 8.0];
/// Number of nodes from which the error is estimated.
const NODES: usize = 48;

/// It is estimated from every how many of `heard` nodes that were heard.
pub(crate) fn every(heard: usize) -> usize {
    heard.div_ceil(NODES).max(1)
}

/// The standard deviation under which `log` is the likeliest, over all places of some of its nodes (dB), of a few
/// values; between the best and its neighbours by a parabola. `solver` makes the solver for a value.
pub(crate) fn likeliest_sigma_db<'a>(
    lattice: &Lattice,
    log: &ReceptionLog,
    solver: impl Fn(f64) -> Solver<'a>,
) -> f64 {
    let heard = heard_nodes(log);
    let sample: Vec<&HeardNode> = heard.iter().step_by(every(heard.len())).collect();
    let evidence = |sigma_db: f64| -> f64 {
        let solver = solver(sigma_db);
        let of_node = |scratch: &mut _, heard: &&HeardNode| {
            let mut moments = Moments::new(lattice);
            solver.search(scratch, log.of(heard.node), Moments::NEGLIGIBLE, &mut moments);
            moments.ln_sum()
        };
        let all: Vec<f64> = sample.par_iter().map_init(|| solver.scratch(), of_node).collect();
        all.into_iter().filter(|evidence| evidence.is_finite()).sum()
    };
    let found = TRIED_DB.map(|sigma_db| [libm::log(sigma_db), evidence(sigma_db)]);
    let mut best = 0;
    for at in 1..found.len() {
        best = if found[at][1] > found[best][1] { at } else { best };
    }
    if best == 0 || best + 1 == found.len() {
        return TRIED_DB[best];
    }
    // The vertex of the parabola through three points.
    let [[x0, y0], [x1, y1], [x2, y2]] = [found[best - 1], found[best], found[best + 1]];
    let (left, right) = ((x1 - x0) * (y1 - y2), (x1 - x2) * (y1 - y0));
    let below = left - right;
    let top = if below.abs() > 0.0 { x1 - 0.5 * ((x1 - x0) * left - (x1 - x2) * right) / below } else { x1 };
    libm::exp(top.clamp(x0, x2))
}
