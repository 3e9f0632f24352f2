//! The worked example of the thesis: the likelihood of one node at four vertices, from the printed distances.

use sextant_mapper::{Trapezoid, TrapezoidConfig};

use super::super::experiment::{Content, Experiment};
use super::super::line::{Line, Ours};
use super::super::published::Published;
use super::super::runs::Runs;

/// The stop at which node p was heard, of six stops.
const HEARD: usize = 2;

/// Vertices with their printed distances to the six stops (m), and the printed likelihood.
const PRINTED: [(&str, [f64; 6], &str); 4] = [
    // The distance to the first stop is printed as 0. At this distance a sent packet would always be received.
    ("(0, 0)", [0.0, 1.44, 2.64, 3.78, 4.68, 6.02], "0"),
    ("(1, 1)", [1.41, 0.36, 1.36, 2.42, 3.2, 4.6], "0.0325"),
    ("(1, 3)", [3.16, 1.81, 0.76, 1.3, 2.5, 3.64], "0.3708"),
    ("(4, 2)", [4.4, 3.2, 2.72, 1.97, 1.21, 2.06], "0"),
];

pub(super) fn experiment() -> Experiment {
    Experiment {
        id: "3.2",
        title: "Worked example: the likelihood of a node at four vertices",
        content: Content::Computed { scenarios: &[], lines, figures: |_| Vec::new() },
        distributions: &[],
        charts: Vec::new(),
        claims: Vec::new(),
        notes: &["The printed factors follow from r = 0.1 m; the text says r = 0.2 m."],
    }
}

/// The likelihoods for p0 = 1, R = 2 m and r = 0.1 m, which agree with the printed factors; the text says r = 0.2 m.
fn lines(_: &Runs) -> Vec<Line> {
    let profile = Trapezoid::try_from(TrapezoidConfig::new(1.0, 0.1, 2.0).literal());
    let likelihood = |distances_m: &[f64; 6]| {
        let profile = profile.as_ref().ok()?;
        let factor = |(stop, &distance_m): (usize, &f64)| {
            let s = profile.probability(distance_m);
            if stop == HEARD { s } else { 1.0 - s }
        };
        Some(distances_m.iter().enumerate().map(factor).product::<f64>())
    };
    PRINTED
        .iter()
        .map(|(vertex, distances_m, published)| Line {
            what: format!("P of node p at {vertex}"),
            published: Some(Published::new(*published, "table 3.2")),
            unit: "",
            ours: likelihood(distances_m).map_or(Ours::Missing, Ours::Exact),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_likelihoods_are_reproduced_within_rounding() {
        let runs = Runs::new(std::path::PathBuf::new(), std::num::NonZeroU32::MIN);
        for line in lines(&runs) {
            let Ours::Exact(ours) = line.ours else { panic!("no likelihood for {}", line.what) };
            let published: f64 = line.published.unwrap().value.parse().unwrap();
            assert!((ours - published).abs() < 2e-3, "{}: {ours} for the printed {published}", line.what);
        }
    }
}
