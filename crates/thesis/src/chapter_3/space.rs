//! Networks in three dimensions (section 3.5.4, figures 3.13 and 3.14).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use super::method::ML_TM;
use sextant::summary::Measure;
use sextant::summary::measures::{map, run};

const SECTION: &str = "section 3.5.4";
const BALL: &str = "ml-tm/sphere.toml";
const CYLINDER: &str = "ml-tm/cylinder.toml";

const NOTES: &[&str] = &[
    "Table 3.4 gives a radius of communication of 10 m for all of chapter 3. With 10 m the whole network is heard from a \
     single layer (see the scenario), so the radius is 3 m here. E_total counts neighbours within the radius of \
     communication (section 3.3), so the published values are compared with 3 m. The other radius is ours.",
    "The captions of the two networks are swapped in the thesis; we follow its text.",
];

/// A network and its published values (section 3.5.4).
struct Network {
    id: &'static str,
    title: &'static str,
    scenario: &'static str,
    distributions: &'static [(&'static str, &'static str)],
    e_total_percent: &'static str,
    time_s: &'static str,
}

/// The ball: figure 3.13 by the count of LaTeX, known as 3.12.
pub(super) fn ball() -> Experiment {
    experiment(Network {
        id: "3.12",
        title: "A ball of 1736 nodes in three dimensions",
        scenario: BALL,
        distributions: &[(BALL, "ml-tm")],
        e_total_percent: "9",
        time_s: "706",
    })
}

/// The cylinder: figure 3.14 by the count of LaTeX, known as 3.13.
pub(super) fn cylinder() -> Experiment {
    experiment(Network {
        id: "3.13",
        title: "A cylinder of 688 nodes around a block of concrete, in three dimensions",
        scenario: CYLINDER,
        distributions: &[(CYLINDER, "ml-tm")],
        e_total_percent: "10",
        time_s: "404",
    })
}

fn experiment(network: Network) -> Experiment {
    let Network { id, title, scenario, distributions, e_total_percent, time_s } = network;
    let quantity = |what: &str, number| Quantity::new(what, scenario, ML_TM.measure(number));
    let within = "nodes that lose at most a fifth of their neighbours";
    let length = Quantity::new("time of driving at 1 m/s", scenario, Measure::OfRun(&run::PATH_LENGTH_M));
    Experiment {
        id,
        title,
        content: Content::Quantities(vec![
            quantity("E_total, neighbourhood of 3 m", &map::CONNECTIVITY_ERROR).published(e_total_percent, SECTION),
            quantity("E_total, neighbourhood of 5 m", &map::CONNECTIVITY_ERROR_1),
            quantity("mean position error", &map::POSITION_ERROR_MEAN_M),
            length.in_unit("s").published(time_s, SECTION),
            quantity(&format!("{within}, neighbourhood of 3 m"), &map::NODES_WITHIN).published("> 90", SECTION),
            quantity(&format!("{within}, neighbourhood of 5 m"), &map::NODES_WITHIN_1),
        ]),
        distributions,
        charts: Vec::new(),
        claims: vec![Claim {
            text: "more than nine in ten nodes lose at most a fifth of their neighbours within 3 m".to_owned(),
            published: Some(Published::new("\"more than 90% of nodes\"", SECTION)),
            check: Check::Above(Term::new(scenario, ML_TM.measure(&map::NODES_WITHIN)), 0.9),
        }],
        notes: NOTES,
    }
}
