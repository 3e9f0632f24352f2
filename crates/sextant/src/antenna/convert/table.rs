//! Tables of tools: a row for each sector and direction, a column for each sector, or one pattern.

use super::book::{Owner, Rows, TableRow};
use super::gain_unit::GainUnit;
use super::names::{AZIMUTH, ColumnName, ELEVATION, GAIN, SECTOR, find, plain};
use super::{AngleNames, ConvertError, Source, SourceNames, angles};

/// The signs between fields, in the order in which they are tried; without any of them, fields are separated by blanks.
const SEPARATORS: [char; 3] = ['\t', ';', ','];
/// What may stand before the number of a sector in the name of its column.
const PREFIXES: [&str; 9] = ["", "s", "sec", "sector", "b", "beam", "gain", "snr", "sectorid"];

/// The gains of the table `text`. Empty lines, lines that begin with `#` or `%`, and lines that are drawn are skipped.
///
/// # Errors
/// If a column is missing, or a field is no number.
pub(super) fn rows(text: &str, names: &SourceNames) -> Result<Source, ConvertError> {
    let Lines { header, separator, lines } = Lines::of(text);
    let known: Vec<&str> = header.iter().map(String::as_str).collect();
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
    if names.sector.is_some() && sector.is_none() {
        return Err(missing("column of sectors", &SECTOR));
    }
    let gains =
        Gains::of(&known, [Some(azimuth), elevation, sector], names, &mut notes).ok_or_else(|| match sector {
            Some(_) => missing("column of gains", &GAIN),
            None => missing("column of gains, and no column for each sector", &GAIN),
        })??;
    let used = |i: usize| {
        i == azimuth || Some(i) == elevation || Some(i) == sector || gains.columns.iter().any(|&(at, _)| at == i)
    };
    let unused: Vec<&str> = (0..known.len()).filter(|&i| !used(i)).map(|i| known[i]).collect();
    if !unused.is_empty() {
        notes.push(format!("not used: the columns `{}`", unused.join("`, `")));
    }
    let mut rows = Vec::new();
    for (number, line) in lines {
        let fields = split(line, separator);
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
        let (azimuth_deg, elevation_deg) = (value(azimuth)?, elevation.map_or(Ok(0.0), value)?);
        for &(column, owner) in &gains.columns {
            let owner = match (owner, sector) {
                (Some(owner), _) => owner,
                (None, Some(column)) if is_quasi_omni(fields.get(column).map_or("", String::as_str)) => {
                    Owner::QuasiOmni
                }
                (None, Some(column)) => Owner::of(value(column)?, || format!("line {number}"))?,
                (None, None) => Owner::Sector(0),
            };
            rows.push(TableRow { owner, azimuth_deg, elevation_deg, gain: value(column)? });
        }
    }
    let mut rows = Rows(rows);
    let of = AngleNames { azimuth: known[azimuth], elevation: elevation.map(|at| known[at]) };
    angles::settle(&mut rows, &of, names)?;
    Ok(Source { rows, named_unit: gains.unit, gains: gains.name, notes })
}

/// The columns with gains.
struct Gains {
    /// Each with its pattern, if that is not in the row.
    columns: Vec<(usize, Option<Owner>)>,
    /// What their names say of their unit.
    unit: Option<GainUnit>,
    /// What they are called.
    name: String,
}

