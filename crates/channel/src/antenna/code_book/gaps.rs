//! Gaps of a measurement: directions of the grid without a gain.

use std::collections::BTreeMap;

use sextant_kernel::text::counted;

use super::Flaw;
use super::measured::Measured;
use super::steps::Steps;
use crate::antenna::sector::runs;

/// What becomes of directions of the grid that a file has no gain for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Gaps {
    /// A file with gaps is refused, and the gaps are named.
    #[default]
    Refuse,
    /// The gain of the nearest measured azimuth at the same elevation; an elevation without any has the gains of the
    /// nearest one.
    Hold,
    /// Linear in decibels between the measured azimuths on both sides at the same elevation; an elevation without any
    /// lies between the nearest ones. Beyond the first and the last one the gain holds.
    Interpolate,
}

/// Most places of gaps that are named.
const MOST_NAMED: usize = 40;

/// Fills the gaps of a measurement, or names them all.
///
/// # Errors
/// If there are any and they are refused, or if a sector has no gain at all.
pub(super) fn settle(measured: &mut Measured, gaps: Gaps) -> Result<(), Flaw> {
    let missing = measured.patterns().flat_map(|pattern| pattern.gains.iter()).filter(|gain| gain.is_nan()).count();
    if missing == 0 {
        return Ok(());
    }
    if let Some(empty) = measured.patterns().find(|pattern| pattern.gains.iter().all(|gain| gain.is_nan())) {
        return Err(Flaw {
            found: format!("{} without a gain in any direction", empty.name()),
            allowed: "a measured gain for each sector".into(),
        });
    }
    if gaps == Gaps::Refuse {
        return Err(named(measured, missing));
    }
    let (azimuths, elevations) = (measured.azimuths, measured.elevations);
    for gains in measured.gains_mut() {
        for row in gains.chunks_exact_mut(azimuths.count) {
            fill(row, azimuths.is_circle(), gaps);
        }
        for column in 0..azimuths.count {
            let mut of_column: Vec<f64> =
                (0..elevations.count).map(|row| gains[row * azimuths.count + column]).collect();
            fill(&mut of_column, false, gaps);
            for (row, gain) in of_column.into_iter().enumerate() {
                gains[row * azimuths.count + column] = gain;
            }
        }
    }
    Ok(())
}

/// Fills the gaps of gains at equal steps, the last of which is beside the first on a circle. Nothing changes if there is
/// no gain at all.
fn fill(gains: &mut [f64], is_circle: bool, gaps: Gaps) {
    let count = gains.len();
    let known: Vec<(usize, f64)> = gains.iter().copied().enumerate().filter(|(_, gain)| !gain.is_nan()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return };
    for (place, filled) in gains.iter_mut().enumerate().filter(|(_, gain)| gain.is_nan()) {
        let next = known.partition_point(|&(at, _)| at < place);
        // Steps to the nearest gains on both sides, and these gains.
        let before = match next.checked_sub(1) {
            Some(i) => Some((place - known[i].0, known[i].1)),
            None => is_circle.then(|| (place + count - last.0, last.1)),
        };
        let after = match known.get(next) {
            Some(&(at, gain)) => Some((at - place, gain)),
            None => is_circle.then(|| (first.0 + count - place, first.1)),
        };
        *filled = match (before, after) {
            (Some((back, left)), Some((ahead, right))) => match gaps {
                Gaps::Interpolate => left + (right - left) * back as f64 / (back + ahead) as f64,
                Gaps::Hold | Gaps::Refuse => {
                    if ahead < back {
                        right
                    } else {
                        left
                    }
                }
            },
            (Some((_, gain)), None) | (None, Some((_, gain))) => gain,
            (None, None) => continue,
        };
    }
}

/// All gaps: how many, and where.
fn named(measured: &Measured, missing: usize) -> Flaw {
    let Measured { azimuths, elevations, .. } = measured;
    let directions = azimuths.count * elevations.count;
    // The sectors without a gain in each direction.
    let mut of_cell: BTreeMap<usize, Vec<&str>> = BTreeMap::new();
    let names: Vec<String> = measured.patterns().map(|pattern| pattern.name()).collect();
    for (pattern, name) in measured.patterns().zip(&names) {
        let gaps = pattern.gains.iter().enumerate().filter(|(_, gain)| gain.is_nan());
        gaps.for_each(|(cell, _)| of_cell.entry(cell).or_default().push(name));
    }
    let mut places: Vec<Place<'_>> = Vec::new();
    for (cell, sectors) in of_cell {
        let (row, column) = (cell / azimuths.count, cell % azimuths.count);
        match places.last_mut() {
            Some(Place { columns: [_, last], rows: [_, at], sectors: same })
                if *last + 1 == column && *at == row && *same == sectors =>
            {
                *last = column;
            }
            _ => places.push(Place { columns: [column; 2], rows: [row; 2], sectors }),
        }
    }
    let mut merged: Vec<Place<'_>> = Vec::new();
    for place in places {
        let above = merged.iter_mut().find(|known| {
            known.rows[1] + 1 == place.rows[0] && known.columns == place.columns && known.sectors == place.sectors
        });
        match above {
            Some(known) => known.rows[1] = place.rows[1],
            None => merged.push(place),
        }
    }
    let count = names.len();
    let mut texts: Vec<String> =
        merged.iter().take(MOST_NAMED).map(|place| place.text(azimuths, elevations, count)).collect();
    if merged.len() > MOST_NAMED {
        texts.push(format!("and {} more places", merged.len() - MOST_NAMED));
    }
    Flaw {
        found: format!(
            "{} in {} gains of {} on a grid of {directions} directions (azimuths {}; elevations {}): {}",
            counted(missing, "gap"),
            directions * count,
            counted(count, "pattern"),
            azimuths.text(),
            elevations.text(),
            texts.join("; ")
        ),
        allowed: "a row for each sector and direction of the grid, or `gaps = \"hold\"` or `gaps = \"interpolate\"`"
            .into(),
    }
}

/// A rectangle of the grid where the same sectors have no gain.
struct Place<'a> {
    columns: [usize; 2],
    rows: [usize; 2],
    sectors: Vec<&'a str>,
}

impl Place<'_> {
    fn text(&self, azimuths: &Steps, elevations: &Steps, of: usize) -> String {
        let numbers: Vec<u8> =
            self.sectors.iter().filter_map(|name| name.strip_prefix("sector ")?.parse().ok()).collect();
        let others = self.sectors.iter().filter(|name| !name.starts_with("sector ")).map(|name| (*name).to_owned());
        let numbered = match numbers[..] {
            [] => None,
            [one] => Some(format!("sector {one}")),
            _ => Some(format!("sectors {}", runs(numbers.iter().copied()))),
        };
        let who = match self.sectors.len() == of && of > 1 {
            true => "all sectors".to_owned(),
            false => numbered.into_iter().chain(others).collect::<Vec<_>>().join(", "),
        };
        format!("azimuth {}, elevation {}: {who}", azimuths.span_text(self.columns), elevations.span_text(self.rows))
    }
}
