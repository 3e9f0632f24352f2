//! A number of a run, of one of its maps or of one of its applications.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::known;
use super::unit::Unit;

/// A number of a run, of one of its maps or of one of its applications, by its path in the summary:
/// `gathering.path_length_m`, `maps.ml-tm.position_error_m.mean`, `applications.detarsk.time_s`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measure {
    of: Of,
    path: String,
    unit: Unit,
}

/// What a number is of; a map and an application have a name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Of {
    Run,
    Map(String),
    Application(String),
}

/// There is no measure of this path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no measure `{0}`; measures are for example `gathering.stops`, `maps.NAME.mapped`, `applications.NAME.time_s`"
)]
pub struct UnknownMeasure(String);

/// What a run has numbers of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

impl Subjects {
    /// Adds the names of others that are new, in their order.
    pub(crate) fn extend(&mut self, others: &Self) {
        let Self { maps, by_nodes, applications, searches } = self;
        for (list, names) in [
            (maps, &others.maps),
            (by_nodes, &others.by_nodes),
            (applications, &others.applications),
            (searches, &others.searches),
        ] {
            for name in names {
                if !list.contains(name) {
                    list.push(name.clone());
                }
            }
        }
    }
}

impl Measure {
    /// Name of its column: its path, without `simulation` and `gathering`, and without the word `maps` or `applications`.
    #[must_use]
    pub fn column(&self) -> String {
        let path = &self.path;
        match &self.of {
            Of::Run => ["simulation.", "gathering."]
                .iter()
                .find_map(|group| path.strip_prefix(group))
                .unwrap_or(path)
                .to_owned(),
            Of::Map(name) | Of::Application(name) => format!("{name}.{path}"),
        }
    }

    /// Its path in the summary.
    #[must_use]
    pub fn path(&self) -> String {
        let path = &self.path;
        match &self.of {
            Of::Run => path.clone(),
            Of::Map(name) => format!("maps.{name}.{path}"),
            Of::Application(name) => format!("applications.{name}.{path}"),
        }
    }

    /// Its unit in the column.
    #[must_use]
    pub fn unit(&self) -> Unit {
        self.unit
    }

    pub(super) fn of(&self) -> &Of {
        &self.of
    }

    /// Its path in the run, the map or the application.
    pub(super) fn path_within(&self) -> &str {
        &self.path
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(path: &str) -> Result<Self, UnknownMeasure> {
        let of_run = || {
            let (found, unit) = known::of_run(true).find(|(known, _)| *known == path)?;
            Some(Self { of: Of::Run, path: found.to_owned(), unit })
        };
        let found = match path.split_once('.') {
            Some(("maps", rest)) => named(rest, Of::Map, || known::of_map(true)),
            Some(("applications", rest)) => named(rest, Of::Application, || known::of_application(true)),
            _ => of_run(),
        };
        found.ok_or_else(|| UnknownMeasure(path.to_owned()))
    }
}

/// The measure whose path is a name, then one of `known`. A name may have dots.
fn named<I: Iterator<Item = (&'static str, Unit)>>(
    path: &str,
    of: fn(String) -> Of,
    known: impl Fn() -> I,
) -> Option<Measure> {
    path.match_indices('.').find_map(|(dot, _)| {
        let (name, rest) = (&path[..dot], &path[dot + 1..]);
        let (found, unit) = known().find(|(known, _)| *known == rest)?;
        Some(Measure { of: of(name.to_owned()), path: found.to_owned(), unit })
    })
}

/// All measures of a run with these subjects, in the order of their columns.
#[must_use]
pub fn all(subjects: &Subjects) -> Vec<Measure> {
    let Subjects { maps, by_nodes, applications, searches } = subjects;
    let measure = |of: Of, (path, unit): (&str, Unit)| Measure { of, path: path.to_owned(), unit };
    let mut measures: Vec<_> = known::of_run(!by_nodes.is_empty()).map(|number| measure(Of::Run, number)).collect();
    for map in maps {
        let numbers = known::of_map(by_nodes.contains(map));
        measures.extend(numbers.map(|number| measure(Of::Map(map.clone()), number)));
    }
    for name in applications {
        let numbers = known::of_application(searches.contains(name));
        measures.extend(numbers.map(|number| measure(Of::Application(name.clone()), number)));
    }
    measures
}

#[cfg(test)]
mod tests {
    use super::super::numbers::Numbers;
    use super::*;
    use crate::summary::{
        ApplicationSummary, DistributedSummary, EnergySummary, ErrorSummary, GatheringSummary, MapSummary, Summary,
    };

