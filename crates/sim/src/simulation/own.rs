//! Simulations whose nodes, robots and sinks all have applications of their own.

use sextant_kernel::SettingError;

use super::setup::Setup;
use super::{Simulation, refuse_traffic};
use crate::application::Application;
use crate::applications::robot::{Robot, RobotTask};
use crate::engine::refuse_beacons;
use crate::observer::Observer;
use crate::outcome::Survey;

/// The own applications of stations, each list in the order of its stations.
#[derive(Clone, Debug)]
pub struct OwnApplications<N> {
    /// Of the nodes.
    pub nodes: Vec<N>,
    /// Of the robots.
    pub robots: Vec<N>,
    /// Of the sinks.
    pub sinks: Vec<N>,
}

impl<N: Application> Simulation<N> {
    /// A simulation, ready to run, whose nodes, robots and sinks have these applications. They send what they want, so
    /// there is no other traffic. The application of a robot replaces whatever its [`RobotTask`] is.
    ///
    /// # Errors
    /// If the traffic of a node is not silent, or a network has superframes: robots and sinks could not send in it.
    ///
    /// # Panics
    /// If there is not one application for each station.
    pub fn with_own(setup: Setup, own: OwnApplications<N>) -> Result<Self, SettingError> {
        let counts = [setup.world.nodes.len(), setup.robots.len(), setup.sinks.len()];
        let found = [own.nodes.len(), own.robots.len(), own.sinks.len()];
        assert_eq!(found, counts, "one application for each node, robot and sink");
        refuse_beacons(setup.networks.iter().map(|network| &network.link))?;
        let robots = setup.robots.into_iter().map(|robot| Robot { task: RobotTask::Own, ..robot }).collect();
        let nodes = counts[0];
        Self::with_applications(Setup { robots, ..setup }, own.robots, own.sinks, |_, networks| {
            networks.iter().try_for_each(|network| refuse_traffic(network, nodes))?;
            Ok(own.nodes)
        })
    }

    /// Runs until all tasks are done, or the time is over, or the observer ends the simulation. Returns also what is left
    /// of the own applications.
    pub fn run_own(self, observer: &mut impl Observer) -> (Survey, OwnApplications<N>) {
        self.run_told(observer)
    }
}
