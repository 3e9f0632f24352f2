//! The error of neighbour scattering, E_NS, as a sign of the distance error (section 5.2.1).

use super::super::chart::{Across, Chart, ChartKind, ChartLine};
use super::super::claim::{Check, Claim};
use super::super::environment::Environment;
use super::super::experiment::{Content, Experiment};
use super::super::line::{Line, Ours};
use super::super::published::Published;
use super::super::runs::{Runs, Term};
use super::subject::{FIRST, SHARE, claim};
use sextant::summary::measures::scattering;
use sextant::summary::{MapSummary, Number};

const SECTION: &str = "section 5.2.1";

/// The values in the sweeps of the scenarios.
const SHARES: [&str; 2] = ["0.05", "0.15"];

const SCENARIOS: &[&str] = &["dmtm/scattering-warehouse.toml", "dmtm/scattering-greenhouse.toml"];

/// An environment with a share of initial anchors.
#[derive(Clone, Copy)]
struct Network {
    environment: Environment,
    share: &'static str,
}

impl Network {
    fn all() -> impl Iterator<Item = Self> {
        let with = |environment| SHARES.into_iter().map(move |share| Self { environment, share });
        Environment::ALL.into_iter().flat_map(with)
    }

    fn name(self) -> String {
        format!("{}, {SHARE} = {}", self.environment.name(), self.share)
    }

    fn term(self, number: &'static Number<MapSummary>) -> Term {
        FIRST.at(self.environment, (SHARE, self.share), number)
    }
}

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "5.3",
        title: "Error of neighbour scattering E_NS against the distance error of the first places",
        content: Content::Computed { scenarios: SCENARIOS, lines, figures: |_| Vec::new() },
        distributions: &[],
        charts: vec![
            chart("5.3-mean", "mean distance error [m]", &scattering::MEANS_M),
            chart("5.3-p90", "90th percentile of the distance error [m]", &scattering::P90S_M),
        ],
        claims: Network::all().flat_map(claims).collect(),
        notes: &[
            "E_NS of a node is the share of its neighbours that lie farther than 7 m away by the coordinates. It is that of the first \
             coordinates, before any is computed again, as in the thesis, which does not say how many anchors it had.",
            "The thesis shows each node. Here the mean and the 90th percentile are compared with its limits. Bins have their upper edge, \
             the first one 0 too; bins without nodes are not listed.",
        ],
    }
}

fn claims(network: Network) -> [Claim; 4] {
    let Network { environment, share } = network;
    let of =
        |text: &str, value, check| claim(environment, &format!("{text}, {SHARE} = {share}"), (value, SECTION), check);
    let below = |number, limit_m| Check::Below(network.term(number), limit_m);
    let (half, one) = ("\"less than 0.5m\"", "\"less than 1m\"");
    [
        of(
            "the mean error where E_NS is at most 0.1 is below 0.5 m",
            half,
            below(&scattering::MEAN_UP_TO_0_1_M, 0.5),
        ),
        of(
            "nine in ten errors where E_NS is at most 0.05 are below 0.5 m",
            half,
            below(&scattering::P90_0_05_M, 0.5),
        ),
        of("the mean error where E_NS is at most 0.2 is below 1 m", one, below(&scattering::MEAN_UP_TO_0_2_M, 1.0)),
        of("nine in ten errors where E_NS is at most 0.05 are below 1 m", one, below(&scattering::P90_0_05_M, 1.0)),
    ]
}

/// Lines of the shares and errors up to the limits, and of each bin that has nodes.
fn lines(runs: &Runs) -> Vec<Line> {
    let mut lines = Vec::new();
    for network in Network::all() {
        let mut line = |what: &str, number, published: Option<&str>| {
            let term = network.term(number);
            let (factor, unit) = term.measure.unit().for_people();
            let ours = runs.mean(&term).map(|mean| Ours::Mean(mean.times(factor)));
            lines.push((
                ours.is_some(),
                Line {
                    what: format!("{}: {what}", network.name()),
                    published: published.map(|value| Published::new(value, SECTION)),
                    unit,
                    ours: ours.unwrap_or(Ours::Missing),
                },
            ));
        };
        line("nodes with E_NS of at most 0.1", &scattering::SHARE_UP_TO_0_1, None);
        line("mean error, E_NS of at most 0.1", &scattering::MEAN_UP_TO_0_1_M, Some("< 0.5"));
        line("nodes with E_NS of at most 0.2", &scattering::SHARE_UP_TO_0_2, None);
        line("mean error, E_NS of at most 0.2", &scattering::MEAN_UP_TO_0_2_M, Some("< 1"));
        for (edge, (mean, p90)) in
            scattering::EDGES.into_iter().zip(scattering::MEANS_M.into_iter().zip(scattering::P90S_M))
        {
            let limit = match edge {
                ..0.11 => Some("< 0.5"),
                ..0.21 => Some("< 1"),
                _ => None,
            };
            line(&format!("mean error, E_NS {:.2} to {edge:.2}", edge - 0.05), mean, limit);
            line(&format!("90th percentile of the error, E_NS {:.2} to {edge:.2}", edge - 0.05), p90, limit);
        }
    }
    // Of no run in which all failed is anything told; else the bins without nodes are left out.
    let any = lines.iter().any(|(is_there, _)| *is_there);
    lines.into_iter().filter(|(is_there, _)| *is_there || !any).map(|(_, line)| line).collect()
}

/// Errors over the bins, with a curve for each network.
fn chart(name: &str, up: &'static str, numbers: &[&'static Number<MapSummary>]) -> Chart {
    let line = |network: Network| {
        let points = scattering::EDGES.into_iter().zip(numbers);
        let points = points.map(|(edge, number)| (Across::Setting(edge), network.term(number)));
        ChartLine { name: network.name(), points: points.collect() }
    };
    Chart {
        name: name.to_owned(),
        kind: ChartKind::Curves,
        title: "First places: error of neighbour scattering and distance error".to_owned(),
        note: "mean over the runs, with 95 % intervals".to_owned(),
        across: "error of neighbour scattering E_NS, upper edge of the bin",
        up,
        lines: Network::all().map(line).collect(),
    }
}
