//! Logs to be written differently.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, SimTime};
use sextant_mapper::TopologyMap;

/// Ten packets of each node at each stop, with strengths; links have their own shadowing, and faint packets are lost.
fn log(nodes: &[Position], stops: &[Position]) -> ReceptionLog {
    let normal = |what: u64, node: u32, stop: u32| {
        Seed(what).normal(Purpose::new(3), [u64::from(node), u64::from(stop), what])
    };
    let mut receptions = Vec::new();
    for (node, place) in (0_u32..).zip(nodes) {
        for (stop, at) in (0_u32..).zip(stops) {
            let mean_dbm = -55.0 - 26.0 * place.distance_m(*at).max(0.5).log10() + 4.0 * normal(1, node, stop);
            let heard: Vec<f64> = (0..10)
                .map(|packet| mean_dbm + 2.5 * normal(2 + packet, node, stop))
                .filter(|&dbm| dbm > -84.0)
                .collect();
            receptions.push(Reception {
                rssi_dbm: (!heard.is_empty()).then(|| heard.iter().sum::<f64>() / heard.len() as f64),
                ..Reception::heard(NodeId(node), stop, u32::try_from(heard.len()).expect("few packets"), 10)
            });
        }
    }
    let stop = |(number, &position): (u64, &Position)| Stop {
        time: SimTime::from_nanos(1_000_000_000 * number),
        ..Stop::at(position)
    };
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, (0..).zip(stops).map(stop).collect(), receptions, Vec::new()).expect("a log")
}

/// `count` places in a box (m).
fn scattered(count: u64, what: u64, [width_m, depth_m, tall_m]: [f64; 3]) -> Vec<Position> {
    let along = |i: u64, axis: u64| Seed(what).uniform(Purpose::new(3), [i, axis, what]);
    let place = |i: u64| Position::new(width_m * along(i, 0), depth_m * along(i, 1), tall_m * along(i, 2));
    (0..count).map(place).collect()
}

/// Places on a lattice of so many columns and rows, 2.5 m apart.
fn lattice_of(columns: u32, rows: u32) -> Vec<Position> {
    let at = |k: u32| Position::new(2.5 * f64::from(k % columns), 2.5 * f64::from(k / columns), 0.0);
    (0..columns * rows).map(at).collect()
}

/// Nine nodes and a lattice of stops, many of which are at equal distances from each other.
pub(super) fn lattice() -> ReceptionLog {
    log(&scattered(9, 31, [15.0, 10.0, 0.0]), &lattice_of(7, 5))
}

/// Three nodes and a few stops anywhere.
pub(super) fn few() -> ReceptionLog {
    log(&scattered(3, 32, [12.0, 8.0, 0.0]), &scattered(12, 33, [12.0, 8.0, 0.0]))
}

/// Stops at several heights.
pub(super) fn in_space() -> ReceptionLog {
    log(&scattered(3, 34, [12.0, 8.0, 6.0]), &scattered(16, 35, [12.0, 8.0, 6.0]))
}

/// Stops on a straight line that is not along an axis.
pub(super) fn on_a_line() -> ReceptionLog {
    let stops: Vec<Position> = (0..12).map(|i| Position::new(2.0 * f64::from(i), 0.75 * f64::from(i), 0.0)).collect();
    log(&scattered(3, 36, [22.0, 8.0, 0.0]), &stops)
}

/// The same log without strengths.
pub(super) fn without_strengths(log: &ReceptionLog) -> ReceptionLog {
    let receptions = log.receptions().iter().map(|reception| Reception { rssi_dbm: None, ..reception }).collect();
    ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions, Vec::new()).expect("a log")
}

/// The logs in the folders of a folder: `stops.csv` and `receptions.csv` in metres. Others are left out.
pub(super) fn of_folder(folder: &Path) -> Vec<(String, ReceptionLog)> {
    let mut folders: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    folders.sort();
    let named = |path: &std::path::PathBuf| Some((path.file_name()?.to_string_lossy().into_owned(), of_files(path)?));
    folders.iter().filter_map(named).collect()
}

/// The cells of a row by the names of their columns.
type Row = BTreeMap<String, String>;

fn rows(file: &Path) -> Option<Vec<Row>> {
    let text = std::fs::read_to_string(file).ok()?;
    let mut lines = text.lines();
    let head: Vec<String> = lines.next()?.split(',').map(str::to_owned).collect();
    let row = |line: &str| head.iter().cloned().zip(line.split(',').map(str::to_owned)).collect();
    Some(lines.map(row).collect())
}

fn number(row: &Row, key: &str) -> Option<f64> {
    row.get(key)?.parse().ok()
}

/// The mean error of a map of the log in a folder, seen from above (m), if the folder has the truth.
pub(super) fn mean_error_m(folder: &Path, log: &ReceptionLog, map: &TopologyMap) -> Option<f64> {
    let mut errors_m = Vec::new();
    for row in rows(&folder.join("nodes.csv"))? {
        let truth = Position::new(number(&row, "x_m")?, number(&row, "y_m")?, 0.0);
        let node = log.names().iter().position(|name| *name == row["node"]);
        if let Some(found) = node.and_then(|node| map.estimates[node].as_ref()) {
            errors_m.push(truth.distance_m(Position { z_m: 0.0, ..found.position }));
        }
    }
    Some(errors_m.iter().sum::<f64>() / errors_m.len() as f64)
}

fn of_files(folder: &Path) -> Option<ReceptionLog> {
    let rows = |name: &str| rows(&folder.join(name));
    let mut number_of: BTreeMap<String, u32> = BTreeMap::new();
    let mut stops = Vec::new();
    for row in rows("stops.csv")? {
        let position = Position::new(number(&row, "x_m")?, number(&row, "y_m")?, number(&row, "z_m").unwrap_or(0.0));
        number_of.insert(row["stop"].clone(), u32::try_from(stops.len()).ok()?);
        let time = SimTime::from_nanos(1_000_000_000 * stops.len() as u64);
        stops.push(Stop { time, ..Stop::at(position) });
    }
    let mut names: Vec<String> = Vec::new();
    let mut receptions = Vec::new();
    for row in rows("receptions.csv")? {
        let node = names.iter().position(|name| *name == row["node"]).unwrap_or_else(|| {
            names.push(row["node"].clone());
            names.len() - 1
        });
        let count = |key: &str| row.get(key).and_then(|text| text.parse::<u32>().ok());
        let received = count("received").unwrap_or(1);
        receptions.push(Reception {
            rssi_dbm: number(&row, "rssi_dbm"),
            ..Reception::heard(
                NodeId::from_index(node),
                *number_of.get(&row["stop"])?,
                received,
                count("sent").unwrap_or(received),
            )
        });
    }
    ReceptionLog::new(names, stops, receptions, Vec::new()).ok()
}
