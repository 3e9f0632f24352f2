//! Stops and receptions as people have them: other columns, delimiters, repeated and absent pairs.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, SimTime};
use sextant_logs::{self as robot_log, ReadOptions, RobotLog, RobotLogError};
use tempfile::TempDir;

const STOPS: &str = "stop,t_s,x_m,y_m\nA,0,0,0\nB,1,1,0\nC,2,2,0\n";

fn folder(stops: &str, receptions: &str) -> TempDir {
    crate::folder(&[("stops.csv", stops), ("receptions.csv", receptions)])
}

fn try_read(stops: &str, receptions: &str) -> Result<RobotLog, RobotLogError> {
    robot_log::read(folder(stops, receptions).path(), &ReadOptions::default())
}

fn read(stops: &str, receptions: &str) -> RobotLog {
    try_read(stops, receptions).unwrap()
}

fn refusal(stops: &str, receptions: &str) -> String {
    try_read(stops, receptions).unwrap_err().to_string()
}

/// Received and sent of a node at each stop; 0 of 1 where the pair is absent.
fn counts(log: &ReceptionLog, node: u32) -> Vec<(u32, u32)> {
    let mut counts = vec![(0, 1); log.stops().len()];
    for reception in log.of(NodeId(node)) {
        counts[reception.stop as usize] = (reception.received, reception.sent);
    }
    counts
}

#[test]
fn a_plain_log_has_no_notes() {
    let log = read(STOPS, "node,stop,received\nlamp,A,1\ndoor,C,1\n");
    assert_eq!(
        (counts(&log.log, 0), counts(&log.log, 1)),
        (vec![(1, 1), (0, 1), (0, 1)], vec![(0, 1), (0, 1), (1, 1)])
    );
    assert_eq!((log.notes, log.plane), (Vec::<String>::new(), None));
}

#[test]
fn other_columns_are_ignored_with_a_note() {
    let log = read(
        "stop,t_s,x_m,y_m,battery_v\nA,0,0,0,3.3\n",
        "node,stop,received,seq,weather,\nlamp,A,1,7,\"rain, wind\",\n",
    );
    assert_eq!(
        log.notes,
        ["stops.csv: ignored columns: `battery_v`", "receptions.csv: ignored columns: `seq`, `weather`"]
    );
}

#[test]
fn a_column_that_looks_like_an_absent_one_is_an_error() {
    for (header, near) in [
        ("node,stop,received,sned", "`sned`; did you mean `sent`?"),
        ("node,stop,received,Sent", "`Sent`; did you mean `sent`?"),
        ("node,stop,received,rssi", "`rssi`; did you mean `rssi_dbm`?"),
        ("node,stop,received,sector_", "`sector_`; did you mean `sector`?"),
    ] {
        let message = refusal(STOPS, &format!("{header}\nlamp,A,1,1\n"));
        assert!(message.contains(near), "{message}");
    }
    // Beside the right one it is another column.
    assert!(try_read(STOPS, "node,stop,received,sent,sned\nlamp,A,1,1,4\n").is_ok());
    let message = refusal("stop,t_s,x,y_m\nA,0,0,0\n", "node,stop,received\n");
    assert!(message.contains("`x`; did you mean `x_m`?"), "{message}");
}

#[test]
fn a_header_alone_is_no_log() {
    assert_eq!(refusal(STOPS, "node,stop,received\n"), "the log has no packets");
    assert!(try_read(STOPS, "node,stop,received\nlamp,A,0\n").is_ok());
}

#[test]
fn packets_beyond_those_that_the_stops_state_as_sent_are_told() {
    let stops = "stop,t_s,x_m,y_m,sent\nA,0,0,0,2\nB,1,1,0,2\n";
    let rows = |at_a: usize| format!("node,stop,rssi_dbm\nlamp,B,-60\n{}", "lamp,A,-50\n".repeat(at_a));
    let is_told = |log: &robot_log::RobotLog| {
        log.notes
            .iter()
            .any(|note| note.starts_with("1 stop of stops.csv has a `sent` below the packets of receptions.csv"))
    };
    let log = read(stops, &rows(3));
    assert_eq!(counts(&log.log, 0), [(3, 3), (1, 2)]);
    assert!(is_told(&log), "{:?}", log.notes);
    assert!(!is_told(&read(stops, &rows(2))));
}

