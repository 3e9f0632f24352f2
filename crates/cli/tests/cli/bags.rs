//! ROS bags as logs of robots. `bags/write_bags.py` wrote the bags with the Python packages rosbags and mcap.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::path::Path;

use sextant_kernel::NodeId;
use sextant_logs::{self as robot_log, BagClock, BagOptions, FieldNames, FormOptions, ReadOptions, RobotLog};

use super::drive::{assert_holds, kept, map, options};
use super::program::{Said, unwrapped};

fn read(name: &str, options: &ReadOptions) -> Result<RobotLog, String> {
    robot_log::read(&kept("bags").join(name), options).map_err(|error| error.to_string())
}

/// Changes how a bag is read.
type Change<'a> = &'a dyn Fn(&mut ReadOptions);

fn with_fields(fields: &str) -> ReadOptions {
    let mut options = options();
    options.bag.packet_topic = Some("/all".to_owned());
    options.form.packet_fields = Some(FieldNames::parse_packets(fields).unwrap());
    options
}

#[test]
fn odometry_and_packets_of_any_message_are_read_without_options() {
    for name in ["odometry", "odometry/odometry.mcap", "split", "ros1.mcap"] {
        let log = read(name, &options()).unwrap();
        assert_holds(&log, ["17", "291", "4660"], [true; 3]);
        assert_eq!(
            log.notes[0],
            "the path is that of `/odom` (nav_msgs/Odometry), the packets are those of `/radio` (radio_msgs/Heard; \
             node=src,rssi_dbm=rssi,t_s=header.stamp), the times are the stamps of the messages"
        );
    }
}

/// Levels stand for ranges: they are known, and negative.
#[test]
fn ranges_are_read_beside_packets_and_instead_of_them() {
    let fields = |text| FieldNames::parse_ranges(text).unwrap();
    let of_ranges = |text| FormOptions { range_fields: Some(fields(text)), ..FormOptions::default() };
    let alone = ReadOptions { form: of_ranges("node=src,range_cm=rssi"), ..ReadOptions::default() };
    let alone = read("odometry", &alone).unwrap();
    assert_eq!((alone.log.receptions().len(), alone.log.ranges().len()), (0, 22));
    let first = alone.log.ranges_to(NodeId(0))[0];
    assert!((first.range_m + 0.5).abs() < 1e-9 && (first.velocity.x_m - 0.5).abs() < 1e-6, "{first:?}");
    assert!((first.position.x_m - 0.125).abs() < 1e-6 && (first.position.y_m - 2.0).abs() < 1e-6, "{first:?}");
    for note in ["the ranges are those of `", "22 ranges were measured, of which 22 count"] {
        assert!(alone.notes.iter().any(|known| known.contains(note)), "{:?}", alone.notes);
    }

    let of_packets = |text| {
        let form =
            FormOptions { packet_fields: Some(FieldNames::parse_packets(text).unwrap()), ..FormOptions::default() };
        read("odometry", &ReadOptions { form, ..ReadOptions::default() }).unwrap()
    };
    let beside = of_packets("node=src,range_m=rssi");
    let plain = of_packets("node=src");
    assert_eq!(beside.log.ranges().len(), 22);
    assert_eq!(beside.log.receptions().to_vec(), plain.log.receptions().to_vec());

    let form = FormOptions { range_fields: Some(fields("node=src,range_m=distance")), ..FormOptions::default() };
    let why = read("odometry", &ReadOptions { form, ..ReadOptions::default() }).unwrap_err();
    assert!(why.contains("distance"), "{why}");
    let why = read("odometry", &ReadOptions { form: of_ranges("node=src"), ..ReadOptions::default() }).unwrap_err();
    assert!(why.contains("`range_m` (or range_cm, range_mm, range_ft, range_ns) is missing"), "{why}");
    let bag = BagOptions { range_topic: Some("/radio".to_owned()), ..BagOptions::default() };
    let why = read("odometry", &ReadOptions { bag, ..ReadOptions::default() }).unwrap_err();
    assert!(why.contains("range_fields=node=PATH,range_m=PATH"), "{why}");
}

#[test]
fn transforms_are_composed_and_each_value_of_a_list_is_a_packet() {
    let mut options = options();
    options.bag.child_frame = Some("antenna".to_owned());
    let log = read("transforms", &options).unwrap();
    assert_holds(&log, ["00:12:4b:00:00:00", "00:12:4b:00:00:01", "00:12:4b:00:00:02"], [true; 3]);
    assert!(log.notes[0].contains("`/tf` (map -> odom -> base_link -> antenna)"), "{}", log.notes[0]);
    assert!(
        log.notes[0].contains("node=beacons[].address,rssi_dbm=beacons[].rssi,sector=beacons[].sector,t_s=stamp")
    );
    let sectors: Vec<_> = log.log.receptions().iter().filter(|at| at.received > 0).map(|at| at.sector).collect();
    assert_eq!(sectors.iter().filter(|sector| **sector == Some(1)).count(), 4, "{sectors:?}");

    // In the frame of the odometry, which turns and moves, the path is another one.
    options.bag.fixed_frame = Some("odom".to_owned());
    let log = read("transforms", &options).unwrap();
    let x_m = log.log.stops()[0].position.x_m;
    // d.y of the script: 2 - (-3), and the antenna is turned by -90°.
    assert!((x_m - 5.0).abs() < 1e-6, "{x_m}");
}

