//! DMmTM against MmTM, DR-MDS and NTLDV-HOP (section 5.3.5).

use super::super::chart::Chart;
use super::super::claim::{Check, Claim};
use super::super::comparison_charts::{DISPLACEMENTS, comparison_charts};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use super::subject::{DR_MDS, HS_15, MMTM, NTLDV_HOP, SS_35, Subject, claim};
use super::swept::{MEAN, P95, THREE, WITHIN_1_M, ZERO};
use sextant::summary::measures::{distributed, map, run, time};
use sextant::summary::{MapSummary, Measure, Number};

const SECTION: &str = "section 5.3.5";

/// The maps that are compared.
const SUBJECTS: [&Subject; 5] = [&SS_35, &HS_15, &MMTM, &DR_MDS, &NTLDV_HOP];

const ERRORS: [(&str, &Number<MapSummary>); 5] = [
    ("mean distance error", MEAN),
    ("median distance error", &map::POSITION_ERROR_MEDIAN_M),
    ("95th percentile of the distance error", P95),
    ("nodes with an error of at most 1 m", WITHIN_1_M),
    ("nodes without a position", &map::UNMAPPED),
];

/// Means that differ by less than this are almost the same (m): a fifth of the distance of neighbouring nodes.
const ALMOST_M: f64 = 0.2;

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "5.11",
        title: "Comparison of DMmTM with MmTM, DR-MDS and NTLDV-HOP",
        content: Content::Quantities(Environment::ALL.into_iter().flat_map(quantities).collect()),
        distributions: &[],
        charts: Environment::ALL.into_iter().flat_map(charts).collect(),
        claims: Environment::ALL.into_iter().flat_map(claims).collect(),
        notes: &[
            "DMmTM-SS, DR-MDS and NTLDV-HOP have the same anchors, 35 % of the nodes; DMmTM-HS has 15 %, and a mobile anchor that \
             about 0.6 of the nodes hear. MmTM has the 3D path of chapter 4 in these rooms, and a robot with 16 sectors.",
            "The papers of DR-MDS and NTLDV-HOP were not available: both are reconstructed from what is known of them, with the true \
             path loss. Their neighbours and ranges come from neighbour discovery over the sectors of the nodes.",
            "\"Almost same\" is taken as less than 0.2 m apart, \"by a 5m distance error\" as 4 to 6 m, and less variance as a smaller \
             95th percentile. Errors are over the nodes with a position that the map had to estimate.",
            "The time is that of all messages, or of the robot's path; nodes and the computer compute in no time.",
        ],
    }
}

/// The time until the map is there, but for the computation.
fn time_s(subject: &Subject, environment: Environment) -> Term {
    let number = if subject.name == MMTM.name { &run::DURATION_S } else { &time::SIM_TIME_S };
    Term::new(subject.scenario(environment), Measure::OfRun(number))
}

fn quantities(environment: Environment) -> Vec<Quantity> {
    let mut quantities = Vec::new();
    for subject in SUBJECTS {
        let mut of = |what: &str, term: Term, published: Option<&str>| {
            quantities.push(Quantity {
                what: format!("{}: {what}, {}", environment.name(), subject.name),
                term,
                unit: None,
                published: published.map(|value| Published::new(value, SECTION)),
            });
        };
        for (what, number) in ERRORS {
            of(what, subject.term(environment, number), None);
        }
        for (sectors, number) in DISPLACEMENTS.into_iter().enumerate() {
            let published = match (sectors, subject.name) {
                (0, "DMmTM-SS") => Some("> 40"),
                (3, "DMmTM-SS") => Some("5"),
                (3, "DR-MDS" | "NTLDV-HOP") => Some("> 20"),
                _ => None,
            };
            of(
                &format!("nodes with a sector displacement of {sectors}"),
                subject.term(environment, number),
                published,
            );
        }
    }
    for subject in [&SS_35, &HS_15, &MMTM] {
        quantities.push(Quantity {
            what: format!("{}: time, {}", environment.name(), subject.name),
            term: time_s(subject, environment),
            unit: None,
            published: None,
        });
    }
    quantities.push(Quantity {
        what: format!("{}: N_R / N, {}", environment.name(), HS_15.name),
        term: HS_15.term(environment, &distributed::HEARD_SHARE),
        unit: None,
        published: Some(Published::new("60", SECTION)),
    });
    quantities
}

