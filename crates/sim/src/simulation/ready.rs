//! Simulations that are ready to run, whatever their stations do.

use std::time::Duration;

use sextant_kernel::{SettingError, SimTime};

use super::{Applications, Simulation, Team};
use crate::application::{Application, BoxedApplication};
use crate::observer::{Observer, RememberingObserver};
use crate::outcome::Survey;
use crate::region::SimulatedRegion;
use crate::setup::Setup;
use crate::snapshot::{Reached, Snapshot};

/// A simulation that runs once, to its end, and leaves a [`Survey`] and an `R` behind. It does not say of what type its
/// applications are: its engine is compiled in the crate that knows them, and not once more in each crate that runs it.
pub struct ReadySimulation<'a, R = ()>(Box<dyn Steps<R> + 'a>);

/// A simulation that leaves an `R` behind, whatever its type.
trait Steps<R> {
    fn until(&mut self, time: SimTime, observer: &mut dyn Observer);
    fn reached(&self) -> Reached;
    fn snapshot(&self) -> Snapshot;
    fn run(self: Box<Self>, observer: &mut dyn Observer) -> (Survey, R);
}

/// A simulation, and what becomes of what is left of its own applications.
struct Recorded<N: Application, F> {
    simulation: Simulation<N>,
    record: F,
}

/// A team, until somebody wants to see it on the way: from then on it is one simulation.
enum TeamOrOne {
    Team(Box<Team>),
    One(Box<Simulation>),
}

/// What a simulation leaves out.
#[derive(Clone, Copy, Debug, Default)]
pub struct LeftOut {
    /// The start that is not counted.
    pub warm_up: Duration,
    /// The part of the nodes' traffic that is simulated.
    pub region: SimulatedRegion,
}

impl<R> ReadySimulation<'_, R> {
    /// Runs it until `time`: what happens at that instant is still to come. It ends before if the tasks of all robots and nodes
    /// are done, nothing is left to happen, or the observer ends it. Nothing happens if it has ended, or `time` is over. All
    /// steps have the same observer, and they change nothing in the result.
    pub fn until(&mut self, time: SimTime, observer: &mut dyn Observer) {
        self.0.until(time, observer);
    }

    /// How far it has gone.
    #[must_use]
    pub fn reached(&self) -> Reached {
        self.0.reached()
    }

    /// What it is like now.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.0.snapshot()
    }

    /// Runs it until the tasks of all robots and nodes are done, or the time is over, or the observer ends the simulation.
    pub fn run(self, observer: &mut dyn Observer) -> (Survey, R) {
        self.0.run(observer)
    }
}

impl<N: Application, R, F: FnOnce(&Survey, Applications<N>) -> R> Steps<R> for Recorded<N, F> {
    fn until(&mut self, time: SimTime, observer: &mut dyn Observer) {
        self.simulation.until(time, observer);
    }

    fn reached(&self) -> Reached {
        self.simulation.engine.reached()
    }

    fn snapshot(&self) -> Snapshot {
        self.simulation.engine.snapshot()
    }

    fn run(self: Box<Self>, observer: &mut dyn Observer) -> (Survey, R) {
        let (survey, own) = self.simulation.run_own(observer);
        let record = (self.record)(&survey, own);
        (survey, record)
    }
}

impl Steps<()> for TeamOrOne {
    fn until(&mut self, time: SimTime, observer: &mut dyn Observer) {
        match self {
            Self::Team(team) => {
                let mut one = Box::new(team.as_one());
                one.until(time, observer);
                *self = Self::One(one);
            }
            Self::One(one) => one.until(time, observer),
        }
    }

    fn reached(&self) -> Reached {
        match self {
            Self::Team(_) => Reached { time: SimTime::ZERO, has_ended: false },
            Self::One(one) => one.engine.reached(),
        }
    }

    fn snapshot(&self) -> Snapshot {
        match self {
            Self::Team(team) => team.as_one().engine.snapshot(),
            Self::One(one) => one.engine.snapshot(),
        }
    }

    fn run(self: Box<Self>, observer: &mut dyn Observer) -> (Survey, ()) {
        let survey = match *self {
            Self::Team(team) => team.run(observer),
            Self::One(one) => one.run_own(observer).0,
        };
        (survey, ())
    }
}

impl<N: Application> Simulation<N> {
    /// The same, ready to run, without its type. What is left of the own applications goes through `record`.
    pub fn ready<'a, R>(self, record: impl FnOnce(Applications<N>) -> R + 'a) -> ReadySimulation<'a, R>
    where
        N: 'a,
    {
        self.ready_with_survey(|_, own| record(own))
    }

    /// The same; `record` sees also what the simulation found.
    pub fn ready_with_survey<'a, R>(
        self,
        record: impl FnOnce(&Survey, Applications<N>) -> R + 'a,
    ) -> ReadySimulation<'a, R>
    where
        N: 'a,
    {
        ReadySimulation(Box::new(Recorded { simulation: self, record }))
    }

    fn until(&mut self, time: SimTime, observer: &mut dyn Observer) {
        self.engine.advance(time, &mut RememberingObserver::new(observer));
    }

    /// The same without what is left out.
    ///
    /// # Errors
    /// Those of [`Simulation::with_region`].
    pub fn without(self, left_out: LeftOut) -> Result<Self, SettingError> {
        self.with_warm_up(left_out.warm_up).with_region(left_out.region)
    }
}

impl ReadySimulation<'static> {
    /// A simulation whose nodes send the traffic of their networks.
    ///
    /// # Errors
    /// Those of [`Simulation::new`] and [`Simulation::with_region`].
    pub fn of_traffic(setup: Setup, left_out: LeftOut) -> Result<Self, SettingError> {
        Ok(Simulation::new(setup)?.without(left_out)?.ready(drop))
    }
}

impl<'a> ReadySimulation<'a> {
    /// A simulation in which some stations have applications of the caller's own: see [`Simulation::mixed`].
    ///
    /// # Errors
    /// Those of [`Simulation::mixed`] and [`Simulation::with_region`].
    ///
    /// # Panics
    /// If a list is not as long as there are stations.
    pub fn mixed(
        setup: Setup,
        own: Applications<Option<BoxedApplication<'a>>>,
        left_out: LeftOut,
    ) -> Result<Self, SettingError> {
        Ok(Simulation::mixed(setup, own)?.without(left_out)?.ready(drop))
    }
}

impl From<Team> for ReadySimulation<'static> {
    fn from(team: Team) -> Self {
        Self(Box::new(TeamOrOne::Team(Box::new(team))))
    }
}
