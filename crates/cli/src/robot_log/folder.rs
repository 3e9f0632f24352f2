//! The folder of a log: `stops.csv`, `receptions.csv`, `contacts.csv`, `sectors.csv`.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{Contact, Reception, ReceptionLog, ReceptionLogBuilder, Stop};
use sextant_kernel::NodeId;

use super::error::RobotLogError;
use super::log::RobotLog;
use super::options::ReadOptions;
use super::output::Output;
use super::sectors;
use super::table::{Row, Table};
use crate::robot_names::RobotNames;

pub(super) const STOPS: &str = "stops.csv";
pub(super) const RECEPTIONS: &str = "receptions.csv";
const CONTACTS: &str = "contacts.csv";
const SECTORS: &str = "sectors.csv";

/// Reads the log in `folder`. Stops are numbered in the order of `stops.csv`, nodes in the order of their first row in
/// `receptions.csv`. A row with nothing received adds a node that was not heard.
///
/// # Errors
/// If a file is missing, cannot be read, or has an invalid row; the error names file, line and column.
pub(super) fn read(folder: &Path, _options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut robots = RobotNames::default();
    let (stops, stop_ids) = read_stops(&folder.join(STOPS), &mut robots)?;
    if stops.is_empty() {
        return Err(RobotLogError::NoStops { path: folder.to_owned() });
    }
    let (names, receptions) = read_receptions(&folder.join(RECEPTIONS), &stop_ids)?;
    let contacts = folder.join(CONTACTS);
    let contacts = if contacts.exists() { read_contacts(&contacts, &mut robots)? } else { Vec::new() };
    let sectors = folder.join(SECTORS);
    let sectors = sectors.exists().then(|| sectors::read(&sectors)).transpose()?;
    let log = receptions.build(names, stops, contacts).and_then(|log| log.with_robots(robots.into_vec()));
    let log = match sectors {
        Some(sectors) => log.and_then(|log| log.with_sectors(sectors)),
        None => log,
    };
    let log = log.map_err(|why| RobotLogError::Log { path: folder.to_owned(), why })?;
    Ok(RobotLog { log, plane: None, notes: Vec::new() })
}

/// The stops, and the index of each by its name in the files.
fn read_stops(path: &Path, robots: &mut RobotNames) -> Result<(Vec<Stop>, BTreeMap<String, u32>), RobotLogError> {
    let table = Table::read(path, &["stop", "t_s", "x_m", "y_m"], &["z_m", "robot"])?;
    let robot = table.column("robot");
    let (id, time) = (table.column("stop"), table.column("t_s"));
    let place = ["x_m", "y_m", "z_m"].map(|name| table.column(name));
    let mut stops = Vec::new();
    let mut ids = BTreeMap::new();
    table.rows(|row| {
        let name = row.filled(id).ok_or_else(|| row.wrong(id, "a number or a name that is not used above"))?;
        let index = u32::try_from(stops.len()).expect("fewer than 2^32 stops");
        if ids.insert(name.to_owned(), index).is_some() {
            return Err(row.wrong(id, "each stop once; this stop is already given above"));
        }
        stops.push(Stop {
            robot: row.robot(robot, robots)?,
            time: row.instant(time)?,
            position: row.position(place)?,
        });
        Ok(())
    })?;
    Ok((stops, ids))
}

/// Names of the nodes and their receptions.
fn read_receptions(
    path: &Path,
    stop_ids: &BTreeMap<String, u32>,
) -> Result<(Vec<String>, ReceptionLogBuilder), RobotLogError> {
    let table = Table::read(path, &["node", "stop", "received"], &["sent", "sector", "rssi_dbm", "snr_db"])?;
    let [node, stop, received, sent] = ["node", "stop", "received", "sent"].map(|name| table.column(name));
    let [sector, rssi, snr] = ["sector", "rssi_dbm", "snr_db"].map(|name| table.column(name));
    let mut names = Vec::new();
    let mut nodes = BTreeMap::new();
    let mut receptions = ReceptionLogBuilder::default();
    let mut pairs = Vec::new();
    table.rows(|row| {
        let name = row.text(node);
        if name.is_empty() {
            return Err(row.wrong(node, "the name of a node"));
        }
        let node = *nodes.entry(name.to_owned()).or_insert_with(|| {
            names.push(name.to_owned());
            NodeId::from_index(names.len() - 1)
        });
        let id = row.filled(stop).unwrap_or("");
        let stop = *stop_ids.get(id).ok_or_else(|| row.wrong(stop, known_stops(stop_ids)))?;
        let count = |column| row.whole(column, u32::MAX);
        let reception = Reception {
            node,
            stop,
            received: count(received)?.ok_or_else(|| row.wrong(received, "a whole number, 0 or above"))?,
            sent: count(sent)?.unwrap_or(1),
            sector: row.whole(sector, u32::from(u8::MAX))?.and_then(|sector| u8::try_from(sector).ok()),
            rssi_dbm: row.finite(rssi)?,
            snr_db: row.finite(snr)?,
        };
        if reception.received > reception.sent {
            let default = if row.filled(sent).is_some() { "" } else { " (1 if `sent` is absent)" };
            return Err(row.wrong(received, format!("at most {}, the packets sent{default}", reception.sent)));
        }
        pairs.push((node, stop, row.offset));
        // 0 of 1 packets means the same as an absent pair.
        let Reception { received, sent, sector, rssi_dbm, snr_db, .. } = reception;
        if (received, sent, sector, rssi_dbm, snr_db) != (0, 1, None, None, None) {
            receptions.push(reception);
        }
        Ok(())
    })?;
    pairs.sort_unstable();
    match pairs
        .windows(2)
        .filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 == pair[1].1)
        .min_by_key(|pair| pair[1].2)
    {
        Some(pair) => Err(twice(path, &table, &names, [pair[0].2, pair[1].2], pair[0].0)),
        None => Ok((names, receptions)),
    }
}

