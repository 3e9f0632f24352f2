//! Tables as programs write them: blanks around cells or between them, no header, times without a zone, columns that are no node,
//! true positions with other columns, one file a stop.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use sextant_channel::Position;
use sextant_logs::{FieldNames, FormOptions, RobotLog};

use super::forms::{read, rows};
use super::program::{folder, sextant, unwrapped};

fn places(log: &RobotLog) -> Vec<Position> {
    log.log.stops().iter().map(|stop| stop.position).collect()
}

const PATH: &str = "t_s,x_m,y_m\n0,0,0\n5,5,0\n10,10,0\n";
const PACKETS: &str = "t_s,node,rssi_dbm\n1.5,lamp,-70\n2.5,lamp,-72\n6.5,door,-60\n7.5,lamp,\n";

#[test]
fn blanks_around_and_between_cells_are_no_part_of_them() {
    let expected = read(&[("path.csv", PATH), ("packets.csv", PACKETS)], FormOptions::default()).unwrap().log;
    let around = |text: &str| text.replace(',', " , ");
    let between = |text: &str| text.replace(',', "   ").replace("lamp   \n", "lamp   -72\n");
    let quoted = "t_s, node, rssi_dbm\n1.5, \"lamp\", -70\n2.5, lamp, -72\n6.5, door, -60\n7.5, lamp,\n";
    for (path, packets) in [
        (around(PATH), around(PACKETS)),
        (PATH.replace(',', "  "), PACKETS.to_owned()),
        (PATH.replace(',', " \t ").replace("\n", "  \r\n"), PACKETS.replace(',', ";")),
        (PATH.replace("t_s", "  t_s").replace(',', " "), quoted.to_owned()),
    ] {
        let found = read(&[("path.csv", &path), ("packets.csv", &packets)], FormOptions::default()).unwrap().log;
        assert_eq!(found, expected, "{path}{packets}");
    }
    let packets = between("t_s,node,rssi_dbm\n1.5,lamp,-70\n2.5,\"big lamp\",-72\n");
    let log = read(&[("path.csv", PATH), ("packets.csv", &packets)], FormOptions::default()).unwrap().log;
    assert_eq!(log.names(), ["lamp", "big lamp"]);
    // The line of an error is that of the file.
    let wrong = "t_s   node  rssi_dbm\n\n  1.5  lamp  -70\n  soon  lamp  -72\n";
    let problem = read(&[("path.csv", PATH), ("packets.csv", wrong)], FormOptions::default()).unwrap_err();
    assert!(problem.starts_with("packets.csv, line 4, column `t_s`: found `soon`"), "{problem}");
    let wide = "x_m y_m lamp door\n0 0 -50 -60\n4 0 -55 nan\n";
    let log = read(&[("survey.csv", wide)], FormOptions::default()).unwrap();
    assert_eq!((log.log.names().len(), rows(&log, 1)), (2, vec![(0, 1, 1, Some(-60.0))]));
}

