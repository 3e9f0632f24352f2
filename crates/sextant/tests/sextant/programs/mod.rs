//! Runs with controllers and applications of the caller's own.

mod applications;
mod controllers;
mod refusals;

use std::path::Path;

use sextant::sim::{Application, Delivery, NetworkId, Port, Team};
use sextant::{Programs, Run, RunRecorder, Scenario, Summary, Unwatched};

const NETWORK: NetworkId = NetworkId(0);

pub(crate) fn shipped(name: &str) -> Scenario {
    Scenario::load(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").join(name)).expect("a good scenario")
}

/// Two sinks, to which 30 nodes send.
pub(crate) fn star() -> Scenario {
    let text = "name = \"star\"\nseed = 5\nduration_s = 8.0\n\
        world.nodes.lattice = { spacing_m = 3.0, jitter_m = 0.5, count = 30, \
          region.rectangle = { min_m = [0, 0], max_m = [18, 15] } }\n\
        radio = { tx_power_dbm = -50, sensitivity_dbm = -90 }\n\
        channel = { environment = \"light-tree\", max_range_m = 9.0, path_loss.log_distance.reference_loss_db = 0.0 }\n\
        mac.csma_unslotted = {}\n\
        traffic.poisson = { rate_per_s = 3.0, acknowledged = true }\n\
        sinks = [{ name = \"west\", position_m = [4, 7, 0] }, { name = \"east\", position_m = [13, 7, 0] }]\n";
    Scenario::parse(text).expect("a good scenario")
}

/// Two robots that never come near each other: without programs they are simulated in parallel.
pub(crate) fn robots_apart() -> Scenario {
    let robot = |name: &str, x: i32| {
        format!(
            "{{ name = \"{name}\", start_m = [{x}, 0], listen_s = 1.2, \
             controller.waypoints.places_m = [[{}, 1], [{}, 3]] }}",
            x + 2,
            x + 4
        )
    };
    let nodes: Vec<String> = (0..6).flat_map(|i| [format!("[{i}, 2]"), format!("[{}, 2]", 400 + i)]).collect();
    let text = format!(
        "name = \"apart\"\nseed = 2\nrobots = [{}, {}]\nworld.nodes.explicit.positions_m = [{}]\n\
         radio = {{ tx_power_dbm = -50, sensitivity_dbm = -90 }}\n\
         channel = {{ environment = \"light-tree\", max_range_m = 6, path_loss.log_distance.reference_loss_db = 0 }}\n\
         mac.csma_unslotted = {{}}\ntraffic.periodic = {{}}\nsimulation.region = \"listeners\"\n",
        robot("first", 0),
        robot("second", 400),
        nodes.join(", ")
    );
    let scenario = Scenario::parse(&text).map_err(|errors| errors.to_string()).expect("a good scenario");
    assert!(Team::of(&scenario.setup(), scenario.region()).expect("a team").is_some());
    scenario
}

/// The summary without its timing, and the octets of the recording.
pub(crate) fn results(scenario: &Scenario, programs: Programs<'_>) -> (String, Vec<u8>) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    let run = sextant::run_with(scenario, programs, &mut RunRecorder::new(&path), &Unwatched).expect("a run");
    let summary = Summary { timing: None, ..run.summary().clone() };
    (summary.to_json(), std::fs::read(path).expect("a recording"))
}

fn run(scenario: &Scenario, programs: Programs<'_>) -> Run {
    sextant::run_with(scenario, programs, &mut (), &Unwatched).expect("a run")
}

/// Counts what it receives.
#[derive(Debug, Default)]
struct Counter(u64);

impl Application for Counter {
    fn hears(&self) -> bool {
        true
    }

    fn delivered(&mut self, _: &Delivery<'_>, _: &mut Port<'_>) {
        self.0 += 1;
    }
}