#[test]
fn fixes_of_a_satellite_receiver_are_a_path_in_a_plane() {
    let log = read("fixes.mcap", &options()).unwrap();
    let places: Vec<_> = log.log.stops().iter().map(|stop| stop.position).collect();
    assert_eq!(places.len(), 6);
    for (second, place) in (0..).zip(&places) {
        // East of the first fix, along y = 0.
        let expected_m = 0.5 * f64::from(second) + 0.25;
        assert!(f64::hypot(place.x_m - expected_m, place.y_m) < 1e-5 && place.z_m.abs() < 1e-5, "{place}");
    }
    let first = log.plane.unwrap().origin();
    assert!((first.lat_deg - 48.58).abs() < 1e-9 && (first.lon_deg - 7.75).abs() < 1e-9, "{first:?}");
    assert!(log.notes[1].starts_with("1 messages of `/fix` without a fix are skipped"), "{:?}", log.notes);
}

#[test]
fn each_type_of_field_is_skipped_in_both_byte_orders() {
    for name in ["little_endian.mcap", "big_endian.mcap"] {
        let log = read(name, &with_fields("node=node_id,rssi_dbm=rssi_dbm")).unwrap();
        assert_holds(&log, ["door", "lamp", "gate"], [true; 3]);
        // Values from the middle of the message.
        for (field, value) in [
            ("octet", "100"),
            ("i8", "-5"),
            ("i16", "-30000"),
            ("u32", "4000000000"),
            ("i64", "-9000000000000000000"),
            ("u64", "18000000000000000000"),
            ("two_texts[1]", "b"),
            ("three[2]", "3"),
            ("few[0]", "-1"),
            ("beacons[0].address", "00:12:4b:00:00:00"),
            ("beacons[0].address[2]", "75"),
            ("header.frame_id", "a"),
        ] {
            let log = read(name, &with_fields(&format!("node={field}"))).unwrap();
            assert_eq!(log.log.names(), [value], "{field}");
        }
        let log = read(name, &with_fields("node=text,rssi_dbm=f64")).unwrap();
        assert_eq!(log.log.names(), ["grüße", "grüßegrüße", "grüßegrüßegrüße"]);
    }
}

#[test]
fn the_clock_can_be_that_of_the_recorder() {
    let mut options = options();
    options.bag.bag_clock = Some(BagClock::Log);
    let log = read("odometry", &options).unwrap();
    // Poses and packets are both 20 ms late, so the log is the same.
    assert_holds(&log, ["17", "291", "4660"], [true; 3]);
    assert_eq!(log.log.stops()[0].time.as_nanos(), 1_700_000_000_143_456_789);
    assert!(log.notes[0].ends_with("the times are when the messages were recorded"), "{}", log.notes[0]);
}

