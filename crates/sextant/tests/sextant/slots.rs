//! Networks with time-slotted channel hopping, end to end, against closed forms and the numbers of another simulator.

mod cells;
mod clocks;
mod msf;
mod stars;

use std::path::Path;

use sextant::summary::MacSummary;
use sextant::{Scenario, Unwatched};

use crate::linked;
pub(crate) use crate::star::assert_close;

/// Nodes `n0`, `n1`, .. and a sink, with the tables `rest`. Without a table of links, each is received over each.
fn network(folder: &Path, nodes: usize, links: Option<&[(&str, &str, f64)]>, rest: &str) -> Scenario {
    let law = "channel.path_loss.log_distance = { exponent = 2.0, reference_loss_db = 40.0 }";
    linked::network(folder, nodes, links, &format!("{law}\n{rest}"))
}

fn mac(scenario: &Scenario) -> MacSummary {
    let run = sextant::run(scenario, &mut (), &Unwatched).expect("a run");
    run.summary().mac.clone().expect("sinks")
}
