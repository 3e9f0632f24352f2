//! Simulations in which some stations have applications of the caller's own, and the others do what the setup says.

use sextant_kernel::{NodeId, SettingError};

use super::{Applications, Simulation, surveyed, traffic};
use crate::application::BoxedApplication;
use crate::applications::robot::RobotTask;
use crate::applications::standard::Receiver;
use crate::setup::Setup;

impl<'a> Simulation<BoxedApplication<'a>> {
    /// A simulation, ready to run, in which those stations have own applications for which `own` has one: it lists all nodes,
    /// all robots and all sinks. The other nodes send the traffic of their networks, the other robots keep their tasks, and the
    /// other sinks only receive. A node with an own application sends what that says and no other traffic. A robot with one
    /// may survey all the same, with [`Port::log_stop`](crate::Port::log_stop), in each network that robots of `setup` survey.
    ///
    /// # Errors
    /// As for [`Simulation::new`], and if a network has superframes, in which an own application of a robot or a sink could not
    /// send.
    ///
    /// # Panics
    /// If a list is not as long as there are stations.
    pub fn mixed(mut setup: Setup, own: Applications<Option<BoxedApplication<'a>>>) -> Result<Self, SettingError> {
        let listed = [own.nodes.len(), own.robots.len(), own.sinks.len()];
        let stations = [setup.world.nodes.len(), setup.robots.len(), setup.sinks.len()];
        assert_eq!(listed, stations, "one entry for each node, robot and sink");
        let surveyed = surveyed(&setup);
        let traffic = traffic::of_nodes(&setup, |node: NodeId| own.nodes[node.index()].is_none())?;
        let nodes = (own.nodes.into_iter().zip(traffic))
            .map(|(own, traffic)| own.unwrap_or_else(|| Box::new(traffic)))
            .collect();
        let mut robots = Vec::new();
        for (robot, own) in setup.robots.iter_mut().zip(own.robots) {
            if let Some(own) = own {
                robot.task = RobotTask::Own;
                robots.push(own);
            }
        }
        let sinks = if own.sinks.iter().all(Option::is_none) { Vec::new() } else { own.sinks };
        let sinks = sinks.into_iter().map(|own| own.unwrap_or_else(|| Box::new(Receiver))).collect();
        let all = Applications { nodes, robots, sinks };
        all.check_superframes(&setup)?;
        Ok(Self { surveyed, ..Self::with_all(setup, all, None)? })
    }
}
