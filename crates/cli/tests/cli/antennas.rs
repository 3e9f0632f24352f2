//! Antennas from the command line: measurements become code books, are shown, and are simulated by their identities.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sextant_mac::dmg::{SweepBody, SweepFrame};
use sextant_recording::read_log;
use tempfile::TempDir;

use crate::pcap::tshark::{dissect, tshark};
use crate::program::{Said, call};

/// The code book with the layout of a measured one.
fn router() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/antennas/router-60ghz.csv")
}

/// The sectors of the router.
fn identities() -> BTreeSet<u8> {
    (0..=30).chain(59..=63).collect()
}

#[test]
fn the_gaps_of_a_measured_book_are_named_and_filled_and_its_sectors_shown() {
    let folder = TempDir::new().unwrap();
    std::fs::copy(router(), folder.path().join("router.csv")).unwrap();
    let show = |words: &[&str]| call(folder.path(), &[&["antenna", "show", "router.csv"], words].concat());
    let message = show(&["--set", "boresight_gain_dbi=15"]).refusal();
    assert!(message.contains("571 gaps in 13320 gains of 37 patterns on a grid of 360 directions"), "{message}");
    assert!(message.contains("azimuth 162 to 171, elevation -10.8 to 5.4: all sectors"), "{message}");
    let filled = ["--set", "boresight_gain_dbi=15", "--set", "gaps=hold", "--set", "outside_gain_dbi=-20"];
    let table = show(&filled).printed();
    let rows: BTreeSet<u8> = table.lines().filter_map(|line| line.split_whitespace().next()?.parse().ok()).collect();
    assert_eq!(rows, identities());
    for name in ["antenna-azimuth-cuts", "antenna-elevation-cuts", "antenna-best-sector"] {
        let svg = std::fs::read_to_string(folder.path().join(format!("router.antenna/{name}.svg"))).unwrap();
        assert!(svg.contains("router: ") && table.contains(&format!("{name}.svg")), "{name}");
    }
    let coverage = show(&[&filled[..], &["--format", "json"]].concat()).json();
    let sectors = coverage["sectors"].as_array().unwrap();
    let won: f64 = sectors.iter().map(|sector| sector["share_won"].as_f64().unwrap()).sum();
    assert!((won + coverage["share_undecided"].as_f64().unwrap() - 1.0).abs() < 1e-9);
    let greatest = sectors.iter().map(|sector| sector["peak_gain_dbi"].as_f64().unwrap()).fold(-99.0, f64::max);
    // Directions are looked at in steps of a degree, so the peak of the grid is hit.
    assert!((greatest - 15.0).abs() < 0.1, "{greatest} dBi");
    let relative = show(&["--set", "gaps=hold", "--set", "outside_gain_dbi=-20"]).refusal();
    assert!(relative.contains("`gain_db` has relative units"), "{relative}");
}

/// The frames of a capture of sweeps: records of classic pcap, each with a radiotap header.
fn frames(path: &Path) -> Vec<SweepFrame> {
    let octets = std::fs::read(path).unwrap();
    let (mut rest, mut frames) = (&octets[24..], Vec::new());
    while !rest.is_empty() {
        let length = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
        let (record, after) = rest[16..].split_at(length);
        let header = usize::from(u16::from_le_bytes(record[2..4].try_into().unwrap()));
        frames.push(SweepFrame::parse(&record[header..]).unwrap());
        rest = after;
    }
    frames
}

/// A robot with the router's antenna among nodes with the same.
const SCENARIO: &str = r#"
name = "router"
seed = 5
[world.nodes.lattice]
spacing_m = 1.3
jitter_m = 0.2
count = 12
[world.nodes.lattice.region.box]
min_m = [0.0, 0.0, 0.5]
max_m = [5.0, 5.0, 1.5]
[mac.sector_sweep]
contention.abft = { slots = 8, frames_per_slot = 16 }
[antenna.nodes.code_book]
file = "router.csv"
gaps = "interpolate"
outside_gain_dbi = -15.0
boresight_gain_dbi = 15.0
[antenna.robots.code_book]
file = "router.csv"
gaps = "interpolate"
outside_gain_dbi = -15.0
boresight_gain_dbi = 15.0
[radio]
tx_power_dbm = 10
sensitivity_dbm = -68
[channel.path_loss.close_in]
carrier_ghz = 60.48
exponent = 2.0
[channel.shadowing]
sigma_db = 0.0
[[robots]]
name = "rover"
start_m = [0.0, 0.0, 0.8]
listen_s = 1
sweeps_per_stop = 4
controller.waypoints.places_m = [[1.0, 1.0, 0.8], [4.0, 1.0, 0.8], [4.0, 4.0, 0.8], [1.0, 4.0, 0.8]]
[[maps]]
algorithm.mmtm = { grid_step_m = 0.5, z_range_m = [0.5, 1.5], profile.channel = {} }
"#;