#[test]
fn columns_of_a_table_without_a_header_are_named_by_their_numbers() {
    let form = FormOptions {
        packet_fields: Some(FieldNames::parse_packets("node=#2,t_s=#1,rssi_dbm=#3").unwrap()),
        path_fields: Some(FieldNames::parse_places("t_s=#1,x_m=#2,y_m=#3").unwrap()),
        ..FormOptions::default()
    };
    let body = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    let (path, packets) = (body(PATH), body(PACKETS));
    let expected = read(&[("path.csv", PATH), ("packets.csv", PACKETS)], FormOptions::default()).unwrap().log;
    assert_eq!(read(&[("path.csv", &path), ("packets.csv", &packets)], form.clone()).unwrap().log, expected);
    // Without the flag, the error says what to give.
    let problem = read(&[("path.csv", &path), ("packets.csv", PACKETS)], FormOptions::default()).unwrap_err();
    assert_eq!(
        problem,
        "path.csv, line 1: the first line is `0,0,0`: values, and no names of columns; if the file has no header, name its \
         columns by their numbers: `path_fields=t_s=#1,x_m=#2,y_m=#3`, for example"
    );
    let problem = read(&[("path.csv", PATH), ("packets.csv", &packets)], FormOptions::default()).unwrap_err();
    assert!(
        problem.contains("packets.csv, line 1: the first line is `1.5,lamp,-70`")
            && problem.contains("`packet_fields=node=#1"),
        "{problem}"
    );
    let wrong =
        FormOptions { path_fields: Some(FieldNames::parse_places("t_s=#1,x_m=#2,y_m=#9").unwrap()), ..form.clone() };
    let problem = read(&[("path.csv", &path), ("packets.csv", &packets)], wrong).unwrap_err();
    assert!(problem.contains("there is no column `#9`; the columns are: #1, #2, #3"), "{problem}");
    // A wide table: the other columns are nodes with their numbers as names.
    let wide = FormOptions {
        path_fields: Some(FieldNames::parse_places("x_m=#1,y_m=#2").unwrap()),
        ..FormOptions::default()
    };
    let log = read(&[("survey.csv", "0;0;-50;-60\n4;0;-55;\n")], wide).unwrap();
    assert_eq!((log.log.names(), places(&log).len()), (&["#3".to_owned(), "#4".to_owned()][..], 2));
    assert_eq!(rows(&log, 0), [(0, 1, 1, Some(-50.0)), (1, 1, 1, Some(-55.0))]);
}

#[test]
fn a_time_without_a_zone_is_never_guessed() {
    let path = "t_s,x_m,y_m\n2024-07-25 16:52:30,0,0\n2024-07-25 16:52:40,10,0\n";
    let packets = "t_s,node\n1721919151.5,lamp\n1721919156.5,lamp\n";
    let zoned = |zone: &str| FormOptions { time_zone: Some(zone.parse().unwrap()), ..FormOptions::default() };
    let problem = read(&[("path.csv", path), ("packets.csv", packets)], FormOptions::default()).unwrap_err();
    assert!(
        problem.contains("found `2024-07-25 16:52:30`; allowed: a time with its zone")
            && problem.contains("`time_zone=UTC`")
            && problem.contains("`time_zone=+02:00`"),
        "{problem}"
    );
    // 16:52:30 two hours ahead of UTC is 1721919150 s after 1970 (date -d '2024-07-25 16:52:30 +02:00' +%s).
    let log = read(&[("path.csv", path), ("packets.csv", packets)], zoned("+02:00")).unwrap();
    assert_eq!(rows(&log, 0).iter().map(|row| row.1).collect::<Vec<_>>(), [1, 1]);
    let problem = read(&[("path.csv", path), ("packets.csv", packets)], zoned("UTC")).unwrap_err();
    assert!(problem.contains("none of the 2 packets was heard"), "{problem}");
    // A time that says its zone keeps it; other forms of dates are read too.
    let own = path.replace("16:52:30", "14:52:30Z").replace("2024-07-25 16:52:40", "\"2024/07/25 16:52:40,000\"");
    let log = read(&[("path.csv", &own), ("packets.csv", packets)], zoned("+02:00")).unwrap();
    assert_eq!(rows(&log, 0).len(), 2);
    let stops = "stop,t_s,x_m,y_m\nA,2024-07-25T16:52:30,0,0\n";
    let receptions = "node,stop,received\nlamp,A,1\n";
    let contacts = "t_s,x_m,y_m\n2024-07-25 16:52:31,1,1\n";
    let files = [("stops.csv", stops), ("receptions.csv", receptions), ("contacts.csv", contacts)];
    let log = read(&files, zoned("+02:00")).unwrap().log;
    assert_eq!(log.stops()[0].time.as_nanos(), 1_721_919_150_000_000_000);
    assert_eq!(log.contacts()[0].time.as_nanos(), 1_721_919_151_000_000_000);
    let wide = "x_m,y_m,t_s,lamp\n0,0,2024-07-25 16:52:30,-50\n";
    let log = read(&[("wide.csv", wide)], zoned("-05:00")).unwrap().log;
    assert_eq!(log.stops()[0].time.as_nanos(), (1_721_919_150 + 7 * 3600) * 1_000_000_000);
    // Too many digits for seconds are parts of a second, which have columns of their own.
    let nanos = PATH.replace("\n5,", "\n1721919155000000000,");
    let problem = read(&[("path.csv", &nanos), ("packets.csv", packets)], FormOptions::default()).unwrap_err();
    assert!(problem.contains("`path_fields=t_ns=NAME`"), "{problem}");
}

