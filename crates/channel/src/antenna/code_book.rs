//! Code books: measured gains of the sectors of a real antenna.

use std::f64::consts::PI;
use std::path::PathBuf;

#[cfg(feature = "config")]
use schemars::JsonSchema;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use super::SECTORS_OF_ANTENNA;
use crate::{Position, SectorConfig, SectorTable};

/// Measured sectors, as written in a scenario: either a file, or the grid and the gains.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct CodeBookConfig {
    /// A CSV file with the columns `sector`, `azimuth_deg`, `elevation_deg` and `gain_dbi`, in any order: a row for
    /// each sector and direction of a regular grid.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub file: Option<PathBuf>,
    /// Azimuths of the grid (degrees), ascending in equal steps.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub azimuths_deg: Option<Vec<f64>>,
    /// Elevations of the grid (degrees), ascending in equal steps.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub elevations_deg: Option<Vec<f64>>,
    /// Gains of each sector.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sectors: Option<Vec<SectorGainsConfig>>,
    /// Gain in directions outside the grid (dBi). If absent, the grid must go all around in azimuth, and the gains at
    /// the lowest and highest elevation hold below and above.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub outside_gain_dbi: Option<f64>,
    /// Greatest gain of any sector (dBi). If absent, that of the measurement. All gains change by the same decibels:
    /// for measurements in relative units.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub boresight_gain_dbi: Option<f64>,
    /// Gain of the quasi-omnidirectional pattern in all directions (dBi).
    #[cfg_attr(feature = "config", serde(default))]
    pub quasi_omni_gain_dbi: f64,
    /// Standard deviation of the gain over the sectors and stations (dB), beside what was measured.
    #[cfg_attr(feature = "config", serde(default))]
    pub gain_ripple_db: f64,
}

/// Measured gains of one sector, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct SectorGainsConfig {
    /// Identity of the sector on air, 0 to 63.
    pub sector: u8,
    /// Gains (dBi): a list for each elevation, with a value for each azimuth.
    pub gain_dbi: Vec<Vec<f64>>,
}

/// Equal steps of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    pub(super) first_deg: f64,
    /// 0 for a single angle.
    pub(super) step_deg: f64,
    pub(super) count: usize,
}

impl Steps {
    /// The steps of these angles (degrees).
    pub(super) fn of(angles_deg: &[f64]) -> Result<Self, String> {
        let (Some(&first_deg), Some(&last)) = (angles_deg.first(), angles_deg.last()) else {
            return Err("an empty list".into());
        };
        if let Some(bad) = angles_deg.iter().find(|deg| !deg.is_finite()) {
            return Err(format!("a list with {bad}"));
        }
        let count = angles_deg.len();
        if count == 1 {
            return Ok(Self { first_deg, step_deg: 0.0, count });
        }
        let step_deg = (last - first_deg) / (count - 1) as f64;
        let smallest = angles_deg.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        for pair in angles_deg.windows(2) {
            let step = pair[1] - pair[0];
            if step <= 0.0 {
                return Err(format!("{} after {}", pair[1], pair[0]));
            }
            if (step - smallest).abs() > STEP_TOLERANCE_DEG {
                return Err(format!("a gap: {} after {}, with steps of {smallest}", pair[1], pair[0]));
            }
        }
        Ok(Self { first_deg, step_deg, count })
    }

    fn last_deg(&self) -> f64 {
        self.first_deg + self.step_deg * (self.count - 1) as f64
    }

    /// Whether a step after the last angle is the first one again.
    fn is_circle(&self) -> bool {
        self.count > 1 && (self.step_deg * self.count as f64 - 360.0).abs() < 0.5 * self.step_deg
    }
}

/// How far steps may differ (degrees): rounded angles of a file.
const STEP_TOLERANCE_DEG: f64 = 0.011;

/// Measured gains on a regular grid, interpolated linearly in decibels.
#[derive(Clone, Debug)]
pub(super) struct CodeBook {
    azimuths: Steps,
    elevations: Steps,
    identities: Vec<u8>,
    /// By sector, elevation, azimuth.
    gains_dbi: Vec<f64>,
    outside_dbi: Option<f64>,
}

