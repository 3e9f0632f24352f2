//! Logs of robots from simulated surveys: shipped scenarios with fewer nodes and stops.

use std::path::{Path, PathBuf};

use sextant::run::Simulator;
use sextant::scenario::Scenario;
use sextant_sim::Unobserved;

use crate::laws::KnownLog;

/// A scenario: the name of the family, its file within `scenarios`, and what is set.
pub type Shipped = (&'static str, &'static str, &'static [&'static str]);

/// Far fewer nodes, and stops 2.5 m apart.
const FEW: [&str; 4] = [
    "world.nodes.lattice.spacing_m=4.0",
    "world.nodes.lattice.jitter_m=1.2",
    "world.nodes.lattice.count=26",
    "robots.0.controller.automated_s.step_m=3.0",
];
/// An L-shaped hall: a block in the corner of the rectangle of `smoke`.
const CORNER: &str = "world.obstacles=[{ name = \"corner\", material = \"concrete\", \
                      shape.box = { center_m = [8.5, 7.5, 0.0], size_m = [7.0, 5.0, 3.0] } }]";
/// Walls between rooms.
const ROOMS: &str = "world.obstacles=[\
                     { name = \"west\", material = \"concrete\", shape.box = { center_m = [4.0, 7.0, 0.0], size_m = [0.3, 6.0, 3.0] } }, \
                     { name = \"east\", material = \"concrete\", shape.box = { center_m = [8.0, 3.0, 0.0], size_m = [0.3, 6.0, 3.0] } }]";

/// All simulated families.
pub const SHIPPED: &[Shipped] = &[
    ("smoke", "smoke.toml", &[]),
    ("smoke-open", "smoke.toml", &["world.obstacles=[]"]),
    ("simulated-l-hall", "smoke.toml", &[CORNER, "world.nodes.lattice.count=22"]),
    ("simulated-rooms", "smoke.toml", &[ROOMS, "world.nodes.lattice.count=24"]),
    ("collisions", "smoke.toml", &["traffic.beacon.interval_s=0.04", "robots.0.listen_s=0.4"]),
    ("circular", "ml-tm/circular.toml", &FEW),
    ("concave", "ml-tm/concave.toml", &FEW),
    ("sparse", "ml-tm/sparse.toml", &FEW),
    (
        "two-robots",
        "ml-tm/two-robots.toml",
        &[FEW[0], FEW[1], FEW[2], FEW[3], "robots.1.controller.automated_s.step_m=3.0"],
    ),
    ("map-then-search", "target/map-then-search.toml", &FEW),
    (
        "trajectory-s",
        "ml-tm/trajectory-s.toml",
        &[
            "world.nodes.random.count=30",
            "robots.0.controller.s_path.lane_spacing_m=2.0",
            "robots.0.controller.s_path.stop_spacing_m=1.5",
        ],
    ),
    ("trajectory-random", "ml-tm/trajectory-random.toml", &["world.nodes.random.count=30"]),
    (
        "odometry-drift",
        "ml-tm/odometry-drift.toml",
        &[
            "world.nodes.random.count=30",
            "robots.0.controller.s_path.lane_spacing_m=2.0",
            "robots.0.controller.s_path.stop_spacing_m=1.5",
        ],
    ),
    (
        "cylinder",
        "ml-tm/cylinder.toml",
        &[
            "world.nodes.lattice.spacing_m=2.6",
            "world.nodes.lattice.jitter_m=0.8",
            "world.nodes.lattice.count=26",
            "robots.0.controller.automated_s.step_m=3.0",
        ],
    ),
    (
        "two-bands",
        "mmtm/two-bands.toml",
        &[
            "world.nodes.lattice.spacing_m=5.0",
            "world.nodes.lattice.jitter_m=1.5",
            "world.nodes.lattice.count=26",
            "robots.0.controller.s_path.stop_spacing_m=4.0",
        ],
    ),
];

/// The folder of the shipped scenarios.
#[must_use]
pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios")
}

/// What the robots of a scenario record under `seed`: the log of its first network. A map of a log alone needs no discovery of
/// neighbours, which does not change the survey.
///
/// # Errors
/// If the scenario is invalid.
pub fn simulated((family, file, set): &Shipped, seed: u64) -> Result<KnownLog, String> {
    let set: Vec<String> = set.iter().map(|flag| (*flag).to_owned()).collect();
    let scenario = Scenario::load_with(scenarios().join(file), &set, Some(seed));
    let scenario = scenario.map_err(|errors| format!("{family}: {errors}"))?;
    let simulator = Simulator::new(&scenario).map_err(|error| format!("{family}: {error}"))?;
    let survey = simulator.run(&mut Unobserved).survey;
    let truth = scenario.world().nodes.iter().map(|node| Some(node.position)).collect();
    Ok(KnownLog { family: (*family).to_owned(), name: format!("{family}-{seed}"), log: survey.log().clone(), truth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_scenarios_give_logs_of_a_few_nodes_and_stops() {
        for shipped in SHIPPED {
            let known = simulated(shipped, 1).unwrap();
            let (nodes, stops) = (known.log.node_count(), known.log.stops().len());
            // A random walk goes on until each node was heard five times: it has the most stops.
            assert!((12..=40).contains(&nodes) && (20..=700).contains(&stops), "{}: {nodes}, {stops}", known.name);
            assert!(known.log.receptions().iter().any(|reception| reception.rssi_dbm.is_some()), "{}", known.name);
        }
    }
}
