//! Messages and energy of the searches (section 6.4.1).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::subject::{CASES, Case, DETARSK, P_G, SEARCHES, SLOW};
use sextant::summary::measures::application::{
    ENERGY_TOTAL_J, ENERGY_TX_J, MESSAGES_OCTETS, MESSAGES_SENT, MESSAGES_SENT_PER_S,
};
use sextant::summary::{ApplicationSummary, Number};

const SECTION: &str = "section 6.4.1";

const EFFORTS: [(&str, &Number<ApplicationSummary>); 5] = [
    ("frames sent", &MESSAGES_SENT),
    ("frames sent per second", &MESSAGES_SENT_PER_S),
    ("octets of all payloads", &MESSAGES_OCTETS),
    ("energy of sending", &ENERGY_TX_J),
    ("energy of all radios of nodes", &ENERGY_TOTAL_J),
];

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "6.messages",
        title: "Messages and energy of DeTarSK and P-G until the capture or the end, robots of 2 m/s",
        content: Content::Quantities(CASES.into_iter().flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: CASES.into_iter().flat_map(claims).collect(),
        notes: &[
            "The thesis gives reasons, but no numbers. A search ends when the target is captured, so that a quick one sends less in all; \
             frames per second do not have this advantage. Repetitions of unacknowledged frames are not among the frames, but in \
             the energy.",
            "The receivers of all nodes are always on, and that is nearly all of the energy of the radios: it grows with the time of the \
             search, not with its messages.",
        ],
    }
}

fn quantities(case: Case) -> Vec<Quantity> {
    let quantity = |(what, number): (&str, _), search: super::subject::Search| Quantity {
        what: format!("{}: {what}, {}", case.name, search.name),
        term: case.term(search, SLOW, number),
        unit: None,
        published: None,
    };
    let of = |effort| SEARCHES.into_iter().map(move |search| quantity(effort, search));
    EFFORTS.into_iter().flat_map(of).collect()
}

fn claims(case: Case) -> [Claim; 4] {
    let claim = |text: &str, value: &str, number| Claim {
        text: format!("{}: {text}", case.name),
        published: Some(Published::new(value, SECTION)),
        check: Check::Least([DETARSK, P_G].map(|search| case.term(search, SLOW, number)).to_vec()),
    };
    [
        claim("DeTarSK sends fewer frames than P-G", "\"less traffic\"", &MESSAGES_SENT),
        claim("DeTarSK sends fewer frames per second than P-G", "\"less traffic\"", &MESSAGES_SENT_PER_S),
        claim("DeTarSK sends with less energy than P-G", "\"less energy\"", &ENERGY_TX_J),
        claim("the radios need less energy with DeTarSK than with P-G", "\"less energy\"", &ENERGY_TOTAL_J),
    ]
}
