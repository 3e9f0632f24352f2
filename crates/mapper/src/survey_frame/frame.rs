//! The change from the frame of a survey to that of its log.

use sextant_channel::Position;
use sextant_kernel::NodeId;

use super::axes::SurveyAxes;
use crate::posterior::Estimate;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The frame of a survey: its axes, and which stop and node of the log each of its stops and nodes is.
#[derive(Clone, Debug)]
pub struct SurveyFrame {
    pub(super) axes: SurveyAxes,
    /// The number in the log of each stop.
    pub(super) stops: Vec<u32>,
    /// The number in the log of each node.
    pub(super) nodes: Vec<NodeId>,
    /// Number of stops in the log.
    pub(super) log_stops: usize,
}

impl SurveyFrame {
    /// A place in the frame of the log (m).
    #[must_use]
    pub fn place(&self, in_survey: Position) -> Position {
        self.axes.back(in_survey)
    }

    /// A place of the log in this frame (m).
    #[must_use]
    pub(crate) fn in_survey(&self, place: Position) -> Position {
        self.axes.place(place)
    }

    /// The number in the log of a node.
    ///
    /// # Panics
    /// If the survey does not have the node.
    #[must_use]
    pub fn node(&self, node: NodeId) -> NodeId {
        self.nodes[node.index()]
    }

    /// The number in the log of a stop.
    ///
    /// # Panics
    /// If the survey does not have the stop.
    #[must_use]
    pub fn stop(&self, stop: u32) -> u32 {
        self.stops[stop as usize]
    }

    /// Number of stops in the log.
    #[must_use]
    pub(crate) fn stops_in_log(&self) -> usize {
        self.log_stops
    }

    /// `map` of a survey in the frame of its log, which has `count` nodes; the nodes of the map are `nodes` there.
    pub(crate) fn map_in_log(&self, map: TopologyMap, nodes: &[usize], count: usize) -> TopologyMap {
        let is_in_world = map.frame == CoordinateFrame::World;
        let mut estimates = vec![None; count];
        for (&node, estimate) in nodes.iter().zip(map.estimates) {
            estimates[node] = estimate.map(|estimate| if is_in_world { self.estimate(estimate) } else { estimate });
        }
        TopologyMap { estimates, ..map }
    }

    fn estimate(&self, estimate: Estimate) -> Estimate {
        Estimate {
            position: self.place(estimate.position),
            covariance: estimate.covariance.map(|covariance| self.axes.covariance_back(covariance)),
            ..estimate
        }
    }
}
