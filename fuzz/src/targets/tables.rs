//! The files of a robot's log.

use sextant_channel::ReceptionLog;
use sextant_logs::{ReadOptions, RobotLog, RowLog};

use crate::named_texts::split;
use crate::scratch::Files;

/// The files that the folder of a log may have, by the first word of their names.
const NAMES: [&str; 10] = [
    "stops.csv",
    "receptions.csv",
    "contacts.csv",
    "sectors.csv",
    "sector_snrs.csv",
    "antenna.toml",
    "packets.csv",
    "path.csv",
    "nodes.csv",
    "names.csv",
];
/// Most files of an input.
const MOST_FILES: usize = 6;

/// The files are refused with an error that names one, or are a log that is written and read again. Read row by row, they are
/// refused too, or have the same stops.
pub(crate) fn check(octets: &[u8]) {
    let Ok(input) = std::str::from_utf8(octets) else { return };
    let files = Files::new();
    for text in split(input, "table", MOST_FILES) {
        let known = NAMES.into_iter().find(|name| name.strip_suffix(".csv") == Some(text.name) || *name == text.name);
        files.write(known.unwrap_or("table.csv"), text.text.as_bytes());
    }
    let options = ReadOptions::default();
    let read = sextant_logs::read(files.folder(), &options);
    let rows = RowLog::open(files.folder(), &options, &mut |_, _| Ok(()));
    match read {
        Ok(read) => {
            if let Ok(Some(rows)) = rows {
                assert_eq!(rows.whole.stops(), read.log.stops(), "the stops of the log that is read row by row");
            }
            log_is_sound(&read);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Counts and strengths of a log are possible, and the log is written as files that read as the same log.
pub(crate) fn log_is_sound(read: &RobotLog) {
    let log = &read.log;
    for reception in log.receptions().iter() {
        assert!(reception.received <= reception.sent, "{reception:?}");
        let numbers = [reception.rssi_dbm, reception.snr_db];
        assert!(numbers.iter().flatten().all(|number| number.is_finite()), "{reception:?}");
    }
    assert!(log.stops().iter().all(|stop| stop.position.is_finite()), "a stop without a place");
    let files = Files::new();
    let folder = files.folder().join("log");
    if sextant_logs::write(&folder, log).is_err() {
        return;
    }
    let again = sextant_logs::read(&folder, &ReadOptions::default());
    let again = again.unwrap_or_else(|error| panic!("a log that was written is refused: {error}")).log;
    is_same(log, &again);
}

/// Names, stops and receptions are the same. Robots are numbered in the order of their first stops, and absent pairs may be
/// written out.
fn is_same(log: &ReceptionLog, again: &ReceptionLog) {
    assert_eq!(log.names(), again.names(), "the names of a log that is written and read");
    assert_eq!(log.stops().len(), again.stops().len(), "the stops of a log that is written and read");
    for (stop, other) in log.stops().iter().zip(again.stops()) {
        assert_eq!(
            (stop.position, stop.time),
            (other.position, other.time),
            "a stop of a log that is written and read"
        );
    }
    let heard = |log: &ReceptionLog| -> Vec<_> {
        let in_vain = |received, sent| received == 0 && sent == 1;
        log.receptions().iter().filter(|reception| !in_vain(reception.received, reception.sent)).collect()
    };
    assert_eq!(heard(log), heard(again), "the receptions of a log that is written and read");
}
