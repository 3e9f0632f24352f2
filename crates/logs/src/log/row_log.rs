//! A folder with `stops.csv` and `receptions.csv` that is read row by row, for logs that are too large for the memory.

use std::path::{Path, PathBuf};

use sextant_channel::{Position, Reception, ReceptionLog, ReceptionLogBuilder};
use sextant_kernel::{Interrupted, NodeId};
use sextant_recording::RobotNames;

use super::companions::Companions;
use super::file_names::{RECEPTIONS, STOPS};
use super::form;
use super::layout::Layout;
use super::stop_log::{left_out_note, unused_sector_snrs};
use crate::LocalPlane;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
#[cfg(test)]
use crate::options::form_options::FormOptions;
use crate::options::read_options::ReadOptions;
use crate::packets::reciprocal;
use crate::packets::rssi_check::RssiCheck;
use crate::packets::signal::{Signal, Strength};
use crate::packets::strengths::Strengths;
use crate::stops::pair_notes::{Listing, PartNames};
use crate::stops::pairs::{Collected, Collector, Kept, PairCount, Rule, Seen};
use crate::stops::receptions::{self, OfRows, ReadRow, SignalKind};
use crate::stops::stop_table::{self, Stops};

/// What a user should know of a log with ranges that is mapped part by part.
pub const UNUSED_RANGES: &str = "measured ranges are not used, because the log is mapped part by part";

/// No row states the packets sent.
const UNSTATED: u32 = u32::MAX;

/// A log whose receptions stay in their file. Rows of a node may be in any places of the file, and several rows may be of one
/// pair of a node and a stop; so rows become receptions only where all rows of a node are at hand
/// ([`receptions`](Self::receptions)), by a rule that all rows of the file give.
#[derive(Debug)]
pub struct RowLog {
    /// Its stops, contacts, sectors and the names of its nodes, without receptions.
    pub whole: ReceptionLog,
    /// The plane of its places, if they are given by latitude and longitude.
    pub plane: Option<LocalPlane>,
    /// Notes for the user.
    pub notes: Vec<String>,
    file: PathBuf,
    /// The name of the file for notes.
    receptions: String,
    stops: Stops,
    options: ReadOptions,
    listing: Listing,
    kind: SignalKind,
    seen: Seen,
    rule: Option<Rule>,
}

/// Takes the rows of a log, each as a reception with its stop. A row that does not state the packets sent has the most that
/// can be stated.
pub type TakeRow<'a> = &'a mut dyn FnMut(Reception, Position) -> Result<(), Interrupted>;

impl RowLog {
    /// Opens the log `path` and passes its rows to `take` for the first time. `None` if it has no `stops.csv` and
    /// `receptions.csv`.
    ///
    /// # Errors
    /// If a file is missing, cannot be read, or has an invalid row; the first error of `take`.
    pub fn open(path: &Path, options: &ReadOptions, take: TakeRow<'_>) -> Result<Option<Self>, RobotLogError> {
        let layout = Layout::of(path, &options.form)?;
        form::refuse(&path.into(), layout.form(), options)?;
        let Layout::Stops(folder) = &layout else { return Ok(None) };
        let mut notes = Vec::new();
        let companions = Companions::of_folder(folder, options.form.time_zone);
        let file = folder.join(RECEPTIONS);
        if companions.ranges.is_some() {
            if !file.exists() {
                return Ok(None);
            }
            notes.push(UNUSED_RANGES.to_owned());
        }
        if options.form.reciprocal {
            notes.push(reciprocal::NOTE.to_owned());
        }
        let mut robots = RobotNames::default();
        let written = Written::of_places(&options.form);
        let skips = options.repair.skip_no_fix;
        let stops = stop_table::read(folder.join(STOPS).into(), &written, skips, &mut robots, &mut notes)?;
        if stops.stops.is_empty() {
            return Err(RobotLogError::NoStops { part: folder.as_path().into() });
        }
        let mut rssi = RssiCheck::new(options);
        let mut strengths = Strengths::of(&options.form);
        let (rows, kind) =
            receptions::open(file.as_path().into(), &stops, &options.form, &mut rssi, &mut strengths, &mut notes)?;
        let listing = rows.listing;
        notes.extend(unused_sector_snrs(&companions, rows.have_sector_snrs()));
        let OfRows { name: receptions, names, left_out } = rows.each(|row, _| Ok(pass(row, &stops, &mut *take)?))?;
        strengths.finish(&mut notes)?;
        notes.extend(left_out_note(&stops, &receptions, left_out));
        notes.extend(rssi.note());
        let contacts = companions.contacts(stops.plane, &mut robots, &mut notes)?;
        let whole = ReceptionLogBuilder::default().build(names, stops.stops.clone(), contacts);
        let whole = whole.and_then(|whole| whole.with_robots(robots.into_vec()));
        let whole = whole.map_err(|why| RobotLogError::Log { part: companions.log.clone(), why })?;
        let whole = companions.with_sectors(whole, &mut notes)?;
        let seen = Seen::new(listing, stops.stops.len());
        let (plane, options) = (stops.plane, options.clone());
        Ok(Some(Self { whole, plane, notes, file, receptions, stops, options, listing, kind, seen, rule: None }))
    }

    /// Passes all rows to `take` once more.
    ///
    /// # Errors
    /// If the file cannot be read, or has an invalid row; the first error of `take`.
    pub fn rows(&self, take: TakeRow<'_>) -> Result<(), RobotLogError> {
        let mut rssi = RssiCheck::new(&self.options);
        let mut strengths = Strengths::of(&self.options.form);
        let (rows, _) = receptions::open(
            self.file.as_path().into(),
            &self.stops,
            &self.options.form,
            &mut rssi,
            &mut strengths,
            &mut Vec::new(),
        )?;
        rows.each(|row, _| Ok(pass(row, &self.stops, &mut *take)?)).map(|_| ())
    }