/// Where a direction falls on the steps of an angle: the steps before and after it, and the share of the second.
type Between = (usize, usize, f64);

impl CodeBook {
    /// The same with the gains that `config` gives beside the grid.
    pub(super) fn with_gains(self, config: &CodeBookConfig) -> Result<Self, SettingError> {
        let mut book = self;
        if let Some(dbi) = config.outside_gain_dbi {
            if dbi.is_nan() || dbi > 100.0 {
                return Err(SettingError::new("outside_gain_dbi", dbi, "at most 100; -inf for none"));
            }
            book.outside_dbi = Some(dbi);
        } else if !book.azimuths.is_circle() {
            let Steps { first_deg, step_deg, .. } = book.azimuths;
            let found = format!(
                "absent, and the azimuths of the grid go from {first_deg} to {} in steps of {step_deg}",
                book.azimuths.last_deg()
            );
            return Err(SettingError::new(
                "outside_gain_dbi",
                found,
                "a gain in dBi, or a grid that goes all around",
            ));
        }
        if let Some(dbi) = config.boresight_gain_dbi {
            let shift = SettingError::in_range("boresight_gain_dbi", dbi, -100.0, 100.0)? - book.greatest_dbi();
            book.gains_dbi.iter_mut().for_each(|gain| *gain += shift);
        }
        Ok(book)
    }

    /// The code book of a scenario.
    pub(super) fn written(
        azimuths_deg: &[f64],
        elevations_deg: &[f64],
        sectors: &[SectorGainsConfig],
    ) -> Result<Self, SettingError> {
        let steps = |key, angles| {
            Steps::of(angles).map_err(|found| SettingError::new(key, found, "angles ascending in equal steps"))
        };
        let azimuths = steps("azimuths_deg", azimuths_deg)?;
        let elevations = steps("elevations_deg", elevations_deg)?;
        let mut rows: Vec<(u8, Vec<f64>)> = Vec::new();
        for (i, SectorGainsConfig { sector, gain_dbi }) in sectors.iter().enumerate() {
            let within = |error: SettingError| error.within(format!("sectors[{i}]"));
            if rows.iter().any(|(other, _)| other == sector) {
                return Err(within(SettingError::new("sector", sector, "an identity that no other sector has")));
            }
            if gain_dbi.len() != elevations.count || gain_dbi.iter().any(|row| row.len() != azimuths.count) {
                let lengths: Vec<_> = gain_dbi.iter().map(Vec::len).collect();
                let found = format!("{} lists of {lengths:?} gains", gain_dbi.len());
                let allowed =
                    format!("{} lists (elevations) of {} gains (azimuths)", elevations.count, azimuths.count);
                return Err(within(SettingError::new("gain_dbi", found, allowed)));
            }
            if let Some(bad) = gain_dbi.iter().flatten().find(|gain| !gain.is_finite()) {
                return Err(within(SettingError::new("gain_dbi", format!("a list with {bad}"), "finite numbers")));
            }
            rows.push((*sector, gain_dbi.concat()));
        }
        Self::new(azimuths, elevations, rows).map_err(|flaw| SettingError::new("sectors", flaw.found, flaw.allowed))
    }

    /// The code book of these sectors, each with its gains by elevation and azimuth, as many as the grid has.
    pub(super) fn new(azimuths: Steps, elevations: Steps, mut sectors: Vec<(u8, Vec<f64>)>) -> Result<Self, Flaw> {
        let flaw = |found: String, allowed: String| Err(Flaw { found, allowed });
        if sectors.is_empty() || sectors.len() > usize::from(SECTORS_OF_ANTENNA) {
            return flaw(format!("{} sectors", sectors.len()), format!("1 to {SECTORS_OF_ANTENNA} sectors"));
        }
        sectors.sort_by_key(|&(identity, _)| identity);
        if let Some((bad, _)) = sectors.iter().find(|(identity, _)| *identity >= SECTORS_OF_ANTENNA) {
            return flaw(format!("sector {bad}"), format!("sectors 0 to {}", SECTORS_OF_ANTENNA - 1));
        }
        if azimuths.last_deg() - azimuths.first_deg > 360.0 - 0.5 * azimuths.step_deg {
            let found = format!("azimuths from {} to {}", azimuths.first_deg, azimuths.last_deg());
            return flaw(found, "each direction once: less than a full circle from the first to the last".into());
        }
        if elevations.first_deg < -90.0 || elevations.last_deg() > 90.0 + 1e-9 {
            let found = format!("elevations from {} to {}", elevations.first_deg, elevations.last_deg());
            return flaw(found, "-90 to 90".into());
        }
        Ok(Self {
            azimuths,
            elevations,
            identities: sectors.iter().map(|&(identity, _)| identity).collect(),
            gains_dbi: sectors.into_iter().flat_map(|(_, gains)| gains).collect(),
            outside_dbi: None,
        })
    }

