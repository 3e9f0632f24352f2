//! The energy that DMmTM costs the nodes (section 5.4.1).

use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::runs::Term;
use super::subject::{HS_15, MMTM, SHARE, SS, Subject, claim};
use sextant::summary::measures::{distributed, map};
use sextant::summary::{MapSummary, Number};

const SECTION: &str = "section 5.4.1";

const COUNTED: &Number<MapSummary> = &map::MESSAGE_ENERGY_J;

/// Shares of initial anchors of DMmTM-SS.
const SHARES: [&str; 3] = ["0.05", "0.15", "0.35"];

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "5.12",
        title: "Energy of the nodes with DMmTM by the count of messages, and by simulated radios",
        content: Content::Quantities(Environment::ALL.into_iter().flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: Environment::ALL.into_iter().flat_map(claims).collect(),
        notes: &[
            "The thesis gives formulas, eq. 5.9 and 5.10, but no energies. M in the text is N_A, the number of initial anchors. Here m is \
             the mean number of anchors that a node heard, new ones too, and a message has the mean size of all messages: if few \
             initial anchors do not suffice, new ones join, and m is large.",
            "Powers are those of the 60 GHz radio of the simulation, which are assumed. The formula counts one reception for each anchor; \
             the simulated radios receive each frame of a sweep that reaches them, and listen between frames, until their map is there. \
             The mobile anchor does not count.",
        ],
    }
}

fn in_words(share: &str) -> String {
    format!("DMmTM-SS, {SHARE} = {share}")
}

fn quantities(environment: Environment) -> Vec<Quantity> {
    let mut quantities = Vec::new();
    let mut of = |name: &str, of_map: &dyn Fn(&'static Number<MapSummary>) -> Term| {
        let what = |what: &str| format!("{}: {what}, {name}", environment.name());
        let quantity = |words: &str, term| Quantity { what: what(words), term, unit: None, published: None };
        quantities.push(quantity("count of messages", of_map(COUNTED)));
        quantities.push(quantity("simulated radios", of_map(&distributed::RADIO_ENERGY_TOTAL_J)));
        quantities.push(quantity("messages of a node", of_map(&distributed::MESSAGES_MEAN)));
        quantities.push(quantity("frames that a node received", of_map(&distributed::FRAMES_RECEIVED_MEAN)));
    };
    for share in SHARES {
        of(&in_words(share), &|number| SS.at(environment, (SHARE, share), number));
    }
    of("DMmTM-HS, 15 % anchors", &|number| HS_15.term(environment, number));
    let what = format!("{}: count of messages, MmTM with 3D", environment.name());
    quantities.push(Quantity { what, term: MMTM.term(environment, COUNTED), unit: None, published: None });
    quantities
}

fn claims(environment: Environment) -> [Claim; 3] {
    let shares = SHARES.map(|share| SS.at(environment, (SHARE, share), COUNTED)).to_vec();
    let of = |subject: &Subject| subject.term(environment, COUNTED);
    [
        claim(
            environment,
            "by the formula, DMmTM-SS needs more energy with 35 % anchors than with 15 %, and more with 15 % than with 5 %",
            ("\"a major effect\"", SECTION),
            Check::Rising(shares),
        ),
        claim(
            environment,
            "by the formula, DMmTM-HS needs more energy than DMmTM-SS with the same 15 % anchors",
            ("eq. 5.10 has one term more", SECTION),
            Check::Rising(vec![SS.at(environment, (SHARE, "0.15"), COUNTED), of(&HS_15)]),
        ),
        claim(
            environment,
            "by the formulas, MmTM with 3D needs more energy than DMmTM-SS and DMmTM-HS with 15 % anchors",
            ("\"more efficient in terms of .. energy consumption\"", "section 5.1"),
            Check::Greatest(vec![of(&MMTM), SS.at(environment, (SHARE, "0.15"), COUNTED), of(&HS_15)]),
        ),
    ]
}
