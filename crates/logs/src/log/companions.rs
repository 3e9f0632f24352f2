//! What a log may have besides the places of its robots and what they heard.

use std::path::{Path, PathBuf};

use sextant_channel::{Contact, ReceptionLog, SectorReport, SectorTable};
use sextant_recording::RobotNames;

use super::file_names::{ANTENNA, CONTACTS, SECTOR_SNRS, SECTORS, TAGS};
use super::layout;
use crate::csv::table_source::TableSource;
use crate::csv::written::Written;
use crate::error::log_part::{LogPart, RowAddress};
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::path::headings::PathHeadings;
use crate::place::local_plane::LocalPlane;
use crate::ranges::dwm1001;
use crate::ranges::levers::{Levers, TagPlaces};
use crate::ranges::range_table::{self, ReadRanges, Whereabouts};
use crate::stops::antenna_file;
use crate::stops::sector_snrs::{self, KnownParts};
use crate::stops::sectors;
use crate::stops::stop_table;
use crate::time::time_zone::TimeZone;

/// What a log may have besides the places of its robots and what they heard.
#[derive(Clone, Debug)]
pub(crate) struct Companions<'a> {
    /// What the log is called in errors on it as a whole.
    pub(crate) log: LogPart,
    /// Where robots met obstacles.
    pub(crate) contacts: Option<TableSource<'a>>,
    /// The directions of the sectors.
    pub(crate) sectors: Option<TableSource<'a>>,
    /// The gains of the sectors.
    pub(crate) antenna: Option<PathBuf>,
    /// The signal-to-noise ratios of all sectors.
    pub(crate) sector_snrs: Option<TableSource<'a>>,
    /// Distances to nodes that were measured.
    pub(crate) ranges: Option<TableSource<'a>>,
    /// Where the tags that measured them are on a robot.
    pub(crate) tags: Option<TableSource<'a>>,
    /// The zone of times that do not say theirs.
    pub(crate) time_zone: Option<TimeZone>,
}

