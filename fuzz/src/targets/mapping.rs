//! A reception log that no reader made, given to every estimator.

use std::sync::{Arc, LazyLock};

use arbitrary::{Result, Unstructured};
use sextant::scenario::{MapSettings, RecordedScenario};
use sextant_channel::{
    Anchor, Contact, EvenSectorsConfig, Link, NeighbourLog, Position, Reception, ReceptionLog, SectorTable, Stop,
};
use sextant_kernel::{Files, NodeId, RobotId, Seed, SimTime};
use sextant_mapper::{EstimatorFindings, Knowledge, MapError, TopologyMap};

use crate::budget::Budget;
use crate::threads::on_one_and_three;

/// All estimators, with the link law of a scenario and coarse grids.
const MAPS: &str = include_str!("maps.toml");

/// So often an estimator asks whether to go on before it is stopped.
const MAP_BUDGET: u64 = 3_000;

/// The first so many maps of the settings are slow.
const SLOW: usize = 8;

static SETTINGS: LazyLock<MapSettings> = LazyLock::new(|| {
    let none = Files::Attached(Arc::default());
    let scenario = RecordedScenario { name: "maps.toml", text: MAPS, files: &none };
    MapSettings::new(Some(scenario), None, None, None, &[]).unwrap_or_else(|errors| panic!("{:?}", errors.errors()))
});

/// What an estimator is given.
struct Given {
    log: ReceptionLog,
    neighbours: NeighbourLog,
    beacons: NeighbourLog,
    anchors: Vec<Anchor>,
    seed: Seed,
    /// The number of the map among those of the settings.
    map: usize,
}

/// The estimator refuses the log, or each place and covariance is a number, a node that was never heard has no evidence, and
/// the map is the same on one thread and on three.
pub(crate) fn check(octets: &[u8]) {
    let Ok(Some(given)) = given(&mut Unstructured::new(octets)) else { return };
    let (one, three) = on_one_and_three(octets, || mapped(&given));
    let name = &SETTINGS.maps[given.map].name;
    if let Ok((map, _)) = &one {
        is_sound(name, map, &given);
    }
    let is_stopped = |made: &Made| matches!(made, Err(MapError::Interrupted(_)));
    if let Some(three) = three.filter(|three| !is_stopped(three) && !is_stopped(&one)) {
        assert_eq!(format!("{one:?}"), format!("{three:?}"), "{name}: on one and on three threads");
    }
}

type Made = std::result::Result<(TopologyMap, Option<EstimatorFindings>), MapError>;

fn mapped(given: &Given) -> Made {
    let job = &SETTINGS.maps[given.map];
    let knowledge = Knowledge {
        neighbours: Some(&given.neighbours),
        beacons: Some(&given.beacons),
        anchors: &given.anchors,
        seed: given.seed,
        ..Knowledge::from(&given.log)
    };
    job.mapper.map_and_learn(knowledge, &Budget::new(MAP_BUDGET))
}

fn is_sound(name: &str, map: &TopologyMap, given: &Given) {
    assert_eq!(map.estimates.len(), given.log.node_count(), "{name}: an entry for each node");
    for estimate in map.estimates.iter().flatten() {
        assert!(estimate.position.is_finite(), "{name}: {estimate:?}");
        for row in estimate.covariance.iter().flatten() {
            assert!(row.iter().all(|entry| entry.is_finite()), "{name}: {estimate:?}");
        }
        if let Some(covariance) = estimate.covariance {
            assert!((0..3).all(|axis| covariance[axis][axis] >= 0.0), "{name}: {estimate:?}");
        }
    }
}

/// Mostly some sixteenths of a metre, sometimes any number. The places are near each other, so that grids are small.
fn length_m(choices: &mut Unstructured<'_>) -> Result<f64> {
    let usual = || |choices: &mut Unstructured<'_>| Ok(f64::from(choices.arbitrary::<i8>()?) / 16.0);
    Ok(match choices.int_in_range(0..=63_u8)? {
        0 => f64::from(choices.arbitrary::<i32>()?) / 1000.0,
        1 => f64::from(choices.arbitrary::<i8>()?) * 1e-9,
        _ => usual()(choices)?,
    })
}

