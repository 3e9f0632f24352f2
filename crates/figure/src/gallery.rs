//! All figures of a recording.

use std::collections::BTreeSet;

use super::distribution::{self, NodeError};
use super::estimated::EstimatedMap;
use super::file::Figure;
use super::picture::Picture;
use super::source::Source;
use super::{
    application, application_curves, displacement, estimated_map, field, likelihood, map, network, reception_curve,
    residuals, scattering, sectors, targets,
};

/// All figures of a recording: `network`, `sectors` if robots have sectors, `targets` if there are any,
/// `field-NAME-Ts` for each recorded instant T of a field. There is `application-NAME` with its time series for each
/// application, `map-NAME` for each map, and `likelihood-NAME-NODE` for each likelihood surface. If the true
/// positions are known, there are `error-cdf` and `connectivity-cdf`. There is `sector-displacement` if nodes have
/// sectors, and `neighbour-scattering` if nodes computed a map.
#[must_use]
pub fn all(source: &Source<'_>) -> Vec<Figure> {
    named(pictures(source))
}

/// The same of maps that were computed from the log of `source`, and whose places it has. Their `map-NAME` has regions and
/// names, and there are `curve-NAME`, the reception curve against the data, and `residuals-NAME`, packets received minus
/// packets expected at each stop, if the map has a curve. If a map uses several networks, there is one of each,
/// `curve-NAME-NETWORK`.
#[must_use]
pub fn all_of_maps(source: &Source<'_>, maps: &[EstimatedMap<'_>]) -> Vec<Figure> {
    let mut figures = pictures(source);
    for estimated in maps {
        let EstimatedMap { name, map, ref curves, .. } = *estimated;
        let own = format!("map-{name}");
        if let Some((_, picture)) = figures.iter_mut().find(|(other, _)| *other == own) {
            *picture = estimated_map::draw(source, estimated, &estimated_map::places(map));
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
fn pictures(source: &Source<'_>) -> Vec<(String, Picture)> {
    let mut figures = vec![("network".to_owned(), network::draw(source))];
    figures.extend(sectors::draw(source).map(|picture| ("sectors".to_owned(), picture)));
    figures.extend(targets::draw(source).map(|picture| ("targets".to_owned(), picture)));
    for instant in &source.drawn.fields {
        let name = format!("field-{}-{}s", instant.name, instant.time.as_secs_f64());
        figures.push((name, field::draw(source, instant)));
    }
    for drawn in &source.drawn.applications {
        let name = format!("application-{}", drawn.name);
        figures.push((name.clone(), application::draw(source, drawn)));
        let curves = application_curves::draw(source, drawn);
        figures.extend(curves.into_iter().map(|(what, picture)| (format!("{name}-{what}"), picture)));
    }
    for (name, places) in &source.drawn.maps {
        figures.push((format!("map-{name}"), map::draw(source, name, places)));
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
    use super::*;

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
