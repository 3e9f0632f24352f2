//! Logs of robots as folders of CSV files.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::{Position, Reception, ReceptionLog, SectorConfig};
use sextant_kernel::{NodeId, SimTime};
use sextant_logs::{self as robot_log, ReadOptions, RobotLogError};
use sextant_mapper::{Concern, CoordinateFrame, Estimate, TopologyMap};
use tempfile::TempDir;

use super::sample;
use crate::program;

const STOPS: &str = "stop,t_s,x_m,y_m,z_m\nA,0,0,0,0\nB,1.5,1,0,0\n";
const RECEPTIONS: &str = "node,stop,received,sent\nlamp,A,2,5\n";

fn folder(stops: &str, receptions: &str) -> TempDir {
    program::folder(&[("stops.csv", stops), ("receptions.csv", receptions)])
}

fn read(stops: &str, receptions: &str) -> ReceptionLog {
    robot_log::read(folder(stops, receptions).path(), &ReadOptions::default()).unwrap().log
}

/// The error message of an invalid folder, without the path of the folder.
fn refusal(stops: &str, receptions: &str) -> String {
    let folder = folder(stops, receptions);
    let message = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    message.replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn a_log_is_read_back_equal_from_a_folder() {
    let parent = tempfile::tempdir().unwrap();
    for (nodes, stops) in [(1, 1), (2, 10), (9, 120)] {
        let log = sample::log(31, nodes, stops);
        let folder = parent.path().join(format!("log of {nodes}"));
        robot_log::write(&folder, &log).unwrap();
        assert_eq!(robot_log::read(&folder, &ReadOptions::default()).unwrap().log, log);
    }
}

#[test]
fn the_robot_of_each_stop_is_read_if_the_file_names_it() {
    let log = read(
        "stop,t_s,x_m,y_m,robot\nA,0,0,0,west\nB,0,100,0,east\nC,1,3,4, west\n",
        "node,stop,received\nlamp,A,1\n",
    );
    assert_eq!(log.robots(), ["west", "east"]);
    assert_eq!(log.stops().iter().map(|stop| stop.robot.0).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(log.drives().map(|drive| drive.length_m()).collect::<Vec<_>>(), [5.0]);
    let unnamed = read(STOPS, RECEPTIONS);
    assert_eq!((unnamed.robots().len(), unnamed.robot_count()), (0, 1));
    let refused = refusal("stop,t_s,x_m,y_m,robot\nA,0,0,0,west\nB,0,1,0,\n", RECEPTIONS);
    assert_eq!(refused, "stops.csv, line 3, column `robot`: found ``; allowed: the name of a robot");
}

#[test]
fn a_log_without_stops_can_be_neither_read_nor_written() {
    let folder = folder("stop,t_s,x_m,y_m\n", "node,stop,received\n");
    let refused = robot_log::read(folder.path(), &ReadOptions::default());
    assert!(matches!(refused, Err(RobotLogError::NoStops { .. })));
    let empty = ReceptionLog::default();
    assert!(matches!(robot_log::write(folder.path(), &empty), Err(RobotLogError::NoStops { .. })));
}

#[test]
fn files_with_byte_order_mark_crlf_and_another_order_of_columns_are_read() {
    let log = read(
        "\u{feff}\"y_m\",x_m, t_s ,stop\r\n2,1,0.25,12\r\n\r\n4,3,1e0,spot\r\n",
        "\u{feff}received,stop,node\r\n1, spot,\"a, \"\"b\"\"\"\r\n1,12,\u{e9}\r\n",
    );
    assert_eq!(log.names(), ["a, \"b\"", "\u{e9}"]);
    assert_eq!(log.stops()[0].position, Position::new(1.0, 2.0, 0.0));
    assert_eq!(log.stops()[1].time, SimTime::from_nanos(1_000_000_000));
    let heard = Reception::heard(NodeId(0), 1, 1, 1);
    assert_eq!(log.of(NodeId(0)), [heard]);
}

#[test]
fn rows_without_receptions_add_nodes() {
    let log = read(STOPS, "node,stop,received,sent\nmute,A,0,\ndeaf,A,0,0\nfar,B,0,4\n");
    assert_eq!(log.names(), ["mute", "deaf", "far"]);
    // 0 of 1 means the same as an absent pair; 0 of 0 and 0 of 4 do not. At stop B four packets are usual.
    let counts: Vec<_> = log.receptions().iter().map(|r| (r.node.0, r.received, r.sent)).collect();
    assert_eq!(counts, [(0, 0, 4), (1, 0, 0), (1, 0, 4), (2, 0, 4)]);
}

#[test]
fn contacts_are_read_if_there_are_any() {
    let folder = folder(STOPS, RECEPTIONS);
    std::fs::write(folder.path().join("contacts.csv"), "t_s,x_m,y_m,z_m\n0.5,1,2,3\n").unwrap();
    let log = robot_log::read(folder.path(), &ReadOptions::default()).unwrap().log;
    assert_eq!(log.contacts()[0].position, Position::new(1.0, 2.0, 3.0));
    assert_eq!(log.contacts()[0].time, SimTime::from_nanos(500_000_000));
}

const SECTORS: &str = "sector,azimuth_from_deg,azimuth_to_deg,elevation_from_deg,elevation_to_deg\n\
    0,-45,45,,\n1,45,135,-10,30\n";

/// The log of a node that is heard in `sector`, with the table `sectors`.
fn with_sectors(sectors: &str, sector: u8) -> (TempDir, Result<ReceptionLog, RobotLogError>) {
    let folder = folder(STOPS, &format!("node,stop,received,sector\nlamp,A,1,{sector}\n"));
    std::fs::write(folder.path().join("sectors.csv"), sectors).unwrap();
    let log = robot_log::read(folder.path(), &ReadOptions::default()).map(|read| read.log);
    (folder, log)
}

#[test]
fn sectors_are_read_and_written() {
    let log = with_sectors(SECTORS, 1).1.unwrap();
    let table: Vec<_> = log.sectors().unwrap().iter().cloned().collect();
    let second = SectorConfig {
        sector: 1,
        azimuth_from_deg: 45.0,
        azimuth_to_deg: 135.0,
        elevation_from_deg: -10.0,
        elevation_to_deg: 30.0,
    };
    assert_eq!((table.len(), &table[1]), (2, &second));
    assert!((table[0].elevation_to_deg - 90.0).abs() < 1e-12);
    let folder = tempfile::tempdir().unwrap();
    robot_log::write(folder.path(), &log).unwrap();
    assert_eq!(robot_log::read(folder.path(), &ReadOptions::default()).unwrap().log, log);
}

#[test]
fn errors_in_sectors_name_the_cell() {
    let header = "sector,azimuth_from_deg,azimuth_to_deg,elevation_to_deg\n";
    for (sectors, sector, expected) in [
        (SECTORS.to_owned(), 7, "node `lamp` at stop 0 was heard in sector 7; the listener's sectors are 0 to 1"),
        (
            format!("{header}0,5,5,\n"),
            0,
            "sectors.csv, line 2, column `azimuth_to_deg`: found `5`; allowed: an azimuth other than azimuth_from_deg (5); 365 is a full circle",
        ),
        (
            format!("{header}0,5,15,91\n"),
            0,
            "column `elevation_to_deg`: found `91`; allowed: above elevation_from_deg (-90), at most 90",
        ),
        (format!("{header}0,5,,\n"), 0, "column `azimuth_to_deg`: found ``; allowed: a finite number"),
        (
            format!("{header}0,5,9,\n0,9,12,\n"),
            0,
            "line 3, column `sector`: found `0`; allowed: each sector once; this sector is already given above",
        ),
        (format!("{header}300,5,9,\n"), 0, "column `sector`: found `300`; allowed: a whole number from 0 to 255"),
    ] {
        let message = with_sectors(&sectors, sector).1.unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn errors_in_cells_name_file_line_column_and_allowed_values() {
    let whole = "a whole number from 0 to 4294967294";
    for (stops, receptions, expected) in [
        (STOPS, "node,stop,received\nlamp,A,-3\n", format!("receptions.csv, line 2, column `received`: found `-3`; allowed: {whole}")),
        (STOPS, "node,stop,received\nlamp,A,1\nlamp,B,x\n", format!("receptions.csv, line 3, column `received`: found `x`; allowed: {whole}")),
        (STOPS, "node,stop,received,sent\nlamp,A,6,5\n", "receptions.csv, line 2, column `received`: found `6`; allowed: at most 5, the packets sent".to_owned()),
        (STOPS, "node,stop,received,sector\nlamp,A,1,256\n", "receptions.csv, line 2, column `sector`: found `256`; allowed: a whole number from 0 to 255".to_owned()),
        (STOPS, "node,stop,received,rssi_dbm\nlamp,A,1,inf\n", "receptions.csv, line 2, column `rssi_dbm`: found `inf`; allowed: a finite number".to_owned()),
        (STOPS, "node,stop,received\n,A,1\n", "receptions.csv, line 2, column `node`: found ``; allowed: the name of a node".to_owned()),
        (STOPS, "node,stop,received\nlamp,C,1\n", "receptions.csv, line 2, column `stop`: found `C`; allowed: one of the 2 stops in stops.csv, from `A` to `B`".to_owned()),
        ("stop,t_s,x_m,y_m\n0,0,NaN,0\n", RECEPTIONS, "stops.csv, line 2, column `x_m`: found `NaN`; allowed: a finite number".to_owned()),
        ("stop,t_s,x_m,y_m\n0,0,,0\n", RECEPTIONS, "stops.csv, line 2, column `x_m`: found ``; allowed: a number of metres from -1e9 to 1e9".to_owned()),
        ("stop,t_s,x_m,y_m\n0,-1,0,0\n", RECEPTIONS, "stops.csv, line 2, column `t_s`: found `-1`; allowed: seconds as a decimal number, at least 0 and below 18446744073, or a time as 2026-11-22T15:04:05Z".to_owned()),
        ("stop,t_s,x_m,y_m\n0,0,0,0\n0,1,1,1\n", RECEPTIONS, "stops.csv, line 3, column `stop`: found `0`; allowed: each stop once; this stop is already given above".to_owned()),
    ] {
        assert_eq!(refusal(stops, receptions), expected);
    }
}

#[test]
fn errors_in_rows_and_headers_name_the_line() {
    for (receptions, expected) in [
        (
            "node,stop,recieved\nlamp,A,1\n",
            "receptions.csv, line 1: unknown column `recieved`; did you mean `received`? Otherwise rename or remove it, or give `packet_fields=received=recieved`; known columns: node, stop, received, sent, sector, rssi_dbm, snr_db, sector_snr_db",
        ),
        (
            "node,stop\nlamp,A\n",
            "receptions.csv, line 1: column `received` is missing; the first line must name the columns: node,stop,received (or node,stop,rssi_dbm, if each row is a packet)",
        ),
        ("", "`receptions.csv` is empty; record or copy it again"),
        ("node,stop,received,stop\n", "receptions.csv, line 1: column `stop` appears twice"),
        ("node,stop,received\nlamp,A,1\nlamp,B\n", "receptions.csv, line 3: 2 cells, but the header has 3 columns"),
    ] {
        assert_eq!(refusal(STOPS, receptions), expected);
    }
}

#[test]
fn lines_are_counted_as_in_an_editor() {
    let unix = "node,stop,received\n\n\nlamp,A,1\n\"two\nlines\",A,1\ndoor,A,?\n";
    for text in [unix.to_owned(), unix.replace('\n', "\r\n"), format!("\u{feff}{unix}")] {
        let message = refusal(STOPS, &text);
        assert!(message.starts_with("receptions.csv, line 7, column `received`: found `?`"), "{message}");
    }
}

#[test]
fn text_that_is_not_utf_8_is_rejected_with_its_line() {
    let folder = folder(STOPS, RECEPTIONS);
    std::fs::write(folder.path().join("receptions.csv"), b"node,stop,received\nlamp,A,1\n\xff,A,1\n").unwrap();
    let message = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(
        message.contains("receptions.csv, line 3: the cell of column `node` is not UTF-8 text; from Latin-1"),
        "{message}"
    );
}

#[test]
fn a_first_line_of_values_is_told() {
    let told = |first: &str| {
        let folder = folder(STOPS, RECEPTIONS);
        std::fs::write(folder.path().join("stops.csv"), format!("{first}\n1,0,2\n")).unwrap();
        robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string()
    };
    let of_values = "the first line is `2,=,-76,2018-07-04`: values, and no names of columns";
    assert!(told("2,=,-76,2018-07-04").contains(of_values), "{}", told("2,=,-76,2018-07-04"));
    assert!(!told("stop,x,y").contains("values, and no names"), "{}", told("stop,x,y"));
}

#[test]
fn the_error_of_a_missing_file_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let error = || robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err();
    assert!(matches!(error(), RobotLogError::NoLog { .. }), "{}", error());
    let nowhere = folder.path().join("stops.csv/below");
    std::fs::write(folder.path().join("stops.csv"), STOPS).unwrap();
    let error = error();
    assert!(matches!(&error, RobotLogError::Read { path, .. } if path.ends_with("receptions.csv")), "{error}");
    assert!(!error.is_system_error());
    let error = robot_log::write(&nowhere, &sample::log(1, 1, 1)).unwrap_err();
    assert!(error.is_system_error(), "{error}");
}

#[test]
fn a_map_file_has_a_row_for_each_mapped_node() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.csv");
    let estimate = |x_m, ties, covariance| {
        let position = Position::new(x_m, 2.0, 0.0);
        Some(Estimate {
            position,
            log_likelihood: None,
            ties,
            covariance,
            infeasible: ties > 1,
            concern: (ties > 1).then_some(Concern::AtEdge),
        })
    };
    let names = ["a", "b,c", "d"].map(str::to_owned);
    let mut map = TopologyMap {
        algorithm: "ml-tm",
        estimates: vec![estimate(0.1, 1, None), None, estimate(-3.0, 4, None)],
        grid_step_m: Some(0.1),
        vertices_evaluated: 7,
        heights: None,
        frame: CoordinateFrame::World,
    };
    robot_log::write_map(&path, &names, &map, None).unwrap();
    let plain = "node,x_m,y_m,z_m,ties,infeasible,concern\na,0.1,2,0,1,0,\"\"\nd,-3,2,0,4,1,at-edge\n";
    assert_eq!(std::fs::read_to_string(&path).unwrap(), plain);
    let places = robot_log::read_map(&path).unwrap();
    assert_eq!(places.keys().map(String::as_str).collect::<Vec<_>>(), ["a", "d"]);

    map.estimates = vec![None, estimate(1.0, 1, Some([[4.0, 0.5, 0.0], [0.5, 9.0, 0.0], [0.0; 3]])), None];
    robot_log::write_map(&path, &names, &map, None).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let header =
        "node,x_m,y_m,z_m,ties,infeasible,concern,cov_xx_m2,cov_xy_m2,cov_xz_m2,cov_yy_m2,cov_yz_m2,cov_zz_m2";
    assert_eq!(text, format!("{header}\n\"b,c\",1,2,0,1,0,\"\",4,0.5,0,9,0,0\n"));
}

#[test]
fn true_positions_are_read_exactly_and_once_per_node() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nodes.csv");
    let truth = BTreeMap::from([
        ("a,b".to_owned(), Position::new(0.1, -2.5e-7, 1e6)),
        (" c".to_owned(), Position::new(1.0 / 3.0, 0.0, 0.0)),
    ]);
    std::fs::write(&path, "node,x_m,y_m,z_m\n\"a,b\",0.1,-2.5e-7,1e6\n\" c\",0.3333333333333333,0,0\n").unwrap();
    let read = robot_log::read_truth(&path, None, None, &mut Vec::new()).unwrap();
    assert_eq!(read.places, truth);
    std::fs::write(&path, "node,x_m,y_m\na,1,2\na,1,2\n").unwrap();
    let message = robot_log::read_truth(&path, None, None, &mut Vec::new()).unwrap_err().to_string();
    assert!(
        message
            .ends_with("line 3, column `node`: found `a`; allowed: each node once; this node is already given above"),
        "{message}"
    );
    assert!(robot_log::read_truth(Path::new("/nonexistent/nodes.csv"), None, None, &mut Vec::new()).is_err());
}
