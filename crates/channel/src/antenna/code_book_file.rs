//! Reading code books, from the settings themselves or from CSV files.

use std::collections::BTreeMap;

use sextant_kernel::{Files, SettingError};

use super::SECTORS_OF_ANTENNA;
use super::code_book::{CodeBook, CodeBookConfig, Flaw, Steps};

const COLUMNS: [&str; 4] = ["sector", "azimuth_deg", "elevation_deg", "gain_dbi"];

/// An angle in millionths of a degree, so that equal angles are equal.
type MicroDegrees = i64;

/// A gain and the line that has it.
type Entry = (f64, usize);

/// The code book that `config` describes; a file path is among `files`.
///
/// # Errors
/// If a value is invalid, or the file cannot be read or has a flaw.
pub(super) fn read(config: &CodeBookConfig, files: &Files) -> Result<CodeBook, SettingError> {
    let book = match (&config.file, &config.azimuths_deg, &config.elevations_deg, &config.sectors) {
        (Some(file), None, None, None) => {
            let path = files.path(file);
            let error = |found: String, allowed: String| SettingError::new("file", found, allowed);
            let text = files.read_text(file).map_err(|cause| {
                let found = format!("`{}`, which cannot be read: {cause}", path.display());
                error(found, "a readable CSV file".into())
            })?;
            parse(&text).map_err(|flaw| error(format!("`{}`, {}", path.display(), flaw.found), flaw.allowed))?
        }
        (Some(_), ..) => {
            let with = "`azimuths_deg`, `elevations_deg` or `sectors`";
            return Err(SettingError::conflict("file", with, "set either the file or the grid"));
        }
        (None, Some(azimuths), Some(elevations), Some(sectors)) => CodeBook::written(azimuths, elevations, sectors)?,
        (None, azimuths, elevations, _) => {
            let key = match (azimuths, elevations) {
                (None, _) => "azimuths_deg",
                (_, None) => "elevations_deg",
                _ => "sectors",
            };
            let needed = "`file`, or `azimuths_deg`, `elevations_deg` and `sectors`";
            return Err(SettingError::missing(key, needed));
        }
    };
    book.with_gains(config)
}

/// The code book in `text`. Empty lines, and lines that begin with `#`, are skipped.
///
/// # Errors
/// The first flaw and its line.
fn parse(text: &str) -> Result<CodeBook, Flaw> {
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, header)) = lines.next() else {
        return Err(flaw("which is empty".into(), format!("a header `{}`, and rows", COLUMNS.join(","))));
    };
    let order = columns(header).map_err(|found| {
        flaw(format!("line {number}: {found}"), format!("the columns `{}`, each once", COLUMNS.join("`, `")))
    })?;
    let mut sectors: BTreeMap<u8, BTreeMap<[MicroDegrees; 2], Entry>> = BTreeMap::new();
    for (number, line) in lines {
        let (sector, [azimuth, elevation], gain) =
            row(line, order).map_err(|(found, allowed)| flaw(format!("line {number}: {found}"), allowed))?;
        let entries = sectors.entry(sector).or_default();
        if let Some((_, before)) = entries.insert([elevation, azimuth], (gain, number)) {
            let found = format!(
                "line {number}: sector {sector} at azimuth {}, elevation {} again, as in line {before}",
                degrees(azimuth),
                degrees(elevation)
            );
            return Err(flaw(found, "each sector and direction once".into()));
        }
    }
    grid(sectors)
}