impl Companions<'_> {
    /// The files of a folder, with times in `time_zone` if they do not say theirs.
    pub(crate) fn of_folder(folder: &Path, time_zone: Option<TimeZone>) -> Self {
        let file = |name: &str| Some(folder.join(name)).filter(|file| file.exists());
        Self {
            log: folder.into(),
            contacts: file(CONTACTS).map(TableSource::from),
            sectors: file(SECTORS).map(TableSource::from),
            antenna: file(ANTENNA),
            sector_snrs: file(SECTOR_SNRS).map(TableSource::from),
            ranges: layout::ranges_of(folder).map(TableSource::from),
            tags: file(TAGS).map(TableSource::from),
            time_zone,
        }
    }

    /// None of a log.
    pub(crate) const fn none(log: LogPart) -> Self {
        Self {
            log,
            contacts: None,
            sectors: None,
            antenna: None,
            sector_snrs: None,
            ranges: None,
            tags: None,
            time_zone: None,
        }
    }

    /// The contacts. The places of the log are in `plane`.
    pub(crate) fn contacts(
        &self,
        plane: Option<LocalPlane>,
        robots: &mut RobotNames,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Contact>, RobotLogError> {
        match &self.contacts {
            Some(contacts) => stop_table::read_contacts(contacts.clone(), self.time_zone, plane, robots, notes),
            None => Ok(Vec::new()),
        }
    }

    /// The log with the sectors, if there are any. Without directions, these are where each sector has the greatest gain.
    pub(crate) fn with_sectors(
        &self,
        log: ReceptionLog,
        notes: &mut Vec<String>,
    ) -> Result<ReceptionLog, RobotLogError> {
        let directions = self.sectors.clone().map(|sectors| sectors::read(sectors, notes)).transpose()?;
        let gains = self.antenna.as_ref().map(|antenna| antenna_file::read(antenna, notes)).transpose()?;
        let table = match (directions, gains, &self.antenna) {
            (None, None, _) => return Ok(log),
            (Some(table), Some(gains), Some(antenna)) => {
                table.with_gains(gains).map_err(|why| antenna_file::other_sectors(antenna, &why))?
            }
            (Some(table), _, _) => table,
            (None, Some(gains), _) => SectorTable::from(gains),
        };
        log.with_sectors(table).map_err(|why| RobotLogError::Log { part: self.log.clone(), why })
    }

    /// The log with the signal-to-noise ratios of all sectors: the `reports` of the receptions, if these have a column for
    /// them, or those of a table of their own. Repeated ones are averaged.
    pub(crate) fn with_sector_snrs(
        &self,
        log: ReceptionLog,
        reports: Option<Vec<SectorReport>>,
        known: KnownParts<'_>,
        notes: &mut Vec<String>,
    ) -> Result<ReceptionLog, RobotLogError> {
        let reports = match (reports, &self.sector_snrs) {
            (None, None) => return Ok(log),
            (Some(reports), None) => reports,
            (None, Some(table)) => sector_snrs::read(table.clone(), &log, known, notes)?,
            (Some(_), Some(table)) => {
                let (part, column) = (table.part(), sector_snrs::COLUMN);
                let (receptions, noun) = (known.receptions, part.noun());
                let problem =
                    format!("{receptions} has the column `{column}` too; remove the column, or this {noun}");
                return Err(wrong(part, problem));
            }
        };
        let log = log.with_sector_snrs(SectorReport::averaged(reports));
        log.map_err(|why| RobotLogError::Log { part: self.log.clone(), why })
    }

    /// The ranges, of which those to nodes in `known` have their numbers; none if the log has no table of them. `path` is the table with
    /// the paths of the robots, if it is one: it has their headings, which places of tags need.
    pub(crate) fn ranges(
        &self,
        form: &FormOptions,
        whereabouts: Whereabouts<'_>,
        path: Option<TableSource<'_>>,
        known: &[String],
        notes: &mut Vec<String>,
    ) -> Result<Option<ReadRanges>, RobotLogError> {
        let levers = match (&self.tags, &self.ranges, path) {
            (Some(tags), Some(_), Some(path)) => {
                let tags = TagPlaces::read(tags.clone(), notes)?;
                Some(Levers { tags, headings: PathHeadings::read(path, &Written::of_places(form))? })
            }
            (Some(tags), Some(_), None) => {
                let problem = "it says where tags are on a robot, but the log has no path with its headings; allowed: beside path.csv or \
                               odometry.csv with the column heading_rad or heading_deg";
                return Err(wrong(tags.part(), problem.to_owned()));
            }
            (_, None, _) | (None, _, _) => None,
        };
        let read = |ranges: &TableSource<'_>| {
            let levers = levers.as_ref();
            match ranges {
                TableSource::File(file) if dwm1001::is_output(file) => {
                    let table = dwm1001::read(file, form.time_zone)?;
                    range_table::read((&table).into(), &Written::default(), levers, whereabouts, known, notes)
                }
                _ => range_table::read(ranges.clone(), &Written::of_ranges(form), levers, whereabouts, known, notes),
            }
        };
        self.ranges.as_ref().map(read).transpose()
    }

    /// Refuses the signal-to-noise ratios of all sectors beside a log whose stops have no names.
    pub(crate) fn refuse_sector_snrs(&self) -> Result<(), RobotLogError> {
        let Some(table) = &self.sector_snrs else { return Ok(()) };
        let part = table.part();
        let problem = match part {
            LogPart::File(_) => {
                "found beside a log without stops.csv, so that its stops have no names; allowed: beside stops.csv and \
                 receptions.csv"
            }
            LogPart::Table(_) => {
                "found beside a path, whose stops have no names; allowed: beside a table of stops and one of receptions"
            }
        };
        Err(wrong(part, problem.to_owned()))
    }
}

/// The error that a part of the log should not be there.
fn wrong(part: LogPart, problem: String) -> RobotLogError {
    let at = match part {
        LogPart::File(path) => RowAddress::File { path, line: 1 },
        LogPart::Table(name) => RowAddress::Table { name, row: None },
    };
    RobotLogError::Row { at, problem }
}
