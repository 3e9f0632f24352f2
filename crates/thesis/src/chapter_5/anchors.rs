//! The share of initial anchors, N_A / N (sections 5.3.3 and 5.3.4): DMmTM-SS, and DMmTM-HS with N_R / N of about 0.6.

use super::super::chart::Across;
use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::subject::{HS, IMPROVED, SHARE, SS, Subject, claim};
use super::swept::{Figures, MEAN, P95, Swept, THREE, WITHIN_1_M, ZERO};
use sextant::summary::measures::distributed;

const OF_STATIC: &str = "section 5.3.3";
const OF_HYBRID: &str = "section 5.3.4";

/// The values in the sweeps of the scenarios.
const SHARES: [&str; 7] = ["0.05", "0.1", "0.15", "0.2", "0.25", "0.3", "0.35"];

/// Means that differ by less than this are almost the same (m): a tenth of the distance of neighbouring nodes.
const ALMOST_M: f64 = 0.1;
/// Shares of nodes that differ by less than this are almost the same.
const ALMOST: f64 = 0.05;

fn over_shares(environment: Environment, subject: &'static Subject) -> Swept {
    Swept { environment, subject, key: SHARE, values: &SHARES }
}

fn in_words(share: &str) -> String {
    format!("{SHARE} = {share}")
}

/// The share as a number.
fn across(_: Swept, share: &str) -> Across {
    Across::Setting(share.parse().expect("a share"))
}

