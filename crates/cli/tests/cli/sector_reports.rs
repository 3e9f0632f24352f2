//! Reports of all sectors, from a scenario to the capture, the recording, its tables and the map.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use sextant_channel::{Position, ReceptionLog, SectorGains};
use sextant_kernel::NodeId;
use sextant_mac::dmg::{MAX_MEASUREMENTS, SweepBody, SweepFrame, brp_measurements};
use sextant_recording::read_log;
use tempfile::TempDir;

use crate::program::{Said, call};

/// A robot with the antenna of the router that asks nodes for all sectors. Nodes listen with 0 dBi.
const SCENARIO: &str = r#"
name = "router"
seed = 2
[world.nodes.random]
count = 60
region.rectangle = { min_m = [0.0, 0.0], max_m = [12.0, 8.0] }
[mac.sector_sweep.contention.csma_feedback]
report_all_sectors = true
[antenna.nodes.sectors]
azimuth_sectors = 8
boresight_gain_dbi = 20.0
[antenna.robots.code_book]
file = "router.csv"
gaps = "interpolate"
outside_gain_dbi = -10.0
boresight_gain_dbi = 15.0
[radio]
tx_power_dbm = 10
sensitivity_dbm = -68
[channel.path_loss.close_in]
carrier_ghz = 60.48
exponent = 2.0
[channel.shadowing]
sigma_db = 0.0
correlation = "per_link"
[[robots]]
name = "rover"
start_m = [1.0, 1.0, 0.0]
listen_s = 0.25
sweeps_per_stop = 4
[robots.controller.automated_s]
step_m = 2.0
lane_spacing_m = 2.0
until = "swept"
coverage_check = false
area.box = { min_m = [0.0, 0.0, -0.1], max_m = [12.0, 8.0, 0.1] }
"#;

/// A map by the gains of the antenna.
const MAP: &str = r#"
[[maps]]
name = "gains"
[maps.algorithm.mmtm]
grid_step_m = 0.5
counts = "at_least_one"
estimate = "posterior_mean"
profile.fitted = {}
"#;

/// A folder with a run of the scenario: `run.mcap`, `run.pcap`, `run.json`, and the tables of the recording in `tables`.
struct Ran(TempDir);

impl Ran {
    /// The scenario with these changes, and a map.
    fn mapped(changes: &[&str]) -> Self {
        Self::of(&format!("{SCENARIO}{MAP}"), changes)
    }

    /// The scenario with these changes.
    fn new(changes: &[&str]) -> Self {
        Self::of(SCENARIO, changes)
    }

    fn of(scenario: &str, changes: &[&str]) -> Self {
        let folder = TempDir::new().unwrap();
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/antennas/router-60ghz.csv");
        fs::copy(book, folder.path().join("router.csv")).unwrap();
        fs::write(folder.path().join("a.toml"), scenario).unwrap();
        let ran = Self(folder);
        let out = ["--out", "run.mcap", "--pcap", "run.pcap", "--summary", "run.json", "--quiet"];
        let sets: Vec<&str> = changes.iter().flat_map(|change| ["--set", change]).collect();
        ran.succeeds(&[&["run", "a.toml"], &out[..], &sets].concat());
        ran.succeeds(&["export", "run.mcap", "--out", "tables"]);
        ran
    }

