//! Compact recordings.

use std::io::Write;

use mcap::records::Metadata;

use super::super::error::RecordingError;
use super::Recorder;
use super::detail::Detail;
use crate::messages::names::DETAIL_METADATA;

impl<W: Write> Recorder<W> {
    /// Makes the recording a compact one, and says so in it: `difference` is what is different from a full one, and `keep` the
    /// setting that records all. Call it before the first stop.
    ///
    /// # Errors
    /// If any write failed, now or before.
    pub fn make_compact(&mut self, difference: &str, keep: &str) -> Result<(), RecordingError> {
        self.detail = Detail::Compact;
        let values = [("form", "compact"), ("difference", difference), ("keep", keep)];
        self.describe(&Metadata {
            name: DETAIL_METADATA.to_owned(),
            metadata: values.map(|(key, value)| (key.to_owned(), value.to_owned())).into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use sextant_channel::{Dbm, Position, Reception, ReceptionLog, Stop};
    use sextant_kernel::{NodeId, Purpose, Seed, SimTime, Unwatched};

    use super::*;
    use crate::FileRecorder;
    use crate::read_log;
    use crate::read_recording;

    /// A survey of 40 stops at each of which 200 of 17 000 nodes were heard, with strengths.
    fn log() -> ReceptionLog {
        let stop = |i: u32| Stop {
            time: SimTime::from_nanos(u64::from(i) * 2_000_000_000),
            ..Stop::at(Position::new(f64::from(i), 0.0, 0.0))
        };
        let draw = |stop: u32, node: u32, what| Seed(3).uniform(Purpose::new(8), [stop.into(), node.into(), what]);
        let heard = |stop: u32| {
            (0..200).map(move |i| {
                let node = NodeId(400 * stop + 7 * i);
                let received = 1 + u32::from(draw(stop, i, 0) < 0.3);
                let sent = received + u32::from(draw(stop, i, 1) < 0.2);
                let rssi_dbm = Some(-90.0 + 30.0 * draw(stop, i, 2));
                Reception { rssi_dbm, ..Reception::heard(node, stop, received, sent) }
            })
        };
        let names = (0..17_000).map(|i| format!("n{i}")).collect();
        let receptions = (0..40).flat_map(heard).collect();
        ReceptionLog::new(names, (0..40).map(stop).collect(), receptions, Vec::new())
            .and_then(|log| log.with_robots(vec!["surveyor".to_owned()]))
            .expect("a log without contradictions")
    }

    fn record(log: &ReceptionLog, path: &Path, is_compact: bool) {
        let mut recorder = FileRecorder::create(path).expect("a new file");
        recorder.set_sensitivity(None, Dbm(-95.0));
        if is_compact {
            recorder.make_compact("less", "recording.detail=full").expect("it is written");
        }
        recorder.log(log).expect("it is written");
        recorder.finish().expect("it is written");
    }

    #[test]
    fn a_compact_recording_has_the_same_log_in_less_space() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = log();
        let size = |name: &str, is_compact| {
            let path = folder.path().join(name);
            record(&log, &path, is_compact);
            let run = read_log(&path).expect("a sound recording");
            assert_eq!(*run.log(), log, "{name}");
            assert_eq!(read_recording(&path).expect("a sound recording").run, run);
            assert_eq!(run.metadata.contains_key("detail"), is_compact);
            std::fs::metadata(&path).expect("a file").len()
        };
        let nodes_alone = {
            let path = folder.path().join("nodes.mcap");
            let silent = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), Vec::new(), Vec::new());
            record(&silent.expect("a log"), &path, true);
            std::fs::metadata(&path).expect("a file").len()
        };
        let per_reception = |size: u64| (size - nodes_alone) as f64 / log.receptions().len() as f64;
        let (full, compact) = (per_reception(size("full.mcap", false)), per_reception(size("compact.mcap", true)));
        // A strength alone has eight octets, of which seven are noise.
        assert!(compact < 13.0 && full > 2.2 * compact, "{full:.1} and {compact:.1} octets a reception");
    }

    #[test]
    fn the_tables_of_a_compact_recording_are_those_of_a_full_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let log = log();
        let rows = |name: &str, is_compact| {
            let path = folder.path().join(name);
            record(&log, &path, is_compact);
            let mut rows = Vec::new();
            crate::read_tables(&path, &mut |piece| {
                if let crate::TablePiece::Row(row) = piece {
                    rows.push((row.table.to_owned(), row.columns.to_vec(), row.cells.to_vec()));
                }
                Ok(())
            })
            .expect("a sound recording");
            rows
        };
        assert!(rows("full.mcap", false) == rows("compact.mcap", true));
    }

    #[test]
    fn a_compact_recording_that_was_cut_loses_whole_stops_only() {
        let log = log();
        let mut recorder = Recorder::new(Vec::new(), Path::new("a.mcap")).expect("a header");
        recorder.make_compact("less", "recording.detail=full").expect("it is written");
        recorder.log(&log).expect("it is written");
        let whole = recorder.into_output().expect("it is written");
        let folder = tempfile::tempdir().expect("a folder");
        let [broken, recovered] = ["broken.mcap", "recovered.mcap"].map(|name| folder.path().join(name));
        std::fs::write(&broken, &whole[..whole.len() * 9 / 10]).expect("it is written");
        crate::recover(&broken, &recovered, &Unwatched).expect("it is recovered");
        let run = read_log(&recovered).expect("a sound recording");
        let stops = run.log().stops().len();
        assert!(stops > 0 && stops < 40 && run.missing_stops == 0, "{stops} stops");
        assert_eq!(run.log().receptions().len(), 200 * stops);
    }
}
