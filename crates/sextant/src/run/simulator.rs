//! The simulation of a scenario.

use sextant_apps::distributed::{MappingNode, MappingRecord};
use sextant_kernel::SettingError;
use sextant_sim::{Applications, Observer, Simulation, Survey, Team};

use crate::scenario::Scenario;

/// The simulation of a scenario, ready to run.
pub enum Simulator {
    /// The nodes send the traffic of their networks.
    OfTraffic(Box<Simulation>),
    /// The same, with robots that may be simulated in parallel.
    OfTeam(Box<Team>),
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
            None => {
                if scenario.warm_up().is_zero()
                    && let Some(team) = Team::of(&setup, scenario.region())?
                {
                    return Ok(Self::OfTeam(Box::new(team)));
                }
                let simulation = Simulation::new(setup)?.with_warm_up(scenario.warm_up());
                Self::OfTraffic(Box::new(simulation.with_region(scenario.region())?))
            }
            Some(map) => {
                let nodes = map.nodes(setup.world.nodes.len(), scenario.anchors());
                let simulation = Simulation::with(setup, Applications::of_nodes(nodes))?;
                let simulation = simulation.with_warm_up(scenario.warm_up());
                Self::OfNodes(Box::new(simulation.with_region(scenario.region())?))
            }
        })
    }

    /// Runs it to its end, or until `observer` ends it.
    #[must_use]
    pub fn run(self, observer: &mut impl Observer) -> Simulated {
        match self {
            Self::OfTraffic(simulation) => Simulated { survey: simulation.run(observer), nodes: Vec::new() },
            Self::OfTeam(team) => Simulated { survey: team.run(observer), nodes: Vec::new() },
            Self::OfNodes(simulation) => {
                let (survey, Applications { nodes, .. }) = simulation.run_own(observer);
                Simulated { survey, nodes: nodes.into_iter().map(MappingNode::into_record).collect() }
            }
        }
    }
}
