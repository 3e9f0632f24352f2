//! The log of a robot in memory.

use super::companions::Companions;
use super::drive;
use super::form::{self, Form, PacketKind, PathKind};
use super::stop_log::{self, StopLog};
use crate::csv::memory_table::MemoryTable;
use crate::csv::table_source::TableSource;
use crate::error::log_part::LogPart;
use crate::error::robot_log_error::RobotLogError;
use crate::options::form_options::FormOptions;
use crate::options::read_options::ReadOptions;
use crate::robot_log::RobotLog;

/// The log of a robot in memory: the tables that a folder with a log has as files.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryLog<'a> {
    /// Where robots were: a table of stops if it has a column `stop`, or their paths over time.
    pub places: MemoryTable<'a>,
    /// What they heard: the receptions at the stops, or the packets on the paths. It may be absent beside ranges.
    pub heard: Option<MemoryTable<'a>>,
    /// Distances to nodes that were measured, at the stops or on the paths.
    pub ranges: Option<MemoryTable<'a>>,
    /// Where robots met obstacles.
    pub contacts: Option<MemoryTable<'a>>,
    /// The directions of the sectors of the antenna.
    pub sectors: Option<MemoryTable<'a>>,
    /// The signal-to-noise ratios of all sectors, beside stops.
    pub sector_snrs: Option<MemoryTable<'a>>,
}

impl<'a> MemoryLog<'a> {
    /// A log of stops and receptions, or of a path and packets.
    #[must_use]
    pub const fn new(places: MemoryTable<'a>, heard: MemoryTable<'a>) -> Self {
        Self { places, heard: Some(heard), ranges: None, contacts: None, sectors: None, sector_snrs: None }
    }

    /// A log of stops or of a path, and ranges that were measured there.
    #[must_use]
    pub const fn of_ranges(places: MemoryTable<'a>, ranges: MemoryTable<'a>) -> Self {
        Self { places, heard: None, ranges: Some(ranges), contacts: None, sectors: None, sector_snrs: None }
    }

    /// Reads the log.
    pub(crate) fn read(&self, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
        let Self { places, heard, ranges, contacts, sectors, sector_snrs } = self;
        let FormOptions { path, packets, stop_files, .. } = &options.form;
        let files = [("path", path.is_some()), ("packets", packets.is_some()), ("stop_files", stop_files.is_some())];
        if let Some((flag, _)) = files.into_iter().find(|(_, is_given)| *is_given) {
            let problem = format!("option `{flag}` names files, but the log is in memory: leave the option out");
            return Err(RobotLogError::Form { problem });
        }
        let log = LogPart::Table(places.name().to_owned());
        let has_stops = self.has_stops(options);
        let packets = if heard.is_some() { PacketKind::Csv } else { PacketKind::Ranges };
        let form = if has_stops { Form::Stops } else { Form::Drive(PathKind::Csv, packets) };
        form::refuse(&log, form, options)?;
        let companions = Companions {
            contacts: contacts.as_ref().map(TableSource::from),
            sectors: sectors.as_ref().map(TableSource::from),
            sector_snrs: sector_snrs.as_ref().map(TableSource::from),
            ranges: ranges.as_ref().map(TableSource::from),
            time_zone: options.form.time_zone,
            ..Companions::none(log)
        };
        if has_stops {
            stop_log::read(
                StopLog { stops: places.into(), receptions: heard.as_ref().map(TableSource::from), companions },
                options,
            )
        } else {
            drive::read_tables(places.into(), heard.as_ref().map(TableSource::from), &companions, options)
        }
    }

    /// Whether the table of places has a column with the names of stops.
    fn has_stops(&self, options: &ReadOptions) -> bool {
        let given = options.form.path_fields.as_ref().and_then(|names| names.name("stop"));
        self.places.column_names().any(|name| name.trim() == given.unwrap_or("stop"))
    }
}
