//! `packets.csv`: one row for each packet that a robot heard.

use std::path::Path;

use sextant_kernel::RobotId;

use super::error::RobotLogError;
use super::gatherer::Gatherer;
use super::packet::Packet;
use super::table::Table;

/// Reads the packets in the file `path` row by row into `gatherer`. `robots` are the names of the robots with a path; none if
/// there is one robot without a name.
pub(super) fn read(
    path: &Path,
    robots: &[String],
    gatherer: &mut Gatherer,
    notes: &mut Vec<String>,
) -> Result<(), RobotLogError> {
    let table = Table::open(path, &["t_s", "node"], &["rssi_dbm", "snr_db", "sector", "robot"])?;
    notes.extend(table.ignored());
    let [time, node, rssi, snr] = ["t_s", "node", "rssi_dbm", "snr_db"].map(|name| table.column(name));
    let [sector, robot] = ["sector", "robot"].map(|name| table.column(name));
    if robot.exists() && robots.is_empty() {
        let problem =
            "column `robot` names the robots, but path.csv has no such column: give it one, or remove this one";
        return Err(table.wrong_header(problem));
    }
    if !robot.exists() && robots.len() > 1 {
        let problem = format!("column `robot` is missing: path.csv has the paths of {} robots", robots.len());
        return Err(table.wrong_header(problem));
    }
    table.rows(|row| {
        let robot = match row.filled(robot) {
            Some(name) => {
                let known = || format!("one of the robots in path.csv: {}", robots.join(", "));
                let index = robots.iter().position(|known| known == name);
                RobotId::from_index(index.ok_or_else(|| row.wrong(robot, known()))?)
            }
            None if robot.exists() => return Err(row.wrong(robot, "the name of a robot")),
            None => RobotId(0),
        };
        gatherer.take(Packet {
            time: row.instant(time)?,
            robot,
            node: row.node(node)?,
            rssi_dbm: row.finite(rssi)?,
            snr_db: row.finite(snr)?,
            sector: row.sector(sector)?,
        })
    })?;
    Ok(())
}