#[test]
fn semicolons_and_tabs_separate_cells_and_leave_the_comma_for_decimals() {
    let expected =
        read("stop,t_s,x_m,y_m\nA,0.25,1.5,-2\nB,1,1,0\n", "node,stop,received,sent,rssi_dbm\n\"a;b\",A,2,5,-70.5\n");
    for delimiter in [";", "\t"] {
        let stops = "stop;t_s;x_m;y_m\nA;0,25;1,5;-2\nB;1;1;0\n".replace(';', delimiter);
        let receptions =
            "node;stop;received;sent;rssi_dbm\n\"a?b\";A;2;5;-70,5\n".replace(';', delimiter).replace('?', ";");
        let log = read(&stops, &receptions);
        assert_eq!(log.log, expected.log);
    }
    let message = refusal("stop,t_s,x_m,y_m\nA,0,1,5,2,0\n", "node,stop,received\n");
    assert!(
        message.contains("line 2: 6 cells, but the header has 4 columns; a decimal comma needs `;` or a tab"),
        "{message}"
    );
    let message = refusal("stop;t_s;x_m;y_m\nA;0;1.234,5;2\n", "node,stop,received\n");
    assert!(message.contains("column `x_m`: found `1.234,5`"), "{message}");
}

#[test]
fn utf_16_text_is_named() {
    let folder = folder(STOPS, "");
    let text: Vec<u8> = "\u{feff}node,stop".encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(folder.path().join("receptions.csv"), text).unwrap();
    let message = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("is text in UTF-16; save it as UTF-8: `iconv"), "{message}");
}

#[test]
fn times_of_stops_may_be_missing() {
    let log = read("stop,x_m,y_m\nA,0,0\nB,4,3\n", "node,stop,received\nlamp,A,1\n");
    assert_eq!(log.log.stops()[1].time, SimTime::ZERO);
    assert_eq!(log.log.stops()[1].position, Position::new(4.0, 3.0, 0.0));
    assert_eq!(log.notes, ["no times (t_s) in stops.csv: the duration of the survey is unknown"]);
}

#[test]
fn repeated_pairs_are_added_up() {
    let log = read(
        STOPS,
        "node,stop,received,sent,rssi_dbm,snr_db\nlamp,A,3,5,-70,4\ndoor,A,5,5,,\nlamp,A,1,5,-60,9\nlamp,A,0,2,,\nlamp,A,1,1,,\n",
    );
    let lamp = log.log.of(NodeId(0)).get(0).unwrap();
    assert_eq!((lamp.received, lamp.sent), (5, 13));
    // Three packets at −70 and one at −60; the strength of the fifth is unknown.
    assert_eq!((lamp.rssi_dbm, lamp.snr_db), (Some(-67.5), Some(9.0)));
    let note = "receptions.csv: 3 rows repeat a pair of node and stop; their packets were added up, and levels averaged over packets";
    assert_eq!(log.notes, [note]);
    // Rows without `sent` are a packet each.
    let log = read(STOPS, "node,stop,received\nlamp,A,1\nlamp,A,0\nlamp,A,1\n");
    assert_eq!(counts(&log.log, 0)[0], (2, 3));
}

#[test]
fn of_repeated_pairs_the_sector_is_that_of_the_best_reception() {
    for (rows, expected) in [
        ("lamp,A,1,5,2,-70\nlamp,A,1,5,4,-60\n", Some(4)),
        ("lamp,A,1,5,2,\nlamp,A,2,5,4,\n", Some(4)),
        ("lamp,A,2,5,2,\nlamp,A,2,5,4,\n", Some(2)),
        ("lamp,A,2,5,2,\nlamp,A,0,5,4,\n", Some(2)),
        ("lamp,A,2,5,,-50\nlamp,A,1,5,4,-60\n", Some(4)),
    ] {
        let log = read(STOPS, &format!("node,stop,received,sent,sector,rssi_dbm\n{rows}"));
        let lamp = log.log.of(NodeId(0)).get(0).unwrap();
        assert_eq!((lamp.sector, lamp.sent), (expected, 10), "{rows}");
    }
}