fn claims(environment: Environment) -> Vec<Claim> {
    let of = |subjects: &[&Subject], number| -> Vec<Term> {
        subjects.iter().map(|subject| subject.term(environment, number)).collect()
    };
    let claim = |text: &str, value: &str, check| claim(environment, text, (value, SECTION), check);
    let mut claims = vec![
        claim(
            "the mean distance errors of DMmTM-SS, DMmTM-HS and MmTM are less than 0.2 m apart",
            "\"almost same average distance error\"",
            Check::Within(of(&[&SS_35, &HS_15, &MMTM], MEAN), ALMOST_M),
        ),
        claim(
            "the 95th percentile of the error of MmTM is less than of DMmTM-SS and DMmTM-HS",
            "\"variance in MmTM is relatively less\"",
            Check::Least(of(&[&MMTM, &SS_35, &HS_15], P95)),
        ),
        claim(
            "MmTM takes more time than DMmTM-SS and DMmTM-HS",
            "\"requires more time\"",
            Check::Greatest([&MMTM, &SS_35, &HS_15].map(|subject| time_s(subject, environment)).to_vec()),
        ),
    ];
    for ours in [&SS_35, &HS_15] {
        for other in [&DR_MDS, &NTLDV_HOP] {
            let (name, than) = (ours.name, other.name);
            claims.push(claim(
                &format!("the mean distance error of {name} is less than that of {than}"),
                "\"outperformed\"",
                Check::Least(of(&[ours, other], MEAN)),
            ));
            let terms = [other, ours].map(|subject| subject.term(environment, MEAN));
            claims.push(claim(
                &format!("the mean distance error of {than} is 4 to 6 m larger than that of {name}"),
                "\"by a 5m distance error\"",
                Check::Difference(terms, 4.0..6.0),
            ));
        }
    }
    claims.extend([
        claim(
            "more nodes of DMmTM-HS have zero sector displacement than of DMmTM-SS",
            "\"high percentage\"",
            Check::Greatest(of(&[&HS_15, &SS_35], ZERO)),
        ),
        claim(
            "more nodes of MmTM have zero sector displacement than of DMmTM-SS and DMmTM-HS",
            "\"higher percentage\"",
            Check::Greatest(of(&[&MMTM, &SS_35, &HS_15], ZERO)),
        ),
        claim(
            "more than 40 % of the nodes of DMmTM-SS have zero sector displacement",
            "\"more than 40%\"",
            Check::Above(SS_35.term(environment, ZERO), 0.4),
        ),
        claim(
            "at most 5 % of the nodes of DMmTM-SS, rounded, have a sector displacement of three",
            "\"only 5%\"",
            Check::Below(SS_35.term(environment, THREE), 0.055),
        ),
    ]);
    for other in [&DR_MDS, &NTLDV_HOP] {
        claims.push(claim(
            &format!("more than 20 % of the nodes of {} have a sector displacement of three", other.name),
            "\"above 20%\"",
            Check::Above(other.term(environment, THREE), 0.2),
        ));
    }
    claims
}

/// The distribution of the errors, and the sector displacements.
fn charts(environment: Environment) -> [Chart; 2] {
    let names = ["cdf", "displacement"].map(|what| format!("5.11-{what}-{}", environment.name()));
    let maps = SUBJECTS.map(|subject| (subject.name.to_owned(), subject));
    comparison_charts(names, environment, &maps, |subject, number| subject.term(environment, number))
}