    /// Takes note of all rows of some nodes for the rule of the whole log. Their numbers may be others than in the whole log.
    pub fn see(&mut self, rows: impl IntoIterator<Item = Reception>) {
        let seen = &mut self.seen;
        match self.kind {
            SignalKind::Whole => seen.add(&collected::<Signal>(self.listing, rows)),
            SignalKind::Strength => seen.add(&collected::<Strength>(self.listing, rows)),
            SignalKind::None => seen.add(&collected::<()>(self.listing, rows)),
        }
    }

    /// Fixes the rule, after all rows were seen. Returns what the user should know of it.
    pub fn fix_rule(&mut self) -> Vec<String> {
        let mut notes = Vec::new();
        let parts = PartNames { stops: &self.stops.name, receptions: &self.receptions };
        self.rule = Some(self.seen.rule(self.whole.node_count(), &self.stops.sent, parts, &mut notes));
        notes
    }

    /// The receptions of some nodes, from all of their rows.
    ///
    /// # Panics
    /// If the rule is not fixed.
    pub fn receptions(&self, rows: impl IntoIterator<Item = Reception>) -> ReceptionLogBuilder {
        let rule = self.rule.as_ref().expect("the rule is fixed before rows become receptions");
        match self.kind {
            SignalKind::Whole => collected::<Signal>(self.listing, rows).receptions(rule),
            SignalKind::Strength => collected::<Strength>(self.listing, rows).receptions(rule),
            SignalKind::None => collected::<()>(self.listing, rows).receptions(rule),
        }
    }
}

/// Passes a row on.
fn pass(row: &ReadRow, stops: &Stops, take: TakeRow<'_>) -> Result<(), Interrupted> {
    let &ReadRow { node, stop, count: PairCount { received, sent }, sector, rssi_dbm, snr_db } = row;
    let sent = sent.unwrap_or(UNSTATED);
    let reception = Reception { node: NodeId(node), stop, received, sent, sector, rssi_dbm, snr_db };
    take(reception, stops.stops[stop as usize].position)
}

/// The rows, sorted.
fn collected<S: Kept>(listing: Listing, rows: impl IntoIterator<Item = Reception>) -> Collected<S> {
    let mut collector = Collector::<S>::new(listing);
    for Reception { node, stop, received, sent, sector, rssi_dbm, snr_db } in rows {
        let count = PairCount { received, sent: Some(sent).filter(|&sent| sent != UNSTATED) };
        collector.push(node.0, stop, count, Signal::new(received, sector, rssi_dbm, snr_db));
    }
    collector.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::stop_log::StopLog;
    use crate::test_kit::folder_of;

    /// The receptions of a log in two halves of its nodes, and its notes.
    fn in_halves(folder: &Path) -> (Vec<Reception>, Vec<String>) {
        let mut rows = Vec::new();
        let log = RowLog::open(folder, &ReadOptions::default(), &mut |row, _| {
            rows.push(row);
            Ok(())
        });
        let mut log = log.expect("a good log").expect("a folder with stops");
        let mut again = Vec::new();
        log.rows(&mut |row, _| {
            again.push(row);
            Ok(())
        })
        .expect("a good log");
        assert_eq!(again, rows);
        let half = |odd: bool| rows.iter().filter(move |row| (row.node.0 % 2 == 1) == odd).copied();
        log.see(half(false));
        log.see(half(true));
        let mut notes = log.fix_rule();
        notes.splice(0..0, log.notes.clone());
        let mut all = ReceptionLogBuilder::default();
        for odd in [true, false] {
            let part = log.receptions(half(odd));
            let names = log.whole.names().to_vec();
            all.extend(log.whole.part(names, part).expect("a part of a log").receptions().iter());
        }
        let all = log.whole.part(log.whole.names().to_vec(), all).expect("a log");
        (all.receptions().to_vec(), notes)
    }

    #[test]
    fn a_log_in_halves_has_the_receptions_of_the_log_in_one_piece() {
        let stops = "stop,x_m,y_m\nA,0,0\nB,1,0\nC,2,0\n";
        for receptions in [
            "node,stop,received\na,A,1\nb,B,1\nc,C,1\na,B,1\n",
            "node,stop,received,sent\na,A,3,5\nb,B,0,4\nc,C,2,\na,B,1,5\nd,A,5,5\na,A,1,1\n",
            "node,stop,rssi_dbm\na,A,-70\na,A,-72\nb,B,-80\nc,A,-60\nc,A,\nd,C,-50\n",
            "node,stop,received\na,A,3\nb,A,2\nc,C,1\nd,B,7\na,A,2\n",
            "node,stop,received,sector,snr_db\na,A,3,1,2.5\nb,A,2,2,\nc,C,1,1,3\na,A,2,2,9\n",
        ] {
            let folder = folder_of([("stops.csv", stops), ("receptions.csv", receptions)]);
            let whole = crate::log::stop_log::read(
                StopLog::of_folder(folder.path(), &FormOptions::default()),
                &ReadOptions::default(),
            )
            .expect("a good log");
            let (found, notes) = in_halves(folder.path());
            assert_eq!(found, whole.log.receptions().to_vec(), "{receptions}");
            let sorted = |mut notes: Vec<String>| {
                notes.sort();
                notes
            };
            assert_eq!(sorted(notes), sorted(whole.notes), "{receptions}");
        }
    }
}