#[test]
fn without_received_each_row_is_a_packet() {
    let log =
        read(STOPS, "node,stop,rssi_dbm\nlamp,A,-70\nlamp,A,-80\nlamp,A,-90\ndoor,A,-60\ndoor,B,-50\nmute,A,\n");
    assert_eq!(counts(&log.log, 0), [(3, 3), (0, 1), (0, 1)]);
    assert_eq!(counts(&log.log, 1), [(1, 1), (1, 1), (0, 1)]);
    assert_eq!(counts(&log.log, 2), [(0, 1), (0, 1), (0, 1)]);
    assert_eq!(log.log.of(NodeId(0)).get(0).unwrap().rssi_dbm, Some(-80.0));
    let notes = [
        "receptions.csv has no column `received`: each row is a packet; the pairs that were heard have strengths, so none of \
         their packets counts as lost; a pair that was not heard counts as one lost packet",
    ];
    assert_eq!(log.notes, notes);
}

#[test]
fn without_sent_no_losses_are_invented_beside_strengths() {
    let rows = "lamp,A,7,-50\ndoor,A,2,-70\ndoor,B,1,-80\nroof,C,3,\nmute,A,0,\n";
    let log = read(STOPS, &format!("node,stop,received,rssi_dbm\n{rows}"));
    assert_eq!(counts(&log.log, 0), [(7, 7), (0, 1), (0, 1)]);
    assert_eq!(counts(&log.log, 1), [(2, 2), (1, 1), (0, 1)]);
    assert_eq!(counts(&log.log, 2), [(0, 1), (0, 1), (3, 3)]);
    assert_eq!(counts(&log.log, 3), [(0, 1), (0, 1), (0, 1)]);
    let notes = [
        "receptions.csv has no column `sent`: the pairs that were heard have strengths, so none of their packets counts as \
         lost; a pair that was not heard counts as one lost packet",
    ];
    assert_eq!(log.notes, notes);
    // A column without a number states nothing either.
    let log = read(STOPS, "node,stop,received,sent,rssi_dbm\nlamp,A,7,,-50\ndoor,A,2,,-70\n");
    assert_eq!((counts(&log.log, 0)[0], counts(&log.log, 1)[0]), ((7, 7), (2, 2)));
}

#[test]
fn losses_are_counted_where_the_stops_state_the_packets_or_few_pairs_have_strengths() {
    let rows = "node,stop,received,rssi_dbm\nlamp,A,7,-50\ndoor,A,2,-70\n";
    let log = read("stop,x_m,y_m,sent\nA,0,0,10\n", rows);
    assert_eq!((counts(&log.log, 0), counts(&log.log, 1)), (vec![(7, 10)], vec![(2, 10)]));
    let log = read(STOPS, "node,stop,received,rssi_dbm\nlamp,A,7,\ndoor,A,2,-70\n");
    assert_eq!((counts(&log.log, 0)[0], counts(&log.log, 1)[0]), ((7, 7), (2, 7)));
}

#[test]
fn without_sent_the_packets_sent_are_the_most_that_were_received() {
    let log = read(STOPS, "node,stop,received\nlamp,A,7\ndoor,A,2\ndoor,B,1\n");
    assert_eq!(
        (counts(&log.log, 0), counts(&log.log, 1)),
        (vec![(7, 7), (0, 1), (0, 1)], vec![(2, 7), (1, 1), (0, 1)])
    );
    let notes = [
        "receptions.csv has no column `sent`: the packets sent are the most that were received of a node at the stop",
    ];
    assert_eq!(log.notes, notes);
}

#[test]
fn absent_pairs_are_as_many_missed_packets_as_are_usual_at_the_stop() {
    let log = read(STOPS, "node,stop,received,sent\na,A,3,10\nb,A,4,10\nc,A,2,12\nd,B,1,\na,B,2,6\na,C,0,0\n");
    assert_eq!(counts(&log.log, 0), [(3, 10), (2, 6), (0, 0)]);
    assert_eq!(counts(&log.log, 1), [(4, 10), (0, 6), (0, 1)]);
    assert_eq!(counts(&log.log, 3), [(0, 10), (1, 6), (0, 1)]);
    let notes = [
        "receptions.csv: 1 rows do not state `sent`; for them it is the median of `sent` at the stop, or `received` if that is more",
        "receptions.csv: 3 absent pairs of node and stop count as missed packets, as many as the median of `sent` at the stop \
         (0 of 0 means that a node could not have been heard)",
    ];
    assert_eq!(log.notes, notes);
}

