//! A log written as a folder of CSV files.

use std::path::Path;

use sextant_channel::{Reception, ReceptionLog};
use sextant_kernel::NodeId;
use sextant_recording::disk;

use super::file_names::{ANTENNA, CONTACTS, RANGES, RECEPTIONS, SECTOR_SNRS, SECTORS, STOPS};
use crate::csv::output::Output;
use crate::error::robot_log_error::RobotLogError;
use crate::ranges::range_table;
use crate::stops::antenna_file;
use crate::stops::sector_snrs;
use crate::stops::sectors;

/// Writes `log` to a folder, from which [`read`](crate::read) reads the same log. The folder is created if it does not exist.
/// Receptions of 0 of 1 packets are omitted, because an absent pair means the same; if other receptions have another number
/// of packets, `stops.csv` says that an absent pair is one packet.
///
/// # Errors
/// If the log has no stops, or a file cannot be written.
pub fn write(folder: &Path, log: &ReceptionLog) -> Result<(), RobotLogError> {
    if log.stops().is_empty() {
        return Err(RobotLogError::NoStops { part: folder.into() });
    }
    disk::create_folders(folder).map_err(|why| RobotLogError::write(folder, why))?;
    let is_named = !log.robots().is_empty();
    let with_robot = |columns: &[&'static str]| [columns, if is_named { &["robot"] } else { &[] }].concat();
    let has_counts = log.receptions().iter().any(|reception| reception.sent != 1);
    let mut header = with_robot(&["stop", "t_s", "x_m", "y_m", "z_m"]);
    header.extend(has_counts.then_some("sent"));
    let has_headings = log.has_headings();
    header.extend(has_headings.then_some("heading_rad"));
    let mut stops = Output::new(&header);
    for (index, stop) in log.stops().iter().enumerate() {
        stops.text(&index.to_string()).instant(stop.time).position(stop.position);
        if is_named {
            stops.text(&log.robot_name(stop.robot));
        }
        if has_counts {
            stops.text("1");
        }
        if has_headings {
            stops.text(&stop.heading_rad.map_or_else(String::new, |heading_rad| heading_rad.to_string()));
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
        if let Some(gains) = table.gains() {
            antenna_file::write(&folder.join(ANTENNA), gains)?;
        }
    }
    if log.has_sector_snrs() {
        sector_snrs::write(&folder.join(SECTOR_SNRS), log)?;
    }

    if !log.ranges().is_empty() {
        range_table::write(&folder.join(RANGES), log)?;
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
