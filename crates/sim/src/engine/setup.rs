//! Everything that an engine needs beside the applications.

use std::time::Duration;

use sextant_channel::ChannelLaw;
use sextant_kernel::Seed;
use sextant_mac::RadioStates;

use crate::faults::Faults;
use crate::link::Technology;
use crate::station::{RobotBody, Sink};
use crate::world::World;

/// A network: its radios, and how its stations share the channel.
#[derive(Clone)]
pub struct NetworkSetup {
    /// The law of the radio channel.
    pub channel: ChannelLaw,
    /// The technology of its links, with the settings of radios and channel access.
    pub technology: Technology,
    /// Energy model of the radios.
    pub radio_states: RadioStates,
    /// Whether each station is in the network; `None` if all are.
    pub members: Option<Vec<bool>>,
}

/// The world, its stations and their networks.
#[derive(Clone)]
pub struct EngineSetup {
    /// The world.
    pub world: World,
    /// The bodies of the robots.
    pub robots: Vec<RobotBody>,
    /// The sinks.
    pub sinks: Vec<Sink>,
    /// The networks.
    pub networks: Vec<NetworkSetup>,
    /// When the simulation ends; `None` if when the tasks of all applications are done.
    pub duration: Option<Duration>,
    /// What goes wrong.
    pub faults: Faults,
    /// The seed of all randomness.
    pub seed: Seed,
}
