//! The best trapezoid in each environment (section 3.5.2, table 3.5).

use super::super::claim::{Check, Claim};
use super::super::experiment::{Content, Experiment};
use super::super::finding::Verdict;
use super::super::line::{Line, Ours};
use super::super::published::Published;
use super::super::runs::{Runs, Term};
use super::method::ML_TM;
use sextant::summary::measures::map;
use sextant::summary::{MapSummary, Number};
use sextant::sweep::Mean;
use sextant_figure::{Curves, Figure, Series};

const TABLE: &str = "table 3.5";

/// The sweep over environments, p0 and R.
const SCENARIO: &str = "ml-tm/sensitivity.toml";

/// The swept parameters of a reception profile: p0 in per cent, and R in tenths of the radius of communication.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Trapezoid {
    p0_percent: u32,
    range_tenths: u32,
}

/// The values in the sweep of the scenario. Its radius of communication is 10 m, so a tenth of it is 1 m.
const P0_PERCENT: [u32; 5] = [80, 85, 90, 95, 100];
const RANGES_TENTHS: [u32; 4] = [7, 8, 9, 10];

impl Trapezoid {
    fn p0(self) -> f64 {
        f64::from(self.p0_percent) / 100.0
    }

    /// R/R_c.
    fn range(self) -> f64 {
        f64::from(self.range_tenths) / 10.0
    }

    /// All combinations.
    fn all() -> impl Iterator<Item = Self> {
        P0_PERCENT
            .into_iter()
            .flat_map(|p0_percent| RANGES_TENTHS.map(|range_tenths| Self { p0_percent, range_tenths }))
    }
}

/// An environment, and its best trapezoid according to table 3.5.
struct Environment {
    name: &'static str,
    words: &'static str,
    best: Trapezoid,
}

const ENVIRONMENTS: [Environment; 3] = [
    Environment { name: "suburban", words: "suburban area", best: Trapezoid { p0_percent: 95, range_tenths: 10 } },
    Environment {
        name: "heavy-tree",
        words: "heavy tree density",
        best: Trapezoid { p0_percent: 90, range_tenths: 10 },
    },
    Environment {
        name: "light-tree",
        words: "light tree density",
        best: Trapezoid { p0_percent: 90, range_tenths: 10 },
    },
];

/// The connectivity error within the radius of communication, and within half of it.
const E_TOTALS: [(&str, &Number<MapSummary>); 2] =
    [("10 m", &map::CONNECTIVITY_ERROR_2), ("5 m", &map::CONNECTIVITY_ERROR)];

/// The connectivity error of a trapezoid in an environment.
fn term(environment: &Environment, trapezoid: Trapezoid, e_total: &'static Number<MapSummary>) -> Term {
    let range_m = f64::from(trapezoid.range_tenths);
    Term {
        scenario: SCENARIO,
        settings: vec![
            ("channel.environment", environment.name.to_owned()),
            ("maps.0.algorithm.ml_tm.profile.trapezoid.p0", format!("{:?}", trapezoid.p0())),
            ("maps.0.algorithm.ml_tm.profile.trapezoid.range_m", format!("{range_m:?}")),
        ],
        measure: ML_TM.measure(e_total),
    }
}

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "3.5",
        title: "Sensitivity to p0 and R in three environments",
        content: Content::Computed { scenarios: &[SCENARIO], lines, figures },
        distributions: &[],
        charts: Vec::new(),
        claims: ENVIRONMENTS.iter().flat_map(claims).collect(),
        notes: &[
            "The network of the sensitivity study in the thesis is lost; ours is the circular one.",
            "E_total counts neighbours within the radius of communication (section 3.3), which is 10 m in table 3.4. The \
             published values are compared with that radius; the other radius is ours.",
        ],
    }
}

/// The best p0 and R of each environment, and E_total with them and with the published ones.
fn lines(runs: &Runs) -> Vec<Line> {
    let best = |environment| {
        E_TOTALS.into_iter().flat_map(move |(radius, e_total)| best(runs, environment, radius, e_total))
    };
    ENVIRONMENTS.iter().flat_map(best).collect()
}

