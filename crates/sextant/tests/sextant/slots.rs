//! Networks with time-slotted channel hopping, end to end, against closed forms and the numbers of another simulator.

mod cells;
mod clocks;
mod msf;
mod stars;

use std::path::Path;

use sextant::summary::MacSummary;
use sextant::{Scenario, Unwatched};

/// Nodes `n0`, `n1`, .. and a sink, with the tables `rest`. Without a file of links, each is received over each.
fn network(folder: &Path, nodes: usize, links: Option<&[(&str, &str, f64)]>, rest: &str) -> Scenario {
    let places: Vec<String> = (0..nodes).map(|node| format!("[{node}.0, 1.0]")).collect();
    let mut trace = "";
    if let Some(links) = links {
        let rows: String = links.iter().map(|(from, to, share)| format!("0,{from},{to},{share}\n")).collect();
        std::fs::write(folder.join("links.csv"), format!("t_s,from,to,prr\n{rows}")).expect("a file");
        trace = "link_trace.file = \"links.csv\"";
    }
    let text = format!(
        r#"
name = "slots"
{trace}
world.nodes.explicit.positions_m = [{}]
reception.overlap = {{}}
radio.tx_power_dbm = 0.0
radio.sensitivity_dbm = -90.0
channel.path_loss.log_distance = {{ exponent = 2.0, reference_loss_db = 40.0 }}
{rest}
[[sinks]]
name = "sink"
position_m = [-1.0, 0.0]
"#,
        places.join(", ")
    );
    std::fs::write(folder.join("scenario.toml"), text).expect("a file");
    Scenario::load(folder.join("scenario.toml")).expect("a scenario")
}

fn mac(scenario: &Scenario) -> MacSummary {
    let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    run.summary().mac.clone().expect("sinks")
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, not {expected} within {tolerance}");
}
