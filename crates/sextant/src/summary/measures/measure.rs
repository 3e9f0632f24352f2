//! A number of a run, of one of its networks, of one of its maps or of one of its applications.

use std::str::FromStr;

use super::known::{self, KnownMeasure};
use super::subjects::{Feature, Subjects};
use super::unit::Unit;

/// A number of a run, of one of its maps or of one of its applications, by its path in the summary:
/// `gathering.path_length_m`, `maps.ml-tm.position_error_m.mean`, `applications.detarsk.time_s`; or of one of several networks, by
/// the name of that in place of `mac`: `networks.fast.prr`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measure {
    of: Of,
    known: KnownMeasure<'static>,
}

/// What a number is of; one of several networks, a map and an application have a name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Of {
    Run,
    Network(String),
    Map(String),
    Mission(String),
}

/// There is no measure of this path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no measure `{0}`; measures are for example `gathering.stops`, `maps.NAME.mapped`, `applications.NAME.time_s`"
)]
pub struct UnknownMeasure(String);

impl Measure {
    /// Name of its column in the table of a sweep. That of a number of a run is its path without `simulation` and
    /// `gathering`, that of a map is its path in the map, and that of an application is its path.
    #[must_use]
    pub fn column(&self) -> String {
        let path = self.known.path;
        match &self.of {
            Of::Run => of_run_shortened(path).to_owned(),
            Of::Map(_) => path.to_owned(),
            Of::Network(_) | Of::Mission(_) => self.path(),
        }
    }

    /// Its name among all measures of a run: its path, without `simulation` and `gathering`, and without the word `maps` or
    /// `applications`.
    #[must_use]
    pub fn name(&self) -> String {
        let path = self.known.path;
        match &self.of {
            Of::Run => of_run_shortened(path).to_owned(),
            Of::Network(_) => self.path(),
            Of::Map(name) | Of::Mission(name) => format!("{name}.{path}"),
        }
    }

    /// Its path in the summary; of one of several networks, the name of that stands for `mac`.
    #[must_use]
    pub fn path(&self) -> String {
        let path = self.known.path;
        match &self.of {
            Of::Run => path.to_owned(),
            Of::Network(name) => format!("networks.{name}.{path}"),
            Of::Map(name) => format!("maps.{name}.{path}"),
            Of::Mission(name) => format!("applications.{name}.{path}"),
        }
    }

    /// Its unit in the column.
    #[must_use]
    pub fn unit(&self) -> Unit {
        self.known.unit
    }

    /// What it is: a name, and after a colon a definition if the name needs one.
    #[must_use]
    pub fn meaning(&self) -> String {
        match (&self.of, self.known.meaning.split_once(':')) {
            (Of::Network(network), Some((name, definition))) => format!("{name}, network {network}:{definition}"),
            (Of::Network(network), None) => format!("{}, network {network}", self.known.meaning),
            (Of::Run | Of::Map(_) | Of::Mission(_), _) => self.known.meaning.to_owned(),
        }
    }

    /// What it is called on an axis, without its unit: `mean position error`.
    #[must_use]
    pub fn name_in_words(&self) -> String {
        let name = self.known.meaning.split(':').next().unwrap_or_default();
        match &self.of {
            Of::Network(network) => format!("{name}, network {network}"),
            Of::Run | Of::Map(_) | Of::Mission(_) => name.to_owned(),
        }
    }

    /// What it is called on an axis, with its unit: `mean position error (m)`.
    #[must_use]
    pub fn label(&self) -> String {
        let name = self.name_in_words();
        match self.unit().symbol() {
            "" | "1" => name,
            unit => format!("{name} ({unit})"),
        }
    }

    /// The map that it is of.
    #[must_use]
    pub fn map(&self) -> Option<&str> {
        match &self.of {
            Of::Map(name) => Some(name),
            Of::Run | Of::Network(_) | Of::Mission(_) => None,
        }
    }

    /// Its column, or that which it would have if its network were the only one.
    #[must_use]
    pub fn column_of_one_network(&self) -> String {
        match &self.of {
            Of::Network(_) => format!("mac.{}", self.known.path),
            Of::Run | Of::Map(_) | Of::Mission(_) => self.column(),
        }
    }

