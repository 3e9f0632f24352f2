//! Tables of tools: a row for each sector and direction, or a column for each sector.

use super::book::{GainUnit, Owner, Row, Rows};
use super::names::{AZIMUTH, ELEVATION, GAIN, SECTOR, find, plain};
use super::{ConvertError, Source, SourceNames};

/// The signs between fields, in the order in which they are tried.
const SEPARATORS: [char; 3] = ['\t', ';', ','];
/// What may stand before the number of a sector in the name of its column.
const PREFIXES: [&str; 9] = ["", "s", "sec", "sector", "b", "beam", "gain", "snr", "sectorid"];

/// The gains of the table `text`. Empty lines, and lines that begin with `#` or `%`, are skipped.
///
/// # Errors
/// If a column is missing, or a field is no number.
pub(super) fn rows(text: &str, names: &SourceNames) -> Result<Source, ConvertError> {
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with(['#', '%']));
    let header = lines.next().map_or("", |(_, line)| line.trim_start_matches('\u{feff}'));
    let separator = SEPARATORS.into_iter().find(|&sign| header.contains(sign)).unwrap_or(',');
    let split = |line: &str| -> Vec<String> {
        line.split(separator).map(|field| field.trim().trim_matches('"').to_owned()).collect()
    };
    let columns = split(header);
    let known: Vec<&str> = columns.iter().map(String::as_str).collect();
    let missing = |what: &'static str, usual: &[&str]| ConvertError::Missing {
        what,
        found: format!("the columns `{}`", known.join("`, `")),
        allowed: format!("a column called `{}`, or its name", usual.join("`, `")),
    };
    let azimuth = find(&known, names.azimuth.as_deref(), &AZIMUTH);
    let azimuth = azimuth.ok_or_else(|| missing("column of azimuths", &AZIMUTH))?;
    let elevation = find(&known, names.elevation.as_deref(), &ELEVATION);
    if names.elevation.is_some() && elevation.is_none() {
        return Err(missing("column of elevations", &ELEVATION));
    }
    let mut notes = Vec::new();
    if elevation.is_none() {
        notes.push("there is no column of elevations: the table is a planar cut at elevation 0".to_owned());
    }
    let sector = find(&known, names.sector.as_deref(), &SECTOR);
    // The columns with gains, each with its sector if it is not in the row.
    let (gains, named_unit): (Vec<(usize, Option<Owner>)>, _) = match sector {
        Some(_) => {
            let gain = find(&known, names.gain.as_deref(), &GAIN).ok_or_else(|| missing("column of gains", &GAIN))?;
            (vec![(gain, None)], unit_of(known[gain]))
        }
        None => {
            let columns = known.iter().enumerate().filter(|&(i, _)| i != azimuth && Some(i) != elevation);
            let gains: Vec<_> = columns.filter_map(|(i, name)| Some((i, Some(owner_of(name)?)))).collect();
            if gains.is_empty() {
                return Err(missing("column of sectors, and no column for each sector", &SECTOR));
            }
            (gains, None)
        }
    };
    let used =
        |i: usize| i == azimuth || Some(i) == elevation || Some(i) == sector || gains.iter().any(|&(at, _)| at == i);
    let unused: Vec<&str> = (0..known.len()).filter(|&i| !used(i)).map(|i| known[i]).collect();
    if !unused.is_empty() {
        notes.push(format!("not used: the columns `{}`", unused.join("`, `")));
    }
    let mut rows = Vec::new();
    for (number, line) in lines {
        let fields = split(line);
        let value = |column: usize| {
            let text = fields.get(column).map_or("", String::as_str);
            let gap =
                text.is_empty() || ["nan", "na", "null", "-", "inf", "-inf"].contains(&text.to_lowercase().as_str());
            let value = if gap { Ok(f64::NAN) } else { text.parse::<f64>() };
            value.map_err(|_| ConvertError::Invalid {
                place: format!("line {number}, column `{}`", known[column]),
                found: format!("`{text}`"),
                allowed: "a number, or `nan` for a gap".into(),
            })
        };
        let (azimuth_deg, elevation_deg) = (value(azimuth)?, elevation.map_or(Ok(level(names)), value)?);
        for &(column, owner) in &gains {
            let owner = match (owner, sector) {
                (Some(owner), _) => owner,
                (None, Some(column)) if is_quasi_omni(fields.get(column).map_or("", String::as_str)) => {
                    Owner::QuasiOmni
                }
                (None, column) => Owner::of(value(column.unwrap_or(0))?, || format!("line {number}"))?,
            };
            rows.push(Row { owner, azimuth_deg, elevation_deg, gain: value(column)? });
        }
    }
    Ok(Source { rows: Rows(rows), named_unit, notes })
}

/// The elevation of a planar cut as it would be written.
pub(super) fn level(names: &SourceNames) -> f64 {
    if names.from_zenith { 90.0 } else { 0.0 }
}

/// The unit that the name of a column or a variable says.
pub(super) fn unit_of(name: &str) -> Option<GainUnit> {
    let letters: String = name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
    match () {
        () if letters.ends_with("dbi") => Some(GainUnit::Dbi),
        () if letters.ends_with("db") || letters.ends_with("dbm") => Some(GainUnit::Relative),
        () if letters.contains("linear") => Some(GainUnit::Linear),
        () => None,
    }
}

/// The pattern whose gains a column has, by its name: `sector_5`, `s5`, `5`, `quasi_omni`.
fn owner_of(name: &str) -> Option<Owner> {
    let plain = plain(name);
    if is_quasi_omni(&plain) {
        return Some(Owner::QuasiOmni);
    }
    let prefix = plain.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number: f64 = plain[prefix.len()..].parse().ok()?;
    PREFIXES.contains(&prefix).then(|| Owner::of(number, String::new).ok()).flatten()
}

fn is_quasi_omni(name: &str) -> bool {
    ["quasiomni", "rx", "omni"].contains(&plain(name).as_str())
}
