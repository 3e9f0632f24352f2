//! The likelihood of one node over the grid.

use sextant_channel::Position;

use crate::lattice::Lattice;

/// Log-likelihood of one node on the part of the grid where it may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The window: the smallest box of vertices that holds the search set.
    pub lattice: Lattice,
    /// Natural logarithm of the likelihood at each vertex of the window, x running fastest;
    /// minus infinity outside the search set and where the likelihood is zero.
    pub log_likelihood: Vec<f64>,
    /// Whether no vertex explains all receptions, so that some were treated as outliers.
    pub infeasible: bool,
}

impl Surface {
    /// The surface over the smallest window that holds `vertices`, linear indices of `lattice` with their
    /// log-likelihoods; `None` if there are none.
    pub(crate) fn of_vertices(lattice: &Lattice, vertices: &[(u64, f64)], infeasible: bool) -> Option<Self> {
        let mut low = [usize::MAX; 3];
        let mut high = [0; 3];
        for &(index, _) in vertices {
            let vertex = lattice.vertex(index);
            for axis in 0..3 {
                low[axis] = low[axis].min(vertex[axis]);
                high[axis] = high[axis].max(vertex[axis]);
            }
        }
        if vertices.is_empty() {
            return None;
        }
        let window = lattice.window(low, high);
        let [nx, ny, nz] = window.counts();
        let mut log_likelihood = vec![f64::NEG_INFINITY; nx * ny * nz];
        for &(index, value) in vertices {
            let [x, y, z] = lattice.vertex(index);
            log_likelihood[((z - low[2]) * ny + y - low[1]) * nx + x - low[0]] = value;
        }
        Some(Self { lattice: window, log_likelihood, infeasible })
    }

    /// The vertex of highest likelihood (the first of equals) and its log-likelihood.
    #[must_use]
    pub fn maximum(&self) -> (Position, f64) {
        let mut best = (0, f64::NEG_INFINITY);
        for (index, &value) in self.log_likelihood.iter().enumerate() {
            if value > best.1 {
                best = (index, value);
            }
        }
        (self.lattice.position(self.lattice.vertex(best.0 as u64)), best.1)
    }
}
