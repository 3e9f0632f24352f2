//! All figures of a recording.

use std::collections::BTreeSet;

use sextant_recording::Places;

use super::applications::application;
use super::applications::application_curves;
use super::applications::field;
use super::applications::targets;
use super::errors::displacement;
use super::errors::distribution::{self, NodeError};
use super::errors::reception_curve;
use super::errors::residuals;
use super::errors::scattering;
use super::maps::crowded_map;
use super::maps::estimated::EstimatedMap;
use super::maps::estimated_map;
use super::maps::likelihood;
use super::maps::map;
use super::networks::crowded_network;
use super::networks::crowded_network::Crowds;
use super::networks::network;
use super::networks::sectors;
use super::source::Source;
use crate::paint::file::Figure;
use crate::paint::picture::Picture;
use crate::plot::density::Crowding;

/// All figures of a recording: `network`, and `survey` if there are so many nodes or stops that dots would overlap; then
/// colours show the number of nodes in each cell, or a mean over them. There are `sectors` if robots have sectors,
/// `targets` if there are any, `field-NAME-Ts` for each recorded instant T of a field. There is `application-NAME` with its time series for each
/// application, `map-NAME` for each map, and `likelihood-NAME-NODE` for each likelihood surface. If the true
/// positions are known, there are `error-cdf` and `connectivity-cdf`. There is `sector-displacement` if nodes have
/// sectors, and `neighbour-scattering` if nodes computed a map.
#[must_use]
pub fn all(source: &Source<'_>) -> Vec<Figure> {
    named(pictures(source, Crowding::default()))
}

/// The same of maps that were computed from the log of `source`, and whose places it has. Their `map-NAME` has regions and
/// names, and there are `curve-NAME`, the reception curve against the data, and `residuals-NAME`, packets received minus
/// packets expected at each stop, if the map has a curve. If a map uses several networks, there is one of each,
/// `curve-NAME-NETWORK`.
#[must_use]
pub fn all_of_maps(source: &Source<'_>, maps: &[EstimatedMap<'_>]) -> Vec<Figure> {
    let crowding = Crowding::default();
    let mut figures = pictures(source, crowding);
    for estimated in maps {
        let EstimatedMap { name, map, ref curves, .. } = *estimated;
        let own = format!("map-{name}");
        let places = estimated_map::places(map);
        // Regions and names have no room in a crowd.
        if !is_map_crowded(source, &places, crowding)
            && let Some((_, picture)) = figures.iter_mut().find(|(other, _)| *other == own)
        {
            *picture = estimated_map::draw(source, estimated, &places);
        }
        for of in curves {
            let network = of.network.map(|network| format!("-{network}")).unwrap_or_default();
            let curve = reception_curve::draw(source.title, name, map, of);
            figures.extend(curve.map(|picture| (format!("curve-{name}{network}"), picture)));
            let residuals = residuals::draw(source, name, map, of);
            figures.extend(residuals.map(|picture| (format!("residuals-{name}{network}"), picture)));
        }
    }
    named(figures)
}

/// The figures and their names, which may be no file names.
fn pictures(source: &Source<'_>, crowding: Crowding) -> Vec<(String, Picture)> {
    let mut figures = networks(source, crowding);
    figures.extend(sectors::draw(source).map(|picture| ("sectors".to_owned(), picture)));
    figures.extend(targets::draw(source).map(|picture| ("targets".to_owned(), picture)));
    for instant in &source.drawn.fields {
        // To the millisecond: a file's name has no tails of rounding.
        let time_s = libm::round(instant.time.as_secs_f64() * 1e3) / 1e3;
        let name = format!("field-{}-{time_s}s", instant.name);
        figures.push((name, field::draw(source, instant)));
    }
    for drawn in &source.drawn.applications {
        let name = format!("application-{}", drawn.name);
        figures.push((name.clone(), application::draw(source, drawn)));
        let curves = application_curves::draw(source, drawn);
        figures.extend(curves.into_iter().map(|(what, picture)| (format!("{name}-{what}"), picture)));
    }
    for (name, places) in &source.drawn.maps {
        let is_crowded = is_map_crowded(source, places, crowding);
        let draw = if is_crowded { crowded_map::draw } else { map::draw };
        figures.push((format!("map-{name}"), draw(source, name, places)));
    }
    for (name, what) in [("error-cdf", NodeError::Position), ("connectivity-cdf", NodeError::Connectivity)] {
        figures.extend(distribution::draw(source, what).map(|picture| (name.to_owned(), picture)));
    }
    figures.extend(displacement::draw(source).map(|picture| ("sector-displacement".to_owned(), picture)));
    figures.extend(scattering::draw(source).map(|picture| ("neighbour-scattering".to_owned(), picture)));
    for surface in &source.drawn.likelihoods {
        let name = format!("likelihood-{}-{}", surface.map, surface.node);
        figures.push((name, likelihood::draw(source, surface)));
    }
    figures
}

