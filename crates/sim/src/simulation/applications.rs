//! The applications that a caller gives to stations.

use sextant_kernel::{NodeId, SettingError};

use crate::applications::robot::RobotTask;
use crate::setup::Setup;

/// The applications that a caller gives to stations, each list in the order of its stations.
#[derive(Clone, Debug)]
pub struct Applications<N> {
    /// Of the nodes.
    pub nodes: Vec<N>,
    /// Of the robots that have one.
    pub robots: Vec<N>,
    /// Of the sinks; none if they only receive.
    pub sinks: Vec<N>,
}

impl<N> Applications<N> {
    /// Applications of the nodes alone.
    #[must_use]
    pub fn of_nodes(nodes: Vec<N>) -> Self {
        Self { nodes, robots: Vec::new(), sinks: Vec::new() }
    }

    /// What `of` makes of each.
    pub fn each<R>(self, of: impl FnMut(N) -> R + Copy) -> Applications<R> {
        let all = |stations: Vec<N>| stations.into_iter().map(of).collect();
        Applications { nodes: all(self.nodes), robots: all(self.robots), sinks: all(self.sinks) }
    }

    /// Refuses what nodes with such applications, and robots and sinks if they have them, cannot do.
    ///
    /// # Panics
    /// If there is not one application for each of these stations.
    pub(super) fn check(&self, setup: &Setup) -> Result<(), SettingError> {
        assert_eq!(self.nodes.len(), setup.world.nodes.len(), "one application for each node");
        let robots = setup.robots.iter().filter(|robot| matches!(robot.task, RobotTask::Own)).count();
        assert!(
            self.robots.is_empty() || self.robots.len() == robots,
            "one application for each robot that waits for one"
        );
        assert!(self.sinks.is_empty() || self.sinks.len() == setup.sinks.len(), "one application for each sink");
        self.check_superframes(setup)?;
        for network in &setup.networks {
            let members = (0..self.nodes.len()).map(NodeId::from_index).filter(|&node| network.has(node));
            let mut traffic = members.filter_map(|node| network.traffic.of(node));
            if let Some(traffic) = traffic.find(|traffic| !traffic.is_silent()) {
                let allowed = "`silent = {}`: nodes with given applications send what these say";
                return Err(SettingError::new(network.key("traffic"), format!("`{}`", traffic.key()), allowed));
            }
        }
        Ok(())
    }

    /// Refuses superframes among robots and sinks with applications.
    pub(super) fn check_superframes(&self, setup: &Setup) -> Result<(), SettingError> {
        let sends = !(self.robots.is_empty() && self.sinks.is_empty());
        if sends && setup.networks.iter().any(|network| network.technology.has_coordinator()) {
            let found = "set for robots or sinks with own applications, none of which sends beacons";
            return Err(SettingError::new("mac.beacon_enabled", found, "`mac.csma_unslotted`"));
        }
        Ok(())
    }
}
