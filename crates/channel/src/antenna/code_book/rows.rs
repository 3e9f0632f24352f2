//! Reading code books from CSV files.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_kernel::{Files, SettingError};

use super::gaps::{self, Gaps};
use super::measured::{Measured, QUASI_OMNI};
use super::steps::Steps;
use super::unit::{self, Unit};
use super::{Flaw, SECTORS_OF_ANTENNA};

/// The columns beside that of the gain.
const ANGLES: [&str; 3] = ["sector", "azimuth_deg", "elevation_deg"];

/// A grid of so many cells is never too large: all sectors together.
const FEW_CELLS: usize = 100_000;
/// A larger grid has at most so many cells for each gain in the file: a short file with two angles that hardly differ would
/// make one of millions.
const MOST_CELLS_OF_A_GAIN: usize = 1000;

/// An angle in millionths of a degree, so that equal angles are equal.
type MicroDegrees = i64;

/// A gain in decibels, not a number for a gap, and the line that has it.
type Entry = (f64, usize);

/// The rows of one pattern, by elevation and azimuth.
type Entries = BTreeMap<[MicroDegrees; 2], Entry>;

/// Which pattern a row belongs to: that of a sector, or the quasi-omnidirectional one.
type Owner = Option<u8>;

/// The measurement in a file among `files`, and whether its gains are in relative units.
///
/// # Errors
/// If the file cannot be read or has a flaw, with the key `file`.
pub(super) fn read(file: &Path, gaps: Gaps, files: &Files) -> Result<(Measured, bool), SettingError> {
    let path = files.path(file);
    let error = |found: String, allowed: String| SettingError::new("file", found, allowed);
    let text = files.read_text(file).map_err(|cause| {
        error(format!("`{}`, which cannot be read: {cause}", path.display()), "a readable CSV file".into())
    })?;
    let flawed = |flaw: Flaw| error(format!("`{}`, {}", path.display(), flaw.found), flaw.allowed);
    parse(&text, gaps).map_err(|flaw| files.discreet(file, flawed(flaw)))
}

/// The measurement in `text`, and whether its gains are in relative units. Empty lines, and lines that begin with `#`, are
/// skipped.
///
/// # Errors
/// The first flaw and its line; all gaps, if they are refused.
fn parse(text: &str, gaps: Gaps) -> Result<(Measured, bool), Flaw> {
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, header)) = lines.next() else {
        return Err(flaw("which is empty".into(), format!("a header `{},gain_dbi`, and rows", ANGLES.join(","))));
    };
    let columns = CodeBookColumns::of(header).map_err(|found| {
        let allowed =
            format!("the columns `{}`, and one of `gain_dbi`, `gain_db` and `gain_linear`", ANGLES.join("`, `"));
        flaw(format!("line {number}: {found}"), allowed)
    })?;
    let mut patterns: BTreeMap<Owner, Entries> = BTreeMap::new();
    for (number, line) in lines {
        let (owner, [azimuth, elevation], gain) =
            columns.row(line).map_err(|(found, allowed)| flaw(format!("line {number}: {found}"), allowed))?;
        let entries = patterns.entry(owner).or_default();
        if let Some((_, before)) = entries.insert([elevation, azimuth], (gain, number)) {
            let found = format!(
                "line {number}: {} at azimuth {}, elevation {} again, as in line {before}",
                owner.map_or_else(|| QUASI_OMNI.to_owned(), |sector| format!("sector {sector}")),
                degrees(azimuth),
                degrees(elevation)
            );
            return Err(flaw(found, "each sector and direction once".into()));
        }
    }
    let mut measured = grid(patterns)?.checked()?;
    if columns.unit == Unit::Dbi {
        unit::suspect_factors(measured.all_gains())?;
    }
    gaps::settle(&mut measured, gaps)?;
    Ok((measured, columns.unit == Unit::Relative))
}