    #[test]
    fn a_measure_is_read_from_the_run_or_from_the_named_map() {
        let energy = EnergySummary { tx: 0.5, rx: 1.25, idle: 0.1 };
        let work = DistributedSummary {
            converged: true,
            unplaced: vec!["a".into(), "b".into()],
            ..DistributedSummary::default()
        };
        let map = MapSummary {
            name: Some("fine".into()),
            algorithm: "ml-tm".into(),
            mapped: 7,
            position_error_m: Some(ErrorSummary { mean: 0.3, max: f64::NAN, ..ErrorSummary::default() }),
            sector_displacement: vec![0.6, 0.4],
            distributed: Some(work),
            ..MapSummary::default()
        };
        let gathering = GatheringSummary { stops: 12, energy_j: Some(energy), ..GatheringSummary::default() };
        let search =
            ApplicationSummary { name: "p-g".into(), captured: Some(false), ..ApplicationSummary::default() };
        let (maps, applications) = (vec![map], vec![search]);
        let summary = Summary { gathering: Some(gathering), maps, applications, ..Summary::default() };
        let numbers = Numbers::of(&summary);
        for (path, column, value) in [
            ("gathering.stops", "stops", Some(12.0)),
            ("gathering.energy_j.rx", "energy_j.rx", Some(1.25)),
            ("simulation.nodes", "nodes", None),
            ("mac.prr", "mac.prr", None),
            ("maps.fine.mapped", "fine.mapped", Some(7.0)),
            ("maps.fine.position_error_m.mean", "fine.position_error_m.mean", Some(0.3)),
            ("maps.fine.position_error_m.max", "fine.position_error_m.max", None),
            ("maps.fine.connectivity_error", "fine.connectivity_error", None),
            ("maps.fine.sector_displacement.1", "fine.sector_displacement.1", Some(0.4)),
            ("maps.fine.sector_displacement.2", "fine.sector_displacement.2", None),
            ("maps.fine.distributed.converged", "fine.distributed.converged", Some(1.0)),
            ("maps.fine.distributed.unplaced", "fine.distributed.unplaced", Some(2.0)),
            ("maps.ml-tm.mapped", "ml-tm.mapped", None),
            ("applications.p-g.captured", "p-g.captured", Some(0.0)),
            ("applications.p-g.captures", "p-g.captures", Some(0.0)),
            ("applications.p-g.arrivals", "p-g.arrivals", None),
        ] {
            let measure: Measure = path.parse().unwrap();
            assert_eq!((measure.path(), measure.column()), (path.to_owned(), column.to_owned()));
            assert_eq!(numbers.get(&measure), value, "{path}");
        }
    }

    #[test]
    fn a_path_that_leads_nowhere_is_rejected() {
        for path in ["stops", "gathering", "maps.mapped", "maps.fine.maped", "applications.p-g", "maps..", ""] {
            let error = path.parse::<Measure>().unwrap_err().to_string();
            assert!(error.contains(&format!("`{path}`")), "{error}");
        }
        let of_dots: Measure = "maps.fine.2.mapped".parse().unwrap();
        assert_eq!(of_dots.column(), "fine.2.mapped");
    }

    #[test]
    fn no_two_measures_share_a_column_and_each_is_found_by_its_path() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let subjects = Subjects {
            maps: names(&["ml-tm", "tpm"]),
            by_nodes: names(&["tpm"]),
            applications: names(&["detarsk", "p-g", "gradient"]),
            searches: names(&["detarsk", "p-g"]),
        };
        let measures = all(&subjects);
        for measure in &measures {
            assert_eq!(&measure.path().parse::<Measure>().unwrap(), measure);
        }
        let mut columns: Vec<_> = measures.iter().map(Measure::column).collect();
        let count = columns.len();
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), count);
    }
}
