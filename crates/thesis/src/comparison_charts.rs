//! Figures that compare maps of an environment: the distribution of the errors, and the sector displacements.

use super::chart::{Across, Chart, ChartKind, ChartLine};
use super::environment::Environment;
use super::runs::Term;
use sextant::summary::measures::{map, position_errors};
use sextant::summary::{MapSummary, Number, POSITION_ERRORS_M};

/// Shares of the nodes with a sector displacement of 0, 1, .. sectors.
pub(super) const DISPLACEMENTS: [&Number<MapSummary>; 5] = [
    &map::SECTOR_DISPLACEMENT_0,
    &map::SECTOR_DISPLACEMENT_1,
    &map::SECTOR_DISPLACEMENT_2,
    &map::SECTOR_DISPLACEMENT_3,
    &map::SECTOR_DISPLACEMENT_4,
];

/// The figures, in files with these names, of `maps` with their names; `term` gives a number of a map.
pub(super) fn comparison_charts<M>(
    [cdf, displacement]: [String; 2],
    environment: Environment,
    maps: &[(String, M)],
    term: impl Fn(&M, &'static Number<MapSummary>) -> Term,
) -> [Chart; 2] {
    let line = |(name, map): &(String, M), across: Vec<Across>, numbers: &[&'static Number<MapSummary>]| {
        let terms = numbers.iter().map(|number| term(map, number));
        ChartLine { name: name.clone(), points: across.into_iter().zip(terms).collect() }
    };
    let limits = || POSITION_ERRORS_M.iter().map(|limit_m| Across::Setting(limit_m.log10())).collect();
    let sectors = || (0_u8..5).map(|sectors| Across::Setting(f64::from(sectors))).collect();
    [
        Chart {
            name: cdf,
            kind: ChartKind::Distribution,
            title: format!("Distance errors in the {}", environment.name()),
            note: "share of the nodes with at most this error; mean over the runs".to_owned(),
            across: "logarithm (base 10) of the distance error in metres",
            up: "share of the nodes [%]",
            lines: maps.iter().map(|map| line(map, limits(), position_errors::ALL)).collect(),
        },
        Chart {
            name: displacement,
            kind: ChartKind::Bars,
            title: format!("Sector displacement in the {}", environment.name()),
            note: "mean over the runs, with 95 % intervals".to_owned(),
            across: "sector displacement of a node [sectors]",
            up: "share of the nodes [%]",
            lines: maps.iter().map(|map| line(map, sectors(), &DISPLACEMENTS)).collect(),
        },
    ]
}
