//! `stops.csv` and `contacts.csv`: where robots listened and what they met.

use std::collections::{BTreeMap, BTreeSet};

use sextant_channel::{Contact, Stop};
use sextant_kernel::SimTime;

use super::heading::Headings;
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::packets::sending::MOST_SENT;
use crate::path::headings;
use crate::place::local_plane::LocalPlane;
use crate::place::place_columns::{COLUMNS, Frame, Places};
use crate::place::without_fix::{is_origin, places_of, without_fix_m};
use crate::time::instant;
use crate::time::time_zone::TimeZone;
use sextant_recording::RobotNames;

/// The stops of a log.
#[derive(Debug)]
pub(crate) struct Stops {
    /// Name of the file or table that has them, for messages.
    pub(crate) name: String,
    pub(crate) stops: Vec<Stop>,
    /// The index of each stop by its name in the files.
    pub(crate) ids: BTreeMap<String, u32>,
    /// Packets that a node sent at each stop, where the file says so.
    pub(crate) sent: Vec<Option<u32>>,
    /// The plane of the places, if they are given by latitude and longitude.
    pub(crate) plane: Option<LocalPlane>,
    /// Names of the stops that were left out, because the receiver had no fix.
    pub(crate) left_out: BTreeSet<String>,
}

/// A row of the file.
struct Listed {
    name: String,
    sent: Option<u32>,
    stop: Stop,
}

/// Reads the stops in a table, as it is `written`. If `skips_no_fix`, rows without a fix are
/// left out.
pub(crate) fn read(
    source: TableSource<'_>,
    written: &Written,
    skips_no_fix: bool,
    robots: &mut RobotNames,
    notes: &mut Vec<String>,
) -> Result<Stops, RobotLogError> {
    let optional = [&COLUMNS[..], &instant::COLUMNS, &headings::COLUMNS, &["robot", "sent"]].concat();
    let known =
        KnownColumns { required: &["stop"], optional: &optional, names: &written.names, others: Others::Ignored };
    let table = Table::open_known(source, known)?;
    notes.extend(table.notes());
    let places = Places::of(&table, Frame::Any, notes)?;
    let time = Times::find(&table, written.time_zone, notes);
    let mut headings = Headings::find(&table, notes);
    let [id, robot, sent] = ["stop", "robot", "sent"].map(|name| table.column(name));
    if time.is_none() {
        notes.push(format!("no times (t_s) in {}: the duration of the survey is unknown", table.name()));
    }
    let mut read = Stops {
        name: table.name(),
        stops: Vec::new(),
        ids: BTreeMap::new(),
        sent: Vec::new(),
        plane: None,
        left_out: BTreeSet::new(),
    };
    let mut listed: Vec<Listed> = Vec::new();
    let mut names = BTreeSet::new();
    table.rows(|row| {
        let name = row.name(id, "a number or a name that is not used above")?;
        if !names.insert(name.clone().into_owned()) {
            return Err(row.wrong(id, "each stop once; this stop is already given above"));
        }
        if skips_no_fix && places.is_without_fix(row) {
            read.left_out.insert(name.into_owned());
            return Ok(());
        }
        let sent = row.whole(sent, MOST_SENT)?;
        let stop = Stop {
            robot: row.robot(robot, robots)?,
            time: time.map_or(Ok(SimTime::ZERO), |time| row.instant(time))?,
            position: places.read(row, &mut read.plane)?,
            heading_rad: headings.read(row)?,
        };
        listed.push(Listed { name: name.into_owned(), sent, stop });
        Ok(())
    })?;
    // Of degrees, the rows themselves told.
    let drops_origin = skips_no_fix
        && read.plane.is_none()
        && without_fix_m(&places_of(listed.iter().map(|row| &row.stop))).is_some();
    for Listed { name, sent, stop } in listed {
        if drops_origin && is_origin(stop.position) {
            read.left_out.insert(name);
            continue;
        }
        let index = u32::try_from(read.stops.len()).expect("fewer than 2^32 stops");
        read.ids.insert(name, index);
        read.sent.push(sent);
        read.stops.push(stop);
    }
    Ok(read)
}

/// Reads the contacts in a table. The places of the log are in `plane`, dates that do not say their zone in `zone`.
pub(crate) fn read_contacts(
    source: TableSource<'_>,
    zone: Option<TimeZone>,
    plane: Option<LocalPlane>,
    robots: &mut RobotNames,
    notes: &mut Vec<String>,
) -> Result<Vec<Contact>, RobotLogError> {
    let table = Table::open(source, &[], &[&instant::COLUMNS[..], &COLUMNS, &["robot"]].concat())?;
    notes.extend(table.notes());
    let time = Times::of(&table, zone, notes)?;
    let places = Places::of(&table, Frame::of(plane.as_ref()), notes)?;
    let robot = table.column("robot");
    let mut plane = plane;
    let mut contacts = Vec::new();
    table.rows(|row| {
        contacts.push(Contact {
            robot: row.robot(robot, robots)?,
            time: row.instant(time)?,
            position: places.read(row, &mut plane)?,
        });
        Ok(())
    })?;
    Ok(contacts)
}