fn position(choices: &mut Unstructured<'_>, is_planar: bool) -> Result<Position> {
    let height_m = if is_planar { 0.0 } else { length_m(choices)? };
    Ok(Position::new(length_m(choices)?, length_m(choices)?, height_m))
}

/// What the octets choose; `None` if no log can be like that.
fn given(choices: &mut Unstructured<'_>) -> Result<Option<Given>> {
    // Those that are slow come first, and are chosen less often.
    let map = match choices.arbitrary::<u8>()? {
        slow @ 0..32 => usize::from(slow) % SLOW,
        fast => SLOW + usize::from(fast) % (SETTINGS.maps.len() - SLOW),
    };
    let nodes = choices.int_in_range(1..=6_usize)?;
    let count = choices.int_in_range(1..=12_u32)?;
    let [is_planar, has_rssi, has_sectors, has_headings] = choices.arbitrary::<[bool; 4]>()?;
    let robots = choices.int_in_range(1..=2_u32)?;
    let mut stops = Vec::new();
    for index in 0..count {
        let heading_rad = if has_headings { Some(f64::from(choices.arbitrary::<i8>()?) / 16.0) } else { None };
        stops.push(Stop {
            robot: RobotId(index % robots),
            time: SimTime::from_nanos(u64::from(index) * 1_000_000_000 + u64::from(choices.arbitrary::<u8>()?)),
            position: position(choices, is_planar)?,
            heading_rad,
        });
    }
    let mut receptions = Vec::new();
    for node in 0..nodes {
        for stop in 0..count {
            if choices.ratio(1, 3)? {
                continue;
            }
            let sent = choices.int_in_range(0..=9_u32)?;
            let received = choices.int_in_range(0..=sent)?;
            let dbm = |choices: &mut Unstructured<'_>| Ok(f64::from(choices.arbitrary::<i8>()?) - 40.0);
            receptions.push(Reception {
                node: NodeId::from_index(node),
                stop,
                received,
                sent,
                sector: if has_sectors && received > 0 { Some(choices.int_in_range(0..=7_u8)?) } else { None },
                rssi_dbm: if has_rssi && received > 0 { Some(dbm(choices)?) } else { None },
                snr_db: None,
            });
        }
    }
    let contacts = (0..choices.int_in_range(0..=2_u32)?)
        .map(|_| Ok(Contact { robot: RobotId(0), time: SimTime::ZERO, position: position(choices, is_planar)? }))
        .collect::<Result<Vec<_>>>()?;
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    let Ok(mut log) = ReceptionLog::new(names, stops, receptions, contacts) else { return Ok(None) };
    if has_sectors {
        let even =
            EvenSectorsConfig { azimuth_sectors: 8, first_azimuth_deg: 0.0, elevations_deg: vec![[-90.0, 90.0]] };
        let Ok(table) = SectorTable::try_from(even) else { return Ok(None) };
        let Ok(with_sectors) = log.with_sectors(table) else { return Ok(None) };
        log = with_sectors;
    }
    let (neighbours, beacons) = (links(choices, nodes)?, links(choices, nodes)?);
    let (Some(neighbours), Some(beacons)) = (neighbours, beacons) else { return Ok(None) };
    let mut anchors = Vec::new();
    for node in 0..nodes {
        if choices.ratio(1, 2)? {
            anchors.push(Anchor { node: NodeId::from_index(node), position: position(choices, is_planar)? });
        }
    }
    let seed = Seed(u64::from(choices.arbitrary::<u8>()?));
    Ok(Some(Given { log, neighbours, beacons, anchors, seed, map }))
}

/// What nodes heard of each other.
fn links(choices: &mut Unstructured<'_>, nodes: usize) -> Result<Option<NeighbourLog>> {
    let mut links = Vec::new();
    for (listener, sender) in (0..nodes).flat_map(|listener| (0..nodes).map(move |sender| (listener, sender))) {
        if listener == sender || choices.ratio(1, 2)? {
            continue;
        }
        let sent = choices.int_in_range(1..=5_u32)?;
        links.push(Link {
            listener: NodeId::from_index(listener),
            sender: NodeId::from_index(sender),
            received: choices.int_in_range(1..=sent)?,
            sent,
            rssi_dbm: Some(f64::from(choices.arbitrary::<i8>()?) - 40.0),
        });
    }
    Ok(NeighbourLog::new(nodes, links).ok())
}
