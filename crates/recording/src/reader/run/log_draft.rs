//! The reception log of one network while it is read.

use sextant_channel::{Reception, ReceptionLogBuilder, SectorConfig, SectorTable, Stop};
use sextant_kernel::NodeId;

use super::Stream;
use crate::messages;

/// The reception log of one network that is being read.
#[derive(Default)]
pub(super) struct LogDraft {
    pub(super) stops: Vec<Stop>,
    pub(super) receptions: ReceptionLogBuilder,
    /// The sectors; `None` if there are none.
    pub(super) sectors: Option<SectorTable>,
    /// Number of receptions of the last stop that are still missing.
    owed: u32,
    /// Receptions of the last stop that wait for those.
    waiting: Vec<Reception>,
    /// The number of the next stop in the file.
    next: u32,
    /// The numbers of the stops in the file, once messages are missing.
    numbers: Option<Vec<u32>>,
    /// Whether messages are missing behind the last stop.
    is_behind_gap: bool,
    /// Number of stops that were removed or are missing between others.
    pub(super) missing_stops: usize,
}

impl LogDraft {
    pub(super) fn add_stop(&mut self, message: &messages::StopMessage, stop: Stop) -> Result<(), String> {
        self.settled()?;
        let next = self.next;
        let is_expected = message.stop == next || self.is_behind_gap && message.stop > next;
        if !is_expected {
            return Err(format!("found stop {}; expected: stop {next}", message.stop));
        }
        self.missing_stops += (message.stop - next) as usize;
        self.next = message.stop.saturating_add(1);
        self.is_behind_gap = false;
        if let Some(numbers) = &mut self.numbers {
            numbers.push(message.stop);
        }
        self.owed = message.receptions;
        self.stops.push(stop);
        Ok(())
    }

    /// Messages are missing here: the last stop is removed if it is incomplete, and the number of the next one may be any.
    pub(super) fn gap(&mut self) {
        self.numbers.get_or_insert_with(|| (0..self.next).collect());
        self.cut_last_stop();
        self.is_behind_gap = true;
    }

    /// Makes the number of a stop in the file that of the stop in the log. `false` if the stop is missing with others.
    pub(super) fn locate(&self, stop: &mut u32) -> bool {
        let Some(numbers) = &self.numbers else { return true };
        let found = numbers.binary_search(stop).ok().and_then(|index| u32::try_from(index).ok());
        *stop = found.unwrap_or(*stop);
        found.is_some()
    }

    pub(super) fn add_range(&mut self, message: &messages::RangeMessage) -> Result<(), String> {
        let stop = self.stops.get(message.stop as usize);
        let robot =
            stop.ok_or_else(|| format!("a range names stop {}, which was not before it", message.stop))?.robot;
        self.receptions.range(message.stop, message.sample(robot));
        Ok(())
    }

    pub(super) fn add_sector(&mut self, message: messages::SectorMessage) -> Result<(), String> {
        let known = self.sectors.take().unwrap_or_default();
        if known.gains().is_some() {
            return Err(format!("sector {} comes after the gains of all sectors", message.sector));
        }
        let sectors = known.iter().cloned().chain([SectorConfig::try_from(message)?]);
        self.sectors = Some(SectorTable::new(sectors).map_err(|why| why.to_string())?);
        Ok(())
    }

    pub(super) fn add_gains(&mut self, message: &messages::SectorGainsMessage) -> Result<(), String> {
        let table = self.sectors.take().unwrap_or_default();
        self.sectors = Some(table.with_gains(message.gains()?).map_err(|why| why.to_string())?);
        Ok(())
    }