/// The gains of the patterns on one grid.
fn grid(patterns: BTreeMap<Owner, Entries>) -> Result<Measured, Flaw> {
    let angles = |axis: usize| {
        let mut angles: Vec<MicroDegrees> =
            patterns.values().flat_map(|entries| entries.keys().map(|angles| angles[axis])).collect();
        angles.sort_unstable();
        angles.dedup();
        angles
    };
    let (elevations, azimuths) = (angles(0), angles(1));
    if !patterns.keys().any(Option::is_some) {
        let found = if patterns.is_empty() { "which has a header only" } else { "which has no sectors" };
        return Err(flaw(found.into(), format!("1 to {SECTORS_OF_ANTENNA} sectors")));
    }
    let axis = |name: &str, angles: &[MicroDegrees]| {
        let degrees: Vec<f64> = angles.iter().map(|&angle| degrees(angle)).collect();
        let (steps, places) = Steps::with_gaps(&degrees)
            .map_err(|found| flaw(format!("{name}: {found}"), "a regular grid: angles in equal steps".into()))?;
        Ok((steps, angles.iter().copied().zip(places).collect::<BTreeMap<MicroDegrees, usize>>()))
    };
    let (azimuths, columns) = axis("azimuths", &azimuths)?;
    let (elevations, rows) = axis("elevations", &elevations)?;
    let gains = patterns.values().map(Entries::len).sum::<usize>();
    let directions = azimuths.count * elevations.count;
    if patterns.len() * directions > FEW_CELLS.max(MOST_CELLS_OF_A_GAIN * gains) {
        let (across, up) = (azimuths.count, elevations.count);
        return Err(flaw(
            format!("a grid of {across} azimuths times {up} elevations for {gains} gains"),
            format!("a gain for at least one in {MOST_CELLS_OF_A_GAIN} directions of each sector"),
        ));
    }
    let mut measured = Measured { azimuths, elevations, sectors: Vec::new(), quasi_omni: None };
    for (owner, entries) in patterns {
        let mut gains = vec![f64::NAN; directions];
        for ([elevation, azimuth], (gain, _)) in entries {
            gains[rows[&elevation] * azimuths.count + columns[&azimuth]] = gain;
        }
        match owner {
            Some(sector) => measured.sectors.push((sector, gains)),
            None => measured.quasi_omni = Some(gains),
        }
    }
    Ok(measured)
}

/// Where the columns of a file are.
struct CodeBookColumns {
    /// The position of each of [`ANGLES`], then that of the gain.
    order: [usize; 4],
    unit: Unit,
    count: usize,
}

impl CodeBookColumns {
    /// Those of a header.
    fn of(header: &str) -> Result<Self, String> {
        let names: Vec<_> = header.trim_start_matches('\u{feff}').split(',').map(str::trim).collect();
        let find = |column: &str| -> Result<Option<usize>, String> {
            let mut found = names.iter().enumerate().filter(|&(_, name)| *name == column).map(|(i, _)| i);
            let place = found.next();
            if found.next().is_some() { Err(format!("two columns `{column}`")) } else { Ok(place) }
        };
        let mut order = [0; 4];
        for (place, column) in order.iter_mut().zip(ANGLES) {
            *place = find(column)?.ok_or_else(|| format!("no column `{column}`"))?;
        }
        let mut gains = Vec::new();
        for (column, unit) in Unit::COLUMNS {
            gains.extend(find(column)?.map(|place| (column, place, unit)));
        }
        let unit = match gains[..] {
            [] => return Err("no column `gain_dbi`".into()),
            [(_, place, unit)] => {
                order[3] = place;
                unit
            }
            [(one, ..), (other, ..), ..] => return Err(format!("the columns `{one}` and `{other}`")),
        };
        let is_known = |name: &str| ANGLES.contains(&name) || Unit::COLUMNS.iter().any(|(column, _)| *column == name);
        match names.iter().find(|name| !is_known(name)) {
            Some(name) => Err(format!("an unknown column `{name}`")),
            None => Ok(Self { order, unit, count: names.len() }),
        }
    }

    /// The owner, azimuth and elevation, and gain of a row; or what was found and what is allowed.
    fn row(&self, line: &str) -> Result<(Owner, [MicroDegrees; 2], f64), (String, String)> {
        let fields: Vec<_> = line.split(',').map(str::trim).collect();
        if fields.len() != self.count {
            return Err((format!("{} fields", fields.len()), format!("{} fields", self.count)));
        }
        let field = |column: usize| fields[self.order[column]];
        let owner = match field(0) {
            QUASI_OMNI => None,
            text => Some(text.parse().ok().filter(|&sector| sector < SECTORS_OF_ANTENNA).ok_or_else(|| {
                let allowed = format!("a sector from 0 to {}, or `{QUASI_OMNI}`", SECTORS_OF_ANTENNA - 1);
                (format!("sector `{text}`"), allowed)
            })?),
        };
        let angle = |column: usize, low: f64, high: f64| {
            let value: Option<f64> = field(column).parse().ok();
            value.filter(|value| (low..=high).contains(value)).map(micro_degrees).ok_or_else(|| {
                (format!("{} `{}`", ANGLES[column], field(column)), format!("a number from {low} to {high}"))
            })
        };
        let angles = [angle(1, -360.0, 360.0)?, angle(2, -90.0, 90.0)?];
        let gain = match field(3) {
            "" => Some(f64::NAN),
            text => match text.parse::<f64>().ok() {
                Some(gap) if gap.is_nan() => Some(gap),
                value => value.and_then(|value| self.unit.decibels(value)),
            },
        };
        let gain = gain.ok_or_else(|| (format!("gain `{}`", field(3)), self.unit.allowed().to_owned()))?;
        Ok((owner, angles, gain))
    }
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
