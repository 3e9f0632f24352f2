//! Everything that a simulation needs.

use std::time::Duration;

use sextant_kernel::Seed;

use crate::applications::survey::Robot;
use crate::applications::traffic::Traffic;
use crate::engine::NetworkSetup;
use crate::station::Sink;
use crate::world::World;

/// A network and the traffic in it.
#[derive(Clone)]
pub struct BusyNetwork {
    /// The network.
    pub link: NetworkSetup,
    /// Traffic of the nodes.
    pub traffic: Traffic,
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
    /// The seed of all randomness.
    pub seed: Seed,
}

impl Setup {
    /// The first network: robots survey its nodes.
    ///
    /// # Panics
    /// If there is no network.
    #[must_use]
    pub fn network(&self) -> &BusyNetwork {
        self.networks.first().expect("a setup has a network")
    }
}
