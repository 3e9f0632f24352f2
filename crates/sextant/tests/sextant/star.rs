//! Nodes round a sink, and what a run says of them.

use sextant::summary::Summary;
use sextant::{Scenario, Unwatched};

/// Nodes at these distances from a sink (m), with the tables `rest`.
pub(crate) fn star(places_m: &[f64], rest: &str) -> Scenario {
    let places: Vec<String> = places_m.iter().map(|x_m| format!("[{x_m:.1}, 0.0]")).collect();
    let text = format!(
        r#"
name = "star"
world.nodes.explicit.positions_m = [{}]
radio.tx_power_dbm = 0.0
radio.sensitivity_dbm = -90.0
channel.path_loss.log_distance = {{ exponent = 2.0, reference_loss_db = 40.0 }}
{rest}
[[sinks]]
name = "sink"
position_m = [0.0, 0.0]
"#,
        places.join(", ")
    );
    Scenario::parse(&text).unwrap_or_else(|errors| panic!("{errors}"))
}

pub(crate) fn summary(scenario: &Scenario) -> Summary {
    sextant::run(scenario, &mut (), &Unwatched).expect("a run").summary().clone()
}

pub(crate) fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected} within {tolerance}");
}
