//! The energy that MmTM costs the nodes (section 4.5.1).

use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::runs::Term;
use super::place::{MMTM, Setup};
use sextant::summary::measures::{map, run};
use sextant::summary::{Measure, Number, Summary};

/// Energy of the simulated radios, by activity.
const RADIOS: [(&str, &Number<Summary>); 3] =
    [("sending", &run::ENERGY_TX_J), ("receiving", &run::ENERGY_RX_J), ("idle", &run::ENERGY_IDLE_J)];

const COUNTED: Measure<'static> = MMTM.measure(&map::MESSAGE_ENERGY_J);

pub(super) fn experiment() -> Experiment {
    let places = || Environment::ALL.into_iter().flat_map(|environment| Setup::ALL.map(|setup| (environment, setup)));
    Experiment {
        id: "4.10",
        title: "Energy of the nodes with MmTM by the count of messages, and by simulated radios",
        content: Content::Quantities(places().flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: Environment::ALL.into_iter().map(claim).collect(),
        notes: &[
            "The thesis gives a formula, N (n E_rx + n s E_tx), but no energies. N is the number of nodes, n the mean number of \
             sweeps that a node answers, s the number of its sectors.",
            "Powers are those of the 60 GHz radio of the simulation, which are assumed. The formula counts one reception per \
             sweep; the simulated radios receive each frame of a sweep that reaches them, and listen between frames.",
        ],
    }
}

fn quantities((environment, setup): (Environment, Setup)) -> impl Iterator<Item = Quantity> {
    let quantity = move |what: &str, measure| {
        let what = format!("{}, {}: {what}", environment.name(), setup.name());
        Quantity::new(what, setup.scenario(environment), measure)
    };
    let counted = quantity("count of messages", COUNTED);
    let simulated =
        RADIOS.map(|(when, number)| quantity(&format!("simulated radios, {when}"), Measure::OfRun(number)));
    [counted].into_iter().chain(simulated)
}

/// More stops of the robot mean more sweeps to answer.
fn claim(environment: Environment) -> Claim {
    let term = |setup: Setup| Term::new(setup.scenario(environment), COUNTED);
    Claim {
        text: format!("{}: by the formula, 3D needs more energy than VAA", environment.name()),
        published: None,
        check: Check::Rising([Setup::Vaa, Setup::Space].map(term).to_vec()),
    }
}