    /// The reception of a message, which its stop has announced.
    pub(super) fn reception(&mut self, message: &messages::ReceptionMessage) -> Result<Reception, String> {
        self.settle(1)?;
        let sector = message.sector.map(|sector| {
            u8::try_from(sector).map_err(|_| format!("node {}: sector {sector}; allowed: 0 to 255", message.node))
        });
        Ok(Reception {
            node: NodeId(message.node),
            stop: message.stop,
            received: message.received,
            sent: message.sent,
            sector: sector.transpose()?,
            rssi_dbm: message.rssi_dbm,
            snr_db: message.snr_db,
        })
    }

    /// Passes a reception on as soon as those of its stop are complete: an incomplete stop is not part of the log.
    pub(super) fn pass(&mut self, reception: Reception, stream: &mut Stream<'_>) -> Result<(), String> {
        self.waiting.push(reception);
        if self.owed > 0 {
            return Ok(());
        }
        for reception in self.waiting.drain(..) {
            let known = self.stops.get(reception.stop as usize);
            let stop =
                known.ok_or_else(|| format!("a reception names stop {}, which was not before it", reception.stop))?;
            if let Err(why) = (stream.take)(reception, stop) {
                let text = why.to_string();
                stream.failed = Some(why);
                return Err(text);
            }
        }
        Ok(())
    }

    /// So many of the receptions that the last stop has announced are here.
    pub(super) fn settle(&mut self, receptions: usize) -> Result<(), String> {
        let count = u32::try_from(receptions).unwrap_or(u32::MAX);
        self.owed = self.owed.checked_sub(count).ok_or("more receptions than their stop has announced")?;
        Ok(())
    }

    fn settled(&self) -> Result<(), String> {
        if self.owed == 0 {
            return Ok(());
        }
        Err(format!("{} receptions are missing before stop {}", self.owed, self.stops.len()))
    }

