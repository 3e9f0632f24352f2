//! The simulation of a scenario.

use sextant_apps::distributed::{MappingNode, MappingRecord};
use sextant_apps::routing::RoutingRecord;
use sextant_kernel::SimTime;
use sextant_scenario::Scenario;
use sextant_sim::{LeftOut, Observer, Reached, ReadySimulation, Snapshot, Survey, Team};

use super::error::RunError;
use super::programs::{ProgrammedRobots, Programs};

/// The simulation of a scenario, ready to run.
pub struct Simulator<'a> {
    stations: Stations<'a>,
    programmed: ProgrammedRobots,
}

/// The simulation, by what its stations leave behind.
enum Stations<'a> {
    /// Nothing besides what robots heard.
    Plain(ReadySimulation<'a>),
    /// A record each: the nodes compute a map themselves.
    OfNodes(ReadySimulation<'static, Vec<MappingRecord>>),
    /// A record of all: packets go over several hops.
    Routed(ReadySimulation<'static, RoutingRecord>),
}

/// What a simulation leaves behind.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// What robots heard, and what became of the packets.
    pub survey: Survey,
    /// What each node found, if the nodes computed a map themselves; otherwise empty.
    pub nodes: Vec<MappingRecord>,
    /// What became of packets that go over several hops, if they do.
    pub routing: Option<RoutingRecord>,
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
        let left_out = LeftOut { warm_up: scenario.warm_up(), region: scenario.region() };
        let stations = match (applications, scenario.distributed(), scenario.routing()) {
            (Some(applications), ..) => Stations::Plain(ReadySimulation::mixed(setup, applications, left_out)?),
            (None, Some(map), _) => {
                let nodes = map.nodes(setup.world.nodes.len(), scenario.anchors());
                Stations::OfNodes(MappingNode::simulation(setup, nodes, left_out)?)
            }
            (None, None, Some(routing)) => Stations::Routed(routing.simulation(setup, left_out)?),
            (None, None, None) => {
                let may_be_parallel = may_be_copied && left_out.warm_up.is_zero();
                let team = may_be_parallel.then(|| Team::of(&setup, left_out.region)).transpose()?.flatten();
                Stations::Plain(match team {
                    Some(team) => team.into(),
                    None => ReadySimulation::of_traffic(setup, left_out)?,
                })
            }
        };
        Ok(Self { stations, programmed })
    }

    /// Runs it until `time`: see [`SteppedRun::until`](super::SteppedRun::until). All steps have the same observer.
    pub(super) fn until(&mut self, time: SimTime, observer: &mut impl Observer) {
        match &mut self.stations {
            Stations::Plain(simulation) => simulation.until(time, observer),
            Stations::OfNodes(simulation) => simulation.until(time, observer),
            Stations::Routed(simulation) => simulation.until(time, observer),
        }
    }

    /// How far it has gone.
    pub(super) fn reached(&self) -> Reached {
        match &self.stations {
            Stations::Plain(simulation) => simulation.reached(),
            Stations::OfNodes(simulation) => simulation.reached(),
            Stations::Routed(simulation) => simulation.reached(),
        }
    }

    /// What it is like now.
    pub(super) fn snapshot(&self) -> Snapshot {
        match &self.stations {
            Stations::Plain(simulation) => simulation.snapshot(),
            Stations::OfNodes(simulation) => simulation.snapshot(),
            Stations::Routed(simulation) => simulation.snapshot(),
        }
    }

    /// Runs it to its end, or until `observer` ends it.
    #[must_use]
    pub fn run(self, observer: &mut impl Observer) -> Simulated {
        let (survey, nodes, routing) = match self.stations {
            Stations::Plain(simulation) => (simulation.run(observer).0, Vec::new(), None),
            Stations::OfNodes(simulation) => {
                let (survey, nodes) = simulation.run(observer);
                (survey, nodes, None)
            }
            Stations::Routed(simulation) => {
                let (survey, routing) = simulation.run(observer);
                (survey, Vec::new(), Some(routing))
            }
        };
        Simulated { survey, nodes, routing, programmed: self.programmed }
    }
}