#[test]
fn columns_that_are_named_as_something_else_are_no_nodes_of_a_wide_table() {
    // All of them have values below 0, as strengths have.
    let text = "x_m,y_m,floor,lamp,temperature_c,door,heading_rad,Battery Level\n\
        0,0,-1,-50,-4.5,-70,-1.5,-0.1\n4,0,-1,-60,-5,-62,-1.25,-0.2\n";
    let log = read(&[("wide.csv", text)], FormOptions::default()).unwrap();
    assert_eq!(log.log.names(), ["lamp", "door"]);
    for note in [
        "wide.csv: 2 columns with the strengths of nodes: `lamp`, `door` (option `node_columns` chooses them)",
        "wide.csv: by their names, no nodes are: `floor`, `temperature_c`, `heading_rad`, `Battery Level` (option \
         `node_columns` chooses nodes)",
    ] {
        assert!(log.notes.iter().any(|told| told == note), "{:?}", log.notes);
    }
    // Whoever has a node of such a name says so.
    let chosen = FormOptions { node_columns: vec!["floor".parse().unwrap()], ..FormOptions::default() };
    assert_eq!(read(&[("wide.csv", text)], chosen).unwrap().log.names(), ["floor"]);
    let problem = read(&[("wide.csv", "x_m,y_m,speed\n0,0,-1\n")], FormOptions::default()).unwrap_err();
    assert!(problem.contains("no column is a node"), "{problem}");
}

#[test]
fn columns_without_a_negative_value_are_no_nodes_of_a_wide_table() {
    let text = "x_m,y_m,Deck,lamp,Wing,door,never\n0,0,2,-50,A,100,100\n4,0,2,100,A,-60,100\n";
    let missing = FormOptions { missing: vec!["100".parse().unwrap()], ..FormOptions::default() };
    let log = read(&[("wide.csv", text)], missing.clone()).unwrap();
    // A node that was never heard has no value but the one for that.
    assert_eq!(log.log.names(), ["lamp", "door", "never"]);
    let note = "wide.csv: without a negative value, and so without strengths in dBm, no nodes are: `Deck`, `Wing` (option \
        `node_columns` chooses nodes)";
    assert!(log.notes.iter().any(|told| told == note), "{:?}", log.notes);
    let chosen = FormOptions { node_columns: vec!["lamp".parse().unwrap(), "Deck".parse().unwrap()], ..missing };
    assert_eq!(read(&[("wide.csv", text)], chosen).unwrap().log.names(), ["Deck", "lamp"]);
    let problem = read(&[("wide.csv", "x_m,y_m,Deck\n0,0,2\n1,0,3\n")], FormOptions::default()).unwrap_err();
    assert!(problem.contains("no column has a negative value"), "{problem}");
}

