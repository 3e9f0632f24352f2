//! What a user should know of a map before trusting it: one source for the printed table, the summary and the report.

use sextant_kernel::text::{counted, listed};
use sextant_mapper::{Concern, Section};

use super::judgement::{Judgement, JudgementLevel};
use super::map::{HeightsSource, HeightsSummary, MapSummary, MeasuredIn, SectorsSummary};

/// What sentences are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Subject {
    /// Which nodes are measured, and whether in the plane.
    Measured,
    /// What the algorithm learned from the log.
    Learned(Section),
    /// Nodes whose receptions no position explains.
    Infeasible,
    /// Nodes in exactly one place.
    Coincident,
    /// Shares of the nodes by sector displacement.
    Displacements,
    /// Nodes whose position is unreliable, and curves at the bound of their search.
    Concerns,
    /// The heights at which nodes were searched for.
    Heights,
}

impl MapSummary {
    /// The same with its judgement, once everything else is known.
    #[must_use]
    pub(crate) fn judged(self) -> Self {
        Self { judgement: of(&self), ..self }
    }
}

/// All sentences on a map: what is not reliable first.
fn of(map: &MapSummary) -> Vec<Judgement> {
    let learned = Section::ALL.into_iter().filter(|section| *section != Section::Warnings).map(Subject::Learned);
    let subjects = [Subject::Concerns, Subject::Infeasible, Subject::Coincident, Subject::Measured]
        .into_iter()
        .chain(learned)
        .chain([Subject::Displacements, Subject::Heights]);
    let (warnings, notes): (Vec<Judgement>, Vec<Judgement>) =
        subjects.flat_map(|subject| on(map, subject)).partition(|one| one.level == JudgementLevel::Warning);
    warnings.into_iter().chain(notes).collect()
}

/// The sentences on a map about one subject.
pub(super) fn on(map: &MapSummary, subject: Subject) -> Vec<Judgement> {
    let name = map.name.as_ref().unwrap_or(&map.algorithm);
    let note = |text: String| Judgement { level: JudgementLevel::Note, text };
    let warning = |text: String| Judgement { level: JudgementLevel::Warning, text };
    match subject {
        Subject::Measured => measured(map, name).into_iter().map(note).collect(),
        Subject::Learned(section) => learned(map, section).map(note).collect(),
        Subject::Infeasible => infeasible(map, name).into_iter().map(warning).collect(),
        Subject::Coincident => coincident(map, name).into_iter().collect(),
        Subject::Displacements => displacements(map, name).into_iter().map(note).collect(),
        Subject::Concerns => {
            let not_made = map.not_made.iter().map(|why| format!("{name}: no map was made: {why}"));
            not_made.chain(concerns(map, name)).chain(learned(map, Section::Warnings)).map(warning).collect()
        }
        Subject::Heights => heights(map, name).into_iter().map(note).collect(),
    }
}

fn learned(map: &MapSummary, section: Section) -> impl Iterator<Item = String> {
    map.learned.lines.iter().filter(move |line| line.section == section).map(|line| line.text.clone())
}

/// How many nodes were measured, where the true positions of some are unknown, and whether in the plane.
fn measured(map: &MapSummary, name: &str) -> Vec<String> {
    let in_plane = (map.measured_in == Some(MeasuredIn::Plane))
        .then(|| format!("{name}: errors and regions in the plane (x, y): the true positions have no heights"));
    let flat = (map.regions_in == Some(MeasuredIn::Plane)).then(|| {
        let plane = map.position_error_in_plane_m.map_or_else(String::new, |error| {
            format!(", where the mean error is {:.2} m and the median {:.2} m", error.mean, error.median)
        });
        format!(
            "{name}: errors are in space, and regions in the plane (x, y){plane}: the map has nodes at a height that was not \
             estimated, and true ones are elsewhere; `{}=[low,high]` seeks heights",
            heights_key(map)
        )
    });
    let some = map.measured.map(|measured| {
        let nodes = counted(map.mapped, "mapped node");
        format!("{name}: errors of {measured} of {nodes}: those whose true positions are known")
    });
    let neighbours = map
        .connectivity_absent
        .as_ref()
        .map(|why| format!("{name}: connectivity error and false neighbours are not known: {why}"));
    in_plane.into_iter().chain(flat).chain(some).chain(neighbours).collect()
}

/// Shares of the nodes by sector displacement, and the pairs of neighbours that have no bearing.
fn displacements(map: &MapSummary, name: &str) -> Vec<String> {
    let Some(SectorsSummary { sector_displacement, sector_pairs: pairs, .. }) = &map.sectors else {
        return Vec::new();
    };
    let shares = sector_displacement.iter().enumerate();
    let shares: Vec<_> = shares.map(|(sectors, share)| format!("{sectors}: {:.1} %", 100.0 * share)).collect();
    let all = pairs.compared + pairs.without_bearing;
    let without = [
        (pairs.without_bearing, "stand on one another, and are not compared: they have no bearing"),
        (pairs.without_bearing_on_map, "are in one place on the map: it suggests the azimuth 0 for them"),
    ];
    let without = without.into_iter().filter(|(count, _)| *count > 0);
    let without = without.map(|(count, what)| format!("{name}: {count} of {all} pairs of neighbours {what}"));
    [format!("{name}: nodes by sector displacement: {}", shares.join(", "))].into_iter().chain(without).collect()
}