    /// The measure of this column of the table of a sweep; of a map, that of the map `map`.
    #[must_use]
    pub fn of_column(column: &str, map: &str) -> Option<Self> {
        let of_run = || known::of_any_run().find(|known| of_run_shortened(known.path) == column);
        if let Some(known) = of_run() {
            return Some(Self { of: Of::Run, known });
        }
        match column.split_once('.') {
            Some(("applications", rest)) => named(rest, Of::Mission, || known::of_mission(true, true)),
            Some(("networks", rest)) => named(rest, Of::Network, known::of_network),
            _ => {
                let known = known::of_map(true).find(|known| known.path == column)?;
                Some(Self { of: Of::Map(map.to_owned()), known })
            }
        }
    }

    pub(super) fn of(&self) -> &Of {
        &self.of
    }

    /// Its path in the run, the map or the application.
    pub(super) fn path_within(&self) -> &str {
        self.known.path
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(path: &str) -> Result<Self, UnknownMeasure> {
        let of_run = || {
            let known = known::of_any_run().find(|known| known.path == path)?;
            Some(Self { of: Of::Run, known })
        };
        let found = match path.split_once('.') {
            Some(("networks", rest)) => named(rest, Of::Network, known::of_network),
            Some(("maps", rest)) => named(rest, Of::Map, || known::of_map(true)),
            Some(("applications", rest)) => named(rest, Of::Mission, || known::of_mission(true, true)),
            _ => of_run(),
        };
        found.ok_or_else(|| UnknownMeasure(path.to_owned()))
    }
}

/// The measure whose path is a name, then one of `known`. A name may have dots.
fn named<I: Iterator<Item = KnownMeasure<'static>>>(
    path: &str,
    of: fn(String) -> Of,
    known: impl Fn() -> I,
) -> Option<Measure> {
    path.match_indices('.').find_map(|(dot, _)| {
        let (name, rest) = (&path[..dot], &path[dot + 1..]);
        let known = known().find(|known| known.path == rest)?;
        Some(Measure { of: of(name.to_owned()), known })
    })
}

/// The path of a number of a run without the words `simulation` and `gathering`.
fn of_run_shortened(path: &str) -> &str {
    ["simulation.", "gathering."].iter().find_map(|group| path.strip_prefix(group)).unwrap_or(path)
}

/// All measures of a run with these subjects, in the order of their columns.
#[must_use]
pub fn all(subjects: &Subjects) -> Vec<Measure> {
    let Subjects { networks, maps, by_nodes, applications, searches, keep_links, features } = subjects;
    let measure = |of: Of, known: KnownMeasure<'static>| Measure { of, known };
    let of_features =
        Feature::ALL.into_iter().filter(|feature| features.contains(feature)).flat_map(known::of_feature);
    let of_run = known::of_run(!by_nodes.is_empty()).chain(of_features);
    let is_one_network = networks.is_empty() || features.contains(&Feature::SingleNetwork);
    let of_run = of_run.filter(|known| is_one_network || !known.path.starts_with("mac."));
    let mut measures: Vec<_> = of_run.map(|number| measure(Of::Run, number)).collect();
    for name in networks {
        measures.extend(known::of_network().map(|number| measure(Of::Network(name.clone()), number)));
    }
    for map in maps {
        let numbers = known::of_map(by_nodes.contains(map));
        measures.extend(numbers.map(|number| measure(Of::Map(map.clone()), number)));
    }
    for name in applications {
        let numbers = known::of_mission(searches.contains(name), keep_links.contains(name));
        measures.extend(numbers.map(|number| measure(Of::Mission(name.clone()), number)));
    }
    measures
}

