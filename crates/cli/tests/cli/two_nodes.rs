//! What the program says of two nodes and a sink with more tables.

use std::path::Path;

use crate::program::{Said, call, unwrapped};

const BASE: &str = r#"name = "two-nodes"
duration_s = 10.0
[world.nodes.explicit]
positions_m = [[20.0, 0.0], [0.0, 20.0]]
names = ["a", "b"]
[[sinks]]
name = "sink"
position_m = [0.0, 0.0]
[radio]
tx_power_dbm = 0.0
sensitivity_dbm = -85.0
[channel.path_loss.log_distance]
exponent = 3.0
reference_loss_db = 40.0
[traffic.periodic]
interval_s = 1.0
"#;

/// Exit code, and standard output and standard error together, of `sextant` with `more` at the end of the scenario.
pub(crate) fn told_in(folder: &Path, more: &str, words: &[&str]) -> (Option<i32>, String) {
    std::fs::write(folder.join("a.toml"), format!("{BASE}{more}")).expect("there is room");
    let (code, printed, message) = call(folder, words).all();
    (Some(code), unwrapped(&(printed + &message)))
}
