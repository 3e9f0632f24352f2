//! Controllers and applications of the caller's own, in place of those of a scenario.

use std::collections::{BTreeMap, BTreeSet};

use sextant_kernel::text::{listed, shortened};
use sextant_sim::{Applications, BoxedApplication, Controller, RobotTask, RoleConfig, Setup};

use sextant_scenario::Scenario;

/// What the caller gives to stations in place of what the scenario says: by default nothing. A program that is given to a
/// station twice replaces the first one.
///
/// A program draws random numbers at addresses of its own, or from a generator of its own that begins with
/// [`program_seed`](sextant_sim::program_seed): then the same programs give the same run. An application that fails cannot
/// say so to the simulation. It keeps its error, does nothing any more, and stops the [`Watch`](sextant_kernel::Watch) of the
/// run. The simulation ends after the stop under way, or after at most a thousand events, and recordings are finished.
#[derive(Default)]
pub struct Programs<'a> {
    controllers: BTreeMap<String, Box<dyn Controller>>,
    nodes: BTreeMap<String, BoxedApplication<'a>>,
    robots: BTreeMap<String, BoxedApplication<'a>>,
    sinks: BTreeMap<String, BoxedApplication<'a>>,
}

/// Robots with programs of the caller's own, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProgrammedRobots {
    /// Those that an own controller drives.
    pub controllers: BTreeSet<String>,
    /// Those with an own application.
    pub applications: BTreeSet<String>,
}

/// Why a program cannot be given to a station.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProgramError {
    /// No station has this name.
    #[error("a program is given to the {kind} `{}`, which is not in the scenario; {}", shortened(.name), known_names(kind, known))]
    UnknownStation {
        /// `node`, `robot` or `sink`.
        kind: &'static str,
        /// The name that was found.
        name: String,
        /// The names of the stations of this kind.
        known: Vec<String>,
    },
    /// A robot does not survey.
    #[error(
        "a program is given to the robot `{robot}` with the role `{role}`; allowed: a robot with the role `survey`"
    )]
    Role {
        /// The robot.
        robot: String,
        /// Its role.
        role: &'static str,
    },
    /// A robot has two programs.
    #[error("the robot `{robot}` is given a controller and an application; give it one of them")]
    Two {
        /// The robot.
        robot: String,
    },
    /// The nodes have an application of the scenario.
    #[error(
        "an application is given to the {kind} `{name}`, but the nodes compute a map; \
         remove the application or `[distributed_mapping]`"
    )]
    Distributed {
        /// `node`, `robot` or `sink`.
        kind: &'static str,
        /// The name of the station.
        name: String,
    },
    /// The nodes route packets.
    #[error(
        "an application is given to the {kind} `{name}`, but the stations route packets; \
         remove the application or `[routing]`"
    )]
    Routed {
        /// `node`, `robot` or `sink`.
        kind: &'static str,
        /// The name of the station.
        name: String,
    },
    /// The stations do nothing before the applications of the scenario.
    #[error(
        "programs are given, but the scenario has no survey in which they run; \
         add a robot with the role `survey`, or `duration_s`"
    )]
    NoSurvey,
}

fn known_names(kind: &str, known: &[String]) -> String {
    if known.is_empty() {
        return format!("it has no {kind}");
    }
    let known: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    format!("its {kind}s: {}", listed(&known))
}

impl<'a> Programs<'a> {
    /// The same, where `controller` drives the robot with this name. The robot surveys, as the scenario says. The controller is
    /// not copied: it decides for one robot, from the start of the run to its end.
    #[must_use]
    pub fn with_controller(mut self, robot: &str, controller: Box<dyn Controller>) -> Self {
        self.controllers.insert(robot.to_owned(), controller);
        self
    }

    /// The same, where the node with this name has `application`, and not the traffic of its networks.
    #[must_use]
    pub fn with_node(mut self, node: &str, application: BoxedApplication<'a>) -> Self {
        self.nodes.insert(node.to_owned(), application);
        self
    }

    /// The same, where the robot with this name has `application`, and not the survey of the scenario. Its own stops, of
    /// [`Port::log_stop`](sextant_sim::Port::log_stop), are those that are mapped.
    #[must_use]
    pub fn with_robot(mut self, robot: &str, application: BoxedApplication<'a>) -> Self {
        self.robots.insert(robot.to_owned(), application);
        self
    }

