//! Searches over time: the error of prediction (figures 6.3 to 6.5) and the distance (figures 6.6 to 6.8).

use super::super::chart::{Across, Chart, ChartKind, ChartLine};
use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::subject::{CASES, Case, DETARSK, P_G, SEARCHES, SLOW, Search};
use sextant::summary::measures::application::{PREDICTION_ERROR_MEAN_M, PREDICTION_ERROR_MEDIAN_M};
use sextant::summary::measures::over_time;
use sextant::summary::{ApplicationSummary, Number, SEARCH_INSTANTS_S};

/// Numbers of a search by instant.
type Numbers = &'static [&'static Number<ApplicationSummary>];

/// Time between two lines of the table (s).
const BETWEEN_LINES_S: u8 = 8;

/// When the distances are compared (s).
const COMPARED_S: u8 = 20;

pub(super) fn of_prediction() -> Experiment {
    let numbers = over_time::prediction_errors_m();
    Experiment {
        id: "6.3",
        title: "Error of prediction over time, robots of 2 m/s",
        content: Content::Quantities(CASES.into_iter().flat_map(|case| errors(case, numbers)).collect()),
        distributions: &[],
        charts: charts("6.3", ("error of prediction", "error of prediction [m]"), numbers),
        claims: CASES.into_iter().flat_map(claims_of_prediction).collect(),
        notes: &[
            "The error is the distance between where a robot thinks that the target is and where it is, when the robot thinks so: the \
             mean over the runs of the means over the 4 s before each instant. Runs that have captured the target count no longer, so \
             that late values are over few runs, which are the difficult ones. P-G does not predict: its error is that of the \
             place to which it drives.",
            "The figures of the thesis show one run each; its text states one bound, for case 2.",
        ],
    }
}

pub(super) fn of_distance() -> Experiment {
    let numbers = over_time::distances_m();
    Experiment {
        id: "6.6",
        title: "Distance between robot and target over time, robots of 2 m/s",
        content: Content::Quantities(CASES.into_iter().flat_map(|case| lines(case, "distance", numbers)).collect()),
        distributions: &[],
        charts: charts("6.6", ("distance to the target", "distance [m]"), numbers),
        claims: CASES.into_iter().map(|case| claim_of_distance(case, numbers)).collect(),
        notes: &[
            "The distance counts as 0 once the target is captured. The figures of the thesis show one run each.",
        ],
    }
}

/// The instants until the target leaves, each with its number.
fn instants(case: Case, numbers: Numbers) -> impl Iterator<Item = (u8, &'static Number<ApplicationSummary>)> {
    let instants = SEARCH_INSTANTS_S.into_iter().zip(numbers.iter().copied());
    instants.take_while(move |&(time_s, _)| time_s <= case.end_s)
}

fn lines(case: Case, what: &str, numbers: Numbers) -> Vec<Quantity> {
    let chosen = || instants(case, numbers).filter(|(time_s, _)| time_s % BETWEEN_LINES_S == 0);
    let line = |search: Search, (time_s, number)| Quantity {
        what: format!("{}: {what} at {time_s} s, {}", case.name, search.name),
        term: case.term(search, SLOW, number),
        unit: None,
        published: None,
    };
    SEARCHES.into_iter().flat_map(|search| chosen().map(move |chosen| line(search, chosen))).collect()
}

fn errors(case: Case, numbers: Numbers) -> Vec<Quantity> {
    let mut quantities = Vec::new();
    for search in SEARCHES {
        for (what, number) in [("mean", &PREDICTION_ERROR_MEAN_M), ("median", &PREDICTION_ERROR_MEDIAN_M)] {
            quantities.push(Quantity {
                what: format!("{}: {what} error of a run, {}", case.name, search.name),
                term: case.term(search, SLOW, number),
                unit: None,
                published: None,
            });
        }
    }
    quantities.extend(lines(case, "error", numbers));
    quantities
}

fn charts(id: &str, (what, up): (&str, &'static str), numbers: Numbers) -> Vec<Chart> {
    let line = |case: Case, search: Search| ChartLine {
        name: search.name.to_owned(),
        points: instants(case, numbers)
            .map(|(time_s, number)| (Across::Setting(f64::from(time_s)), case.term(search, SLOW, number)))
            .collect(),
    };
    let chart = |case: Case| Chart {
        name: format!("{id}-{}", case.name.replace(' ', "-")),
        kind: ChartKind::Curves,
        title: format!("{what}, {}", case.name),
        note: "mean over the runs, with 95 % intervals; robots of 2 m/s".to_owned(),
        across: "time [s]",
        up,
        lines: SEARCHES.into_iter().map(|search| line(case, search)).collect(),
    };
    CASES.into_iter().map(chart).collect()
}

fn claims_of_prediction(case: Case) -> Vec<Claim> {
    let error = |search, number| case.term(search, SLOW, number);
    let mut claims = vec![Claim {
        text: format!("{}: the mean error of DeTarSK is less than that of P-G", case.name),
        published: Some(Published::new("\"does not have a prediction method\"", "section 6.4.1")),
        check: Check::Least([DETARSK, P_G].map(|search| error(search, &PREDICTION_ERROR_MEAN_M)).to_vec()),
    }];
    if case == CASES[1] {
        claims.push(Claim {
            text: format!("{}: the mean error of DeTarSK is less than 5 m", case.name),
            published: Some(Published::new("\"an error less than 5m\"", "section 6.4")),
            check: Check::Below(error(DETARSK, &PREDICTION_ERROR_MEAN_M), 5.0),
        });
    }
    claims
}

/// At an instant of all cases.
fn claim_of_distance(case: Case, numbers: Numbers) -> Claim {
    let (time_s, number) =
        instants(case, numbers).find(|(time_s, _)| *time_s == COMPARED_S).expect("it is one of the instants");
    Claim {
        text: format!("{}: after {time_s} s, DeTarSK is nearer to the target than P-G", case.name),
        published: Some(Published::new("\"compared to P-G algorithm\"", "section 6.4.1")),
        check: Check::Least([DETARSK, P_G].map(|search| case.term(search, SLOW, number)).to_vec()),
    }
}
