//! Filters and predictions of DeTarSK.

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::runs::Term;
use sextant::summary::measures::application::{
    CAPTURED, PREDICTION_ERROR_MEAN_M, PREDICTION_ERROR_MEDIAN_M, SIM_TIME_S, TIME_S,
};
use sextant::summary::{ApplicationSummary, Measure, Number};

const SCENARIO: &str = "target/filters.toml";

/// What is compared, and the applications.
const VARIANTS: [(&str, &str); 7] = [
    ("robust Kalman filter, waves", "robust-waves"),
    ("robust Kalman filter, integral", "robust-integral"),
    ("robust Kalman filter, product", "robust-product"),
    ("robust Kalman filter, straight on", "robust-straight"),
    ("Kalman filter, straight on", "kalman-straight"),
    ("particle filter, straight on", "particles-straight"),
    ("robust Kalman filter, straight on, pursuit", "pursuit"),
];

const NUMBERS: [(&str, &Number<ApplicationSummary>); 5] = [
    ("runs with a capture", &CAPTURED),
    ("time", &TIME_S),
    ("time until the capture or the end", &SIM_TIME_S),
    ("mean error of prediction", &PREDICTION_ERROR_MEAN_M),
    ("median error of prediction", &PREDICTION_ERROR_MEDIAN_M),
];

pub(super) fn experiment() -> Experiment {
    let quantity = |(what, number), (name, application): (&str, _)| Quantity {
        what: format!("{what}: {name}"),
        term: term(application, number),
        unit: None,
        published: None,
    };
    let of = |number| VARIANTS.into_iter().map(move |variant| quantity(number, variant));
    Experiment {
        id: "6.filters",
        title: "DeTarSK with other filters and predictions, case 2 with a robot of 2 m/s",
        content: Content::Quantities(NUMBERS.into_iter().flat_map(of).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: claims(),
        notes: &[
            "The thesis has the robust Kalman filter alone, with a curve through the turns of the target of which it does not state enough; \
             `integral` and `product` are two readings of it. The comparison is ours.",
            "Straight on is a target that keeps its velocity. In a pursuit the robot drives to where the target is now, else to where it \
             can meet it.",
        ],
    }
}

fn term(application: &'static str, number: &'static Number<ApplicationSummary>) -> Term {
    Term::new(SCENARIO, Measure::OfApplication(application, number))
}

fn claims() -> Vec<Claim> {
    let least = |text: &str, number, applications: [&'static str; 2]| Claim {
        text: text.to_owned(),
        published: None,
        check: Check::Least(applications.map(|application| term(application, number)).to_vec()),
    };
    vec![
        least(
            "a curve through the turns (waves) captures sooner than going straight on",
            &SIM_TIME_S,
            ["robust-waves", "robust-straight"],
        ),
        least("driving to a meeting captures sooner than pursuit", &SIM_TIME_S, ["robust-straight", "pursuit"]),
        least(
            "the robust Kalman filter predicts better than the Kalman filter",
            &PREDICTION_ERROR_MEAN_M,
            ["robust-straight", "kalman-straight"],
        ),
        least(
            "the robust Kalman filter predicts better than the particle filter",
            &PREDICTION_ERROR_MEAN_M,
            ["robust-straight", "particles-straight"],
        ),
    ]
}
