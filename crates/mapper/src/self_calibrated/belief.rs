//! The current estimate of the place of one node.

use sextant_channel::Position;
use sextant_kernel::NodeId;

use crate::posterior::{Cell, Concern};

/// The current estimate of the place of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaceBelief {
    pub(super) node: NodeId,
    /// Posterior mean (m).
    pub(super) mean: Position,
    /// Log-likelihood of the likeliest vertex.
    pub(super) highest: f64,
    /// Covariance of the vertices (m²).
    pub(super) covariance: [[f64; 3]; 3],
    /// What a vertex stands for.
    pub(super) cell: Cell,
    /// What the bounds of the node say of the posterior.
    pub(super) concern: Option<Concern>,
    /// Whether the window does not hold the posterior: there is probability at its edge, but within the bounds.
    pub(super) is_cramped: bool,
    /// How far the mean moved in the last round (m).
    pub(super) shift_m: f64,
}

impl PlaceBelief {
    /// Standard deviation along an axis (m).
    pub(super) fn spread_m(&self, axis: usize) -> f64 {
        self.covariance[axis][axis].max(0.0).sqrt()
    }
}
