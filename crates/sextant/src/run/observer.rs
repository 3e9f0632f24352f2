//! What sees a run: recordings, captures, progress, and whatever a program adds.

use sextant_kernel::{SimTime, Watch};
use sextant_mapper::EstimatorFindings;
use sextant_scenario::{MapJob, PlannedMission, Scenario};
use sextant_sim::{Observer, Survey};

use super::discovery::Discoveries;
use super::error::RunError;
use super::evaluation::Evaluation;
use super::mission::Performance;
use super::simulator::Simulated;
use crate::summary::Summary;

/// Sees a run while it goes on, the events of its simulations too. By default it ignores everything. `()` sees nothing, a
/// pair is two observers, and an `Option` may be none. An error ends the run, and is what the run returns.
pub trait RunObserver: Observer {
    /// The run begins, and what precedes the survey is known.
    ///
    /// # Errors
    /// Whatever ends the run.
    fn run_started(&mut self, _start: &RunStart<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// A simulation begins: the survey or a mission. The events of [`Observer`] follow.
    ///
    /// # Errors
    /// Whatever ends the run.
    fn simulation_started(&mut self, _start: &SimulationStart<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// The survey is over: by itself, or because an observer or the watch stopped it.
    ///
    /// # Errors
    /// Whatever ends the run, above all what went wrong during the simulation.
    fn survey_finished(&mut self, _end: &SurveyEnd<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// A map is computed and measured.
    ///
    /// # Errors
    /// Whatever ends the run.
    fn map_finished(&mut self, _map: &MapEnd<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// A mission is over.
    ///
    /// # Errors
    /// Whatever ends the run, above all what went wrong during the simulation.
    fn mission_finished(&mut self, _end: &MissionEnd<'_>) -> Result<(), RunError> {
        Ok(())
    }

    /// The run is over, and this is its summary, without timing. Files are finished here.
    ///
    /// # Errors
    /// Whatever the run is to return.
    fn run_finished(&mut self, _summary: &Summary) -> Result<(), RunError> {
        Ok(())
    }
}

/// What is known when a run begins.
#[derive(Clone, Copy)]
pub struct RunStart<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// What the nodes found out of each other before the survey.
    pub discoveries: &'a Discoveries,
}

/// What is known when a simulation begins.
#[derive(Clone, Copy)]
pub struct SimulationStart<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The mission that is simulated; `None` for the survey.
    pub mission: Option<&'a PlannedMission>,
    /// The names of the robots that take part; the events name them by their index.
    pub robots: &'a [String],
    /// Time 0 of the simulation in the whole run: phases of a run follow each other.
    pub start: SimTime,
}

/// A survey that is over.
#[derive(Clone, Copy)]
pub struct SurveyEnd<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// What was heard, and what became of the packets.
    pub simulated: &'a Simulated,
}

/// A map that is computed and measured.
#[derive(Clone, Copy)]
pub struct MapEnd<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The survey that the map is of.
    pub simulated: &'a Simulated,
    /// What the nodes found out of each other before the survey.
    pub discoveries: &'a Discoveries,
    /// The map of the scenario; `None` for the map that the nodes computed themselves.
    pub named: Option<&'a MapJob>,
    /// The map and its errors.
    pub evaluation: &'a Evaluation,
    /// Stops further work on the map.
    pub watch: &'a dyn Watch,
}

impl MapEnd<'_> {
    /// When the survey of the map ended.
    #[must_use]
    pub fn time(&self) -> SimTime {
        self.simulated.survey.end
    }

    /// Name of the map.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.evaluation.name
    }

    /// What was estimated with the map.
    #[must_use]
    pub fn learned(&self) -> Option<&EstimatorFindings> {
        self.evaluation.learned.as_ref()
    }
}

/// A mission that is over.
#[derive(Clone, Copy)]
pub struct MissionEnd<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The mission.
    pub mission: &'a PlannedMission,
    /// Time 0 of its simulation in the whole run.
    pub start: SimTime,
    /// What its simulation left behind.
    pub survey: &'a Survey,
    /// What happened and what was worked out, with its summary.
    pub performance: &'a Performance,
}

/// Writes the observers that pass each stage of a run on to others.
macro_rules! each_stage {
    ($($name:ident($argument:ident: $kind:ty));* $(;)?) => {
        impl RunObserver for () {}

        impl<O: RunObserver + ?Sized> RunObserver for &mut O {
            $(fn $name(&mut self, $argument: $kind) -> Result<(), RunError> {
                (**self).$name($argument)
            })*
        }

        impl<O: RunObserver> RunObserver for Option<O> {
            $(fn $name(&mut self, $argument: $kind) -> Result<(), RunError> {
                self.as_mut().map_or(Ok(()), |observer| observer.$name($argument))
            })*
        }

        /// Both are called, the first one first, also if it fails; the first error counts.
        impl<A: RunObserver, B: RunObserver> RunObserver for (A, B) {
            $(fn $name(&mut self, $argument: $kind) -> Result<(), RunError> {
                let first = self.0.$name($argument);
                first.and(self.1.$name($argument))
            })*
        }
    };
}

each_stage! {
    run_started(start: &RunStart<'_>);
    simulation_started(start: &SimulationStart<'_>);
    survey_finished(end: &SurveyEnd<'_>);
    map_finished(map: &MapEnd<'_>);
    mission_finished(end: &MissionEnd<'_>);
    run_finished(summary: &Summary);
}
