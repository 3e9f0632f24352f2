//! Prints how well each estimator maps logs of robots whose nodes have known places: the mean, median and 95th percentile of
//! the position error, the share of the nodes within their 95 % regions, and the time.
//!
//! Usage: `robot_logs_table FOLDER..`: each a log with `nodes.csv`, or a folder of such logs.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use sextant::robot_log::{self, ReadOptions};
use sextant_channel::{Position, Reception, ReceptionLog};
use sextant_kernel::Unwatched;
use sextant_mapper::{
    Auto, AutoConfig, EstimateKind, FittedConfig, FittedMlTm, Learned, LinkModel, LinkModelConfig, Mapper,
    MlTmConfig, PacketCentroid, PacketCentroidConfig, PositionError, ProfileConfig, Region, SelfCalibrated,
    SelfCalibratedConfig,
};

#[expect(clippy::disallowed_methods, reason = "a stopwatch")]
fn now() -> Instant {
    Instant::now()
}

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let folders: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if folders.is_empty() {
        return Err("name folders: each a log with nodes.csv, or a folder of such logs".into());
    }
    let mut logs: Vec<PathBuf> = Vec::new();
    for folder in folders {
        if folder.join("nodes.csv").is_file() {
            logs.push(folder);
        } else {
            let inside: std::io::Result<Vec<_>> =
                std::fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect();
            logs.extend(inside?.into_iter().filter(|path| path.join("nodes.csv").is_file()));
        }
    }
    logs.sort();
    for log in &logs {
        table(log)?;
    }
    Ok(())
}

/// Prints the table of the log in `folder`.
fn table(folder: &Path) -> Outcome<()> {
    let read = robot_log::read(folder, &ReadOptions::default())?;
    let truth = robot_log::read_truth(&folder.join("nodes.csv"), read.plane.as_ref(), &mut Vec::new())?;
    let places: Vec<Option<Position>> = read.log.names().iter().map(|name| truth.get(name).copied()).collect();
    let mut out = std::io::stdout().lock();
    writeln!(out, "{} ({} nodes, {} stops)", folder.display(), read.log.node_count(), read.log.stops().len())?;
    let without_rssi = without_rssi(&read.log)?;
    let has_rssi = without_rssi != read.log;
    for (name, mapper) in mappers()? {
        line(&mut out, name, &mapper, &read.log, &places)?;
        if has_rssi && matches!(mapper, Mapper::Auto(_) | Mapper::LinkModel(_)) {
            line(&mut out, &format!("{name}, no RSSI"), &mapper, &without_rssi, &places)?;
        }
    }
    Ok(())
}

fn mappers() -> Outcome<Vec<(&'static str, Mapper)>> {
    let profile = FittedConfig::default();
    let fitted = MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        ..MlTmConfig::new(0.25, ProfileConfig::Fitted(profile.clone()))
    };
    let centroid = |power| PacketCentroid::try_from(PacketCentroidConfig { power }).map(Mapper::PacketCentroid);
    Ok(vec![
        ("auto", Mapper::Auto(Auto::try_from(AutoConfig::default())?)),
        ("link-model", Mapper::LinkModel(LinkModel::try_from(LinkModelConfig::default())?)),
        ("fitted", Mapper::FittedMlTm(FittedMlTm::new(fitted, profile)?)),
        ("self-calibrated", Mapper::SelfCalibrated(SelfCalibrated::try_from(SelfCalibratedConfig::default())?)),
        ("packet centroid, power 1", centroid(1.0)?),
        ("packet centroid, power 3", centroid(3.0)?),
        ("packet centroid, power 6", centroid(6.0)?),
    ])
}

fn line(
    out: &mut impl Write,
    name: &str,
    mapper: &Mapper,
    log: &ReceptionLog,
    truth: &[Option<Position>],
) -> Outcome<()> {
    let start = now();
    let (map, learned) = mapper.map_and_learn(log, &Unwatched)?;
    let seconds = start.elapsed().as_secs_f64();
    let pairs =
        || map.estimates.iter().zip(truth).filter_map(|(estimate, place)| Some((estimate.as_ref()?, (*place)?)));
    let errors: Vec<f64> = pairs().map(|(estimate, place)| estimate.position.distance_m(place)).collect();
    let held: Vec<bool> = pairs()
        .filter_map(|(estimate, place)| {
            Some(Region::of_95(estimate, map.grid_step_m.unwrap_or(0.0))?.contains(place))
        })
        .collect();
    write!(out, "  {name:26}")?;
    if let Some(PositionError { mean, median, p95, .. }) = PositionError::of(&errors) {
        write!(out, " mean {mean:6.3} m, median {median:6.3} m, 95 % below {p95:6.3} m")?;
    }
    if !held.is_empty() {
        let within = held.iter().filter(|within| **within).count();
        write!(out, ", {:5.1} % in their regions", 100.0 * within as f64 / held.len() as f64)?;
    }
    let chosen = match learned {
        Some(Learned::Choice(choice)) => format!(", chose {}", choice.chosen),
        _ => String::new(),
    };
    writeln!(out, ", {seconds:.1} s{chosen}, {} concerns", map.concerns().count())?;
    Ok(())
}

/// The log without strengths.
fn without_rssi(log: &ReceptionLog) -> Outcome<ReceptionLog> {
    let receptions = log.receptions().iter().map(|reception| Reception { rssi_dbm: None, snr_db: None, ..reception });
    let bare =
        ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions.collect(), log.contacts().to_vec())?;
    Ok(bare.with_robots(log.robots().to_vec())?)
}