    fn succeeds(&self, words: &[&str]) {
        call(self.0.path(), words).printed();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn log(&self) -> ReceptionLog {
        read_log(&self.path("run.mcap")).unwrap().logs.first().clone()
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    /// The true places of the nodes, by name.
    fn places(&self) -> BTreeMap<String, Position> {
        let table = fs::read_to_string(self.path("tables/nodes.csv")).unwrap();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let [x_m, y_m, z_m] = [1, 2, 3].map(|column| cells[column].parse().unwrap());
            (cells[0].to_owned(), Position::new(x_m, y_m, z_m))
        };
        table.lines().skip(1).map(row).collect()
    }

    /// The frames of the capture, each with its octets.
    fn frames(&self) -> Vec<(SweepFrame, Vec<u8>)> {
        let octets = fs::read(self.path("run.pcap")).unwrap();
        let (mut rest, mut frames) = (&octets[24..], Vec::new());
        while !rest.is_empty() {
            let length = u32::from_le_bytes(rest[8..12].try_into().unwrap()) as usize;
            let (record, after) = rest[16..].split_at(length);
            let header = usize::from(u16::from_le_bytes(record[2..4].try_into().unwrap()));
            frames.push((SweepFrame::parse(&record[header..]).unwrap(), record[header..].to_vec()));
            rest = after;
        }
        frames
    }
}

/// The power at the node over the noise of -71.5 dBm with 0 dBi (dB): 10 dBm, and the close-in law with exponent 2, which
/// is constant over the first metre.
fn snr_db(distance_m: f64) -> f64 {
    const LIGHT_M_PER_S: f64 = 299_792_458.0;
    10.0 - 20.0 * (4.0 * PI * 60.48e9 * distance_m.max(1.0) / LIGHT_M_PER_S).log10() + 71.5
}

fn direction(from: Position, to: Position) -> Position {
    let way = Position::new(to.x_m - from.x_m, to.y_m - from.y_m, to.z_m - from.z_m);
    way * (1.0 / way.length_m())
}

#[test]
fn every_report_is_the_link_budget_of_its_sector_and_weak_sectors_are_absent() {
    let ran = Ran::new(&[]);
    let (log, places) = (ran.log(), ran.places());
    let gains = log.sectors().unwrap().gains().unwrap();
    let (mut reports, mut absent, mut worst_db) = (0, 0, 0.0_f64);
    for number in 0..log.node_count() {
        let node = NodeId::from_index(number);
        for (index, stop) in (0_u32..).zip(log.stops()) {
            let found = log.sector_snrs(node, index);
            if found.is_empty() {
                continue;
            }
            let place = places[&log.names()[number]];
            let mut gains_dbi = Vec::new();
            gains.all_dbi(direction(stop.position, place), &mut gains_dbi);
            let all = gains.identities().iter().zip(gains_dbi);
            let all = all.map(|(&of, gain_dbi)| (of, snr_db(stop.position.distance_m(place)) + gain_dbi));
            // Sensitivity over the noise: -68 + 71.5 dB.
            let expected: BTreeMap<u8, f64> = all.filter(|&(_, exact_db)| exact_db >= 3.5).collect();
            let heard: Vec<u8> = found.iter().map(|report| report.sector).collect();
            assert!(heard.iter().eq(expected.keys()), "{node:?} at {index}: {heard:?}, not {expected:?}");
            for report in found {
                worst_db = worst_db.max((f64::from(report.snr_db) - expected[&report.sector]).abs());
            }
            reports += found.len();
            absent += gains.identities().len() - found.len();
        }
    }
    assert!(worst_db <= 0.1251, "{worst_db} dB");
    assert!(reports > 1000 && absent > 200, "{reports} reports, {absent} weak sectors");
}

#[test]
fn what_is_on_air_is_in_the_log_and_in_the_summary() {
    let ran = Ran::new(&[]);
    let (mut asked, mut sent, mut measured) = (0_u64, 0_u64, 0);
    for (frame, octets) in ran.frames() {
        match frame.body {
            SweepBody::Feedback { refinement, .. } => asked += u64::from(refinement.asks_for_all_sectors()),
            SweepBody::Brp { measurements } => {
                let found = brp_measurements(&octets).unwrap();
                assert!(found.len() == usize::from(measurements) && measurements <= MAX_MEASUREMENTS);
                assert!(found.windows(2).all(|pair| pair[0].snr >= pair[1].snr));
                sent += 1;
                measured += found.len();
            }
            _ => {}
        }
    }
    let summary = ran.json("run.json");
    let counts = &summary["gathering"]["sector_reports"];
    let received = counts["received"].as_u64().unwrap();
    assert_eq!(counts["asked"].as_u64(), Some(asked));
    assert!(received <= sent && sent <= asked && received > 100, "{received} of {sent} of {asked}");
    // Each report of the log was on air; the table has each of them.
    let rows = fs::read_to_string(ran.path("tables/sector_snrs.csv")).unwrap().lines().count() - 1;
    assert_eq!(rows, ran.log().sector_reports().count());
    assert!(rows > 1000 && rows <= measured, "{rows} of {measured}");
    // Without the question there is no word of it anywhere.
    let silent = Ran::new(&["mac.sector_sweep.contention.csma_feedback.report_all_sectors=false"]);
    assert!(!silent.log().has_sector_snrs() && !silent.path("tables/sector_snrs.csv").exists());
    assert_eq!(silent.json("run.json")["gathering"].get("sector_reports"), None);
    assert!(silent.frames().iter().all(|(frame, _)| !matches!(frame.body, SweepBody::Brp { .. })));
}

#[test]
fn run_recording_and_tables_give_one_map_that_uses_the_reports() {
    let ran = Ran::mapped(&["world.nodes.random.count=8"]);
    let map = |log: &str, out: &str, more: &[&str]| {
        let json = format!("{out}.json");
        ran.succeeds(&[&["map", log, "--quiet", "--out", out, "--summary", &json], more].concat());
        fs::read_to_string(ran.path(out)).unwrap()
    };
    // The recording has the map of the run, and is mapped again by the settings of its scenario.
    let of_recording = map("run.mcap", "again.csv", &[]);
    let errors = |name: &str| ran.json(name)["maps"][0]["position_error_m"].clone();
    assert!(errors("run.json")["mean"].as_f64().is_some_and(|mean_m| mean_m < 1.0), "{}", errors("run.json"));
    assert_eq!(errors("run.json"), errors("again.csv.json"));
    // Tables have no settings: these are the same.
    let algorithm = "maps.0.algorithm={ mmtm = { grid_step_m = 0.5, counts = \"at_least_one\", \
        estimate = \"posterior_mean\", profile.fitted = {} } }";
    let of_tables = map("tables", "b.csv", &["--set", algorithm]);
    assert_eq!(of_recording, of_tables);
    fs::remove_file(ran.path("tables/sector_snrs.csv")).unwrap();
    assert_ne!(map("tables", "c.csv", &["--set", algorithm]), of_tables);
}

/// The squared error of `levels` (dB), by place in `gains_dbi`, but for a common one.
fn misfit(levels: &[(usize, f64)], gains_dbi: &[f64]) -> f64 {
    let rest: Vec<f64> = levels.iter().map(|&(place, level)| level - gains_dbi[place]).collect();
    let mean = rest.iter().sum::<f64>() / rest.len() as f64;
    rest.iter().map(|level| (level - mean).powi(2)).sum()
}

/// The gains of all sectors in each direction of the horizon, in steps of half a degree (rad, dBi).
fn horizon(gains: &SectorGains) -> Vec<(f64, Vec<f64>)> {
    let of_step = |step: u32| {
        let azimuth_rad = f64::from(step) * TAU / 720.0;
        let mut gains_dbi = Vec::new();
        gains.all_dbi(Position::new(azimuth_rad.cos(), azimuth_rad.sin(), 0.0), &mut gains_dbi);
        (azimuth_rad, gains_dbi)
    };
    (0..720).map(of_step).collect()
}

/// Mean errors of the azimuth of a node (degrees).
#[derive(Clone, Copy, Debug, Default)]
struct AzimuthErrors {
    /// By one report of at least six sectors: the direction in which they fit best.
    by_report: f64,
    /// By the name of the best sector: the middle of the directions in which it is the best.
    by_name: f64,
    /// The same of nodes in front of the antenna, if it is known that they are.
    by_report_in_front: f64,
    by_name_in_front: f64,
    count: u32,
    in_front: u32,
}

/// The antenna is an array in a plane, whose sectors look the same behind it but for a common loss.
fn azimuth_errors(ran: &Ran) -> AzimuthErrors {
    let (log, places) = (ran.log(), ran.places());
    let gains = log.sectors().unwrap().gains().unwrap();
    let all = horizon(gains);
    let front: Vec<_> = all.iter().filter(|(azimuth_rad, _)| azimuth_rad.cos() > 0.0).cloned().collect();
    let column = |sector: u8| gains.identities().iter().position(|&of| of == sector).unwrap();
    let mut sum = AzimuthErrors::default();
    for reception in log.receptions().iter() {
        let levels = log.sector_snrs(reception.node, reception.stop).iter();
        let levels: Vec<(usize, f64)> = levels.map(|of| (column(of.sector), f64::from(of.snr_db))).collect();
        let (Some(best), true) = (reception.sector.map(column), levels.len() >= 6) else { continue };
        let stop = log.stops()[reception.stop as usize].position;
        let way = direction(stop, places[&log.names()[reception.node.index()]]);
        let errors_deg = |among: &[(f64, Vec<f64>)]| {
            let fit = among.iter().min_by(|a, b| misfit(&levels, &a.1).total_cmp(&misfit(&levels, &b.1))).unwrap();
            let is_best = |gains_dbi: &[f64]| gains_dbi.iter().all(|&gain| gain <= gains_dbi[best]);
            let middle_rad = middle_rad(among.iter().filter(|(_, gains_dbi)| is_best(gains_dbi)));
            let exact_rad = way.y_m.atan2(way.x_m);
            [fit.0, middle_rad].map(|found| ((found - exact_rad + PI).rem_euclid(TAU) - PI).abs().to_degrees())
        };
        let [by_report, by_name] = errors_deg(&all);
        (sum.by_report, sum.by_name, sum.count) = (sum.by_report + by_report, sum.by_name + by_name, sum.count + 1);
        if way.x_m > 0.0 {
            let [by_report, by_name] = errors_deg(&front);
            sum.by_report_in_front += by_report;
            sum.by_name_in_front += by_name;
            sum.in_front += 1;
        }
    }
    let (count, in_front) = (f64::from(sum.count), f64::from(sum.in_front));
    AzimuthErrors {
        by_report: sum.by_report / count,
        by_name: sum.by_name / count,
        by_report_in_front: sum.by_report_in_front / in_front,
        by_name_in_front: sum.by_name_in_front / in_front,
        ..sum
    }
}

/// The middle of some azimuths (rad).
fn middle_rad<'a>(directions: impl Iterator<Item = &'a (f64, Vec<f64>)>) -> f64 {
    let (x, y) =
        directions.fold((0.0, 0.0), |(x, y), (azimuth_rad, _)| (x + azimuth_rad.cos(), y + azimuth_rad.sin()));
    y.atan2(x)
}

#[test]
fn one_report_of_all_sectors_tells_the_direction_that_the_best_sector_alone_does_not() {
    for (ripple_db, most_deg) in [("0.0", 0.5), ("2.0", 10.0)] {
        let change = format!("antenna.robots.code_book.gain_ripple_db={ripple_db}");
        let found = azimuth_errors(&Ran::new(&[&change]));
        println!("ripple {ripple_db} dB: {found:?}");
        assert!(found.in_front > 100 && found.by_report_in_front < most_deg, "{found:?}");
        assert!(found.by_name_in_front > 2.0 * found.by_report_in_front.max(4.0), "{found:?}");
        assert!(found.by_name > 40.0 && found.by_report < found.by_name, "{found:?}");
    }
}