#[test]
fn true_positions_have_the_columns_that_a_flag_names() {
    let stops = "stop,x_m,y_m\n0,0,0\n1,2,0\n2,0,2\n3,2,2\n";
    let receptions = "node,stop,rssi_dbm\nlamp,0,-50\nlamp,1,-55\nlamp,2,-56\nlamp,3,-60\n";
    let folder = folder(&[
        ("stops.csv", stops),
        ("receptions.csv", receptions),
        ("named.csv", "id;X;Y\nlamp;0;0\n"),
        ("bare.txt", "lamp 0 0\n"),
        ("blanks.csv", "node, x_m, y_m\nlamp, 0, 0\n"),
    ]);
    let log = folder.path().display().to_string();
    let run = |truth: &str, words: &[&str]| {
        let truth = folder.path().join(truth).display().to_string();
        let words = [&["map", &log, "--algorithm", "rssi-centroid", "--truth", &truth], words].concat();
        let output = sextant().args(words).env("NO_COLOR", "1").output().unwrap();
        let text = |octets: &[u8]| unwrapped(&String::from_utf8_lossy(octets));
        // The last line has the time that it took.
        let stdout = text(&output.stdout).split(" time ").next().unwrap().to_owned();
        (output.status.code().unwrap(), stdout, text(&output.stderr))
    };
    let (_, expected, _) = run("blanks.csv", &[]);
    assert!(expected.contains("rssi-centroid 1/1"), "{expected}");
    let (code, found, stderr) = run("named.csv", &["--truth-fields", "node=id,x_m=X,y_m=Y"]);
    assert_eq!((code, &found), (0, &expected), "{stderr}");
    let (code, found, stderr) = run("bare.txt", &["--truth-fields", "node=#1,x_m=#2,y_m=#3"]);
    assert_eq!((code, &found), (0, &expected), "{stderr}");
    let (code, _, stderr) = run("named.csv", &[]);
    assert!(
        code == 2 && stderr.contains("unknown column `X`") && stderr.contains("`--truth-fields x_m=X`"),
        "{stderr}"
    );
    let (code, _, stderr) = run("bare.txt", &[]);
    assert!(code == 2 && stderr.contains("`--truth-fields node=#1,x_m=#2,y_m=#3`"), "{stderr}");
}

fn stop_files(template: &str) -> FormOptions {
    FormOptions { stop_files: Some(template.parse().unwrap()), ..FormOptions::default() }
}

#[test]
fn files_of_packets_have_their_stop_in_their_name() {
    let files = [
        ("00_raw.csv", "node,rssi_dbm\nlamp,-50\nlamp,-52\ndoor,-70\n"),
        ("01_raw.csv", "node,rssi_dbm\nlamp,-60\n"),
        ("90_raw.csv", "rssi_dbm,node\n-66,door\n"),
        ("notes.txt", "of monday"),
    ];
    let log = read(&files, stop_files("{x}{y}_raw.csv")).unwrap();
    assert_eq!(places(&log), [Position::ORIGIN, Position::new(0.0, 1.0, 0.0), Position::new(9.0, 0.0, 0.0)]);
    assert_eq!(log.log.names(), ["lamp", "door"]);
    assert_eq!(rows(&log, 0), [(0, 2, 2, Some(-51.0)), (1, 1, 1, Some(-60.0))]);
    assert_eq!(rows(&log, 1), [(0, 1, 1, Some(-70.0)), (2, 1, 1, Some(-66.0))]);
    assert_eq!(
        log.notes[0],
        "3 files are those of 3 stops, by their names (option `stop_files`); 1 file with other names are not read: notes.txt"
    );
    // Other names of columns, and no header.
    let form = FormOptions {
        packet_fields: Some(FieldNames::parse_packets("node=#1,rssi_dbm=#2").unwrap()),
        ..stop_files("{x}_{y}_{z}.csv")
    };
    let log = read(&[("-1.5_2_0.5.csv", "lamp,-50\n"), ("10_2_0.5.csv", "lamp,-60\n")], form).unwrap();
    assert_eq!(places(&log), [Position::new(-1.5, 2.0, 0.5), Position::new(10.0, 2.0, 0.5)]);
    assert_eq!(rows(&log, 0), [(0, 1, 1, Some(-50.0)), (1, 1, 1, Some(-60.0))]);
}