#[test]
fn a_bag_without_an_end_is_read_as_far_as_it_goes() {
    let whole = std::fs::read(kept("bags/ros1.mcap")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("killed.mcap");
    let read_first = |octets: usize| {
        std::fs::write(&path, &whole[..octets]).unwrap();
        robot_log::read(&path, &options())
    };
    let log = read_first(whole.len() * 4 / 10).unwrap();
    assert!(log.notes[0].contains("has no end, as after a crash of the recorder"), "{}", log.notes[0]);
    let stops = log.log.stops().len();
    assert!((2..6).contains(&stops), "{stops}");
    // Wherever it ends, there is an answer.
    for octets in (0..whole.len()).step_by(97) {
        if let Err(error) = read_first(octets) {
            assert!(error.to_string().contains("killed.mcap"), "{error}");
        }
    }
}

#[test]
fn a_damaged_bag_is_an_error() {
    let mut octets = std::fs::read(kept("bags/big_endian.mcap")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.mcap");
    // Within the first chunk.
    octets[500] ^= 0x55;
    std::fs::write(&path, octets).unwrap();
    let problem = robot_log::read(&path, &options()).unwrap_err().to_string();
    assert!(problem.contains("damaged.mcap` is damaged at byte"), "{problem}");
    assert!(problem.contains("`mcap recover "), "{problem}");
}

#[test]
fn a_bag_with_any_wrong_octet_has_an_answer() {
    // This one has no checksums.
    let whole = std::fs::read(kept("bags/odometry/odometry.mcap")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wrong.mcap");
    for at in (0..whole.len()).step_by(7) {
        let mut octets = whole.clone();
        octets[at] ^= 1 << (at % 8);
        std::fs::write(&path, octets).unwrap();
        // An error or a log, but no panic.
        let _ = robot_log::read(&path, &options());
    }
}

#[test]
fn what_a_bag_lacks_is_listed() {
    let topics = "/chatter (std_msgs/String), /odom (nav_msgs/Odometry), /radio (radio_msgs/Heard)";
    let no_poses = |options: &mut ReadOptions| options.bag.pose_topic = Some("/pose".to_owned());
    let no_path = |options: &mut ReadOptions| options.bag.pose_topic = Some("/radio".to_owned());
    let no_frames = |options: &mut ReadOptions| options.bag.child_frame = Some("antenna".to_owned());
    let no_packets = |options: &mut ReadOptions| options.bag.packet_topic = Some("/wifi".to_owned());
    let no_node = |options: &mut ReadOptions| options.bag.packet_topic = Some("/chatter".to_owned());
    let no_field = |options: &mut ReadOptions| {
        options.bag.packet_topic = Some("/radio".to_owned());
        options.form.packet_fields = Some(FieldNames::parse_packets("node=source").unwrap());
    };
    let no_text = |options: &mut ReadOptions| {
        options.form.packet_fields = FieldNames::parse_packets("node=src,rssi_dbm=radio").ok()
    };
    let cases: [(Change<'_>, String); 7] = [
        (&no_poses, format!("it has no topic `/pose` with messages; its topics: {topics}")),
        (&no_path, "topic `/radio`: its messages are radio_msgs/Heard; allowed for a path: nav_msgs/Odometry".to_owned()),
        (&no_frames, "topic `/odom`: option `child_frame` and option `fixed_frame` are for transforms".to_owned()),
        (&no_packets, format!("it has no topic `/wifi` with messages; its topics: {topics}")),
        (&no_node, "topic `/chatter`: its messages (std_msgs/String) have no obvious field".to_owned()),
        (
            &no_field,
            "topic `/radio`: field `source`: there is no `source`; the fields of this message: header.stamp \
             (builtin_interfaces/Time), header.frame_id (string), radio (string<=12), src (uint16), rssi (int8), payload \
             (uint8[])"
                .to_owned(),
        ),
        (&no_text, "`rssi_dbm` is the field `radio`, which is a string; allowed: a number".to_owned()),
    ];
    for (change, expected) in cases {
        let mut options = options();
        change(&mut options);
        let problem = read("odometry", &options).unwrap_err();
        assert!(problem.contains(&expected), "{problem}");
    }
    let problem = read("transforms", &{
        let mut options = options();
        options.bag.child_frame = Some("radio".to_owned());
        options
    });
    let expected = "topic `/tf`: no transform leads to frame `radio`; transforms: base_link -> antenna, odom -> base_link, \
        map -> odom, base_link -> wheel";
    assert!(problem.as_ref().unwrap_err().contains(expected), "{problem:?}");
    // Two parts of the message have an address or an identifier with a level.
    let problem = read("little_endian.mcap", &options()).unwrap_err();
    assert!(problem.contains("no topic has messages with an obvious node and RSSI"), "{problem}");
}

#[test]
fn bags_of_other_formats_name_the_command_that_converts_them() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content, command) in [
        ("old.bag", &b"#ROSBAG V2.0\n"[..], "rosbags-convert --src"),
        #[cfg(not(feature = "sqlite-bags"))]
        ("walk.db3", b"SQLite format 3\0", "ros2 bag convert -i"),
        #[cfg(feature = "sqlite-bags")]
        ("walk.db3", b"SQLite format 3\0", "SQLite cannot read it: file is not a database"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        let stderr = map(&path, &[]).refusal();
        assert!(stderr.contains(command), "{stderr}");
    }
}

#[test]
fn a_bag_is_mapped_and_a_recording_is_told_from_it() {
    let (code, _, stderr) = map(&kept("bags/odometry"), &["--profile", "p0=0.9,plateau_m=1,range_m=3"]).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(unwrapped(&stderr).contains("the path is that of `/odom`"), "{stderr}");
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("run.mcap");
    let smoke = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/smoke.toml");
    let mut run = assert_cmd::cargo::cargo_bin_cmd!("sextant");
    run.arg("run").arg(smoke).arg("--out").arg(&recording).output().unwrap().printed();
    map(&recording, &[]).printed();
    let stderr = map(&recording, &["--pose-topic", "/odom"]).refusal();
    assert!(stderr.contains("`--pose-topic` is for ROS bags, but"), "{stderr}");
    let stderr = map(&kept("bags/odometry"), &["--pan", "0xabcd"]).refusal();
    assert!(stderr.contains("`--pan` is for captures of sniffers, but"), "{stderr}");
}

#[test]
fn of_many_topics_an_error_lists_some() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("topics.mcap");
    let mut writer = mcap::WriteOptions::new().profile("ros2").create(std::fs::File::create(&path).unwrap()).unwrap();
    let schema = writer.add_schema("p/msg/A", "ros2msg", b"uint8 a\n").unwrap();
    for topic in 0..3000 {
        let channel = writer.add_channel(schema, &format!("/t{topic}"), "cdr", &Default::default()).unwrap();
        let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 1, publish_time: 1 };
        writer.write_to_known_channel(&header, &[0, 1, 0, 0, 7]).unwrap();
    }
    writer.finish().unwrap();
    let stderr = map(&path, &[]).refusal();
    assert!(stderr.contains("/t0 (p/A)"), "{stderr}");
    assert!(stderr.contains(" and 2900 more") && stderr.len() < 10_000, "{stderr}");
}
