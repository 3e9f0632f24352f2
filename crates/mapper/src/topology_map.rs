//! The result of a mapping algorithm.

use sextant_channel::Position;
use sextant_kernel::NodeId;

use crate::log_facts::SoughtHeights;
use crate::metrics::{Reflection, Similarity};
use crate::posterior::{Concern, Estimate};

/// The places of the nodes that an algorithm estimated from a reception log.
#[derive(Clone, Debug, PartialEq)]
pub struct TopologyMap {
    /// The algorithm's name: `ml-tm`.
    pub algorithm: &'static str,
    /// One entry a node of the log; `None` for a node that was never heard, which is not placed.
    pub estimates: Vec<Option<Estimate>>,
    /// Distance of neighbouring grid vertices, if the algorithm has a grid (m).
    pub grid_step_m: Option<f64>,
    /// Grid vertices whose likelihood was computed, summed over the nodes; 0 without a grid.
    pub vertices_evaluated: u64,
    /// At which heights nodes were sought; `None` for an algorithm that searches no heights.
    pub heights: Option<SoughtHeights>,
    /// What the places are relative to.
    pub frame: CoordinateFrame,
}

/// What the places of a map are relative to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum CoordinateFrame {
    /// The world, as robot or anchors know it.
    #[default]
    World,
    /// The world: the map was made without anchors and aligned to them afterwards.
    AlignedToAnchors,
    /// Nothing: each part of the map is known up to rotation, reflection and scale. Holds the part that each node
    /// belongs to.
    Relative(Vec<u32>),
}

impl TopologyMap {
    /// Stores the estimates of all nodes, and adds up the numbers of vertices evaluated for them.
    pub(crate) fn take_in(&mut self, solved: Vec<(Option<Estimate>, u64)>) {
        for (slot, (estimate, evaluated)) in self.estimates.iter_mut().zip(solved) {
            *slot = estimate;
            self.vertices_evaluated += evaluated;
        }
    }

    /// The map of an algorithm that gives only places.
    #[must_use]
    pub fn of_places(algorithm: &'static str, places: Vec<Option<Position>>, frame: CoordinateFrame) -> Self {
        let estimates = places.into_iter().map(|place| place.map(Estimate::of_place)).collect();
        Self { algorithm, estimates, grid_step_m: None, vertices_evaluated: 0, heights: None, frame }
    }

    /// Aligns each part of a relative map to the world, by the similarity that fits the `known` places of nodes best;
    /// mirror images are allowed. Nodes are removed from the map if their part has fewer than `least` known places,
    /// or if these do not determine a similarity. A map in the world is not changed.
    #[must_use]
    pub fn aligned_to(mut self, known: &[(NodeId, Position)], least: usize) -> Self {
        let CoordinateFrame::Relative(part_of) = std::mem::take(&mut self.frame) else { return self };
        let parts = part_of.iter().max().map_or(0, |&last| last + 1);
        for part in 0..parts {
            let pairs: Vec<(Position, Position)> = known
                .iter()
                .filter(|(node, _)| part_of[node.index()] == part)
                .filter_map(|&(node, place)| Some((self.estimates[node.index()].as_ref()?.position, place)))
                .collect();
            let fit = if pairs.len() < least { None } else { Similarity::fit(&pairs, Reflection::Allowed).ok() };
            for (estimate, _) in self.estimates.iter_mut().zip(&part_of).filter(|&(_, &of)| of == part) {
                *estimate = estimate.take().and_then(|estimate| {
                    let position = fit.as_ref()?.apply(estimate.position);
                    Some(Estimate { position, covariance: None, ..estimate })
                });
            }
        }
        self
    }

    /// Number of nodes whose place is exactly that of another node, because the algorithm cannot tell them apart.
    #[must_use]
    pub fn coincident(&self) -> usize {
        let bits = |place: Position| <[f64; 3]>::from(place).map(f64::to_bits);
        let mut places: Vec<_> = self.positions().into_iter().flatten().map(bits).collect();
        places.sort_unstable();
        places.chunk_by(|a, b| a == b).map(<[_]>::len).filter(|&count| count > 1).sum()
    }

    /// Places of the nodes (m), `None` where a node is not mapped.
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

    /// The nodes whose place is not reliable, by number.
    pub fn concerns(&self) -> impl Iterator<Item = (NodeId, Concern)> {
        let concern = |(node, estimate): (usize, &Option<Estimate>)| {
            Some((NodeId::from_index(node), estimate.as_ref()?.concern?))
        };
        self.estimates.iter().enumerate().filter_map(concern)
    }

    /// Number of nodes for which no vertex explains all that was heard.
    #[must_use]
    pub fn infeasible(&self) -> usize {
        self.estimates.iter().flatten().filter(|estimate| estimate.infeasible).count()
    }
}
