//! How much work a search takes, for people who wait for it.

use rayon::prelude::*;
use sextant_channel::{ReceptionLog, Receptions};
use sextant_kernel::NodeId;

use super::Solver;

/// Nodes that a thread looks at in one piece, at least.
const PIECE: usize = 64;

impl Solver<'_> {
    /// Evaluations of the profile that the search for the nodes of `log` takes, at most: vertices within range of all
    /// stops that heard a node (of any, if there are none) times stops in range of one of these.
    pub(crate) fn operations(&self, log: &ReceptionLog) -> f64 {
        let of_node = |node| self.operations_of(log.of(NodeId::from_index(node)));
        let operations: Vec<f64> = (0..log.node_count()).into_par_iter().with_min_len(PIECE).map(of_node).collect();
        operations.into_iter().sum()
    }

    fn operations_of(&self, receptions: Receptions<'_>) -> f64 {
        let Some([first, last]) = self.corners(receptions) else { return 0.0 };
        let range_m = self.curve.range_m;
        let is_feasible = (0..3).all(|axis| last[axis] - first[axis] < 2.0 * range_m);
        let (low, high) = if is_feasible { (last, first) } else { (first, last) };
        let (low, high) = (low.map(|value| value - range_m), high.map(|value| value + range_m));
        let spans = [0, 1, 2].map(|axis| self.lattice.span(axis, low[axis], high[axis]).0.len());
        let stops = self.cells.count_near_box(low.map(|x| x - range_m), high.map(|x| x + range_m));
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = spans.iter().product::<usize>() as f64 * stops as f64;
        operations
    }

    /// Corners of the box that holds the stops that heard a node (m); `None` if none did.
    fn corners(&self, receptions: Receptions<'_>) -> Option<[[f64; 3]; 2]> {
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let mut include = |stop: u32| {
            for (axis, value) in <[f64; 3]>::from(self.places[stop as usize]).into_iter().enumerate() {
                corners[0][axis] = if value < corners[0][axis] { value } else { corners[0][axis] };
                corners[1][axis] = if value > corners[1][axis] { value } else { corners[1][axis] };
            }
        };
        match receptions.packets() {
            None => receptions.stops().iter().for_each(|&stop| include(stop)),
            Some(packets) => {
                let heard = receptions.stops().iter().zip(packets).filter(|&(_, (received, _))| received > 0);
                heard.for_each(|(&stop, _)| include(stop));
            }
        }
        (corners[0][0] <= corners[1][0]).then_some(corners)
    }
}
