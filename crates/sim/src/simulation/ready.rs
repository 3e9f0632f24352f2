//! Simulations that are ready to run, whatever their stations do.

use std::time::Duration;

use sextant_kernel::SettingError;

use super::{Applications, Simulation, Team};
use crate::application::{Application, BoxedApplication};
use crate::observer::Observer;
use crate::outcome::Survey;
use crate::region::SimulatedRegion;
use crate::setup::Setup;

/// A simulation that runs once, to its end, and leaves a [`Survey`] and an `R` behind. It does not say of what type its
/// applications are: its engine is compiled in the crate that knows them, and not once more in each crate that runs it.
pub struct ReadySimulation<'a, R = ()>(Box<Run<'a, R>>);

/// Runs a simulation.
type Run<'a, R> = dyn FnOnce(&mut dyn Observer) -> (Survey, R) + 'a;

/// What a simulation leaves out.
#[derive(Clone, Copy, Debug, Default)]
pub struct LeftOut {
    /// The start that is not counted.
    pub warm_up: Duration,
    /// The part of the nodes' traffic that is simulated.
    pub region: SimulatedRegion,
}

impl<'a, R: 'a> ReadySimulation<'a, R> {
    /// The same; what it leaves behind goes through `act` at the end.
    pub fn then<S>(self, act: impl FnOnce(R) -> S + 'a) -> ReadySimulation<'a, S> {
        ReadySimulation(Box::new(move |observer| {
            let (survey, left) = self.run(observer);
            (survey, act(left))
        }))
    }

    /// Runs it until the tasks of all robots and nodes are done, or the time is over, or the observer ends it.
    pub fn run(self, observer: &mut dyn Observer) -> (Survey, R) {
        self.0(observer)
    }
}

impl<N: Application> Simulation<N> {
    /// The same, ready to run, without its type. What is left of the own applications goes through `record`.
    pub fn ready<'a, R>(self, record: impl FnOnce(Applications<N>) -> R + 'a) -> ReadySimulation<'a, R>
    where
        N: 'a,
    {
        ReadySimulation(Box::new(move |observer| {
            let (survey, own) = self.run_told(observer);
            (survey, record(own))
        }))
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
        Self(Box::new(|observer| (team.run(observer), ())))
    }
}
