//! Everything that a simulation needs.

use std::time::Duration;

use sextant_kernel::Seed;

use crate::applications::robot::Robot;
use crate::batteries::Batteries;
use crate::faults::Faults;
use crate::network::Network;
use crate::service::network_id::NetworkId;
use crate::station::{Roll, Sink};
use crate::world::World;

/// Everything that a simulation needs: the world, its stations and their networks.
#[derive(Clone)]
pub struct Setup {
    /// The world.
    pub world: World,
    /// The networks: at least one.
    pub networks: Vec<Network>,
    /// The robots.
    pub robots: Vec<Robot>,
    /// The fixed sinks.
    pub sinks: Vec<Sink>,
    /// When the simulation ends; `None` if when the tasks of all applications are done.
    pub duration: Option<Duration>,
    /// What goes wrong.
    pub faults: Faults,
    /// The batteries of the nodes; `None` if these never run empty.
    pub batteries: Option<Batteries>,
    /// The seed of all randomness.
    pub seed: Seed,
}

impl Setup {
    /// Nodes of `world` in one network, without robots and sinks, until nothing is left to happen.
    #[must_use]
    pub fn of(world: World, network: Network, seed: Seed) -> Self {
        Self {
            world,
            networks: vec![network],
            robots: Vec::new(),
            sinks: Vec::new(),
            duration: None,
            faults: Faults::default(),
            batteries: None,
            seed,
        }
    }

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
    pub fn network(&self) -> &Network {
        self.networks.first().expect("a setup has a network")
    }

    /// How many stations of each kind there are.
    pub(crate) fn roll(&self) -> Roll {
        Roll { nodes: self.world.nodes.len(), robots: self.robots.len(), sinks: self.sinks.len() }
    }

    /// Whether each station is in the network `id`; `None` if all are.
    pub(crate) fn members(&self, id: NetworkId) -> Option<Vec<bool>> {
        let network = &self.networks[id.index()];
        let robots = self.robots.iter().map(|robot| robot.body.networks.contains(&id));
        let is_all = network.members.is_none()
            && robots.clone().all(|is_in| is_in)
            && self.sinks.iter().all(|sink| sink.networks.is_none());
        if is_all {
            return None;
        }
        let nodes = network.members.clone().unwrap_or_else(|| vec![true; self.world.nodes.len()]);
        let sinks = self.sinks.iter().map(|sink| sink.is_in(id));
        Some(nodes.into_iter().chain(robots).chain(sinks).collect())
    }
}
