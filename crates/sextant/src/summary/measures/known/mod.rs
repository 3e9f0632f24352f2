//! What is measured: the numbers of a run, of a map and of an application, by path, in the order of the columns of tables.
//! A path leads through the keys of the summary, or is a name that [`derived`](super::derived) works out.

mod map;
mod mission;
mod run;

use super::subjects::Feature;
use super::unit::Unit::{self, Count, Joule, MeanCount, Metre, Second, Share};

/// A number that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct KnownMeasure<'a> {
    /// Its path in the run, the map or the application.
    pub(super) path: &'a str,
    pub(super) unit: Unit,
    /// What it is: a name, and after a colon a definition if the name needs one.
    pub(super) meaning: &'a str,
}

/// A number that is one of a family.
#[derive(Clone, Debug)]
struct Made {
    path: String,
    unit: Unit,
    meaning: String,
}

const fn known<'a>(path: &'a str, unit: Unit, meaning: &'a str) -> KnownMeasure<'a> {
    KnownMeasure { path, unit, meaning }
}

/// All of a map that may be computed by nodes.
pub(super) fn of_map(is_by_nodes: bool) -> impl Iterator<Item = KnownMeasure<'static>> {
    let (work, scattering) =
        if is_by_nodes { (map::BY_NODES, map::SCATTERING.as_slice()) } else { Default::default() };
    all(map::MAP, &map::DISTRIBUTIONS).chain(all(work, scattering))
}

/// All of an application that may be a search for targets, or keep a link.
pub(super) fn of_mission(is_search: bool, keeps_link: bool) -> impl Iterator<Item = KnownMeasure<'static>> {
    let link = if keeps_link { mission::LINK } else { Default::default() };
    all(mission::MISSION, if is_search { mission::COURSE.as_slice() } else { Default::default() })
        .chain(all(link, &[]))
}

/// All of a run in which nodes may compute a map.
pub(super) fn of_run(has_maps_by_nodes: bool) -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::RUN, &[]).chain(all(if has_maps_by_nodes { run::WITH_MAPS_BY_NODES } else { &[] }, &[]))
}

/// All of a run with this feature, in addition.
pub(super) fn of_feature(feature: Feature) -> impl Iterator<Item = KnownMeasure<'static>> {
    let written = match feature {
        Feature::Routing => run::WITH_ROUTING,
        Feature::WayDown => run::WITH_WAY_DOWN,
        Feature::Rpl => run::WITH_RPL,
        Feature::Fragments => run::WITH_FRAGMENTS,
        Feature::Slots => run::WITH_SLOTS,
        Feature::NegotiatedCells => run::WITH_NEGOTIATED_CELLS,
        Feature::Batteries => run::WITH_BATTERIES,
        Feature::Sleep => run::WITH_SLEEP,
        Feature::SingleNetwork => &[],
    };
    all(written, &[])
}

/// All of one of several networks.
pub(super) fn of_network() -> impl Iterator<Item = KnownMeasure<'static>> {
    let stripped =
        |known: KnownMeasure<'static>| Some(KnownMeasure { path: known.path.strip_prefix("mac.")?, ..known });
    of_any_run().filter_map(stripped)
}

/// All of any run.
pub(super) fn of_any_run() -> impl Iterator<Item = KnownMeasure<'static>> {
    of_run(true).chain(Feature::ALL.into_iter().flat_map(of_feature))
}

fn all(
    written: &'static [KnownMeasure<'static>],
    made: &'static [Made],
) -> impl Iterator<Item = KnownMeasure<'static>> {
    written.iter().copied().chain(made.iter().map(|Made { path, unit, meaning }| known(path, *unit, meaning)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_has_a_name_of_its_own_that_fits_on_an_axis() {
        for numbers in [of_any_run().collect::<Vec<_>>(), of_map(true).collect(), of_mission(true, true).collect()] {
            let mut names = Vec::new();
            for KnownMeasure { path, meaning, .. } in numbers {
                let name = meaning.split(':').next().unwrap_or_default();
                assert!((4..=85).contains(&name.chars().count()), "{path}: {name}");
                assert!(!names.contains(&name), "{path}: another number is called `{name}` too");
                names.push(name);
            }
        }
    }
}