/// The trapezoid with the least `e_total` in an environment.
fn best(
    runs: &Runs,
    environment: &'static Environment,
    radius: &str,
    e_total: &'static Number<MapSummary>,
) -> Vec<Line> {
    let mean = |trapezoid| runs.mean(&term(environment, trapezoid, e_total));
    let means = Trapezoid::all().filter_map(|trapezoid| Some((trapezoid, mean(trapezoid)?.mean)));
    let Some((best, _)) = means.min_by(|(_, a), (_, b)| a.total_cmp(b)) else { return Vec::new() };
    let is_as_good = |other: &Trapezoid| {
        let check = Check::Least([best, *other].map(|at| term(environment, at, e_total)).to_vec());
        check.finding(runs).is_some_and(|finding| finding.verdict != Verdict::Holds)
    };
    let others = P0_PERCENT.map(|p0_percent| Trapezoid { p0_percent, ..best });
    let others = others.into_iter().filter(|other| *other != best);
    let as_good: Vec<_> = others.filter(is_as_good).map(|other| other.p0().to_string()).collect();
    let best_p0 = match as_good.as_slice() {
        [] => best.p0().to_string(),
        others => format!("{} (not significantly better than {})", best.p0(), others.join(", ")),
    };
    // The published error is for the radius of communication.
    let is_published = std::ptr::eq(e_total, E_TOTALS[0].1);
    let published = |value: f64| is_published.then(|| Published::new(value.to_string(), TABLE));
    let percent = |mean: Option<Mean>| mean.map_or(Ours::Missing, |mean| Ours::Mean(mean.times(100.0)));
    let line = |what: &str, published, unit, ours| Line {
        what: format!("{}: {what}, neighbourhood of {radius}", environment.words),
        published,
        unit,
        ours,
    };
    let said = environment.best;
    vec![
        line("best p0", published(said.p0()), "", Ours::Text(best_p0)),
        line("best R/R_c", published(said.range()), "", Ours::Text(best.range().to_string())),
        line("E_total at the best p0 and R/R_c", None, "%", percent(mean(best))),
        line(&format!("E_total at p0 {}, R/R_c {}", said.p0(), said.range()), None, "%", percent(mean(said))),
    ]
}

/// The conclusions of table 3.5 for an environment.
fn claims(environment: &'static Environment) -> [Claim; 2] {
    let best = environment.best;
    let (p0, range) = (best.p0(), best.range());
    let claim = |text: String, value: String, others: Vec<Trapezoid>| {
        let trapezoids = [best].into_iter().chain(others.into_iter().filter(|other| *other != best));
        Claim {
            text: format!("{}: {text} has the least E_total within 10 m", environment.words),
            published: Some(Published::new(value, TABLE)),
            check: Check::Least(trapezoids.map(|at| term(environment, at, E_TOTALS[0].1)).collect()),
        }
    };
    let other_p0 = P0_PERCENT.map(|p0_percent| Trapezoid { p0_percent, ..best });
    let other_ranges = RANGES_TENTHS.map(|range_tenths| Trapezoid { range_tenths, ..best });
    [
        claim(format!("p0 {p0} at R/R_c {range}"), format!("p0 {p0}"), other_p0.to_vec()),
        claim(format!("R/R_c {range} at p0 {p0}"), format!("R/R_c {range}"), other_ranges.to_vec()),
    ]
}

/// The connectivity error over p0 in each environment, with a curve for each R.
fn figures(runs: &Runs) -> Vec<Figure> {
    let (radius, e_total) = E_TOTALS[0];
    let figure = |environment: &Environment| {
        let mean = |trapezoid| runs.mean(&term(environment, trapezoid, e_total));
        let curve = |range_tenths| {
            let at = |p0_percent| Trapezoid { p0_percent, range_tenths };
            let point = |p0_percent| Some((at(p0_percent).p0(), 100.0 * mean(at(p0_percent))?.mean));
            let points = P0_PERCENT.into_iter().filter_map(point).collect();
            Series { name: format!("R/R_c {}", at(100).range()), points, half_widths: Vec::new() }
        };
        let count = mean(environment.best).map_or(0, |mean| mean.runs);
        Curves {
            title: format!("Sensitivity, {}", environment.words),
            note: format!("neighbourhood of {radius}; mean of {count} runs of the circular network"),
            across: "p0".to_owned(),
            up: "connectivity error [%]".to_owned(),
            series: RANGES_TENTHS.map(curve).to_vec(),
        }
        .figure(&format!("3.5-{}", environment.name))
    };
    ENVIRONMENTS.iter().map(figure).collect()
}