/// The means over the shares in each environment, of several maps.
fn all(subjects: &[&'static Subject]) -> Vec<Swept> {
    let of = |environment| subjects.iter().map(move |subject| over_shares(environment, subject));
    Environment::ALL.into_iter().flat_map(of).collect()
}

pub(super) fn of_static() -> Experiment {
    let lines = all(&[&SS, &IMPROVED]);
    let figures = Figures {
        id: "5.6",
        title: "DMmTM-SS: share of initial anchors",
        across: "initial anchors / nodes",
        lines: &lines,
    };
    Experiment {
        id: figures.id,
        title: "DMmTM-SS: share of initial anchors, with the thesis' estimates and with ours",
        content: Content::Quantities(lines.iter().flat_map(|swept| static_quantities(*swept)).collect()),
        distributions: &[],
        charts: figures.charts(across),
        claims: static_claims(),
        notes: &[
            "The thesis prints one number, the mean error in the greenhouse with 10 % anchors. The layouts are ours, because its \
             figures are lost; numbers of nodes are those of its text.",
            "With the printed powers, the close-in path loss does not reach the printed 7 m. The antennas of the scenarios have the \
             missing gain. The metal racks of our warehouse are opaque; the thesis does not say what its racks let through.",
            "Errors are over the nodes that are not initial anchors and have a position; shares of nodes count those without one as \
             infinitely far.",
            "\"ours\" is not in the thesis. In the same windows, messages say how uncertain places are, anchors take the directions \
             that most bearings allow, and nodes the mean of a posterior that knows whom they have not heard.",
            "The displacement of a node is the median over its neighbours on the ground, of up to half of its 8 sectors.",
        ],
    }
}

fn static_quantities(swept: Swept) -> Vec<Quantity> {
    let is_printed = swept.environment == Environment::Greenhouse && swept.subject.name == SS.name;
    swept.quantities(in_words, |share, number| {
        (is_printed && share == "0.1" && std::ptr::eq(number, MEAN)).then(|| Published::new("0.75", OF_STATIC))
    })
}

fn static_claims() -> Vec<Claim> {
    let [warehouse, greenhouse] = Environment::ALL;
    let mut claims = Vec::new();
    for environment in Environment::ALL {
        claims.extend(trends(over_shares(environment, &SS), OF_STATIC));
    }
    let ss = |environment| over_shares(environment, &SS);
    claims.push(claim(
        greenhouse,
        "the mean distance error with 10 % anchors is at most 0.75 m, rounded",
        ("0.75 m", OF_STATIC),
        Check::Below(ss(greenhouse).term("0.1", MEAN), 0.755),
    ));
    claims.push(claim(
        greenhouse,
        "most nodes have an error of at most 1 m with 15 % anchors",
        ("\"majority of sensors\"", OF_STATIC),
        Check::Above(ss(greenhouse).term("0.15", WITHIN_1_M), 0.5),
    ));
    for share in ["0.05", "0.15", "0.35"] {
        let both = |number| [warehouse, greenhouse].map(|environment| ss(environment).term(share, number)).to_vec();
        claims.push(claim(
            warehouse,
            &format!("the mean distance error is less than in the greenhouse, {}", in_words(share)),
            ("\"comparatively less\"", OF_STATIC),
            Check::Least(both(MEAN)),
        ));
        claims.push(claim(
            warehouse,
            &format!("more nodes have zero sector displacement than in the greenhouse, {}", in_words(share)),
            ("\"high\"", OF_STATIC),
            Check::Greatest(both(ZERO)),
        ));
    }
    for environment in Environment::ALL {
        for share in ["0.05", "0.15", "0.35"] {
            let terms = [&IMPROVED, &SS].map(|subject| over_shares(environment, subject).term(share, MEAN));
            claims.push(Claim {
                text: format!(
                    "{}: our estimates have a smaller mean distance error, {}",
                    environment.name(),
                    in_words(share)
                ),
                published: None,
                check: Check::Least(terms.to_vec()),
            });
        }
    }
    claims
}

/// The error falls, and sectors are right more often, from few anchors to many.
fn trends(swept: Swept, section: &'static str) -> [Claim; 3] {
    [
        claim(
            swept.environment,
            "the mean distance error is less with 35 % anchors than with 15 %, and less with 15 % than with 5 %",
            ("\"decreases when the anchor ratio increase\"", section),
            Check::Rising(swept.terms(&["0.35", "0.15", "0.05"], MEAN)),
        ),
        claim(
            swept.environment,
            "more nodes have zero sector displacement with 35 % anchors than with 15 %, and more with 15 % than with 5 %",
            ("\"also increasing\"", section),
            Check::Rising(swept.terms(&["0.05", "0.15", "0.35"], ZERO)),
        ),
        claim(
            swept.environment,
            "fewer nodes have a sector displacement of three with 35 % anchors than with 5 %",
            ("\"decreasing\"", section),
            Check::Rising(swept.terms(&["0.35", "0.05"], THREE)),
        ),
    ]
}

pub(super) fn of_hybrid() -> Experiment {
    let lines = all(&[&HS]);
    let figures = Figures {
        id: "5.10",
        title: "DMmTM-HS: share of initial anchors, with N_R / N of about 0.6",
        across: "initial anchors / nodes",
        lines: &lines,
    };
    Experiment {
        id: figures.id,
        title: figures.title,
        content: Content::Quantities(lines.iter().flat_map(|swept| hybrid_quantities(*swept)).collect()),
        distributions: &[],
        charts: figures.charts(across),
        claims: Environment::ALL.into_iter().flat_map(hybrid_claims).collect(),
        notes: &[
            "The text of the thesis has N_R / N = 0.6, the caption of the figure 0.15. Here the mobile anchor drives for the time in \
             which about 0.6 of the nodes hear it; the share that came out is in the table.",
            "\"Almost the same\" is taken as less than 0.1 m apart, and less than 5 points apart. The thesis says that the variance of \
             the error falls: here the 95th percentile.",
        ],
    }
}

fn hybrid_quantities(swept: Swept) -> Vec<Quantity> {
    let mut quantities = swept.quantities(in_words, |_, _| None);
    quantities.extend(SHARES.map(|share| Quantity {
        what: format!("{}: N_R / N, {}", swept.environment.name(), in_words(share)),
        term: swept.term(share, &distributed::HEARD_SHARE),
        unit: None,
        published: Some(Published::new("60", OF_HYBRID)),
    }));
    quantities
}

fn hybrid_claims(environment: Environment) -> [Claim; 5] {
    let swept = over_shares(environment, &HS);
    let beyond = ["0.2", "0.25", "0.3", "0.35"];
    [
        claim(
            environment,
            "the mean distance error is less with 20 % anchors than with 10 %, and less with 10 % than with 5 %",
            ("\"the distance error decreases\"", OF_HYBRID),
            Check::Rising(swept.terms(&["0.2", "0.1", "0.05"], MEAN)),
        ),
        claim(
            environment,
            "the mean distance errors with 20 to 35 % anchors are less than 0.1 m apart",
            ("\"stays almost the same\"", OF_HYBRID),
            Check::Within(swept.terms(&beyond, MEAN), ALMOST_M),
        ),
        claim(
            environment,
            "the 95th percentile of the error is less with 35 % anchors than with 20 %",
            ("\"the variance of the error keeps decreasing\"", OF_HYBRID),
            Check::Rising(swept.terms(&["0.35", "0.2"], P95)),
        ),
        claim(
            environment,
            "more nodes have zero sector displacement with 20 % anchors than with 10 %, and more with 10 % than with 5 %",
            ("\"increases with the number of anchors\"", OF_HYBRID),
            Check::Rising(swept.terms(&["0.05", "0.1", "0.2"], ZERO)),
        ),
        claim(
            environment,
            "the shares of nodes with zero sector displacement with 20 to 35 % anchors are less than 5 points apart",
            ("\"barely changes\"", OF_HYBRID),
            Check::Within(swept.terms(&beyond, ZERO), ALMOST),
        ),
    ]
}
