//! A number of a run, of one of its maps or of one of its applications.

use super::number::{Number, Unit};
use super::{application, distributed, map, node_errors, over_time, position_errors, run, scattering, time};
use crate::summary::{ApplicationSummary, MapSummary, Summary};

/// A number of a run, of one of its maps or of one of its applications.
#[derive(Clone, Copy, Debug)]
pub enum Measure<'a> {
    /// A number of the run as a whole.
    OfRun(&'static Number<Summary>),
    /// A number of the map of this name.
    OfMap(&'a str, &'static Number<MapSummary>),
    /// A number of the application of this name.
    OfApplication(&'a str, &'static Number<ApplicationSummary>),
}

/// What a run has numbers of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Subjects {
    /// Names of its maps.
    pub maps: Vec<String>,
    /// Names of those that nodes compute.
    pub by_nodes: Vec<String>,
    /// Names of its applications.
    pub applications: Vec<String>,
    /// Names of those that search targets.
    pub searches: Vec<String>,
}

impl Measure<'_> {
    /// Name of its column; a number of a map begins with the name of the map.
    #[must_use]
    pub fn column(&self) -> String {
        match self {
            Self::OfRun(number) => number.column.to_owned(),
            Self::OfMap(map, number) => format!("{map}.{}", number.column),
            Self::OfApplication(application, number) => format!("{application}.{}", number.column),
        }
    }

    /// Its unit in the column.
    #[must_use]
    pub fn unit(&self) -> Unit {
        match self {
            Self::OfRun(number) => number.unit,
            Self::OfMap(_, number) => number.unit,
            Self::OfApplication(_, number) => number.unit,
        }
    }

    /// Its value in `summary`; `None` if it does not apply.
    #[must_use]
    pub fn of(&self, summary: &Summary) -> Option<f64> {
        let value = match self {
            Self::OfRun(number) => (number.read)(summary),
            Self::OfMap(name, number) => {
                let is_named = |map: &&MapSummary| map.name.as_ref().unwrap_or(&map.algorithm) == name;
                summary.maps.iter().find(is_named).and_then(number.read)
            }
            Self::OfApplication(name, number) => {
                summary.applications.iter().find(|application| application.name == *name).and_then(number.read)
            }
        };
        value.filter(|value| value.is_finite())
    }
}

/// Measures are equal if their columns are.
impl PartialEq for Measure<'_> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::OfRun(a), Self::OfRun(b)) => a.column == b.column,
            (Self::OfMap(map_a, a), Self::OfMap(map_b, b)) => (map_a, a.column) == (map_b, b.column),
            (Self::OfApplication(of_a, a), Self::OfApplication(of_b, b)) => (of_a, a.column) == (of_b, b.column),
            _ => false,
        }
    }
}

/// All measures of a run with these subjects, in the order of their columns.
#[must_use]
pub fn all<'a>(subjects: &'a Subjects) -> Vec<Measure<'a>> {
    let Subjects { maps, by_nodes, applications, searches } = subjects;
    let of_nodes = if by_nodes.is_empty() { &[] } else { time::ALL };
    let of_run = run::ALL.iter().chain(of_nodes).map(|number| Measure::OfRun(number));
    let of_map = |map| {
        let own = if by_nodes.contains(map) { [distributed::ALL, scattering::ALL] } else { [&[][..]; 2] };
        let own = own.into_iter().flatten();
        let numbers = map::ALL.iter().chain(node_errors::ALL).chain(position_errors::ALL).chain(own);
        numbers.map(move |number| Measure::OfMap(map.as_str(), number))
    };
    let of_application = |name: &'a String| {
        let own = if searches.contains(name) { over_time::ALL } else { &[] };
        application::ALL.iter().chain(own).map(move |number| Measure::OfApplication(name.as_str(), number))
    };
    of_run.chain(maps.iter().flat_map(of_map)).chain(applications.iter().flat_map(of_application)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::{EnergySummary, ErrorSummary, GatheringSummary};

    #[test]
    fn a_measure_is_read_from_the_run_or_from_the_named_map() {
        let energy = EnergySummary { tx: 0.5, rx: 1.25, idle: 0.1 };
        let map = MapSummary {
            name: Some("fine".into()),
            algorithm: "ml-tm".into(),
            mapped: 7,
            position_error_m: Some(ErrorSummary { mean: 0.3, max: f64::NAN, ..ErrorSummary::default() }),
            ..MapSummary::default()
        };
        let gathering = GatheringSummary { stops: 12, energy_j: Some(energy), ..GatheringSummary::default() };
        let summary = Summary { gathering: Some(gathering), maps: vec![map], ..Summary::default() };
        for (measure, column, value) in [
            (Measure::OfRun(&run::STOPS), "stops", Some(12.0)),
            (Measure::OfRun(&run::ENERGY_RX_J), "energy_j.rx", Some(1.25)),
            (Measure::OfRun(&run::NODES), "nodes", None),
            (Measure::OfMap("fine", &map::MAPPED), "fine.mapped", Some(7.0)),
            (Measure::OfMap("fine", &map::POSITION_ERROR_MEAN_M), "fine.position_error_m.mean", Some(0.3)),
            (Measure::OfMap("fine", &map::POSITION_ERROR_MAX_M), "fine.position_error_m.max", None),
            (Measure::OfMap("fine", &map::CONNECTIVITY_ERROR), "fine.connectivity_error", None),
            (Measure::OfMap("ml-tm", &map::MAPPED), "ml-tm.mapped", None),
        ] {
            assert_eq!((measure.column(), measure.of(&summary)), (column.to_owned(), value));
        }
    }

    #[test]
    fn no_two_measures_share_a_column() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let subjects = Subjects {
            maps: names(&["ml-tm", "tpm"]),
            by_nodes: names(&["tpm"]),
            applications: names(&["detarsk", "p-g", "gradient"]),
            searches: names(&["detarsk", "p-g"]),
        };
        let mut columns: Vec<_> = all(&subjects).iter().map(Measure::column).collect();
        let count = columns.len();
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), count);
    }
}
