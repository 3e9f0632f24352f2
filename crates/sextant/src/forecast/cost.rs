//! What a simulation costs.

use serde::Serialize;
use sextant_channel::Position;
use sextant_sim::Setup;

use sextant_scenario::Scenario;

use super::network::Reach;
use super::way::Way;

/// Events of a frame, and the time of an event on one core (s). Both are means of measured runs of shipped scenarios.
struct Effort {
    events_per_frame: f64,
    event_s: f64,
}

/// With unslotted CSMA-CA. Measured: 6.0 to 6.3 events a frame and 0.1 to 0.4 µs an event, with 30 to 700 nodes.
const UNSLOTTED: Effort = Effort { events_per_frame: 6.2, event_s: 0.2e-6 };

/// With a coordinator: most frames wait for a beacon that their node hears, and are replaced by the next one. Measured: 3.5
/// events a frame that is offered.
const COORDINATED: Effort = Effort { events_per_frame: 3.5, event_s: 0.3e-6 };

/// With sector sweeps; a frame is the answer of a node, which sweeps too. Measured: 21 and 22 events an answer, 3 and 5 µs an
/// event, with 410 and 591 nodes.
const SWEEPING: Effort = Effort { events_per_frame: 21.5, event_s: 4e-6 };

/// What a simulation costs. Maps are not part of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CostForecast {
    /// Simulated time (s).
    pub sim_time_s: f64,
    /// Frames that the nodes offer, as far as they are simulated; with sector sweeps, their answers.
    pub frames: f64,
    /// Events of the simulation.
    pub events: f64,
    /// Seconds of one core.
    pub cpu_s: f64,
}

impl CostForecast {
    /// The cost, if the rate of the traffic and the duration are known.
    pub(super) fn of(scenario: &Scenario, setup: &Setup, reaches: &[Reach<'_>], ways: &[Way<'_>]) -> Option<Self> {
        let survey_s = ways.iter().map(Way::duration_s).fold(0.0, f64::max);
        let sim_time_s = setup.duration.map_or(survey_s, |duration| duration.as_secs_f64());
        if sim_time_s <= 0.0 {
            return None;
        }
        let mut cost = Self { sim_time_s, frames: 0.0, events: 0.0, cpu_s: 0.0 };
        if reaches.iter().any(Reach::sweeps) {
            cost.add(ways.iter().map(Way::answers).sum(), &SWEEPING);
        }
        let share = simulated_share(scenario, setup, ways);
        for reach in reaches.iter().filter(|reach| !reach.sweeps()) {
            let effort = if reach.network.technology.has_coordinator() { &COORDINATED } else { &UNSLOTTED };
            cost.add(share * sim_time_s * reach.rate_per_s()? * reach.nodes.len() as f64, effort);
        }
        Some(cost)
    }

    fn add(&mut self, frames: f64, effort: &Effort) {
        let events = effort.events_per_frame * frames;
        self.frames += frames;
        self.events += events;
        self.cpu_s += effort.event_s * events;
    }
}

/// So many stops of each robot are looked at.
const STOPS: usize = 64;

/// Share of the nodes whose traffic is simulated, over the stops of the robots.
fn simulated_share(scenario: &Scenario, setup: &Setup, ways: &[Way<'_>]) -> f64 {
    let (region, nodes) = (scenario.region(), &setup.world.nodes);
    // The applications of nodes answer what they hear.
    if setup.needs_all().is_some() || region.is_all_of(nodes.len()) || scenario.distributed().is_some() {
        return 1.0;
    }
    let Ok(Some(halo_m)) = region.halo_m(setup.reach()) else { return 1.0 };
    let near = |place: Position| nodes.iter().filter(|node| node.position.distance_m(place) <= halo_m).count() as f64;
    let of_way = |way: &Way<'_>| {
        let step = way.stops().len().div_ceil(STOPS).max(1);
        let counts: Vec<f64> = way.stops().iter().step_by(step).map(|&stop| near(stop)).collect();
        counts.iter().sum::<f64>() / counts.len().max(1) as f64
    };
    let all: f64 = ways.iter().map(of_way).sum();
    (all / nodes.len().max(1) as f64).min(1.0)
}