fn twice(path: &Path, table: &Table, names: &[String], offsets: [usize; 2], node: NodeId) -> RobotLogError {
    let [first, second] = offsets.map(|offset| table.line(offset));
    let name = &names[node.index()];
    let problem =
        format!("node `{name}` at this stop is already on line {first}; give each pair of node and stop once");
    RobotLogError::Row { path: path.to_owned(), line: second, problem }
}

fn known_stops(ids: &BTreeMap<String, u32>) -> String {
    let mut by_index: Vec<(&u32, &String)> = ids.iter().map(|(id, index)| (index, id)).collect();
    by_index.sort_unstable();
    match by_index.as_slice() {
        [(_, first), .., (_, last)] => {
            format!("one of the {} stops in {STOPS}, from `{first}` to `{last}`", ids.len())
        }
        _ => format!("the only stop in {STOPS}: {}", by_index.iter().map(|(_, id)| id.as_str()).collect::<String>()),
    }
}

fn read_contacts(path: &Path, robots: &mut RobotNames) -> Result<Vec<Contact>, RobotLogError> {
    let table = Table::read(path, &["t_s", "x_m", "y_m"], &["z_m", "robot"])?;
    let robot = table.column("robot");
    let time = table.column("t_s");
    let place = ["x_m", "y_m", "z_m"].map(|name| table.column(name));
    let mut contacts = Vec::new();
    table.rows(|row: &Row<'_>| {
        contacts.push(Contact {
            robot: row.robot(robot, robots)?,
            time: row.instant(time)?,
            position: row.position(place)?,
        });
        Ok(())
    })?;
    Ok(contacts)
}

/// Writes `log` to a folder, from which [`read`] reads the same log. The folder is created if it does not exist.
/// Receptions of 0 of 1 packets are omitted, because an absent pair means the same.
///
/// # Errors
/// If the log has no stops, or a file cannot be written.
pub fn write(folder: &Path, log: &ReceptionLog) -> Result<(), RobotLogError> {
    if log.stops().is_empty() {
        return Err(RobotLogError::NoStops { path: folder.to_owned() });
    }
    std::fs::create_dir_all(folder).map_err(|why| RobotLogError::write(folder, why))?;
    let is_named = !log.robots().is_empty();
    let with_robot = |columns: &[&'static str]| [columns, if is_named { &["robot"] } else { &[] }].concat();
    let mut stops = Output::new(&with_robot(&["stop", "t_s", "x_m", "y_m", "z_m"]));
    for (index, stop) in log.stops().iter().enumerate() {
        stops.text(&index.to_string()).instant(stop.time).position(stop.position);
        if is_named {
            stops.text(&log.robot_name(stop.robot));
        }
        stops.end();
    }
    stops.save(&folder.join(STOPS))?;

    let sectors = log.receptions().iter().any(|reception| reception.sector.is_some());
    let strengths = log.receptions().iter().any(|reception| reception.rssi_dbm.is_some());
    let ratios = log.receptions().iter().any(|reception| reception.snr_db.is_some());
    let mut header = vec!["node", "stop", "received", "sent"];
    header.extend(sectors.then_some("sector"));
    header.extend(strengths.then_some("rssi_dbm"));
    header.extend(ratios.then_some("snr_db"));
    let mut receptions = Output::new(&header);
    for (index, name) in log.names().iter().enumerate() {
        let heard = log.of(NodeId::from_index(index));
        let in_vain = Reception {
            node: NodeId::from_index(index),
            stop: 0,
            received: 0,
            sent: 1,
            sector: None,
            rssi_dbm: None,
            snr_db: None,
        };
        // Each node needs a row to keep its order. For an unheard node it is 0 of 1 packets at the first stop, which
        // means the same as no row.
        let unheard = heard.is_empty().then_some(in_vain);
        for reception in heard.iter().chain(unheard) {
            receptions.text(name);
            for count in [reception.stop, reception.received, reception.sent] {
                receptions.text(&count.to_string());
            }
            if sectors {
                receptions.text(&reception.sector.map_or_else(String::new, |sector| sector.to_string()));
            }
            if strengths {
                receptions.text(&reception.rssi_dbm.map_or_else(String::new, |rssi| rssi.to_string()));
            }
            if ratios {
                receptions.text(&reception.snr_db.map_or_else(String::new, |snr| snr.to_string()));
            }
            receptions.end();
        }
    }
    receptions.save(&folder.join(RECEPTIONS))?;
    if let Some(table) = log.sectors() {
        sectors::write(&folder.join(SECTORS), table)?;
    }

    if log.contacts().is_empty() {
        return Ok(());
    }
    let mut contacts = Output::new(&with_robot(&["t_s", "x_m", "y_m", "z_m"]));
    for contact in log.contacts() {
        contacts.instant(contact.time).position(contact.position);
        if is_named {
            contacts.text(&log.robot_name(contact.robot));
        }
        contacts.end();
    }
    contacts.save(&folder.join(CONTACTS))
}
