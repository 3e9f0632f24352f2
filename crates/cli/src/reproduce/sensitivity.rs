//! Which trapezoid maps best in which environment.

use super::Runs;
use super::line::{Line, Ours};
use crate::figure::{Curves, Figure, Series};
use crate::summary::{Measure, measures};
use crate::sweep::Mean;

/// The sweep over environments, p0 and R.
pub(super) const SCENARIO: &str = "ml-tm/sensitivity.toml";

/// What is to be least.
const CONNECTIVITY_ERROR: Measure<'static> = Measure::OfMap("ml-tm", &measures::map::CONNECTIVITY_ERROR);

/// Radius of communication of the scenario [m].
const RADIUS_M: f64 = 10.0;

/// Name in the scenario, in words, and the published best p0 (at R/R_c = 1).
const ENVIRONMENTS: [(&str, &str, f64); 3] = [
    ("suburban", "suburban area", 0.95),
    ("heavy-tree", "heavy tree density", 0.9),
    ("light-tree", "light tree density", 0.9),
];

/// The connectivity error of one cell.
struct Point {
    environment: String,
    p0: f64,
    range_m: f64,
    error: Mean,
}

fn points(runs: &Runs) -> Vec<Point> {
    let Some(plan) = runs.plan(SCENARIO) else { return Vec::new() };
    let of = |cell: usize| {
        let values = plan.values(cell);
        let value = |end: &str| {
            let at = plan.keys().iter().position(|key| key.name.ends_with(end))?;
            Some(values[at].clone())
        };
        Some(Point {
            environment: value("environment")?,
            p0: value("p0")?.parse().ok()?,
            range_m: value("range_m")?.parse().ok()?,
            error: runs.mean(SCENARIO, cell, CONNECTIVITY_ERROR)?,
        })
    };
    (0..plan.cells().len()).filter_map(of).collect()
}

/// The best p0 and R of each environment, and how much is lost by the published ones.
pub(super) fn lines(runs: &Runs) -> Vec<Line> {
    let points = points(runs);
    let mut lines = Vec::new();
    for (environment, words, published_p0) in ENVIRONMENTS {
        let here: Vec<&Point> = points.iter().filter(|point| point.environment == environment).collect();
        let Some(best) = here.iter().min_by(|a, b| a.error.mean.total_cmp(&b.error.mean)) else { continue };
        let line = |what: &str, published: String, unit, ours| Line {
            what: format!("{words}: {what}"),
            published,
            unit,
            ours,
        };
        lines.push(line("best p0", format!("{published_p0}"), "", Ours::Text(format!("{}", best.p0))));
        lines.push(line("best R/R_c", "1".to_owned(), "", Ours::Text(format!("{}", best.range_m / RADIUS_M))));
        lines.push(line("E_total there", String::new(), "%", Ours::Mean(percent(best.error))));
        let is_published =
            |point: &&&Point| (point.p0 - published_p0).abs() < 1e-9 && (point.range_m - RADIUS_M).abs() < 1e-9;
        if let Some(point) = here.iter().find(is_published) {
            let what = format!("E_total at p0 {published_p0}, R/R_c 1");
            lines.push(line(&what, String::new(), "%", Ours::Mean(percent(point.error))));
        }
    }
    lines
}

fn percent(mean: Mean) -> Mean {
    Mean { mean: 100.0 * mean.mean, half_width_95: mean.half_width_95.map(|width| 100.0 * width), ..mean }
}

/// The connectivity error over p0, a curve for each R, in each environment.
pub(super) fn figures(runs: &Runs) -> Vec<Figure> {
    let points = points(runs);
    let figure = |&(environment, words, _): &(&str, &str, f64)| {
        let mut series: Vec<Series> = Vec::new();
        for point in points.iter().filter(|point| point.environment == environment) {
            let name = format!("R/R_c {}", point.range_m / RADIUS_M);
            let at = series.iter().position(|series| series.name == name).unwrap_or_else(|| {
                series.push(Series { name, points: Vec::new() });
                series.len() - 1
            });
            series[at].points.push((point.p0, 100.0 * point.error.mean));
        }
        Curves {
            title: format!("Sensitivity, {words}"),
            note: format!("mean of {} runs of the circular network", points.first().map_or(0, |p| p.error.runs)),
            across: "p0".to_owned(),
            up: "connectivity error [%]".to_owned(),
            series,
        }
        .figure(&format!("3.5-{environment}"))
    };
    if points.is_empty() { Vec::new() } else { ENVIRONMENTS.iter().map(figure).collect() }
}
