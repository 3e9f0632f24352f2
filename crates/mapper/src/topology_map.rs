//! The result of a mapping algorithm.

use sextant_channel::Position;

/// Where the nodes are, as far as an algorithm can tell from a reception log.
#[derive(Clone, Debug, PartialEq)]
pub struct TopologyMap {
    /// The algorithm's name: `ml-tm`.
    pub algorithm: &'static str,
    /// One entry a node of the log; `None` for a node that was never heard, which is not placed.
    pub estimates: Vec<Option<Estimate>>,
    /// Distance of neighbouring grid vertices, if the algorithm has a grid [m].
    pub grid_step_m: Option<f64>,
    /// Grid vertices whose likelihood was computed, summed over the nodes; 0 without a grid.
    pub vertices_evaluated: u64,
}

/// Where one node is.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The place [m].
    pub position: Position,
    /// Natural logarithm of the highest likelihood on the grid.
    pub log_likelihood: f64,
    /// Number of vertices with the highest likelihood (within 10⁻⁹ in its logarithm); 1 if it is unique.
    pub ties: u32,
    /// Posterior covariance of x, y, z [m²]: present for a posterior mean.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Whether no vertex explains all that was heard, so that outliers had to be admitted.
    pub infeasible: bool,
}

impl TopologyMap {
    /// Places of the nodes [m], `None` where a node is not mapped.
    #[must_use]
    pub fn positions(&self) -> Vec<Option<Position>> {
        self.estimates.iter().map(|estimate| estimate.as_ref().map(|e| e.position)).collect()
    }

    /// Number of nodes on the map.
    #[must_use]
    pub fn mapped(&self) -> usize {
        self.estimates.iter().flatten().count()
    }

    /// Number of nodes of the log that are not on the map.
    #[must_use]
    pub fn unmapped(&self) -> usize {
        self.estimates.len() - self.mapped()
    }

    /// Number of nodes for which no vertex explains all that was heard.
    #[must_use]
    pub fn infeasible(&self) -> usize {
        self.estimates.iter().flatten().filter(|estimate| estimate.infeasible).count()
    }
}
