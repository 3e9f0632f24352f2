//! What a simulation costs.

use serde::Serialize;
use sextant_channel::Position;
use sextant_kernel::NodeId;
use sextant_sim::{Setup, Traffic};

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

/// The same with acknowledgements. Measured: 9.5 events a frame, with 40 nodes and a load of 0.14 Erlang.
const ACKNOWLEDGED: Effort = Effort { events_per_frame: 9.5, event_s: 0.3e-6 };

/// With a coordinator: most frames wait for a beacon that their node hears, and are replaced by the next one. Measured: 3.5
/// events a frame that is offered.
const COORDINATED: Effort = Effort { events_per_frame: 3.5, event_s: 0.3e-6 };

/// With sector sweeps; a frame is the answer of a node, which sweeps too. Measured: 21 and 22 events an answer, 3 and 5 µs an
/// event, with 410 and 591 nodes.
const SWEEPING: Effort = Effort { events_per_frame: 21.5, event_s: 4e-6 };

/// What a simulation costs. Maps are not part of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CostForecast {
    /// Simulated time (s).
    pub sim_time_s: f64,
    /// Frames with packets of nodes, as far as they are simulated: over all hops, with answers to packets, fragments, and the tries
    /// that weak links need; with sector sweeps, the answers of nodes.
    pub frames: f64,
    /// What stations send besides, so that it is not in `frames`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub without: Vec<&'static str>,
    /// Events of the simulation; absent if they are not known, because there are several hops, or slots, or stations that sleep.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub events: Option<f64>,
    /// Seconds of one core; absent as the events.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_s: Option<f64>,
}

impl CostForecast {
    /// The cost, if the rate of the traffic and the duration are known.
    pub(super) fn of(scenario: &Scenario, setup: &Setup, reaches: &[Reach<'_>], ways: &[Way<'_>]) -> Option<Self> {
        let survey_s = ways.iter().map(Way::duration_s).fold(0.0, f64::max);
        let sim_time_s = setup.duration.map_or(survey_s, |duration| duration.as_secs_f64());
        if sim_time_s <= 0.0 {
            return None;
        }
        let mut cost = Self { sim_time_s, frames: 0.0, without: Vec::new(), events: Some(0.0), cpu_s: Some(0.0) };
        if reaches.iter().any(Reach::sweeps) {
            cost.add(ways.iter().map(Way::answers).sum(), Some(&SWEEPING));
        }
        let share = simulated_share(scenario, setup, ways);
        for reach in reaches.iter().filter(|reach| !reach.sweeps()) {
            let technology = &reach.network.technology;
            let per_packet = scenario.routing().map(|routing| routing.expected_frames(reach.tries()));
            let frames_per_s = |(node, place): &(NodeId, Position)| {
                let rate_per_s = reach.network.traffic.of(*node).map_or(Some(0.0), Traffic::rate_per_s)?;
                let frames = match &per_packet {
                    Some(per_packet) => per_packet.get(node.index()).copied().unwrap_or(0.0),
                    None => reach.frames_of_packet(*node, *place),
                };
                Some(rate_per_s * frames)
            };
            let frames_per_s = reach.nodes.iter().map(frames_per_s).sum::<Option<f64>>()?;
            let is_acknowledged = per_packet.is_some() || reach.network.traffic.is_acknowledged();
            let effort = if per_packet.is_some() || technology.has_slots() || technology.sleeping().is_some() {
                None
            } else if technology.has_coordinator() {
                Some(&COORDINATED)
            } else if is_acknowledged {
                Some(&ACKNOWLEDGED)
            } else {
                Some(&UNSLOTTED)
            };
            cost.add(share * sim_time_s * frames_per_s, effort);
            let is_built = scenario.config().routing.as_ref().is_some_and(|routing| routing.tree.is_built());
            for (is_sent, what) in [
                (is_acknowledged, "acknowledgements"),
                (is_acknowledged, "tries after collisions"),
                (is_built, "messages of the tree"),
                (technology.sleeping().is_some(), "what wakes receivers"),
                (technology.has_slots(), "what keeps slots"),
            ] {
                if is_sent && !cost.without.contains(&what) {
                    cost.without.push(what);
                }
            }
        }
        Some(cost)
    }

    fn add(&mut self, frames: f64, effort: Option<&Effort>) {
        let events = effort.map(|effort| effort.events_per_frame * frames);
        let cpu_s = effort.map(|effort| effort.event_s * effort.events_per_frame * frames);
        self.frames += frames;
        self.events = self.events.zip(events).map(|(a, b)| a + b);
        self.cpu_s = self.cpu_s.zip(cpu_s).map(|(a, b)| a + b);
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
