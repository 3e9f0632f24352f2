//! Four paths of the robot through one network (section 3.4, table 3.3).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment, Quantity};
use super::super::published::Published;
use super::super::runs::Term;
use super::method::ML_TM;
use sextant::summary::Measure;
use sextant::summary::measures::{map, run};

const TABLE: &str = "table 3.3";
const SECTION: &str = "section 3.4";

/// A path and its published values (table 3.3).
struct Trajectory {
    name: &'static str,
    scenario: &'static str,
    e_total_percent: &'static str,
    time_s: &'static str,
}

const RANDOM: Trajectory = Trajectory {
    name: "random walk",
    scenario: "ml-tm/trajectory-random.toml",
    e_total_percent: "7",
    time_s: "128 ± 20",
};
const SPIRAL: Trajectory =
    Trajectory { name: "spiral", scenario: "ml-tm/trajectory-spiral.toml", e_total_percent: "6", time_s: "133" };
const S: Trajectory =
    Trajectory { name: "S", scenario: "ml-tm/trajectory-s.toml", e_total_percent: "6", time_s: "130" };
const HILBERT: Trajectory = Trajectory {
    name: "Hilbert curve",
    scenario: "ml-tm/trajectory-hilbert.toml",
    e_total_percent: "5",
    time_s: "256",
};

/// In the order of the table.
const TRAJECTORIES: [&Trajectory; 4] = [&RANDOM, &SPIRAL, &S, &HILBERT];

const LENGTH: Measure<'static> = Measure::OfRun(&run::PATH_LENGTH_M);
const E_TOTAL: Measure<'static> = ML_TM.measure(&map::CONNECTIVITY_ERROR);

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "3.3",
        title: "Four paths of the robot",
        content: Content::Quantities(TRAJECTORIES.into_iter().flat_map(quantities).collect()),
        distributions: &[],
        charts: Vec::new(),
        claims: claims(),
        notes: &[
            "100 nodes at random in 10 m x 10 m. The radius of communication is 3 m, which is also the neighbourhood of \
             E_total. The thesis gives neither the distance of lanes nor the length of steps: both are 1 m here.",
            "The table gives the lengths of paths in seconds, without a speed; section 3.5.3 has 1 m/s.",
            "The random walk takes a new direction at each step, and ends when each node was heard five times.",
        ],
    }
}

fn quantities(trajectory: &Trajectory) -> [Quantity; 3] {
    let &Trajectory { name, scenario, e_total_percent, time_s } = trajectory;
    let e_total = format!("{name}: E_total, neighbourhood of 3 m");
    [
        Quantity::new(e_total, scenario, E_TOTAL).published(e_total_percent, TABLE),
        Quantity::new(format!("{name}: time of driving at 1 m/s"), scenario, LENGTH)
            .in_unit("s")
            .published(time_s, TABLE),
        Quantity::new(format!("{name}: mean position error"), scenario, ML_TM.measure(&map::POSITION_ERROR_MEAN_M)),
    ]
}

fn claims() -> Vec<Claim> {
    let terms = |of: &[&Trajectory], measure| of.iter().map(|one| Term::new(one.scenario, measure)).collect();
    let [s, hilbert] = [&S, &HILBERT].map(|one| Term::new(one.scenario, LENGTH));
    let claim = |text: &str, value: &str, source, check| Claim {
        text: text.to_owned(),
        published: Some(Published::new(value, source)),
        check,
    };
    vec![
        claim(
            "E_total of the four paths is less than 3 points apart",
            "5 to 7 %, \"nearly same\"",
            SECTION,
            Check::Within(terms(&TRAJECTORIES, E_TOTAL), 0.03),
        ),
        claim(
            "E_total of S and spiral is less than a point apart",
            "6 and 6 %, \"almost same\"",
            SECTION,
            Check::Within(terms(&[&S, &SPIRAL], E_TOTAL), 0.01),
        ),
        claim(
            "the Hilbert curve has the least E_total of the four",
            "5 % against 7, 6, 6 %",
            TABLE,
            Check::Least(terms(&[&HILBERT, &RANDOM, &SPIRAL, &S], E_TOTAL)),
        ),
        claim(
            "the Hilbert curve is the longest of the four",
            "256 s against 128 ± 20, 133, 130 s",
            SECTION,
            Check::Greatest(terms(&[&HILBERT, &RANDOM, &SPIRAL, &S], LENGTH)),
        ),
        claim(
            "the Hilbert curve is 1.75 to 2.25 times as long as the S",
            "256 s against 130 s",
            TABLE,
            Check::Ratio([hilbert, s], 1.75..2.25),
        ),
        claim(
            "the S is shorter than the spiral",
            "130 s against 133 s",
            SECTION,
            Check::Least(terms(&[&S, &SPIRAL], LENGTH)),
        ),
    ]
}
