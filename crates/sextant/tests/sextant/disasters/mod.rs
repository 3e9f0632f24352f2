//! Disks that fail, are full, tear a write, are interrupted or lose their power, at each change that a small piece of work makes
//! of them. Nothing that was reported as written is lost, and what is left is whole, or can be gone on with.

mod campaigns;
mod exports;
mod files;
mod maps;
mod recordings;
mod sweeps;
mod trial;

/// A survey of a few nodes at a few stops, as text.
const SHORT: &str = r#"
name = "short"
seed = 1
radio = { tx_power_dbm = -50.0, sensitivity_dbm = -90.0 }
traffic.beacon = { mpdu_octets = 20, interval_s = 0.5, jitter = 0.1 }
reception.sinr_threshold.threshold_db = 3.0
mac.csma_unslotted = {}
world.nodes.lattice = { spacing_m = 2.0, count = 6, region.rectangle = { min_m = [0.0, 0.0], max_m = [6.0, 4.0] } }

[channel]
environment = "light-tree"
max_range_m = 6.0
path_loss.log_distance.reference_loss_db = 0.0

[[robots]]
name = "surveyor"
start_m = [-1.0, -1.0]
listen_s = 1.0
controller.s_path = { lane_spacing_m = 4.0, overshoot_m = 1.0, region.rectangle = { min_m = [0.0, 0.0], max_m = [6.0, 4.0] } }

[[maps]]
[maps.algorithm.ml_tm]
grid_step_m = 0.5
profile.trapezoid = { p0 = 0.9, plateau_m = 1.0, range_m = 6.0 }
"#;
