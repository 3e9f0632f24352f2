//! Maps of logs in parts: the same, to the last bit, as in one piece.

use sextant_channel::{EvenSectorsConfig, Position, Reception, ReceptionLog, ReceptionLogBuilder, SectorTable, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, CountRule, EstimateKind, FittedConfig, Knowledge, LinkModelConfig, LogParts, MapError, Mapper,
    MdsMapConfig, MlTmConfig, PacketCentroidConfig, PartsError, ProfileConfig, SectorModel, SectorsConfig,
    SoftSectorsConfig, TrapezoidConfig,
};

/// Side of the square with the stops (m), and how far nodes are heard (m).
const SIDE_M: f64 = 24.0;
const RANGE_M: f64 = 6.0;

/// Whether the listener has sectors.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Antenna {
    Omni,
    Sectors,
}

/// 90 nodes of which each stop hears those near it, a stop whose receiver does not work, a reception from far away, and a node
/// that was never heard. Stops are in layers `rise_m` apart.
fn survey(antenna: Antenna, rise_m: f64) -> ReceptionLog {
    let draw =
        |node: usize, what: u64, stop: usize| Seed(5).uniform(Purpose::new(3), [node as u64, what, stop as u64]);
    let place = |i: usize| {
        let height_m = if i.is_multiple_of(2) { 0.0 } else { rise_m };
        Position::new((i % 17) as f64 * SIDE_M / 16.0, (i / 17) as f64 * SIDE_M / 16.0, height_m)
    };
    let stops: Vec<Stop> = (0..289).map(|i| Stop::at(place(i))).collect();
    let mut receptions = ReceptionLogBuilder::default();
    for node in 0..90 {
        let at = Position::new(SIDE_M * draw(node, 0, 0), SIDE_M * draw(node, 1, 0), 0.3 * rise_m);
        for (number, stop) in stops.iter().enumerate() {
            let apart = at - stop.position;
            let chance = 0.95 * (1.0 - apart.length_m() / RANGE_M);
            let received = (0..3).filter(|&packet| draw(node, 2 + packet, number) < chance).count();
            let is_far = node == 7 && number == if at.x_m < 12.0 { 288 } else { 0 };
            if number == 144 || received == 0 && !is_far {
                continue;
            }
            let azimuth_deg = apart.y_m.atan2(apart.x_m).to_degrees() + 12.0 * (draw(node, 9, number) - 0.5);
            let sector = (azimuth_deg.rem_euclid(360.0) / 45.0).floor();
            receptions.push(Reception {
                sector: (antenna == Antenna::Sectors && draw(node, 10, number) < 0.8)
                    .then_some((0..8).rev().find(|&sector_number| f64::from(sector_number) <= sector).unwrap_or(0)),
                ..Reception::heard(
                    NodeId::from_index(node),
                    u32::try_from(number).expect("few stops"),
                    u32::try_from(received).expect("few packets").max(1),
                    3,
                )
            });
        }
    }
    let names = (0..91).map(|node| format!("n{node}")).collect();
    let log = receptions.build(names, stops, Vec::new()).expect("a good log");
    if antenna == Antenna::Omni {
        return log;
    }
    let even = EvenSectorsConfig { azimuth_sectors: 8, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
    log.with_sectors(SectorTable::try_from(even).expect("good sectors")).expect("good sectors")
}

/// A log in parts of nodes that are spread over all of it.
#[derive(Debug)]
pub(crate) struct Parts {
    log: ReceptionLog,
    whole: ReceptionLog,
    nodes: Vec<Vec<NodeId>>,
}

impl Parts {
    pub(crate) fn new(log: &ReceptionLog, count: usize) -> Self {
        let whole = log.part(log.names().to_vec(), ReceptionLogBuilder::default()).expect("no receptions are good");
        let of_part = |part: usize| {
            (0..log.node_count())
                .map(NodeId::from_index)
                .filter(|node| node.index() * 7 % 11 % count == part)
                .collect()
        };
        Self { log: log.clone(), whole, nodes: (0..count).map(of_part).collect() }
    }
}

impl LogParts for Parts {
    fn whole(&self) -> &ReceptionLog {
        &self.whole
    }

    fn count(&self) -> usize {
        self.nodes.len()
    }

    fn nodes(&self, part: usize) -> &[NodeId] {
        &self.nodes[part]
    }

    fn read(&self, part: usize) -> Result<ReceptionLog, PartsError> {
        let mut receptions = ReceptionLogBuilder::default();
        for (number, &node) in self.nodes[part].iter().enumerate() {
            let renumbered = |reception| Reception { node: NodeId::from_index(number), ..reception };
            receptions.extend(self.log.of(node).iter().map(renumbered));
        }
        if self.log.receptions().sectors().is_some() {
            receptions.keep_sectors();
        }
        let names = self.nodes[part].iter().map(|node| self.log.names()[node.index()].clone()).collect();
        Ok(self.log.part(names, receptions).map_err(MapError::from)?)
    }
}

fn trapezoid() -> ProfileConfig {
    let config = TrapezoidConfig { floor: 0.001, ..TrapezoidConfig::new(0.95, 0.0, RANGE_M) };
    ProfileConfig::Trapezoid(config)
}

/// Checks that a map in three parts is the same as in one piece.
fn check(what: &str, algorithm: AlgorithmConfig, log: &ReceptionLog) {
    check_in(&[3], what, algorithm, log);
}

/// The same in these numbers of parts.
fn check_in(counts: &[usize], what: &str, algorithm: AlgorithmConfig, log: &ReceptionLog) {
    let mapper = Mapper::try_from(algorithm).expect("good settings");
    let (map, learned) = mapper.map_and_learn(log, &Unwatched).expect("a map");
    assert!(map.mapped() == 90 && map.unmapped() == 1, "{what}: {} mapped", map.mapped());
    for &count in counts {
        let parts = Parts::new(log, count);
        let (of_parts, learned_of_parts) =
            mapper.map_parts(&parts, Knowledge::from(parts.whole()), &Unwatched).expect("a map");
        assert!(of_parts == map, "{what} in {count} parts");
        assert!(learned_of_parts == learned, "{what} in {count} parts: {learned_of_parts:?} {learned:?}");
    }
}

#[test]
fn a_grid_under_a_given_profile_is_the_same_in_parts() {
    let omni = survey(Antenna::Omni, 0.0);
    for estimate in [EstimateKind::Argmax, EstimateKind::PosteriorMean] {
        let config = MlTmConfig { estimate, ..MlTmConfig::new(0.5, trapezoid()) };
        check_in(&[1, 3], "plane", AlgorithmConfig::MlTm(config), &omni);
    }
    let counts = Some(CountRule::AtLeastOne);
    check("slots", AlgorithmConfig::MlTm(MlTmConfig { counts, ..MlTmConfig::new(0.5, trapezoid()) }), &omni);
    let space = survey(Antenna::Omni, 3.0);
    check("space", AlgorithmConfig::MlTm(MlTmConfig::new(1.0, trapezoid())), &space);
    check("centroid", AlgorithmConfig::PacketCentroid(PacketCentroidConfig::default()), &omni);
}

#[test]
fn sectors_are_the_same_in_parts() {
    let log = survey(Antenna::Sectors, 0.0);
    let soft =
        SectorsConfig { model: Some(SectorModel::Soft(SoftSectorsConfig::default())), ..SectorsConfig::default() };
    for sectors in [None, Some(soft)] {
        let config = MlTmConfig { sectors, ..MlTmConfig::new(0.5, trapezoid()) };
        check("ml-tm", AlgorithmConfig::MlTm(config.clone()), &log);
        check("mmtm", AlgorithmConfig::Mmtm(config), &log);
    }
}

#[test]
fn a_fitted_profile_is_the_same_in_parts() {
    let fitted = || ProfileConfig::Fitted(FittedConfig::default());
    let omni = survey(Antenna::Omni, 0.0);
    for estimate in [EstimateKind::Argmax, EstimateKind::PosteriorMean] {
        check("plane", AlgorithmConfig::MlTm(MlTmConfig { estimate, ..MlTmConfig::new(0.5, fitted()) }), &omni);
    }
    // So fine a grid takes so long that each node gets one of its own.
    check("own grids", AlgorithmConfig::MlTm(MlTmConfig::new(0.01, fitted())), &omni);
    let sectors = survey(Antenna::Sectors, 0.0);
    check("sectors", AlgorithmConfig::MlTm(MlTmConfig::new(0.5, fitted())), &sectors);
    check("mmtm", AlgorithmConfig::Mmtm(MlTmConfig::new(0.5, fitted())), &sectors);
}

#[test]
fn the_law_of_links_is_the_same_in_parts_if_all_nodes_tell_it() {
    check_in(&[3], "plane", AlgorithmConfig::LinkModel(LinkModelConfig::default()), &survey(Antenna::Omni, 0.0));
}

#[test]
fn an_algorithm_that_needs_all_nodes_at_once_is_refused_by_name() {
    let parts = Parts::new(&survey(Antenna::Omni, 0.0), 2);
    let mapper = Mapper::try_from(AlgorithmConfig::MdsMap(MdsMapConfig::default())).expect("good settings");
    let refused = mapper.map_parts(&parts, Knowledge::from(parts.whole()), &Unwatched).expect_err("it is refused");
    let text = refused.to_string();
    assert!(text.contains("`mds-map` cannot map tile by tile") && text.contains("`ml-tm`"), "{text}");
}