#[test]
fn files_of_scans_and_of_named_stops_are_logs_too() {
    let scans =
        [("scan_1_2.csv", "lamp,door,FloorID\n-50,,1\n-52,-70,1\n"), ("scan_3_2.csv", "lamp,hall,FloorID\n,-61,1\n")];
    let log = read(&scans, stop_files("scan_{x}_{y}.csv")).unwrap();
    assert_eq!(places(&log), [Position::new(1.0, 2.0, 0.0), Position::new(3.0, 2.0, 0.0)]);
    assert_eq!(log.log.names(), ["lamp", "door", "hall"]);
    assert_eq!(rows(&log, 0), [(0, 2, 2, Some(-51.0))]);
    assert_eq!(rows(&log, 1), [(0, 1, 2, Some(-70.0))]);
    let named = [
        ("stops.csv", "stop,x_m,y_m\nkitchen,5,6\nhall,7,8\n"),
        ("at kitchen.csv", "node,rssi_dbm\nlamp,-50\n"),
        ("at hall.csv", "node,rssi_dbm\nlamp,-60\n"),
    ];
    let log = read(&named, stop_files("at {stop}.csv")).unwrap();
    assert_eq!(places(&log), [Position::new(5.0, 6.0, 0.0), Position::new(7.0, 8.0, 0.0)]);
    assert_eq!(rows(&log, 0), [(0, 1, 1, Some(-50.0)), (1, 1, 1, Some(-60.0))]);
    let robots = [("a_1_1.csv", "node,rssi_dbm\nlamp,-50\n"), ("b_1_1.csv", "node,rssi_dbm\nlamp,-60\n")];
    let log = read(&robots, stop_files("{robot}_{x}_{y}.csv")).unwrap().log;
    assert_eq!((log.robots().len(), log.stops().len()), (2, 2));
    let earth = [("48.58,7.75.csv", "node,rssi_dbm\nlamp,-50\n"), ("48.581,7.75.csv", "node,rssi_dbm\nlamp,-60\n")];
    let log = read(&earth, stop_files("{lat},{lon}.csv")).unwrap();
    assert!(log.plane.is_some() && (places(&log)[1].y_m - 111.2).abs() < 0.5, "{:?}", places(&log));
}

#[test]
fn names_of_files_that_say_no_stop_are_errors() {
    let rows = "node,rssi_dbm\nlamp,-50\n";
    for (files, template, expected) in [
        (
            &[("123_raw.csv", rows)][..],
            "{x}{y}_raw.csv",
            "the name `123_raw.csv` fits option `stop_files` in several ways: x_m 1, y_m 23; x_m 12, y_m 3; allowed: names that \
             fit in one way, by a sign between the fields, or by the number of their characters, as {x:1}{y:2}",
        ),
        (&[("a.csv", rows)], "{x}_{y}.csv", "no file of"),
        (&[("1_2.csv", "node,rssi_dbm,x_m\nlamp,-50,3\n"), ("3_2.csv", rows)], "{x}_{y}.csv", ""),
        (
            &[("1_2.csv", rows), ("3_2.csv", "node,rssi_dbm\nlamp,loud\n")],
            "{x}_{y}.csv",
            "3_2.csv, line 2, column `rssi_dbm`: found `loud`",
        ),
        (
            &[("1_2.csv", "stop,node,rssi_dbm\n1,lamp,-50\n")],
            "{x}_{y}.csv",
            "the column `stop` is in the file, and in its name too",
        ),
    ] {
        match read(files, stop_files(template)) {
            Err(problem) => assert!(problem.contains(expected), "{problem}\nshould say: {expected}"),
            Ok(log) => assert!(expected.is_empty(), "{:?}", log.notes),
        }
    }
    let folder =
        folder(&[("stops.csv", "stop,x_m,y_m\nA,0,0\n"), ("receptions.csv", "node,stop,received\nlamp,A,1\n")]);
    let file = folder.path().join("stops.csv").display().to_string();
    let output = sextant().args(["map", &file, "--stop-files", "{x}_{y}.csv"]).output().unwrap();
    let stderr = unwrapped(&String::from_utf8_lossy(&output.stderr));
    assert!(
        output.status.code() == Some(2) && stderr.contains("`--stop-files` is for folders with a file a stop"),
        "{stderr}"
    );
}