    /// Removes the last stop if it is incomplete.
    pub(super) fn cut_last_stop(&mut self) {
        if self.owed > 0 {
            self.stops.pop();
            self.numbers.as_mut().map(Vec::pop);
            self.receptions.forget_from(u32::try_from(self.stops.len()).unwrap_or(u32::MAX));
            self.waiting.clear();
            self.owed = 0;
            self.missing_stops += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use sextant_channel::{
        ListenerAntennaConfig, Position, RangeSample, ReceptionLog, SectorGains, SectorReport, SectorTable,
    };
    use sextant_kernel::{Files, SimTime, Unwatched};

    use super::*;
    use crate::Recorder;
    use crate::TablePiece;
    use crate::read_log;
    use crate::read_tables;
    use crate::stream_log;

    const BOOK: &str = "code_book.azimuths_deg = [-120, 0, 120]\ncode_book.elevations_deg = [0]\n\
        code_book.sectors = [{ sector = 2, gain_dbi = [[1.1, 2.2, -3.3]] }, { sector = 9, gain_dbi = [[-4, 0.1, 7]] }]";

    fn gains(text: &str) -> SectorGains {
        let config: ListenerAntennaConfig = toml::from_str(text).unwrap();
        SectorGains::read(&config, &Files::default()).unwrap()
    }

    /// 40 stops, at each of which each of three nodes was heard; two of them report both sectors.
    fn log() -> ReceptionLog {
        let stop = |i: u32| Stop {
            time: SimTime::from_nanos(u64::from(i) * 1_000_000_000),
            ..Stop::at(Position::new(f64::from(i), 0.0, 0.0))
        };
        let heard = |i: u32| Reception {
            node: NodeId(i % 3),
            stop: i / 3,
            received: 1,
            sent: 1,
            sector: Some(if i.is_multiple_of(2) { 2 } else { 9 }),
            rssi_dbm: None,
            snr_db: Some(3.25),
        };
        let reports = (0..120).filter(|i| i % 3 > 0).flat_map(|i| {
            [2, 9].map(|sector| {
                let snr_db = f64::from(i) / 8.0 - f64::from(sector);
                SectorReport { node: NodeId(i % 3), stop: i / 3, sector, snr_db }
            })
        });
        let names = ["a", "b", "c"].map(str::to_owned).to_vec();
        ReceptionLog::new(names, (0..40).map(stop).collect(), (0..120).map(heard).collect(), Vec::new())
            .and_then(|log| log.with_robots(vec!["surveyor".to_owned()]))
            .and_then(|log| log.with_sectors(SectorTable::from(gains(BOOK))))
            .and_then(|log| log.with_sector_snrs(reports.collect()))
            .unwrap()
    }

    fn recorded(log: &ReceptionLog, is_compact: bool) -> Vec<u8> {
        let mut recorder = Recorder::new(Vec::new(), Path::new("a.mcap")).unwrap();
        if is_compact {
            recorder.make_compact("less", "recording.detail=full").unwrap();
        }
        recorder.log(log).unwrap();
        recorder.into_output().unwrap()
    }

    #[test]
    fn ranges_are_read_back_equal_with_those_of_a_stop_that_is_cut_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let range = |i: u32| RangeSample {
            time: SimTime::from_nanos(u64::from(i) * 130_000_000),
            velocity: Position::new(0.25, 0.0, -0.125),
            ..RangeSample::of(NodeId(i % 3), Position::new(f64::from(i) / 7.0, 0.5, 1.0), f64::from(i) - 0.3)
        };
        let log = log().with_ranges((0..300).map(range).collect()).unwrap();
        for is_compact in [false, true] {
            let path = folder.path().join(format!("{is_compact}.mcap"));
            std::fs::write(&path, recorded(&log, is_compact)).unwrap();
            let run = read_log(&path).unwrap();
            assert_eq!((run.log(), run.leaves_out_ranges), (&log, false));
            let streamed = stream_log(&path, None, &mut |_, _| Ok(())).unwrap();
            assert!(streamed.leaves_out_ranges && streamed.log().ranges().is_empty());
            let mut rows = 0;
            read_tables(&path, &mut |piece| {
                rows += usize::from(matches!(&piece, TablePiece::Row(row) if row.table == "ranges"));
                Ok(())
            })
            .unwrap();
            assert_eq!(rows, 300);
        }
        let mut draft = LogDraft { stops: log.stops()[..2].to_vec(), owed: 1, ..LogDraft::default() };
        for (stop, sample) in log.stops_of_ranges().into_iter().zip(log.ranges()) {
            draft.receptions.range(stop, *sample);
        }
        draft.cut_last_stop();
        assert_eq!(draft.missing_stops, 1);
        let kept = draft.receptions.build(log.names().to_vec(), draft.stops, Vec::new()).unwrap();
        assert!(!kept.ranges().is_empty() && kept.ranges().iter().all(|range| range.time < log.stops()[1].time));
    }

    #[test]
    fn gains_and_ratios_of_all_sectors_are_read_back_equal() {
        let folder = tempfile::tempdir().unwrap();
        for is_compact in [false, true] {
            let path = folder.path().join("a.mcap");
            std::fs::write(&path, recorded(&log(), is_compact)).unwrap();
            let run = read_log(&path).unwrap();
            assert_eq!(*run.log(), log());
            assert!(!run.leaves_out_sector_snrs);
            let mut receptions = Vec::new();
            let streamed = stream_log(&path, None, &mut |reception, _| {
                receptions.push(reception);
                Ok(())
            });
            let streamed = streamed.unwrap();
            assert!(streamed.leaves_out_sector_snrs && receptions.len() == 120);
            assert_eq!(streamed.log().sectors(), log().sectors());
        }
    }

    #[test]
    fn ratios_are_a_table_and_the_antenna_is_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        std::fs::write(&path, recorded(&log(), false)).unwrap();
        let (mut rows, mut files) = (Vec::new(), Vec::new());
        let left_out = read_tables(&path, &mut |piece| {
            match piece {
                TablePiece::Row(row) if row.table == "sector_snrs" => {
                    let header: Vec<_> = row.columns.iter().map(|column| column.name.to_string()).collect();
                    assert_eq!(header, ["node", "stop", "sector", "snr_db"]);
                    rows.push(row.cells.iter().map(ToString::to_string).collect::<Vec<_>>().join(","));
                }
                TablePiece::Row(_) => {}
                TablePiece::Attachment { name, data } => {
                    files.push((name.to_owned(), String::from_utf8(data.to_vec()).unwrap()));
                }
            }
            Ok(())
        });
        assert!(left_out.unwrap().topics.is_empty());
        assert_eq!((rows.len(), rows[0].as_str(), rows[1].as_str()), (160, "b,0,2,-1.875", "b,0,9,-8.875"));
        let [(name, text)] = files.as_slice() else { panic!("{files:?}") };
        assert_eq!((name.as_str(), gains(text)), ("antenna.toml", gains(BOOK)));
    }

