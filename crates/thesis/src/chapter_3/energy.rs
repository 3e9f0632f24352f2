//! The energy that the maps of the comparison cost the nodes (section 3.6.1).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use super::comparison::{NETWORKS, Network};
use super::method::{METHODS, ML_TM, Method, RSSI, TPM};
use sextant::summary::measures::{map, run};
use sextant::summary::{Measure, Number, Summary};

/// Energy of the simulated radios, by activity.
const RADIOS: [(&str, &Number<Summary>); 5] = [
    ("sending during the survey", &run::ENERGY_TX_J),
    ("neighbour discovery, sending", &run::NEIGHBOURS_TX_J),
    ("neighbour discovery, receiving", &run::NEIGHBOURS_RX_J),
    ("anchors' packets, sending", &run::ANCHORS_TX_J),
    ("anchors' packets, receiving", &run::ANCHORS_RX_J),
];

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "energy",
        title: "Energy of the nodes by the count of messages, and by simulated radios",
        content: Content::Quantities(NETWORKS.into_iter().flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: NETWORKS.into_iter().map(claim).collect(),
        notes: &[
            "The thesis gives formulas but no numbers. Packets, powers and currents are those of the simulation (CC2420). \
             Time samples are the stops; anchors and neighbours heard are means over the nodes; p = 1 packet is sent.",
            "During discovery the simulated radios listen all the time. The message count does not include this energy.",
        ],
    }
}

fn quantities(network: &'static Network) -> impl Iterator<Item = Quantity> {
    let Network { name, scenario, .. } = network;
    let counted = METHODS.map(|method| {
        let what = format!("{name}: {} ({})", method.name, method.equation);
        Quantity::new(what, scenario, method.measure(&map::MESSAGE_ENERGY_J))
    });
    let simulated = RADIOS.map(|(when, number)| {
        Quantity::new(format!("{name}: simulated radios, {when}"), scenario, Measure::OfRun(number))
    });
    counted.into_iter().chain(simulated)
}

fn claim(network: &Network) -> Claim {
    let term = |method: &Method| Term::new(network.scenario, method.measure(&map::MESSAGE_ENERGY_J));
    Claim {
        text: format!("{}: the RSSI method needs less energy than ML-TM and the SVD hop map", network.name),
        published: Some(Published::new("\"the most energy-efficient\"", "section 3.6.1")),
        check: Check::Least([&RSSI, &ML_TM, &TPM].map(term).to_vec()),
    }
}
