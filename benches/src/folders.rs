//! Logs of robots in folders, with the true places of their nodes.

use std::path::{Path, PathBuf};

use sextant_channel::{LogError, Reception, ReceptionLog};
use sextant_logs::{self as robot_log, ReadOptions, RobotLogError};

use crate::laws::KnownLog;

/// What the name of a log has more without its strengths.
pub const WITHOUT_STRENGTHS: &str = ", no RSSI";

/// The folders that have `nodes.csv`: those of `named`, or within one of `named`, sorted.
///
/// # Errors
/// If a folder cannot be read.
pub fn logs_in(named: &[PathBuf]) -> std::io::Result<Vec<PathBuf>> {
    let mut logs: Vec<PathBuf> = Vec::new();
    for folder in named {
        if folder.join("nodes.csv").is_file() {
            logs.push(folder.clone());
        } else {
            let inside: std::io::Result<Vec<_>> = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect();
            logs.extend(inside?.into_iter().filter(|path| path.join("nodes.csv").is_file()));
        }
    }
    logs.sort();
    Ok(logs)
}

/// The log in `folder`, of the family `real`.
///
/// # Errors
/// If a file is invalid.
pub fn read(folder: &Path) -> Result<KnownLog, RobotLogError> {
    let read = robot_log::read(folder, &ReadOptions::default())?;
    let truth = robot_log::read_truth(&folder.join("nodes.csv"), None, read.plane.as_ref(), &mut Vec::new())?;
    let truth = read.log.names().iter().map(|name| truth.places.get(name).copied()).collect();
    let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned();
    Ok(KnownLog { family: "real".to_owned(), name, log: read.log, truth })
}

/// The log without strengths, under another name; `None` if it has none.
///
/// # Errors
/// If the log contradicts itself.
pub fn without_strengths(known: &KnownLog) -> Result<Option<KnownLog>, LogError> {
    let log = &known.log;
    if log.receptions().iter().all(|reception| reception.rssi_dbm.is_none()) {
        return Ok(None);
    }
    let receptions = log.receptions().iter().map(|reception| Reception { rssi_dbm: None, snr_db: None, ..reception });
    let bare =
        ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions.collect(), log.contacts().to_vec());
    let bare = bare?.with_robots(log.robots().to_vec())?;
    let [family, name] = [&known.family, &known.name].map(|text| format!("{text}{WITHOUT_STRENGTHS}"));
    Ok(Some(KnownLog { family, name, log: bare, truth: known.truth.clone() }))
}