    #[test]
    fn a_recording_that_was_cut_loses_whole_stops_only() {
        let whole = recorded(&log(), false);
        let folder = tempfile::tempdir().unwrap();
        let [broken, recovered] = ["broken.mcap", "recovered.mcap"].map(|name| folder.path().join(name));
        for tenths in [6, 8, 9] {
            std::fs::write(&broken, &whole[..whole.len() * tenths / 10]).unwrap();
            crate::recover(&broken, &recovered, &Unwatched).unwrap();
            let log = read_log(&recovered).unwrap().logs.first().clone();
            let stops = log.stops().len();
            assert!(stops > 0 && log.sector_reports().count() == 4 * stops, "{stops} stops");
            std::fs::remove_file(&recovered).unwrap();
        }
    }

    #[test]
    fn of_stops_behind_a_gap_those_are_kept_whose_receptions_are_all_there() {
        let stop = |number, receptions| {
            let stop = log().stops()[number as usize];
            (messages::StopMessage { stop: number, receptions, ..messages::StopMessage::default() }, stop)
        };
        let mut draft = LogDraft::default();
        let add = |draft: &mut LogDraft, (message, stop)| draft.add_stop(&message, stop);
        add(&mut draft, stop(0, 0)).unwrap();
        add(&mut draft, stop(1, 2)).unwrap();
        assert!(add(&mut draft, stop(2, 0)).is_err());
        draft.gap();
        let located = |draft: &LogDraft, mut number| draft.locate(&mut number).then_some(number);
        assert_eq!((located(&draft, 0), located(&draft, 1)), (Some(0), None), "its receptions are missing");
        add(&mut draft, stop(5, 1)).unwrap();
        assert_eq!((located(&draft, 5), draft.missing_stops), (Some(1), 4));
        assert!(add(&mut draft, stop(7, 0)).is_err());
        draft.settle(1).unwrap();
        let refused = add(&mut draft, stop(7, 0)).unwrap_err();
        assert!(refused.contains("expected: stop 6"), "{refused}");
        add(&mut draft, stop(6, 1)).unwrap();
        draft.gap();
        draft.cut_last_stop();
        assert_eq!((draft.stops.len(), draft.missing_stops), (2, 5));
    }

    #[test]
    fn sectors_that_do_not_agree_are_rejected() {
        let mut draft = LogDraft::default();
        let message = |text| messages::SectorGainsMessage::new(&gains(text)).unwrap();
        let problem = draft.add_gains(&message("sectors.azimuth_sectors = 4")).unwrap_err();
        assert!(problem.contains("0 to 3") && problem.contains("none"), "{problem}");
        draft.sectors = Some(SectorTable::new(SectorTable::from(gains(BOOK)).iter().cloned()).unwrap());
        draft.add_gains(&message(BOOK)).unwrap();
        let more = SectorTable::from(gains("sectors.azimuth_sectors = 1"));
        let sector = messages::SectorMessage::from(more.iter().next().unwrap());
        assert!(draft.add_sector(sector).unwrap_err().contains("after the gains"));
    }
}
