//! A run in steps of its caller.

use sextant_kernel::{SimTime, Watch};
use sextant_scenario::Scenario;
use sextant_sim::Snapshot;

use super::error::RunError;
use super::observer::RunObserver;
use super::pipeline::{Run, StartedRun};
use super::programs::Programs;

/// A run that its caller advances to one time after the other, and looks at in between. The steps change nothing: summary and
/// recording are those of [`run`](super::run()), byte for byte.
///
/// The steps are those of the survey: what robots, anchors and the traffic do. [`finish`](Self::finish) goes on to its end, then
/// makes the maps and runs the applications.
///
/// ```
/// use sextant::kernel::SimTime;
/// use sextant::{Scenario, SteppedRun, Unwatched};
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))?;
///
/// let scenario = Scenario::load("scenarios/smoke.toml")?;
/// let mut run = SteppedRun::new(&scenario, (), &Unwatched)?;
/// run.until(SimTime::from_secs(10));
/// let now = run.snapshot().expect("a robot surveys");
/// assert_eq!(now.time, SimTime::from_secs(10));
/// println!("{} is at {}", now.robots[0].name, now.robots[0].pose.truth.position);
/// println!("{} stops, {} of {} packets received", now.stops, now.packets.received, now.packets.sent);
/// while !run.has_ended() {
///     run.until(run.time() + std::time::Duration::from_secs(60));
/// }
/// let run = run.finish()?;
/// println!("{} nodes mapped", run.summary().maps[0].mapped);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct SteppedRun<'a, O> {
    run: StartedRun<'a>,
    observer: O,
}

impl<'a, O: RunObserver> SteppedRun<'a, O> {
    /// The run of `scenario` at time 0. `observer` sees it: an observer, or a mutable reference to one. If `watch` stops the
    /// work, the survey ends at the next event at which it is asked.
    ///
    /// # Errors
    /// If parts of the scenario do not fit together, or `observer` fails.
    pub fn new(scenario: &'a Scenario, observer: O, watch: &'a dyn Watch) -> Result<Self, RunError> {
        Self::with(scenario, Programs::default(), observer, watch)
    }

    /// The same with controllers and applications of the caller's own.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and if a program cannot be given to its station.
    pub fn with(
        scenario: &'a Scenario,
        programs: Programs<'a>,
        mut observer: O,
        watch: &'a dyn Watch,
    ) -> Result<Self, RunError> {
        let run = StartedRun::new(scenario, programs, &mut observer, watch)?;
        Ok(Self { run, observer })
    }

    /// Goes on until `time`: all that happens before has happened, and what happens at that very instant has not. Nothing
    /// happens if the survey has ended, or is at a later time already. A survey ends by itself, at its `duration_s`, or because
    /// the observer or the watch ends it; an error of the observer is returned by [`finish`](Self::finish).
    ///
    /// Robots that never meet are simulated in parallel by [`run`](super::run()), and here as one simulation, with the same
    /// result.
    pub fn until(&mut self, time: SimTime) {
        self.run.until(time, &mut self.observer);
    }

    /// The time until which it has gone on; where the survey has ended, its end.
    #[must_use]
    pub fn time(&self) -> SimTime {
        self.run.reached().map_or(SimTime::ZERO, |reached| reached.time)
    }

    /// Whether the survey has ended, or the scenario has none.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.run.reached().is_none_or(|reached| reached.has_ended)
    }

    /// Where the robots are, and what was sent and heard so far; `None` if the scenario has no survey.
    #[must_use]
    pub fn snapshot(&self) -> Option<Snapshot> {
        self.run.snapshot()
    }

    /// The observer, with what it has seen so far.
    #[must_use]
    pub fn observer(&self) -> &O {
        &self.observer
    }

    /// Goes on to the end of the survey, computes and measures the maps, and runs the applications. The time that the caller
    /// took between the steps is part of the summary's timing.
    ///
    /// # Errors
    /// As for [`run`](super::run()).
    pub fn finish(mut self) -> Result<Run, RunError> {
        self.run.finish(&mut self.observer)
    }
}