    #[expect(clippy::cast_possible_truncation, reason = "a code book has at most 64 sectors")]
    pub(super) fn sector_count(&self) -> u8 {
        self.identities.len() as u8
    }

    /// Identity on air of the sector with this number.
    pub(super) fn identity(&self, sector: u8) -> u8 {
        self.identities[usize::from(sector)]
    }

    pub(super) fn greatest_dbi(&self) -> f64 {
        self.gains_dbi.iter().copied().chain(self.outside_dbi).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Gain of a sector in the unit direction `d` (dBi).
    #[inline]
    pub(super) fn gain_dbi(&self, sector: u8, d: Position) -> f64 {
        let cell = self.azimuth(libm::atan2(d.y_m, d.x_m)).zip(self.elevation(libm::asin(d.z_m.clamp(-1.0, 1.0))));
        let Some(((left, right, along), (below, above, up))) = cell else {
            return self.outside_dbi.unwrap_or(f64::NEG_INFINITY);
        };
        let row = |elevation: usize| {
            let gains =
                &self.gains_dbi[(usize::from(sector) * self.elevations.count + elevation) * self.azimuths.count..];
            gains[left] + along * (gains[right] - gains[left])
        };
        let low = row(below);
        low + up * (row(above) - low)
    }

    /// Where an azimuth in [−π, π] falls; `None` outside the grid.
    #[inline]
    fn azimuth(&self, azimuth_rad: f64) -> Option<Between> {
        let Steps { first_deg, step_deg, count } = self.azimuths;
        let mut deg = azimuth_rad * (180.0 / PI) - first_deg;
        // The first azimuth of a grid is anywhere, so one turn forward or back may not be enough.
        while deg < -GRID_SLACK_DEG {
            deg += 360.0;
        }
        while deg >= 360.0 - GRID_SLACK_DEG {
            deg -= 360.0;
        }
        if !self.azimuths.is_circle() {
            return inside(deg, step_deg, count);
        }
        let steps = (deg.max(0.0) * (count as f64 / 360.0)).min(count as f64);
        let before = floor(steps).min(count - 1);
        Some((before, if before + 1 == count { 0 } else { before + 1 }, steps - before as f64))
    }

    /// Where an elevation falls; `None` outside the grid if there is a gain for that.
    #[inline]
    fn elevation(&self, elevation_rad: f64) -> Option<Between> {
        let Steps { first_deg, step_deg, count } = self.elevations;
        let deg = elevation_rad * (180.0 / PI) - first_deg;
        let deg = if self.outside_dbi.is_none() { deg.clamp(0.0, step_deg * (count - 1) as f64) } else { deg };
        inside(deg, step_deg, count)
    }

    /// The wedge of each sector: the smallest interval of azimuth and of elevation that has all directions of the grid
    /// where it is the best; if there are none, the direction of its own greatest gain. A step more on each side has
    /// the directions in between where it is still the best.
    pub(super) fn table(&self) -> SectorTable {
        let (columns, count) = (self.azimuths.count, self.azimuths.count * self.elevations.count);
        let sectors = self.identities.len();
        let best_of_cell: Vec<usize> = (0..count)
            .map(|cell| {
                let gain = |sector: usize| self.gains_dbi[sector * count + cell];
                (1..sectors).fold(0, |best, sector| if gain(sector) > gain(best) { sector } else { best })
            })
            .collect();
        let wedges = (0..self.sector_count()).map(|sector| {
            let index = usize::from(sector);
            let mut cells: Vec<usize> = (0..count).filter(|&cell| best_of_cell[cell] == index).collect();
            if cells.is_empty() {
                let gains = &self.gains_dbi[index * count..(index + 1) * count];
                let peak = (1..count).fold(0, |peak, cell| if gains[cell] > gains[peak] { cell } else { peak });
                cells.push(peak);
            }
            let mut of_column = vec![false; columns];
            cells.iter().for_each(|cell| of_column[cell % columns] = true);
            let (first, last) = self.arc(&of_column);
            let rows = || cells.iter().map(|cell| cell / columns);
            let elevation = self.elevations_of(rows().min().unwrap_or(0), rows().max().unwrap_or(0));
            SectorConfig {
                sector,
                azimuth_from_deg: first,
                azimuth_to_deg: last,
                elevation_from_deg: elevation[0],
                elevation_to_deg: elevation[1],
            }
        });
        SectorTable::new(wedges).expect("intervals of a grid are ascending, and each sector has one")
    }

    /// The smallest arc of azimuth that has all marked columns (degrees).
    fn arc(&self, marked: &[bool]) -> (f64, f64) {
        let Steps { first_deg, step_deg, count } = self.azimuths;
        let step_deg = if count == 1 { LONE_ANGLE_DEG } else { step_deg };
        let columns: Vec<usize> = (0..count).filter(|&column| marked[column]).collect();
        // The widest gap between neighbouring columns, around the circle.
        let turn = 360.0 / step_deg;
        let gap = |i: usize| match columns.get(i + 1) {
            Some(&next) => (next - columns[i]) as f64,
            None => columns[0] as f64 + turn - columns[i] as f64,
        };
        let widest =
            (0..columns.len()).fold(columns.len() - 1, |best, i| if gap(i) > gap(best) + 1e-6 { i } else { best });
        let first = columns[(widest + 1) % columns.len()];
        let pad_deg = if count == 1 { LONE_ANGLE_DEG / 2.0 } else { step_deg };
        let from = first_deg + first as f64 * step_deg - pad_deg;
        let width = 360.0 - gap(widest) * step_deg + 2.0 * pad_deg;
        (from, from + width.min(360.0))
    }

    /// The elevations of these rows of the grid (degrees). Without a gain outside, the outermost rows reach straight up
    /// and down.
    fn elevations_of(&self, lowest: usize, highest: usize) -> [f64; 2] {
        let Steps { first_deg, step_deg, count } = self.elevations;
        let holds = self.outside_dbi.is_none();
        let pad_deg = if count == 1 { LONE_ANGLE_DEG / 2.0 } else { step_deg };
        let low = if holds && lowest == 0 { -90.0 } else { first_deg + step_deg * lowest as f64 - pad_deg };
        let high = if holds && highest + 1 == count { 90.0 } else { first_deg + step_deg * highest as f64 + pad_deg };
        [low.max(-90.0), high.min(90.0)]
    }
}

/// Width for which a single measured angle stands (degrees).
const LONE_ANGLE_DEG: f64 = 1.0;
/// How far outside the grid a direction still counts as on its border (degrees): rounding of angles.
const GRID_SLACK_DEG: f64 = 1e-9;

/// Where an angle above the first one falls on steps that do not wrap.
#[inline]
fn inside(deg: f64, step_deg: f64, count: usize) -> Option<Between> {
    if count == 1 {
        return (deg.abs() <= GRID_SLACK_DEG.max(LONE_ANGLE_DEG / 2.0)).then_some((0, 0, 0.0));
    }
    let last = (count - 1) as f64;
    let steps = deg / step_deg;
    if steps < -GRID_SLACK_DEG / step_deg || steps > last + GRID_SLACK_DEG / step_deg {
        return None;
    }
    let steps = steps.clamp(0.0, last);
    let before = floor(steps).min(count - 2);
    Some((before, before + 1, steps - before as f64))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "steps are small and not negative")]
#[inline]
fn floor(steps: f64) -> usize {
    steps as usize
}

/// What is wrong with a code book.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Flaw {
    pub(super) found: String,
    pub(super) allowed: String,
}
