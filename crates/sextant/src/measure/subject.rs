//! What is measured: a map by its name.

use sextant_channel::ReceptionLog;
use sextant_mapper::KnowledgeKind;

use sextant_scenario::MapJob;

/// What a summary says of a map that the map itself does not know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Subject<'a> {
    /// Its name in tables and recordings.
    pub(crate) name: &'a str,
    /// The knowledge that its algorithm uses, as far as there is any.
    pub(crate) knowledge: Vec<KnowledgeKind>,
    /// The networks that it uses, if the scenario names them.
    pub(crate) networks: Vec<String>,
}

impl<'a> Subject<'a> {
    /// The map `named` of `log`: it knows of what its algorithm uses what there is.
    pub(crate) fn new(named: &'a MapJob, log: &ReceptionLog) -> Self {
        let joint = named.mapper.networks();
        let networks = if joint.is_empty() {
            named.network.iter().cloned().collect()
        } else {
            joint.into_iter().map(str::to_owned).collect()
        };
        let knowledge = named.mapper.uses().iter().copied().filter(|kind| is_in(log, *kind)).collect();
        Self { name: &named.name, knowledge, networks }
    }
}

/// Whether there is knowledge of a kind that an algorithm uses: strengths may be absent from `log`, and so may packets beside ranges.
/// A log without any rows is one whose rows are read tile by tile: then all that is used counts.
fn is_in(log: &ReceptionLog, kind: KnowledgeKind) -> bool {
    let mut heard = log.receptions().iter().filter(|row| row.received > 0);
    match kind {
        KnowledgeKind::RobotRssi => {
            let is_by_tiles = log.receptions().is_empty() && log.ranges().is_empty();
            is_by_tiles || heard.any(|row| row.rssi_dbm.is_some())
        }
        KnowledgeKind::RobotReceptions => log.ranges().is_empty() || heard.next().is_some(),
        KnowledgeKind::RobotRanges
        | KnowledgeKind::RobotPath
        | KnowledgeKind::Neighbours
        | KnowledgeKind::NeighbourRssi
        | KnowledgeKind::AnchorReceptions
        | KnowledgeKind::AnchorRssi
        | KnowledgeKind::Anchors
        | KnowledgeKind::PathLoss
        | KnowledgeKind::Obstacles => true,
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Position, RangeSample, Reception, Stop};
    use sextant_kernel::NodeId;
    use sextant_scenario::MapSettings;

    use super::*;

    #[test]
    fn a_map_knows_strengths_and_packets_only_if_there_are_any() {
        let settings = MapSettings::new(None, None, None, None, &[]).unwrap();
        let known = |rows: Vec<Reception>, ranges: Vec<RangeSample>| {
            let stops = vec![Stop::at(Position::ORIGIN)];
            let log = ReceptionLog::new(vec!["lamp".to_owned()], stops, rows, Vec::new()).unwrap();
            Subject::new(&settings.maps[0], &log.with_ranges(ranges).unwrap()).knowledge
        };
        let counts = Reception::heard(NodeId(0), 0, 3, 5);
        let [packets, strengths, path] =
            [KnowledgeKind::RobotReceptions, KnowledgeKind::RobotRssi, KnowledgeKind::RobotPath];
        assert_eq!(known(vec![counts], Vec::new()), [packets, path]);
        let strong = Reception { rssi_dbm: Some(-50.0), ..counts };
        assert_eq!(known(vec![strong], Vec::new()), [packets, strengths, path]);
        assert_eq!(known(Vec::new(), vec![RangeSample::of(NodeId(0), Position::ORIGIN, 4.0)]), [path]);
    }
}
