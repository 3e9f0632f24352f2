//! The time until the target is captured (table 6.1).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::subject::{CASES, Case, DETARSK, FAST, P_G, SEARCHES, SLOW, Search, THESIS, in_words};
use sextant::summary::measures::application::{CAPTURED, SIM_TIME_S, TIME_S};

const TABLE: &str = "table 6.1";
const SECTION: &str = "section 6.4.1";

/// Published times (s) of DeTarSK at 2 m/s and at 3 m/s, and of P-G at 3 m/s, by case.
const TIMES_S: [[&str; 3]; 3] = [["70", "47", "79"], ["80", "52", "76"], ["29", "18", "35"]];

/// Share of the runs that stands for "captures", and less than its complement for "never".
const MOST: f64 = 0.8;

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "6.1",
        title: "Time to capture the target, with robots of 2 and 3 m/s and a target of 1.5 m/s",
        content: Content::Quantities((0..CASES.len()).flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: CASES.into_iter().flat_map(claims).collect(),
        notes: &[
            "The thesis has one run of each case; its way of the target is only in its pictures. Ours is another one with each seed \
             (1, 2, ..), with the places and times of entering and leaving that the thesis states. The same seed is the same way \
             for all searches and speeds.",
            "The time is over the captured runs alone, so that a search that captures early or not at all looks quick. The time until \
             the capture or the end counts a run without a capture as 82, 84 or 44 s, when the target leaves. Conclusions about \
             times compare it.",
            "A robot captures a target within 1 m. The radius of detection (1.5 m), the layout of the sparse network and the powers of \
             the radios are ours: the thesis does not state them. P-G has the true places in both; here DeTarSK has them too. \
             What maps cost is in 6.maps.",
            "\"Captures\" is taken as in more than 80 % of the runs, and \"unable to capture\" as in less than 20 %. These intervals are \
             those of a share (Clopper and Pearson, 1934), and a margin is from the middle of the interval: 80 % takes 17 runs and more.",
        ],
    }
}

/// The published time of a search in the case with this index.
fn published_s(case: usize, search: Search, speed: &str) -> Option<&'static str> {
    let [slow, fast, of_p_g] = TIMES_S[case];
    match (search, speed) {
        (DETARSK | THESIS, SLOW) => Some(slow),
        (DETARSK | THESIS, FAST) => Some(fast),
        (P_G, FAST) => Some(of_p_g),
        _ => None,
    }
}

fn quantities(index: usize) -> Vec<Quantity> {
    let case = CASES[index];
    let mut quantities = Vec::new();
    for speed in [SLOW, FAST] {
        for search in SEARCHES {
            let mut of = |what: &str, number, published: Option<Published>| {
                quantities.push(Quantity {
                    what: format!("{}, {}: {what}, {}", case.name, in_words(speed), search.name),
                    term: case.term(search, speed, number),
                    unit: None,
                    published,
                });
            };
            let time_s = published_s(index, search, speed);
            let never = time_s.is_none().then(|| Published::new("0", TABLE));
            of("runs with a capture", &CAPTURED, never);
            of("time", &TIME_S, time_s.map(|time_s| Published::new(time_s, TABLE)));
            of("time until the capture or the end", &SIM_TIME_S, None);
        }
    }
    quantities
}

fn claims(case: Case) -> Vec<Claim> {
    let claim = |text: String, (value, source): (&str, &'static str), check| Claim {
        text: format!("{}: {text}", case.name),
        published: Some(Published::new(value, source)),
        check,
    };
    let mut claims = Vec::new();
    for search in [DETARSK, THESIS] {
        let name = search.name;
        let slow = || case.term(search, SLOW, &SIM_TIME_S);
        claims.extend([
            claim(
                format!("{name} captures at 2 m/s"),
                ("a time", TABLE),
                Check::Above(case.term(search, SLOW, &CAPTURED), MOST),
            ),
            claim(
                format!("{name} at 2 m/s is sooner than P-G at 3 m/s"),
                ("\"less time and lower speed\"", SECTION),
                Check::Least(vec![slow(), case.term(P_G, FAST, &SIM_TIME_S)]),
            ),
            claim(
                format!("{name} is sooner than P-G, both at 2 m/s"),
                ("\"much faster\"", SECTION),
                Check::Least(vec![slow(), case.term(P_G, SLOW, &SIM_TIME_S)]),
            ),
        ]);
    }
    claims.push(claim(
        "P-G does not capture at 2 m/s".to_owned(),
        ("\"unable to capture\"", SECTION),
        Check::Below(case.term(P_G, SLOW, &CAPTURED), 1.0 - MOST),
    ));
    claims
}