#[cfg(test)]
mod tests {
    use super::super::numbers::Numbers;
    use super::*;
    use crate::summary::{
        DistributedSummary, EnergySummary, ErrorSummary, GatheringSummary, MacSummary, MapSummary, MissionSummary,
        SectorsSummary, Summary, TrafficSummary,
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
            sectors: Some(SectorsSummary { sector_displacement: vec![0.6, 0.4], ..SectorsSummary::default() }),
            distributed: Some(work),
            ..MapSummary::default()
        };
        let gathering = GatheringSummary { stops: 12, energy_j: Some(energy), ..GatheringSummary::default() };
        let search = MissionSummary { name: "p-g".into(), captured: Some(false), ..MissionSummary::default() };
        let (maps, applications) = (vec![map], vec![search]);
        let summary = Summary { gathering: Some(gathering), maps, applications, ..Summary::default() };
        let numbers = Numbers::of(&summary);
        for (path, name, value) in [
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
            assert_eq!((measure.path(), measure.name()), (path.to_owned(), name.to_owned()));
            assert_eq!(
                Measure::of_column(&measure.column(), measure.map().unwrap_or_default()),
                Some(measure.clone())
            );
            assert_eq!(numbers.get(&measure), value, "{path}");
        }
    }

    #[test]
    fn each_of_several_networks_has_its_numbers_under_its_name() {
        let mac = |network: &str, prr: f64| MacSummary {
            network: Some(network.to_owned()),
            all: TrafficSummary { prr: Some(prr), ..TrafficSummary::default() },
            ..MacSummary::default()
        };
        let summary =
            Summary { mac: Some(mac("a", 0.5)), other_networks: vec![mac("b", 0.25)], ..Summary::default() };
        let subjects = Subjects { networks: vec!["a".into(), "b".into()], ..Subjects::default() };
        let (measures, numbers) = (all(&subjects), Numbers::of(&summary));
        let value = |path: &str| {
            let measure = measures.iter().find(|measure| measure.path() == path)?;
            assert_eq!(Measure::of_column(&measure.column(), "").as_ref(), Some(measure));
            numbers.get(measure)
        };
        assert_eq!(
            [value("networks.a.prr"), value("networks.b.prr"), value("mac.prr")],
            [Some(0.5), Some(0.25), None]
        );
        let prr: Measure = "networks.b.prr".parse().unwrap();
        assert_eq!(prr.label(), "packet reception ratio, network b");
        assert_eq!(prr.column_of_one_network(), "mac.prr");
        // Where some cells have one network, that has its own columns.
        let features = [Feature::SingleNetwork].into();
        assert!(all(&Subjects { features, ..subjects }).iter().any(|measure| measure.path() == "mac.prr"));
    }

    #[test]
    fn a_path_that_leads_nowhere_is_rejected() {
        for path in ["stops", "gathering", "maps.mapped", "maps.fine.maped", "applications.p-g", "maps..", ""] {
            let error = path.parse::<Measure>().unwrap_err().to_string();
            assert!(error.contains(&format!("`{path}`")), "{error}");
        }
        let of_dots: Measure = "maps.fine.2.mapped".parse().unwrap();
        assert_eq!((of_dots.name(), of_dots.column()), ("fine.2.mapped".to_owned(), "mapped".to_owned()));
    }

    #[test]
    fn no_two_measures_of_a_map_or_a_run_share_a_column_and_each_is_found_by_its_path() {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let subjects = Subjects {
            maps: names(&["ml-tm", "tpm"]),
            by_nodes: names(&["tpm"]),
            applications: names(&["detarsk", "p-g", "gradient"]),
            searches: names(&["detarsk", "p-g"]),
            keep_links: names(&["gradient"]),
            networks: names(&["a", "b"]),
            ..Subjects::every("")
        };
        let measures = all(&subjects);
        for measure in &measures {
            assert_eq!(&measure.path().parse::<Measure>().unwrap(), measure);
        }
        let mut columns: Vec<_> = measures.iter().map(|measure| (measure.map(), measure.column())).collect();
        let count = columns.len();
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), count);
        let of_maps: Vec<_> = columns.iter().filter(|(map, _)| map.is_some()).map(|(_, column)| column).collect();
        let others = columns.iter().filter(|(map, _)| map.is_none());
        assert!(others.clone().all(|(_, column)| !of_maps.contains(&column)), "one column, two meanings");
        assert!(others.count() > 50 && measures.iter().all(|measure| !measure.label().contains(':')));
    }
}
