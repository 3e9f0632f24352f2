//! Everything that a simulation needs.

use std::time::Duration;

use sextant_kernel::{NodeId, Seed};

use crate::applications::robot::Robot;
use crate::applications::traffic::TrafficPlan;
use crate::engine::NetworkSetup;
use crate::faults::Faults;
use crate::service::network_id::NetworkId;
use crate::station::Sink;
use crate::world::World;

/// A network and the traffic in it.
#[derive(Clone)]
pub struct BusyNetwork {
    /// Its name, if the scenario has several.
    pub name: Option<String>,
    /// The network.
    pub link: NetworkSetup,
    /// Traffic of the nodes.
    pub traffic: TrafficPlan,
    /// Whether each node is in the network; `None` if all nodes are.
    pub nodes: Option<Vec<bool>>,
}

impl BusyNetwork {
    /// Whether a node is in the network.
    #[must_use]
    pub fn has(&self, node: NodeId) -> bool {
        self.nodes.as_ref().is_none_or(|nodes| nodes[node.index()])
    }
}

/// Everything that a simulation needs.
#[derive(Clone)]
pub struct Setup {
    /// The world.
    pub world: World,
    /// The networks: at least one.
    pub networks: Vec<BusyNetwork>,
    /// The robots.
    pub robots: Vec<Robot>,
    /// The fixed sinks.
    pub sinks: Vec<Sink>,
    /// When the simulation ends; `None` if when the last robot has finished.
    pub duration: Option<Duration>,
    /// What goes wrong.
    pub faults: Faults,
    /// The seed of all randomness.
    pub seed: Seed,
}

impl Setup {
    /// The networks that robots survey, in their order; the first network if no robot surveys.
    #[must_use]
    pub fn surveyed(&self) -> Vec<NetworkId> {
        let mut surveyed: Vec<NetworkId> = (self.robots.iter().filter(|robot| robot.is_surveying()))
            .flat_map(|robot| robot.body.networks.iter().copied())
            .collect();
        surveyed.sort_unstable();
        surveyed.dedup();
        if surveyed.is_empty() {
            surveyed.push(NetworkId::default());
        }
        surveyed
    }

    /// The first network: the only one, unless the scenario names several.
    ///
    /// # Panics
    /// If there is no network.
    #[must_use]
    pub fn network(&self) -> &BusyNetwork {
        self.networks.first().expect("a setup has a network")
    }
}
