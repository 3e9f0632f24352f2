//! What needs all nodes of a setup, whatever part is asked for.

use crate::applications::traffic::Traffic;
use crate::halo::AllSimulated;
use crate::region::{MANY_NODES, SimulatedRegion};
use crate::setup::Setup;

impl Setup {
    /// Why all nodes have to be simulated, if the networks and stations are a reason.
    #[must_use]
    pub fn needs_all(&self) -> Option<AllSimulated> {
        let traffic = || self.networks.iter().flat_map(|network| network.traffic.kinds());
        if self.networks.iter().any(|network| network.technology.has_coordinator()) {
            Some(AllSimulated::Superframes)
        } else if traffic().any(|kind| !kind.may_rest()) {
            Some(AllSimulated::Saturated)
        } else if !self.sinks.is_empty() {
            Some(AllSimulated::Sinks)
        } else if traffic().any(Traffic::is_acknowledged) {
            Some(AllSimulated::Acknowledged)
        } else if self.batteries.is_some() {
            Some(AllSimulated::Batteries)
        } else {
            traffic().all(Traffic::is_silent).then_some(AllSimulated::OnlyAnswers)
        }
    }
}

impl SimulatedRegion {
    /// Whether so few nodes are all simulated.
    #[must_use]
    pub fn is_all_of(self, nodes: usize) -> bool {
        self == Self::NearListenersIfMany && nodes < MANY_NODES
    }
}