/// Nodes whose receptions no position explains.
fn infeasible(map: &MapSummary, name: &str) -> Option<String> {
    let count = map.infeasible.filter(|&count| count > 0)?;
    let (have, they) = if count == 1 { ("has", "it is") } else { ("have", "they are") };
    let nodes = counted(map.mapped, "mapped node");
    Some(format!(
        "{name}: {count} of {nodes} {have} no position that agrees with all receptions; {they} placed where most agree"
    ))
}

/// Nodes that have exactly the place of another one: a warning if they are more than half of the nodes on the map.
fn coincident(map: &MapSummary, name: &str) -> Option<Judgement> {
    let count = map.coincident.filter(|&count| count > 0)?;
    let nodes = counted(map.mapped, "mapped node");
    let text = format!("{count} of {nodes} have exactly the place of another one: the map does not tell them apart");
    Some(if 2 * count > map.mapped {
        Judgement { level: JudgementLevel::Warning, text: format!("{name}: warning: {text}") }
    } else {
        Judgement { level: JudgementLevel::Note, text: format!("{name}: {text}") }
    })
}

/// Nodes whose position is unreliable.
fn concerns(map: &MapSummary, name: &str) -> Vec<String> {
    let of = |concern: Concern| {
        let nodes: Vec<&str> =
            map.concerns.iter().filter(|of| of.concern == concern).map(|of| of.node.as_str()).collect();
        let count = nodes.len();
        let (is, did, has) = if count == 1 { ("is", "did", "has") } else { ("are", "did", "have") };
        let what = match concern {
            Concern::AtEdge => format!("{is} at the boundary of the searched area"),
            Concern::Unsettled => format!("{did} not settle within the rounds of the fit"),
            Concern::NoEvidence => format!("{has} no place that the evidence prefers"),
            Concern::TwoPlaces => {
                format!("{has} two places that fit the ranges about as well")
            }
            Concern::TooFew => format!("{has} fewer ranges or stops than a place needs"),
        };
        let advice = match concern {
            Concern::AtEdge => {
                "stops on their other side, or a larger area if one is given, would tell where they are"
            }
            Concern::Unsettled => "more rounds or more stops would tell where they are",
            Concern::NoEvidence => {
                "stops where they are heard and others where they are not would tell where they are; of ranges, stops all round them"
            }
            Concern::TwoPlaces => {
                "on a straight way they are mirror images, which a stop beside it or bounds of heights (`z_range_m`) tell apart; on \
                 others the node may have moved, or two have one name"
            }
            Concern::TooFew => "ranges or stops at more places would tell where they are",
        };
        let (many, nodes) = (counted(count, "node"), listed(&nodes));
        let text = format!("{name}: warning: {many} {what}, so the position is unreliable: {nodes}; {advice}");
        (count > 0).then_some(text)
    };
    Concern::ALL.into_iter().filter_map(of).collect()
}

/// The heights at which nodes were searched for, if the stops have different heights and no setting gives the heights.
fn heights(map: &MapSummary, name: &str) -> Option<String> {
    let HeightsSummary { low_m, high_m, from, uneven_m } = map.heights?;
    match (from, uneven_m) {
        (HeightsSource::Reach, _) => Some(format!(
            "{name}: nodes searched at heights from {low_m:.2} to {high_m:.2} m, the range of packets from the stops \
             (`{}` sets other heights)",
            heights_key(map)
        )),
        (_, Some(uneven_m)) => Some(format!(
            "{name}: nodes searched in the plane at {low_m:.2} m, because the heights of the stops differ by only \
             {uneven_m:.2} m (`{}` sets other heights)",
            heights_key(map)
        )),
        _ => None,
    }
}

/// The key of the heights between which nodes are searched for, within the map.
fn heights_key(map: &MapSummary) -> String {
    format!("algorithm.{}.z_range_m", map.algorithm.replace('-', "_"))
}

#[cfg(test)]
mod tests {
    use super::super::map::ConcernSummary;
    use super::*;

    #[test]
    fn what_is_not_reliable_comes_first() {
        let concern = |node: &str| ConcernSummary { node: node.into(), concern: Concern::AtEdge };
        let map = MapSummary {
            algorithm: "auto".into(),
            mapped: 3,
            measured: Some(2),
            infeasible: Some(1),
            concerns: vec![concern("a"), concern("b")],
            ..MapSummary::default()
        };
        let said = of(&map);
        let levels: Vec<JudgementLevel> = said.iter().map(|one| one.level).collect();
        assert_eq!(levels, [JudgementLevel::Warning, JudgementLevel::Warning, JudgementLevel::Note]);
        assert!(said[0].text.starts_with("auto: warning: 2 nodes are at the boundary"), "{}", said[0].text);
        assert!(of(&MapSummary::default()).is_empty());
    }

    #[test]
    fn what_is_absent_has_a_reason_and_nodes_in_one_place_are_told() {
        let map = MapSummary {
            algorithm: "ml-tm".into(),
            mapped: 6,
            coincident: Some(4),
            connectivity_absent: Some("the nodes are on a line".into()),
            ..MapSummary::default()
        };
        let said = of(&map);
        assert_eq!(said[0].level, JudgementLevel::Warning);
        assert!(said[0].text.contains("warning: 4 of 6 mapped nodes have exactly the place"), "{}", said[0].text);
        assert!(said[1].text.contains("false neighbours are not known: the nodes are on a line"), "{}", said[1].text);
        let few = MapSummary { coincident: Some(2), ..map };
        assert_eq!(of(&few).iter().filter(|one| one.level == JudgementLevel::Note).count(), 2);
    }
}
