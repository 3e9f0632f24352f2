//! A folder with `path.csv` and `packets.csv`.

use std::fmt::Write as _;

use sextant_channel::Position;
use sextant_kernel::NodeId;
use sextant_logs::{self as robot_log, ReadOptions, RobotLog, RobotLogError, StopRule};

use crate::folder;

const PATH: &str = "t_s,x_m,y_m\n0,0,0\n5,5,0\n10,10,0\n";
const PACKETS: &str = "t_s,node,rssi_dbm\n1.5,lamp,-70\n2.5,lamp,-72\n6.5,door,-60\n7.5,lamp,\n";

fn try_read(files: &[(&str, &str)]) -> Result<RobotLog, RobotLogError> {
    let options =
        ReadOptions { stop_every: StopRule::Distance(5.0), packet_interval_s: Some(1.0), ..ReadOptions::default() };
    robot_log::read(folder(files).path(), &options)
}

fn read(path: &str, packets: &str) -> RobotLog {
    try_read(&[("path.csv", path), ("packets.csv", packets)]).unwrap()
}

fn refusal(path: &str, packets: &str) -> String {
    let folder = folder(&[("path.csv", path), ("packets.csv", packets)]);
    let message = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    message.replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn packets_on_a_path_are_a_log() {
    let log = read(PATH, PACKETS);
    assert_eq!(log.log.names(), ["lamp", "door"]);
    let stops: Vec<Position> = log.log.stops().iter().map(|stop| stop.position).collect();
    assert_eq!(stops, [Position::new(2.5, 0.0, 0.0), Position::new(7.5, 0.0, 0.0)]);
    let lamp: Vec<_> = log.log.of(NodeId(0)).iter().map(|r| (r.received, r.sent, r.rssi_dbm)).collect();
    assert_eq!(lamp, [(2, 5, Some(-71.0)), (1, 5, None)]);
    let door: Vec<_> = log.log.of(NodeId(1)).iter().map(|r| (r.received, r.sent)).collect();
    assert_eq!(door, [(0, 5), (1, 5)]);
    assert_eq!(log.notes, ["the path is cut into 2 stops, one each 5 m (option `stop_every` sets it)"]);
}

#[test]
fn contacts_sectors_and_several_robots_belong_to_it_too() {
    let files = [
        ("path.csv", "t_s,x_m,y_m,robot\n0,0,0,west\n0,50,0,east\n4,4,0,west\n4,54,0,east\n"),
        ("packets.csv", "t_s,node,robot,sector\n1.5,lamp,east,1\n1.5,door,west,0\n"),
        ("contacts.csv", "t_s,x_m,y_m,robot\n1,0.5,0,east\n"),
        ("sectors.csv", "sector,azimuth_from_deg,azimuth_to_deg\n0,0,180\n1,180,360\n"),
    ];
    let log = try_read(&files).unwrap().log;
    assert_eq!(log.robots(), ["west", "east"]);
    assert_eq!(log.stops().iter().map(|stop| stop.robot.0).collect::<Vec<_>>(), [0, 1]);
    assert_eq!((log.contacts()[0].robot.0, log.sectors().map(|table| table.iter().count())), (1, Some(2)));
    // It sends at 0.5, 1.5, 2.5 and 3.5 s, which both robots could have heard.
    let lamp: Vec<_> = log.of(NodeId(0)).iter().map(|r| (r.stop, r.received, r.sent, r.sector)).collect();
    assert_eq!(lamp, [(0, 0, 4, None), (1, 1, 4, Some(1))]);
}

#[test]
fn times_since_1970_are_exact() {
    let shifted = |text: &str| {
        let row = |line: &str| match line.split_once(',') {
            Some((time, rest)) if time != "t_s" => {
                let (whole, fraction) = time.split_once('.').unwrap_or((time, "0"));
                format!("{}.{fraction},{rest}\n", 1_700_000_000 + whole.parse::<u64>().unwrap())
            }
            _ => format!("{line}\n"),
        };
        text.lines().map(row).collect::<String>()
    };
    let (log, later) = (read(PATH, PACKETS), read(&shifted(PATH), &shifted(PACKETS)));
    assert_eq!(log.log.receptions().to_vec(), later.log.receptions().to_vec());
    assert_eq!(later.log.stops()[1].time.as_nanos() - log.log.stops()[1].time.as_nanos(), 1_700_000_000_000_000_000);
}

#[test]
fn errors_name_the_file_and_the_line() {
    for (path, packets, expected) in [
        (
            "t_s,x_m,y_m\n0,0,0\n9,1,0\n3,1,0\n",
            PACKETS,
            "path.csv, line 4: the time goes back by 6 s, from 9 s to 3 s",
        ),
        (
            "t_s,x_m,y_m\n0,0,0\n",
            PACKETS,
            "path.csv`: the path has 1 poses at different times; at least two are required",
        ),
        ("t_s,x_m,y_m\n0,0,0\n1,0,0\n1,7,0\n", PACKETS, "path.csv, line 4: two places at 1 s, 7.0 m from each other"),
        (
            "t_s,x_m,y_m\n0,0,0\n1,nan,0\n",
            PACKETS,
            "path.csv, line 3, column `x_m`: found `nan`; allowed: a finite number",
        ),
        (
            "t_s,x_m\n0,0\n",
            PACKETS,
            "path.csv, line 1: column `y_m` is missing; places need the columns x_m,y_m[,z_m] or lat,lon[,alt_m]",
        ),
        (PATH, "t_s,node\n1,a\nsoon,b\n", "packets.csv, line 3, column `t_s`: found `soon`; allowed: seconds"),
        (PATH, "t_s,node\n1,\n", "packets.csv, line 2, column `node`: found ``; allowed: the name of a node"),
        (
            PATH,
            "t_s,node,rssi_dbm\n1,a,inf\n",
            "packets.csv, line 2, column `rssi_dbm`: found `inf`; allowed: a finite number",
        ),
        (
            PATH,
            "t_s,node,robot\n1,a,west\n",
            "packets.csv, line 1: column `robot` names the robots, but path.csv has no such column",
        ),
        (PATH, "t_s,node\n", "the log has no packets"),
        (
            PATH,
            "t_s,node\n20,a\n30,a\n",
            "none of the 2 packets was heard while the place of the robot is known: the packets are from 20 s to 30 s, the path is from 0 s to 10 s",
        ),
        (
            "t_s,x_m,y_m,robot\n0,0,0,a\n1,0,1,a\n0,0,0,b\n1,0,1,b\n",
            PACKETS,
            "packets.csv, line 1: column `robot` is missing: path.csv has the paths of 2 robots",
        ),
        (
            "t_s,x_m,y_m,robot\n0,0,0,a\n1,0,1,a\n",
            "t_s,node,robot\n0,n,b\n",
            "packets.csv, line 2, column `robot`: found `b`; allowed: one of the robots in path.csv: a",
        ),
    ] {
        let message = refusal(path, packets);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_folder_has_one_log() {
    let error = |files: &[(&str, &str)]| try_read(files).unwrap_err().to_string();
    let both = error(&[("path.csv", PATH), ("packets.csv", PACKETS), ("stops.csv", "stop,x_m,y_m\n")]);
    assert!(both.contains("has both packets.csv, path.csv and stops.csv"), "{both}");
    let alone = error(&[("path.csv", PATH)]);
    assert!(alone.contains("has path.csv, but no packets.csv"), "{alone}");
    let pathless = error(&[("packets.csv", PACKETS)]);
    assert!(pathless.contains("not where the robot was: give its path with `path=FILE`"), "{pathless}");
    let empty = error(&[]);
    assert!(
        empty.contains("has no log: neither stops.csv and receptions.csv, nor path.csv and packets.csv"),
        "{empty}"
    );
}

#[test]
fn a_log_that_has_stops_is_not_cut() {
    let folder =
        folder(&[("stops.csv", "stop,x_m,y_m\nA,0,0\n"), ("receptions.csv", "node,stop,received\nlamp,A,1\n")]);
    for (flag, options) in [
        ("stop_every", ReadOptions { stop_every: StopRule::Distance(1.0), ..ReadOptions::default() }),
        ("packet_interval", ReadOptions { packet_interval_s: Some(1.0), ..ReadOptions::default() }),
    ] {
        let message = robot_log::read(folder.path(), &options).unwrap_err().to_string();
        assert!(message.starts_with(&format!("option `{flag}` is for logs of packets and a path, but")), "{message}");
        assert!(message.ends_with("is a folder with stops"), "{message}");
    }
}

#[test]
fn a_survey_of_packets_is_the_survey_of_its_counts() {
    // Nodes that send every second, heard within 3 m, along a line. As packets and as counted by hand.
    let mut packets = "t_s,node\n".to_owned();
    let mut counted = vec![vec![(0_u32, 0_u32); 10]; 3];
    for (node, x_m) in [2.0, 6.0, 9.0].into_iter().enumerate() {
        for second in 0..20 {
            let time = f64::from(second) + 0.25;
            let stop = usize::try_from(second / 2).unwrap();
            counted[node][stop].1 += 1;
            if (0.5 * time - x_m).abs() < 3.0 {
                counted[node][stop].0 += 1;
                writeln!(packets, "{time},n{node}").unwrap();
            }
        }
    }
    let options =
        ReadOptions { stop_every: StopRule::Distance(1.0), packet_interval_s: None, ..ReadOptions::default() };
    let folder = folder(&[("path.csv", "t_s,x_m,y_m\n0,0,0\n20,10,0\n"), ("packets.csv", &packets)]);
    let log = robot_log::read(folder.path(), &options).unwrap();
    for (node, expected) in (0..).zip(counted) {
        let found: Vec<_> = log.log.of(NodeId(node)).iter().map(|r| (r.received, r.sent)).collect();
        assert_eq!(found, expected);
    }
    let note = "the nodes send every 1 s (median; 1 s to 1 s), as the gaps between the packets of 3 of 3 nodes tell";
    assert!(log.notes.iter().any(|found| found.starts_with(note)), "{:?}", log.notes);
}
