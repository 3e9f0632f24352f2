//! How much work an input may ask for.

use std::sync::atomic::{AtomicU64, Ordering};

use sextant::forecast::CostForecast;
use sextant::{Forecast, Scenario};
use sextant_kernel::{Watch, Work};

/// Stops work after it has asked so often whether to go on. The count is that of the work, not of a clock, so an input ends
/// at the same place each time.
#[derive(Debug)]
pub(crate) struct Budget(AtomicU64);

impl Budget {
    /// A budget of so many questions.
    pub(crate) fn new(questions: u64) -> Self {
        Self(AtomicU64::new(questions))
    }
}

impl Watch for Budget {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

/// Most nodes of a scenario that is simulated.
const MOST_NODES: usize = 12;
/// Most events and frames that the forecast may say; of several hops, slots and sleep it says frames alone.
const MOST_EVENTS: f64 = 20_000.0;
const MOST_FRAMES: f64 = 2_000.0;
/// The longest simulated time (s).
const LONGEST_S: f64 = 120.0;

/// Whether the forecast of the program says that the simulation of `scenario` is short. One whose length cannot be told is not.
pub(crate) fn is_small(scenario: &Scenario) -> bool {
    let nodes = scenario.world().nodes.len();
    let is_short = |cost: CostForecast| {
        let is_few = cost.events.map_or(cost.frames <= MOST_FRAMES, |events| events <= MOST_EVENTS);
        is_few && cost.sim_time_s <= LONGEST_S
    };
    nodes <= MOST_NODES
        && Forecast::of(scenario).cost.is_some_and(is_short)
        && scenario.maps().len() <= 3
        && scenario.missions().is_empty()
}