impl Gains {
    /// The gains among the columns `known`, beside those of the azimuth, the elevation and the sector; `None` if there are none.
    fn of(
        known: &[&str],
        others: [Option<usize>; 3],
        names: &SourceNames,
        notes: &mut Vec<String>,
    ) -> Option<Result<Self, ConvertError>> {
        let [.., sector] = others;
        let of_one = |at: usize| {
            let name = ColumnName::of(known[at]);
            if let (None, Some(unit)) = (name.gain_unit(), name.other_unit()) {
                return Err(ConvertError::Invalid {
                    place: format!("column `{}`", known[at]),
                    found: format!("the unit `{unit}`"),
                    allowed: "gains in dBi or dB, or factors of power".to_owned(),
                });
            }
            Ok(Self { columns: vec![(at, None)], unit: name.gain_unit(), name: known[at].to_owned() })
        };
        let free = || known.iter().enumerate().filter(|(at, _)| !others.contains(&Some(*at)));
        if sector.is_none() && names.gain.is_none() {
            let columns: Vec<_> = free().filter_map(|(at, name)| Some((at, Some(owner_of(name)?)))).collect();
            if let (Some(&(first, _)), Some(&(last, _))) = (columns.first(), columns.last()) {
                let mut units: Vec<_> =
                    columns.iter().map(|&(at, _)| ColumnName::of(known[at]).gain_unit()).collect();
                units.dedup();
                let is_snr = columns.iter().all(|&(at, _)| plain(known[at]).starts_with("snr"));
                let unit = match units[..] {
                    [Some(unit)] => Some(unit),
                    _ => is_snr.then_some(GainUnit::Relative),
                };
                let name = if first == last {
                    known[first].to_owned()
                } else {
                    format!("{}` to `{}", known[first], known[last])
                };
                return Some(Ok(Self { columns, unit, name }));
            }
        }
        if names.gain.is_some() {
            let at = find(known, names.gain.as_deref(), &GAIN)?;
            if sector.is_none() {
                notes.push(ONE_PATTERN.to_owned());
            }
            return Some(of_one(at));
        }
        let found: Vec<usize> =
            free().filter(|(_, name)| GAIN.contains(&plain(name).as_str())).map(|(at, _)| at).collect();
        match found[..] {
            [] => None,
            [only] => {
                if sector.is_none() {
                    notes.push(ONE_PATTERN.to_owned());
                }
                Some(of_one(only))
            }
            // Of several in one table, it must be said which.
            _ => Some(Err(ConvertError::SeveralGains {
                found: found.iter().map(|&at| known[at].to_owned()).collect(),
            })),
        }
    }
}

/// What is said of a table without sectors.
const ONE_PATTERN: &str = "there is no column of sectors: the table is one pattern, that of sector 0";

/// The header of a table, and its lines with their numbers.
struct Lines<'a> {
    header: Vec<String>,
    /// What separates fields; `None` for blanks.
    separator: Option<char>,
    lines: Vec<(usize, &'a str)>,
}

impl<'a> Lines<'a> {
    fn of(text: &'a str) -> Self {
        let all = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim().trim_start_matches('\u{feff}')));
        let is_comment = |line: &str| line.starts_with(['#', '%', '!']);
        let is_drawn = |line: &str| line.chars().all(|c| matches!(c, '-' | '=' | '_' | ' ' | '+' | '|'));
        let mut lines: Vec<(usize, &str)> =
            all.clone().filter(|(_, line)| !line.is_empty() && !is_comment(line) && !is_drawn(line)).collect();
        let first = lines.first().copied().unwrap_or_default();
        let separator_of = |line: &str| SEPARATORS.into_iter().find(|&sign| line.contains(sign));
        let is_number = |field: &String| field.parse::<f64>().is_ok();
        // FEKO has the names of its columns in the last comment before the numbers.
        let separator = separator_of(first.1);
        let fields = split(first.1, separator);
        if !fields.is_empty() && fields.iter().all(is_number) {
            let comment = all.take_while(|(number, _)| *number < first.0).filter(|(_, line)| is_comment(line)).last();
            let header = comment.map(|(_, line)| line.trim_start_matches(['#', '%', '!', '*']).trim());
            let header = header.map(|line| split(line, separator)).filter(|header| header.len() == fields.len());
            if let Some(header) = header {
                return Self { header, separator, lines };
            }
        }
        if !lines.is_empty() {
            lines.remove(0);
        }
        Self { header: fields, separator, lines }
    }
}

/// The fields of a line. A blank is part of a field within quotes or brackets, and before the bracket of a unit.
fn split(line: &str, separator: Option<char>) -> Vec<String> {
    let plain = |field: &str| field.trim().trim_matches('"').to_owned();
    if let Some(separator) = separator {
        return line.split(separator).map(plain).collect();
    }
    let (mut fields, mut field, mut depth, mut is_quoted) = (Vec::new(), String::new(), 0_u32, false);
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' => is_quoted = !is_quoted,
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if !c.is_whitespace() || is_quoted || depth > 0 {
            field.push(c);
            continue;
        }
        while rest.peek().is_some_and(|next| next.is_whitespace()) {
            rest.next();
        }
        if rest.peek() == Some(&'[') && !field.is_empty() {
            field.push(' ');
        } else if !field.is_empty() {
            fields.push(plain(&std::mem::take(&mut field)));
        }
    }
    if !field.is_empty() {
        fields.push(plain(&field));
    }
    fields
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
