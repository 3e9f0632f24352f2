//! Missions: what robots and nodes do together on a map of the nodes. Each is a folder of its own, with a file
//! `mission.rs` that says what this port asks, and a line in [`AlgorithmConfig`](crate::AlgorithmConfig).

mod goal;
mod link_record;
mod outcome;
mod place;
mod team;

use std::fmt;
use std::sync::Arc;

use sextant_kernel::SettingError;
use sextant_sim::{ReadySimulation, Setup};

use crate::navigation::NavigationMap;

pub use goal::{MissionGoal, SoughtField};
pub use link_record::LinkRecord;
pub use outcome::{MissionArrival, MissionOutcome};
pub use place::{MissionLinks, MissionMedium, MissionPlace, MissionRobots};
pub use team::MissionTeam;

/// The settings of a mission, as written in a scenario.
pub trait MissionSettings {
    /// The key of its algorithm in a scenario.
    fn key(&self) -> &'static str;

    /// Its name in tables.
    fn name(&self) -> &'static str;

    /// Over which links it works: those that carry messages, unless a mission says otherwise.
    fn links(&self) -> MissionLinks {
        MissionLinks::Messages
    }

    /// Refuses a world that has nothing for the mission, or no node that could sense it.
    ///
    /// # Errors
    /// `algorithm`, with what the world lacks.
    fn check_world(&self, place: &MissionPlace<'_>) -> Result<(), SettingError>;

    /// Refuses robots that could not do it; all can, unless a mission says otherwise.
    ///
    /// # Errors
    /// `robots`, with the robot and what it lacks.
    fn check_robots(&self, _: &MissionRobots<'_>) -> Result<(), SettingError> {
        Ok(())
    }

    /// The mission, checked.
    ///
    /// # Errors
    /// If a setting is out of its range, or contradicts another or the world.
    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError>;
}

/// A mission that has been checked.
pub trait Mission: fmt::Debug + Send + Sync {
    /// What it is after.
    fn goal(&self) -> MissionGoal;

    /// The simulation of all stations, which know `map`, ready to run.
    ///
    /// # Errors
    /// Those of [`Simulation::with`](sextant_sim::Simulation::with).
    ///
    /// # Panics
    /// If `team` is not that of `setup`.
    fn prepare(
        self: Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
        setup: Setup,
    ) -> Result<ReadySimulation<'static, MissionOutcome>, SettingError>;
}