#[test]
fn one_row_does_not_say_what_is_usual_at_a_stop() {
    // As in a log that counts packets from the first to the last one received: mostly one.
    let log = read(STOPS, "node,stop,received,sent\na,A,1,1\nb,A,1,1\nc,A,1,1\na,B,2,3\n");
    assert_eq!(
        (counts(&log.log, 0), counts(&log.log, 1)),
        (vec![(1, 1), (2, 3), (0, 1)], vec![(1, 1), (0, 1), (0, 1)])
    );
    assert_eq!(log.notes, Vec::<String>::new());
}

#[test]
fn listing_some_silent_pairs_and_not_others_is_said() {
    let log = read(STOPS, "node,stop,received,sent\na,A,3,4\na,B,0,4\nb,B,1,4\nmute,A,0,4\n");
    let mixed = "receptions.csv lists 1 pairs of which nothing was received and leaves out 5 others";
    assert!(log.notes.iter().any(|note| note.starts_with(mixed)), "{:?}", log.notes);
    let all = read(STOPS, "node,stop,received,sent\na,A,3,4\na,B,0,4\na,C,0,0\n");
    assert_eq!(all.notes, Vec::<String>::new());
}

#[test]
fn stops_can_state_the_packets_sent() {
    let stops = "stop,x_m,y_m,sent\nA,0,0,10\nB,1,0,\nC,2,0,0\n";
    let log = read(stops, "node,stop,received\na,A,3\nb,B,1\n");
    assert_eq!(
        (counts(&log.log, 0), counts(&log.log, 1)),
        (vec![(3, 10), (0, 1), (0, 0)], vec![(0, 10), (1, 1), (0, 0)])
    );
    let message = refusal(stops, "node,stop,received\na,A,11\n");
    assert!(
        message.ends_with(
            "column `received`: found `11`; allowed: at most 10, the packets sent at this stop as stops.csv has it"
        ),
        "{message}"
    );
    // A row that states it goes before.
    let log = read(stops, "node,stop,received,sent\na,A,3,20\na,B,1,\nb,A,2,\n");
    assert_eq!(
        (counts(&log.log, 0), counts(&log.log, 1)),
        (vec![(3, 20), (1, 1), (0, 0)], vec![(2, 10), (0, 1), (0, 0)])
    );
}

#[test]
fn a_log_with_absent_pairs_is_written_so_that_they_stay_absent() {
    let log = read(STOPS, "node,stop,received,sent\na,A,3,10\nb,B,1,4\n").log;
    let sparse = ReceptionLog::new(
        log.names().to_vec(),
        log.stops().to_vec(),
        log.receptions().iter().filter(|reception| reception.received > 0).collect(),
        Vec::new(),
    );
    let sparse = sparse.unwrap();
    assert_ne!(sparse, log);
    let folder = tempfile::tempdir().unwrap();
    for log in [sparse, log] {
        robot_log::write(folder.path(), &log).unwrap();
        let again = robot_log::read(folder.path(), &ReadOptions::default()).unwrap();
        assert_eq!((again.log, again.notes), (log, Vec::<String>::new()));
    }
}

#[test]
fn rows_beyond_one_merge_are_one_log() {
    // More pairs than are merged at once, stop by stop.
    let (nodes, stops) = (400, 300);
    let mut text = "node,stop,received,sent\n".to_owned();
    for stop in 0..stops {
        for node in 0..nodes {
            text += &format!("n{node},{stop},{},9\n", (node * 7 + stop) % 9);
        }
    }
    text += "n3,5,1,9\n";
    let places: String = (0..stops).map(|stop| format!("{stop},{stop},{stop},0\n")).collect();
    let log = read(&format!("stop,t_s,x_m,y_m\n{places}"), &text).log;
    assert_eq!(log.receptions().len(), nodes * stops);
    for node in 0..nodes {
        let counts = counts(&log, u32::try_from(node).unwrap());
        for (stop, count) in counts.into_iter().enumerate() {
            let received = u32::try_from((node * 7 + stop) % 9).unwrap();
            let expected = if (node, stop) == (3, 5) { (received + 1, 18) } else { (received, 9) };
            assert_eq!(count, expected);
        }
    }
}
