//! What the errors of a map cost in a search.

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use sextant::summary::measures::application::{
    CAPTURED, MAP_ERROR_M, OWN_PLACE_ERROR_MEAN_M, PREDICTION_ERROR_MEAN_M, SIM_TIME_S, TIME_S,
};
use sextant::summary::{ApplicationSummary, Measure, Number};

const SCENARIO: &str = "target/maps.toml";

/// The maps, and the searches on them.
const MAPS: [(&str, &str); 4] = [
    ("true places", "on-true-places"),
    ("ML-TM", "on-ml-tm"),
    ("the self-calibrated map", "on-self-calibrated"),
    ("TPM", "on-tpm"),
];

const NUMBERS: [(&str, &Number<ApplicationSummary>); 6] = [
    ("mean error of the map", &MAP_ERROR_M),
    ("runs with a capture", &CAPTURED),
    ("time", &TIME_S),
    ("time until the capture or the end", &SIM_TIME_S),
    ("mean error of prediction", &PREDICTION_ERROR_MEAN_M),
    ("mean error of the robot's own place", &OWN_PLACE_ERROR_MEAN_M),
];

/// Times that differ by less than this cost nothing (s): an eighth of the visit.
const ALMOST_S: f64 = 5.5;

pub(super) fn experiment() -> Experiment {
    let quantity = |(what, number), (name, application): (&str, _)| Quantity {
        what: format!("{what}, {name}"),
        term: term(application, number),
        unit: None,
        published: None,
    };
    let of = |number| MAPS.into_iter().map(move |map| quantity(number, map));
    Experiment {
        id: "6.maps",
        title: "DeTarSK on maps with errors, case 3 with a robot of 2 m/s",
        content: Content::Quantities(NUMBERS.into_iter().flat_map(of).filter(has_value).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: claims(),
        notes: &[
            "A robot surveys the network of case 3, and another one searches on the maps that come of it. The thesis searches on \
             ML-TM, and has no searches on other maps.",
            "TPM is in an own scale, orientation and handedness, which the searching robot has to find out; errors are after an alignment \
             of the neighbourhood.",
            "\"Removes the errors\" is taken as a mean time until the capture or the end that is less than 5.5 s apart, an eighth of the \
             visit.",
        ],
    }
}

/// The true places have no error.
fn has_value(quantity: &Quantity) -> bool {
    quantity.term.measure != Measure::OfApplication(MAPS[0].1, &MAP_ERROR_M)
}

fn term(application: &'static str, number: &'static Number<ApplicationSummary>) -> Term {
    Term::new(SCENARIO, Measure::OfApplication(application, number))
}

fn claims() -> Vec<Claim> {
    let [truth, ml_tm, self_calibrated, tpm] = MAPS;
    let apart = |(name, application): (&str, _), published| Claim {
        text: format!("the search on {name} takes about as long as on the true places"),
        published,
        check: Check::Within(
            [application, truth.1].map(|application| term(application, &SIM_TIME_S)).to_vec(),
            ALMOST_S,
        ),
    };
    vec![
        apart(ml_tm, Some(Published::new("\"removes the errors due to distortion\"", "section 6.5"))),
        apart(self_calibrated, None),
        Claim {
            text: "the search on TPM takes longer than on the true places".to_owned(),
            published: None,
            check: Check::Least([truth.1, tpm.1].map(|application| term(application, &SIM_TIME_S)).to_vec()),
        },
    ]
}