#[test]
fn identities_of_a_code_book_are_those_on_air_in_the_capture_in_the_log_and_in_its_tables() {
    let folder = TempDir::new().unwrap();
    std::fs::copy(router(), folder.path().join("router.csv")).unwrap();
    std::fs::write(folder.path().join("a.toml"), SCENARIO).unwrap();
    call(folder.path(), &["run", "a.toml", "--out", "run.mcap", "--pcap", "run.pcap", "--quiet"]).printed();

    let log = read_log(&folder.path().join("run.mcap")).unwrap().logs.first().clone();
    assert_eq!(log.sectors().unwrap().identities(), "0 to 30, 59 to 63");
    let heard: BTreeSet<u8> = log.receptions().iter().filter_map(|reception| reception.sector).collect();
    assert!(heard.len() > 5 && heard.is_subset(&identities()), "{heard:?}");

    // All sectors are swept, by the robot and by the nodes, and what nodes answer is what the log has.
    let (mut swept, mut answered, mut chosen) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
    for frame in frames(&folder.path().join("run.pcap")) {
        match frame.body {
            SweepBody::Iss { sector, total_sectors, .. } => {
                assert_eq!((sector.antenna, total_sectors), (0, 36));
                swept.insert(sector.sector);
            }
            SweepBody::Rss { sector, feedback, .. } => {
                answered.insert(sector.sector);
                chosen.insert(feedback.select.sector);
            }
            SweepBody::Feedback { feedback, .. } => assert!(identities().contains(&feedback.select.sector)),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!((&swept, &answered), (&identities(), &identities()));
    assert!(heard.is_subset(&chosen), "{heard:?} in the log, {chosen:?} in answers");

    // The tables of the recording have the same numbers.
    call(folder.path(), &["export", "run.mcap", "--out", "tables"]).printed();
    let sectors = std::fs::read_to_string(folder.path().join("tables/sectors.csv")).unwrap();
    let of_table: BTreeSet<u8> =
        sectors.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!(of_table, identities());
    // Mapping the recording uses the same sectors as the run did.
    call(folder.path(), &["map", "run.mcap", "--quiet", "--summary", "map.json"]).printed();

    if let Some(program) = tshark() {
        let ids = dissect(&program, &folder.path().join("run.pcap"), &["wlan.ssw.sector_id"]);
        let number = |text: &String| match text.strip_prefix("0x") {
            Some(digits) => u8::from_str_radix(digits, 16).ok(),
            None => text.parse().ok(),
        };
        let found: BTreeSet<u8> = ids.iter().filter_map(|fields| number(fields.first()?)).collect();
        assert_eq!(found, identities());
    }
}

#[test]
fn a_measurement_becomes_a_code_book_that_is_never_its_own_input() {
    let folder = TempDir::new().unwrap();
    let wide = (0..36).map(|step| format!("{},{},{}\n", 10 * step, step % 7 - 3, -(step % 5)));
    let table = format!("phi,S4,S60\n{}", wide.collect::<String>());
    std::fs::write(folder.path().join("tool.csv"), &table).unwrap();
    let unknown = call(folder.path(), &["antenna", "convert", "tool.csv", "book.csv"]).refusal();
    assert!(unknown.contains("--unit dbi"), "{unknown}");
    let converted = call(folder.path(), &["antenna", "convert", "tool.csv", "book.csv", "--unit", "db"]);
    let told = converted.printed();
    assert!(told.contains("book.csv: 2 sectors, 36 directions, 0 gaps in `gain_db`"), "{told}");
    assert!(told.contains("code_book = { file = \"book.csv\", boresight_gain_dbi = GAIN }"), "{told}");
    let (_, _, note) = converted.all();
    assert!(note.contains("a planar cut at elevation 0"), "{note}");
    let shown = call(folder.path(), &["antenna", "show", "book.csv", "--set", "boresight_gain_dbi=12"]).printed();
    assert!(shown.contains("60  "), "{shown}");
    let code = |words: &[&str]| call(folder.path(), &[&["antenna", "convert"], words].concat()).status.code();
    assert_eq!(code(&["tool.csv", "tool.csv", "--unit", "db", "--force"]), Some(2));
    assert_eq!(code(&["tool.csv", "book.csv", "--unit", "db"]), Some(2), "it exists");
    assert_eq!(code(&["tool.csv", "book.csv", "--force", "--unit", "dbi"]), Some(0));
    assert_eq!(std::fs::read_to_string(folder.path().join("tool.csv")).unwrap(), table);
    let message = call(folder.path(), &["antenna", "convert", "tool.csv", "b.csv", "--azimuth", "angle"]).refusal();
    assert!(message.contains("found the columns `phi`, `S4`, `S60`") && message.contains("--azimuth"), "{message}");
}

#[test]
fn a_beam_at_the_horizon_stays_there_and_a_scenario_refuses_angles_in_radians() {
    let folder = TempDir::new().unwrap();
    let mut spherical = "Theta [deg.],Phi [deg.],Abs(Gain)[dBi]\n".to_owned();
    let mut radians = "azimuth,gain_dbi\n".to_owned();
    let mut half = "phi,theta,gain_dbi\n".to_owned();
    for phi in (0..360).step_by(10) {
        for theta in (0..=180).step_by(10) {
            let gain = if (phi, theta) == (40, 90) { 9 } else { -4 };
            spherical += &format!("{theta},{phi},{gain}\n");
            if theta <= 90 {
                half += &format!("{phi},{theta},{gain}\n");
            }
        }
        radians += &format!("{:.8},{}\n", f64::from(phi - 180).to_radians(), phi % 7 - 3);
    }
    for (name, table) in [("spherical.csv", &spherical), ("radians.csv", &radians), ("half.csv", &half)] {
        std::fs::write(folder.path().join(name), table).unwrap();
    }
    let convert = |words: &[&str]| call(folder.path(), &[&["antenna", "convert"], words].concat());
    convert(&["spherical.csv", "book.csv"]).printed();
    let book = std::fs::read_to_string(folder.path().join("book.csv")).unwrap();
    assert!(book.contains("\n0,40,0,9\n") && book.matches(",9\n").count() == 1, "{book}");
    for (file, words) in
        [("half.csv", ["--zenith", "--elevation 'theta'"]), ("radians.csv", ["--radians", "--degrees"])]
    {
        let message = convert(&[file, "no.csv"]).refusal();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    assert!(convert(&["half.csv", "zenith.csv", "--zenith"]).status.success());
    // The help is that of the fault, and no option that is given already.
    std::fs::write(folder.path().join("low.csv"), "azimuth_deg,theta_deg,gain_dbi\n0,190,3\n10,20,3\n").unwrap();
    std::fs::write(folder.path().join("bad.csv"), "azimuth_deg,elevation_deg,gain_dbi\n0,0,x\n").unwrap();
    std::fs::write(folder.path().join("far.csv"), "sector,azimuth_deg,elevation_deg,gain_dbi\n70,0,0,1\n").unwrap();
    for (words, expected, absent) in [
        (&["low.csv", "no.csv", "--zenith"][..], "190 from the zenith", "--zenith"),
        (&["bad.csv", "no.csv"], "`x`", "--zenith"),
        (&["far.csv", "no.csv"], "--quasi-omni ID", "--zenith"),
        (&["low.csv", "no.csv", "--elevation", "theta_deg"], "--zenith", "--quasi-omni"),
    ] {
        let message = convert(words).refusal();
        assert!(message.contains(expected) && !message.contains(absent), "{words:?}: {message}");
    }
    assert!(convert(&["half.csv", "level.csv", "--elevation", "theta"]).status.success());
    assert!(convert(&["radians.csv", "turned.csv", "--radians"]).status.success());
    let turned = std::fs::read_to_string(folder.path().join("turned.csv")).unwrap();
    assert!(turned.contains("\n0,-180,0,-3\n") && turned.contains("\n0,170,0,"), "{turned}");
    // A code book has degrees; once around in radians is refused, also where directions outside have a gain.
    let mut book = "sector,azimuth_deg,elevation_deg,gain_dbi\n".to_owned();
    for step in 0..36 {
        book += &format!("0,{:.5},0,{}\n", f64::from(10 * step - 180).to_radians(), step % 7 - 3);
    }
    std::fs::write(folder.path().join("rad.csv"), book).unwrap();
    let message = call(folder.path(), &["antenna", "show", "rad.csv", "--set", "outside_gain_dbi=-20"]).refusal();
    assert!(message.contains("once around in radians"), "{message}");
    let scenario = SCENARIO.replace("router.csv", "rad.csv").replace("gaps = \"interpolate\"\n", "");
    std::fs::write(folder.path().join("a.toml"), scenario).unwrap();
    let message = call(folder.path(), &["check", "a.toml"]).refusal();
    assert!(message.contains("once around in radians"), "{message}");
}