/// The gains of the sectors on one grid.
fn grid(sectors: BTreeMap<u8, BTreeMap<[MicroDegrees; 2], Entry>>) -> Result<CodeBook, Flaw> {
    let angles = |axis: usize| {
        let mut angles: Vec<MicroDegrees> =
            sectors.values().flat_map(|entries| entries.keys().map(|angles| angles[axis])).collect();
        angles.sort_unstable();
        angles.dedup();
        angles
    };
    let (elevations, azimuths) = (angles(0), angles(1));
    if sectors.is_empty() {
        return Err(flaw("which has a header only".into(), format!("1 to {SECTORS_OF_ANTENNA} sectors")));
    }
    let steps = |name: &str, angles: &[MicroDegrees]| {
        Steps::of(&angles.iter().map(|&angle| degrees(angle)).collect::<Vec<_>>())
            .map_err(|found| flaw(format!("{name}: {found}"), "a regular grid: angles in equal steps".into()))
    };
    let (azimuth_steps, elevation_steps) = (steps("azimuths", &azimuths)?, steps("elevations", &elevations)?);
    let mut rows = Vec::with_capacity(sectors.len());
    for (sector, entries) in sectors {
        let mut gains = Vec::with_capacity(entries.len());
        for &elevation in &elevations {
            for &azimuth in &azimuths {
                let Some(&(gain, _)) = entries.get(&[elevation, azimuth]) else {
                    let lines = || entries.values().map(|&(_, line)| line);
                    let found = format!(
                        "a gap: sector {sector} (lines {} to {}) has no row at azimuth {}, elevation {}",
                        lines().min().unwrap_or(0),
                        lines().max().unwrap_or(0),
                        degrees(azimuth),
                        degrees(elevation)
                    );
                    return Err(flaw(found, "a row for each sector and direction of the grid".into()));
                };
                gains.push(gain);
            }
        }
        rows.push((sector, gains));
    }
    CodeBook::new(azimuth_steps, elevation_steps, rows)
}

/// The position of each of [`COLUMNS`] in the header.
fn columns(header: &str) -> Result<[usize; 4], String> {
    let names: Vec<_> = header.trim_start_matches('\u{feff}').split(',').map(str::trim).collect();
    let mut order = [0; 4];
    for (place, column) in order.iter_mut().zip(COLUMNS) {
        let mut found = names.iter().enumerate().filter(|&(_, name)| *name == column).map(|(i, _)| i);
        *place = found.next().ok_or_else(|| format!("no column `{column}`"))?;
        if found.next().is_some() {
            return Err(format!("two columns `{column}`"));
        }
    }
    match names.iter().find(|name| !COLUMNS.contains(name)) {
        Some(name) => Err(format!("an unknown column `{name}`")),
        None => Ok(order),
    }
}

/// Sector, azimuth and elevation, and gain of a row; or what was found and what is allowed.
fn row(line: &str, order: [usize; 4]) -> Result<(u8, [MicroDegrees; 2], f64), (String, String)> {
    let fields: Vec<_> = line.split(',').map(str::trim).collect();
    if fields.len() != COLUMNS.len() {
        return Err((format!("{} fields", fields.len()), format!("{} fields", COLUMNS.len())));
    }
    let field = |column: usize| fields[order[column]];
    let sector = field(0).parse().ok().filter(|&sector| sector < SECTORS_OF_ANTENNA).ok_or_else(|| {
        (format!("sector `{}`", field(0)), format!("a sector from 0 to {}", SECTORS_OF_ANTENNA - 1))
    })?;
    let number = |column: usize, low: f64, high: f64| {
        let value: Option<f64> = field(column).parse().ok();
        value.filter(|value| (low..=high).contains(value)).ok_or_else(|| {
            (format!("{} `{}`", COLUMNS[column], field(column)), format!("a number from {low} to {high}"))
        })
    };
    let azimuth = micro_degrees(number(1, -360.0, 360.0)?);
    let elevation = micro_degrees(number(2, -90.0, 90.0)?);
    Ok((sector, [azimuth, elevation], number(3, -200.0, 100.0)?))
}

#[expect(clippy::cast_possible_truncation, reason = "angles are at most 360 degrees")]
fn micro_degrees(deg: f64) -> MicroDegrees {
    (deg * 1e6).round() as MicroDegrees
}

fn degrees(angle: MicroDegrees) -> f64 {
    angle as f64 / 1e6
}

fn flaw(found: String, allowed: String) -> Flaw {
    Flaw { found, allowed }
}
