//! A recording of a run.

use sextant::Scenario;
use sextant_kernel::Unwatched;
use sextant_recording::{
    TablePiece, inspect, read_course, read_known, read_log, read_packets, read_recording, read_run, read_tables,
    read_truth, read_world, recover, stream_log,
};

use crate::properties::errors_are_clear;
use crate::scratch;

/// All readers of recordings read it or refuse it. What is recovered of it is sound, and has all messages before the damage
/// and those behind it. The copy of a sound recording has the same messages and the same log.
pub(crate) fn check(octets: &[u8]) {
    let path = scratch::file("recording.mcap", octets);
    let Ok(inspection) = inspect(&path) else { return };
    let log = read_log(&path);
    if let Ok(run) = &log {
        let _ = read_known(&path, run.log().node_count());
        let mut receptions = 0;
        let streamed = stream_log(&path, None, &mut |_, _| {
            receptions += 1;
            Ok(())
        });
        if streamed.is_ok() {
            assert_eq!(receptions, run.log().receptions().len(), "receptions one by one, and all together");
        }
    }
    if let Ok(run) = read_run(&path)
        && let Some(scenario) = run.attachment("scenario.toml")
        && let Ok(text) = std::str::from_utf8(&scenario.data)
        && let Err(errors) = Scenario::parse(text)
    {
        errors_are_clear(&errors);
    }
    let _ = (read_truth(&path), read_course(&path), read_packets(&path), read_world(&path), read_recording(&path));
    let _ = read_tables(&path, &mut |piece| {
        if let TablePiece::Row(row) = piece {
            assert_eq!(row.columns.len(), row.cells.len(), "a cell for each column");
        }
        Ok(())
    });
    let copy = scratch::path("recovered.mcap");
    if let Ok(recovery) = recover(&path, &copy, &Unwatched) {
        let copied = inspect(&copy).expect("what was recovered is a recording");
        assert_eq!(copied.damage, None, "what was recovered is damaged");
        assert_eq!(copied.messages, recovery.messages, "messages that were copied");
        assert!(inspection.messages <= recovery.messages, "messages before the damage are lost");
        if inspection.damage.is_none() {
            assert_eq!(inspection.messages, recovery.messages, "messages of a sound recording");
        }
        if let (Ok(log), None) = (&log, &inspection.damage) {
            let again = read_log(&copy).expect("the log of a copy can be read");
            assert_eq!(again.logs, log.logs, "the log of a copy is another one");
        }
    }
}
