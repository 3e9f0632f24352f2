//! What is measured: the numbers of a run, of a map and of an application, by path, in the order of the columns of tables.
//! A path leads through the keys of the summary, or is a name that [`derived`](super::derived) works out.

mod map;
mod mission;
mod run;

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

/// All of a run whose network has slots, in addition.
pub(super) fn of_slots() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_SLOTS, &[])
}

/// All of a run whose stations agree on cells, in addition.
pub(super) fn of_negotiated_cells() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_NEGOTIATED_CELLS, &[])
}

/// All of a run whose nodes have batteries, in addition.
pub(super) fn of_batteries() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_BATTERIES, &[])
}

/// All of a run whose stations sleep between checks of the channel, in addition.
pub(super) fn of_sleep() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_SLEEP, &[])
}

/// All of a run in which packets go over several hops, in addition.
pub(super) fn of_routing() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_ROUTING, &[])
}

/// All of a run in which packets go down from a sink, in addition.
pub(super) fn of_way_down() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_WAY_DOWN, &[])
}

/// All of a run whose packets go in fragments, in addition.
pub(super) fn of_fragments() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_FRAGMENTS, &[])
}

/// All of a run with a tree of RPL, in addition.
pub(super) fn of_rpl() -> impl Iterator<Item = KnownMeasure<'static>> {
    all(run::WITH_RPL, &[])
}

/// All of any run.
pub(super) fn of_any_run() -> impl Iterator<Item = KnownMeasure<'static>> {
    let mac = of_slots().chain(of_negotiated_cells()).chain(of_sleep()).chain(of_routing()).chain(of_way_down());
    let hops = of_fragments().chain(of_rpl());
    of_run(true).chain(mac).chain(hops).chain(of_batteries())
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