/// The figures of the network and of the survey: one, or two where dots would overlap.
fn networks(source: &Source<'_>, crowding: Crowding) -> Vec<(String, Picture)> {
    let Source { drawn, log, .. } = *source;
    let views = source.views(source.survey().chain(drawn.sinks.values().copied()));
    let (nodes, stops) = (drawn.nodes.len(), log.stops().len());
    let crowds = Crowds { nodes: crowding.is_crowded(nodes, &views), stops: crowding.is_crowded(stops, &views) };
    if !crowds.nodes && !crowds.stops {
        return vec![("network".to_owned(), network::draw(source))];
    }
    let mut figures = vec![("network".to_owned(), crowded_network::draw(source, crowds))];
    if stops > 0 {
        figures.push(("survey".to_owned(), crowded_network::draw_survey(source)));
    }
    figures
}

/// Whether the dots of a map would overlap.
fn is_map_crowded(source: &Source<'_>, places: &Places, crowding: Crowding) -> bool {
    let count = places.len().max(source.drawn.nodes.len());
    crowding.is_crowded(count, &source.views(places.values().copied()))
}

fn named(figures: Vec<(String, Picture)>) -> Vec<Figure> {
    let mut taken = BTreeSet::new();
    figures.into_iter().map(|(name, picture)| Figure { name: file_name(&name, &mut taken), picture }).collect()
}

/// `name` as a file name: characters that a file system may reject are replaced, and a number is added if the name is
/// already used. Names that differ only in upper and lower case count as equal, as on some file systems.
fn file_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    const LONGEST: usize = 80;
    let plain = |letter: char| if letter.is_alphanumeric() || "-_.+".contains(letter) { letter } else { '_' };
    let name: String = name.chars().take(LONGEST).map(plain).collect();
    let numbered = |number: u32| if number == 1 { name.clone() } else { format!("{name}-{number}") };
    let free = (1..).map(numbered).find(|name| taken.insert(name.to_lowercase()));
    free.expect("there are more numbers than names")
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, Reception, ReceptionLog, Stop};
    use sextant_kernel::NodeId;
    use sextant_recording::RecordedWorld;

    use super::*;
    use crate::paint::picture::Mark;

    /// A square of 20 by 20 nodes with a map and a stop at each node.
    fn world() -> (ReceptionLog, RecordedWorld) {
        let site = |i: u32| Position::new(f64::from(i % 20), f64::from(i / 20), 0.0);
        let nodes: Places = (0..400).map(|i| (NodeId(i), site(i))).collect();
        let mapped = nodes.iter().skip(3).map(|(&node, &place)| (node, place + Position::new(0.1, 0.0, 0.0)));
        let stop = |i| Stop::at(site(i));
        let heard = |i| Reception::heard(NodeId(i), i, 1, 1);
        let names = (0..400).map(|i| format!("n{i}")).collect();
        let log = ReceptionLog::new(names, (0..400).map(stop).collect(), (0..400).map(heard).collect(), Vec::new())
            .unwrap();
        let maps = vec![("ml-tm".to_owned(), mapped.collect())];
        (log, RecordedWorld { nodes, maps, ..RecordedWorld::default() })
    }

    fn discs(figures: &[(String, Picture)], name: &str) -> usize {
        let (_, picture) = figures.iter().find(|(other, _)| other == name).unwrap();
        picture.marks.iter().filter(|mark| matches!(mark, Mark::Disc { .. })).count()
    }

    #[test]
    fn crowded_nodes_are_cells_and_others_are_dots() {
        let (log, drawn) = world();
        let source =
            Source { title: "t", log: &log, drawn: &drawn, sector_displacements: &[], claimed_obstacles: &[] };
        let names = |figures: &[(String, Picture)]| figures.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        let usual = pictures(&source, Crowding::default());
        assert_eq!(names(&usual), ["network", "map-ml-tm", "error-cdf", "connectivity-cdf"]);
        // The legend has a dot too.
        assert_eq!([discs(&usual, "network"), discs(&usual, "map-ml-tm")], [401, 398]);
        let crowded = pictures(&source, Crowding { least_distance: 100.0 });
        assert_eq!(names(&crowded), ["network", "survey", "map-ml-tm", "error-cdf", "connectivity-cdf"]);
        assert_eq!([discs(&crowded, "network"), discs(&crowded, "map-ml-tm"), discs(&crowded, "survey")], [0; 3]);
    }

    #[test]
    fn file_names_are_plain_and_unique() {
        let mut taken = BTreeSet::new();
        let mut name = |name| file_name(name, &mut taken);
        assert_eq!(name("likelihood-ml-tm-a/b"), "likelihood-ml-tm-a_b");
        assert_eq!(name("likelihood-ml-tm-a b"), "likelihood-ml-tm-a_b-2");
        assert_eq!(name("likelihood-ml-tm-A:b"), "likelihood-ml-tm-A_b-3");
        assert_eq!(name("map-é"), "map-é");
        assert!(name(&"x".repeat(1000)).len() < 100);
    }
}
