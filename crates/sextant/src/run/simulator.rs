//! The simulation of a scenario.

use sextant_apps::distributed::{MappingNode, MappingRecord};
use sextant_kernel::SettingError;
use sextant_sim::{Applications, Observer, Simulation, Survey};

use crate::scenario::Scenario;

/// The simulation of a scenario, ready to run.
pub enum Simulator {
    /// The nodes send the traffic of their networks.
    OfTraffic(Box<Simulation>),
    /// The nodes compute a map themselves.
    OfNodes(Box<Simulation<MappingNode>>),
}

/// What a simulation leaves behind.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// What robots heard, and what became of the packets.
    pub survey: Survey,
    /// What each node found, if the nodes computed a map themselves; otherwise empty.
    pub nodes: Vec<MappingRecord>,
}

impl Simulator {
    /// The simulation of `scenario`.
    ///
    /// # Errors
    /// If parts of the scenario do not fit together.
    pub fn new(scenario: &Scenario) -> Result<Self, SettingError> {
        let setup = scenario.setup();
        Ok(match scenario.distributed() {
            None => Self::OfTraffic(Box::new(Simulation::new(setup)?.with_warm_up(scenario.warm_up()))),
            Some(map) => {
                let nodes = map.nodes(setup.world.nodes.len(), scenario.anchors());
                let simulation = Simulation::with(setup, Applications::of_nodes(nodes))?;
                Self::OfNodes(Box::new(simulation.with_warm_up(scenario.warm_up())))
            }
        })
    }

    /// Runs it to its end, or until `observer` ends it.
    #[must_use]
    pub fn run(self, observer: &mut impl Observer) -> Simulated {
        match self {
            Self::OfTraffic(simulation) => Simulated { survey: simulation.run(observer), nodes: Vec::new() },
            Self::OfNodes(simulation) => {
                let (survey, Applications { nodes, .. }) = simulation.run_own(observer);
                Simulated { survey, nodes: nodes.into_iter().map(MappingNode::into_record).collect() }
            }
        }
    }
}
