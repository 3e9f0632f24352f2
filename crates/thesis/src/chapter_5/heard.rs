//! The share of the nodes that hear the mobile anchor, N_R / N (section 5.3.4): DMmTM-HS with 15 % static anchors.

use super::super::chart::Across;
use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::subject::{HS_BY_TIME, claim};
use super::swept::{Figures, MEAN, Swept, THREE, ZERO};
use sextant::summary::measures::distributed;

const SECTION: &str = "section 5.3.4";

/// The swept setting.
const KEY: &str = "distributed_mapping.mobile_phase_s";

/// The values in the sweeps of the scenarios.
const fn times_s(environment: Environment) -> &'static [&'static str; 6] {
    match environment {
        Environment::Warehouse => &["150", "450", "700", "900", "1350", "1800"],
        Environment::Greenhouse => &["5", "25", "40", "60", "80", "100"],
    }
}

fn over_times(environment: Environment) -> Swept {
    Swept { environment, subject: &HS_BY_TIME, key: KEY, values: times_s(environment) }
}

pub(super) fn experiment() -> Experiment {
    let lines = Environment::ALL.map(over_times);
    let figures = Figures {
        id: "5.9",
        title: "DMmTM-HS: nodes that hear the mobile anchor, with 15 % static anchors",
        across: "nodes that heard the mobile anchor / nodes",
        lines: &lines,
    };
    Experiment {
        id: figures.id,
        title: figures.title,
        content: Content::Quantities(lines.iter().flat_map(|swept| quantities(*swept)).collect()),
        distributions: &[],
        charts: figures.charts(|swept, time_s| Across::Measured(swept.term(time_s, &distributed::HEARD_SHARE))),
        claims: Environment::ALL.into_iter().flat_map(trends).chain([almost_flat()]).collect(),
        notes: &[
            "The thesis does not say how it varied N_R / N. Here the mobile anchor drives for a longer time; the share that came out \
             is in the table, and across the figures. With more time, nodes also hear it at more stops.",
            "\"Almost the same\" is taken as less than 0.1 m apart.",
        ],
    }
}

fn in_words(time_s: &str) -> String {
    format!("{time_s} s")
}

fn quantities(swept: Swept) -> Vec<Quantity> {
    let quantity = |what: &str, time_s: &str, number| Quantity {
        what: format!("{}: {what}, {}", swept.environment.name(), in_words(time_s)),
        term: swept.term(time_s, number),
        unit: None,
        published: None,
    };
    let mut quantities: Vec<_> =
        swept.values.iter().map(|time_s| quantity("N_R / N", time_s, &distributed::HEARD_SHARE)).collect();
    let stops = |time_s: &&str| quantity("stops at which a node hears it", time_s, &distributed::STOPS_HEARD_MEAN);
    quantities.extend(swept.values.iter().map(stops));
    quantities.extend(swept.quantities(in_words, |_, _| None));
    quantities
}

/// From a short time to a long one.
fn trends(environment: Environment) -> [Claim; 3] {
    let swept = over_times(environment);
    let values = swept.values;
    let (rising, falling) = ([values[0], values[2], values[5]], [values[5], values[2], values[0]]);
    let words = falling.map(in_words);
    let [long, middle, short] = &words;
    [
        claim(
            environment,
            &format!(
                "the mean distance error is less after {long} than after {middle}, and less then than after {short}"
            ),
            ("\"decreasing\"", SECTION),
            Check::Rising(swept.terms(&falling, MEAN)),
        ),
        claim(
            environment,
            &format!(
                "more nodes have zero sector displacement after {long} than after {middle}, and more then than after {short}"
            ),
            ("\"increases\"", SECTION),
            Check::Rising(swept.terms(&rising, ZERO)),
        ),
        claim(
            environment,
            &format!("fewer nodes have a sector displacement of three after {long} than after {short}"),
            ("\"decreases\"", SECTION),
            Check::Rising(swept.terms(&[values[5], values[0]], THREE)),
        ),
    ]
}

fn almost_flat() -> Claim {
    let swept = over_times(Environment::Warehouse);
    claim(
        Environment::Warehouse,
        "the mean distance errors after 900, 1350 and 1800 s, when N_R / N is about 0.8 and more, are less than 0.1 m apart",
        ("\"almost same after N_R/N = 0.8\"", SECTION),
        Check::Within(swept.terms(&swept.values[3..], MEAN), 0.1),
    )
}
