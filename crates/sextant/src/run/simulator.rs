//! The simulation of a scenario.

use sextant_apps::distributed::{MappingNode, MappingRecord};
use sextant_kernel::SettingError;
use sextant_scenario::Scenario;
use sextant_sim::{Application, Applications, BoxedApplication, Observer, Simulation, Survey, Team};

use super::error::RunError;
use super::programs::{ProgrammedRobots, Programs};

/// The simulation of a scenario, ready to run.
pub struct Simulator<'a> {
    stations: Stations<'a>,
    programmed: ProgrammedRobots,
}

/// The simulation, by what its stations do: what is usual is compiled for itself.
enum Stations<'a> {
    /// The nodes send the traffic of their networks.
    OfTraffic(Box<Simulation>),
    /// The same, with robots that may be simulated in parallel.
    OfTeam(Box<Team>),
    /// The nodes compute a map themselves.
    OfNodes(Box<Simulation<MappingNode>>),
    /// Some stations have applications of the caller's own.
    Mixed(Box<Simulation<BoxedApplication<'a>>>),
}

/// What a simulation leaves behind.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// What robots heard, and what became of the packets.
    pub survey: Survey,
    /// What each node found, if the nodes computed a map themselves; otherwise empty.
    pub nodes: Vec<MappingRecord>,
    /// The robots with programs of the caller's own.
    pub programmed: ProgrammedRobots,
}

impl<'a> Simulator<'a> {
    /// The simulation of `scenario`.
    ///
    /// # Errors
    /// If parts of the scenario do not fit together.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        Self::with(scenario, Programs::default())
    }

    /// The same with programs of the caller's own.
    ///
    /// # Errors
    /// If parts of the scenario do not fit together, or a program cannot be given to its station.
    pub fn with(scenario: &Scenario, programs: Programs<'a>) -> Result<Self, RunError> {
        let mut setup = scenario.setup();
        let programmed = programs.programmed();
        // A team copies its controllers, and simulates some more than once. Those of the caller's own decide once.
        let may_be_copied = programs.is_empty();
        let applications = programs.place(scenario, &mut setup)?;
        let stations = match (applications, scenario.distributed()) {
            (Some(applications), _) => Stations::Mixed(ready(scenario, Simulation::mixed(setup, applications)?)?),
            (None, Some(map)) => {
                let nodes = map.nodes(setup.world.nodes.len(), scenario.anchors());
                Stations::OfNodes(ready(scenario, Simulation::with(setup, Applications::of_nodes(nodes))?)?)
            }
            (None, None) => {
                let may_be_parallel = may_be_copied && scenario.warm_up().is_zero();
                let team = may_be_parallel.then(|| Team::of(&setup, scenario.region())).transpose()?.flatten();
                match team {
                    Some(team) => Stations::OfTeam(Box::new(team)),
                    None => Stations::OfTraffic(ready(scenario, Simulation::new(setup)?)?),
                }
            }
        };
        Ok(Self { stations, programmed })
    }

    /// Runs it to its end, or until `observer` ends it.
    #[must_use]
    pub fn run(self, observer: &mut impl Observer) -> Simulated {
        let (survey, nodes) = match self.stations {
            Stations::OfTraffic(simulation) => (simulation.run(observer), Vec::new()),
            Stations::OfTeam(team) => (team.run(observer), Vec::new()),
            Stations::Mixed(simulation) => (simulation.run(observer), Vec::new()),
            Stations::OfNodes(simulation) => {
                let (survey, Applications { nodes, .. }) = simulation.run_own(observer);
                (survey, nodes.into_iter().map(MappingNode::into_record).collect())
            }
        };
        Simulated { survey, nodes, programmed: self.programmed }
    }
}

/// The same with the warm-up and the region of `scenario`.
fn ready<N: Application>(scenario: &Scenario, simulation: Simulation<N>) -> Result<Box<Simulation<N>>, SettingError> {
    simulation.with_warm_up(scenario.warm_up()).with_region(scenario.region()).map(Box::new)
}