    /// The same, where the sink with this name has `application`. It receives as before.
    #[must_use]
    pub fn with_sink(mut self, sink: &str, application: BoxedApplication<'a>) -> Self {
        self.sinks.insert(sink.to_owned(), application);
        self
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.controllers.is_empty() && !self.has_applications()
    }

    fn has_applications(&self) -> bool {
        !(self.nodes.is_empty() && self.robots.is_empty() && self.sinks.is_empty())
    }

    /// The robots with programs.
    pub(super) fn programmed(&self) -> ProgrammedRobots {
        ProgrammedRobots {
            controllers: self.controllers.keys().cloned().collect(),
            applications: self.robots.keys().cloned().collect(),
        }
    }

    /// Gives the controllers to the robots of `setup`, which is that of `scenario`. Returns the applications of all stations;
    /// `None` if no station has one.
    pub(super) fn place(
        self,
        scenario: &Scenario,
        setup: &mut Setup,
    ) -> Result<Option<Applications<Option<BoxedApplication<'a>>>>, ProgramError> {
        self.check(scenario)?;
        let has_applications = self.has_applications();
        let Self { controllers, nodes, robots, sinks } = self;
        let names: Vec<String> = setup.robots.iter().map(|robot| robot.body.name.clone()).collect();
        for (robot, controller) in setup.robots.iter_mut().zip(by_station("robot", controllers, &names)?) {
            if let Some(controller) = controller {
                robot.task = RobotTask::Survey(controller);
            }
        }
        let node_names: Vec<String> = setup.world.nodes.iter().map(|node| node.name.clone()).collect();
        let sink_names: Vec<String> = setup.sinks.iter().map(|sink| sink.name.clone()).collect();
        let applications = Applications {
            nodes: by_station("node", nodes, &node_names)?,
            robots: by_station("robot", robots, &names)?,
            sinks: by_station("sink", sinks, &sink_names)?,
        };
        Ok(has_applications.then_some(applications))
    }

    /// Refuses programs that do not fit the scenario; unknown names of robots are found here, because there may be robots that
    /// do not take part.
    fn check(&self, scenario: &Scenario) -> Result<(), ProgramError> {
        let robots = &scenario.config().robots;
        for name in self.controllers.keys().chain(self.robots.keys()) {
            let robot = robots.iter().find(|robot| robot.name == *name);
            let role = match robot.map(|robot| &robot.role) {
                None => {
                    let known = robots.iter().map(|robot| robot.name.clone()).collect();
                    return Err(ProgramError::UnknownStation { kind: "robot", name: name.clone(), known });
                }
                Some(RoleConfig::Survey) => continue,
                Some(RoleConfig::Anchor) => "anchor",
                Some(RoleConfig::Agent) => "agent",
            };
            return Err(ProgramError::Role { robot: name.clone(), role });
        }
        if let Some(robot) = self.controllers.keys().find(|robot| self.robots.contains_key(*robot)) {
            return Err(ProgramError::Two { robot: robot.clone() });
        }
        let kinds = [("node", &self.nodes), ("robot", &self.robots), ("sink", &self.sinks)];
        let first = kinds.into_iter().find_map(|(kind, given)| Some((kind, given.keys().next()?)));
        if let (Some(_), Some((kind, name))) = (scenario.distributed(), first) {
            return Err(ProgramError::Distributed { kind, name: name.clone() });
        }
        if let (Some(_), Some((kind, name))) = (scenario.routing(), first) {
            return Err(ProgramError::Routed { kind, name: name.clone() });
        }
        if !self.is_empty() && !scenario.config().has_traffic() && scenario.distributed().is_none() {
            return Err(ProgramError::NoSurvey);
        }
        Ok(())
    }
}

/// What was given to each of the stations with these names.
fn by_station<T>(
    kind: &'static str,
    given: BTreeMap<String, T>,
    names: &[String],
) -> Result<Vec<Option<T>>, ProgramError> {
    let numbers: BTreeMap<&str, usize> = (names.iter().enumerate()).map(|(i, name)| (&**name, i)).collect();
    let mut all: Vec<Option<T>> = names.iter().map(|_| None).collect();
    for (name, program) in given {
        let Some(&number) = numbers.get(&*name) else {
            return Err(ProgramError::UnknownStation { kind, name, known: names.to_vec() });
        };
        all[number] = Some(program);
    }
    Ok(all)
}
