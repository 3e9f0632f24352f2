//! A log as a folder of CSV tables.

use std::fmt::Write as _;
use std::path::Path;

use sextant_channel::{Position, ReceptionLog};

use super::LawError;

/// The columns of `receptions.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Columns {
    /// All, and all pairs.
    All,
    /// Without `sent`, and only pairs that were heard.
    WithoutSent,
}

/// Writes the log, and the places of its nodes (`nodes.csv`) if any is known.
pub(super) fn write(
    log: &ReceptionLog,
    truth: &[Option<Position>],
    folder: &Path,
    columns: Columns,
) -> Result<(), LawError> {
    let mut stops = String::from("stop,t_s,x_m,y_m,z_m\n");
    for (number, stop) in log.stops().iter().enumerate() {
        let Position { x_m, y_m, z_m } = stop.position;
        line(&mut stops, format_args!("{number},{},{x_m},{y_m},{z_m}", stop.time.as_secs_f64()));
    }
    let without_sent = columns == Columns::WithoutSent;
    let has_strengths = log.receptions().iter().any(|reception| reception.rssi_dbm.is_some());
    let mut receptions = String::from(if without_sent { "node,stop,received" } else { "node,stop,received,sent" });
    receptions.push_str(if has_strengths { ",rssi_dbm\n" } else { "\n" });
    for reception in log.receptions().iter().filter(|reception| !without_sent || reception.received > 0) {
        let mut row = format!("{},{},{}", log.names()[reception.node.index()], reception.stop, reception.received);
        if !without_sent {
            row.push_str(&format!(",{}", reception.sent));
        }
        if has_strengths {
            row.push_str(&reception.rssi_dbm.map_or_else(|| ",".to_owned(), |rssi_dbm| format!(",{rssi_dbm:.3}")));
        }
        line(&mut receptions, format_args!("{row}"));
    }
    let mut nodes = String::from("node,x_m,y_m,z_m\n");
    for (name, place) in log.names().iter().zip(truth) {
        if let Some(Position { x_m, y_m, z_m }) = place {
            line(&mut nodes, format_args!("{name},{x_m},{y_m},{z_m}"));
        }
    }
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| LawError::Write { path, source }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let has_truth = truth.iter().any(Option::is_some);
    let files =
        [("stops.csv", &stops, true), ("receptions.csv", &receptions, true), ("nodes.csv", &nodes, has_truth)];
    for (name, text, _) in files.into_iter().filter(|(_, _, is_written)| *is_written) {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(failed(&path))?;
    }
    Ok(())
}

fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    writeln!(text, "{arguments}").expect("a string takes all text");
}
