//! Code books: measured gains of the sectors of a real antenna.

mod gaps;
mod inline;
mod measured;
mod rows;
mod steps;
mod unit;
mod wedges;

use std::f64::consts::PI;
use std::path::PathBuf;

use sextant_kernel::{Files, SettingError};

use super::SECTORS_OF_ANTENNA;
use crate::geometry::position::Position;
pub use gaps::Gaps;
use measured::Measured;
use steps::{Steps, floor};
pub use unit::look_like_factors;

/// Measured sectors, as written in a scenario: either a file, or the grid and the gains.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CodeBookConfig {
    /// A CSV file with the columns `sector`, `azimuth_deg`, `elevation_deg` and `gain_dbi`, in any order: a row for
    /// each sector and direction of a regular grid. Identities of sectors are 0 to 63 and may have gaps; the rows of
    /// `quasi_omni` are the pattern with which the antenna listens. A column `gain_linear` has factors instead, and a
    /// column `gain_db` decibels in relative units, which need `boresight_gain_dbi`.
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
    /// Gains of the pattern with which the antenna listens (dBi): a list for each elevation, with a value for each
    /// azimuth. If absent, it is the same in all directions.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub quasi_omni_dbi: Option<Vec<Vec<f64>>>,
    /// What becomes of directions of the grid that the file has no gain for.
    #[cfg_attr(feature = "config", serde(default))]
    pub gaps: Gaps,
    /// Width in elevation within which a planar cut holds, centred on the cut (degrees): the half-power width of the
    /// beams in elevation, above 0, at most 180. Beyond it `outside_gain_dbi` holds. If absent, the cut holds at all
    /// elevations. Only for a grid with one elevation.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub vertical_width_deg: Option<f64>,
    /// Gain in directions outside the grid (dBi). If absent, the grid must go all around in azimuth, and the gains at
    /// the lowest and highest elevation hold below and above. Those of a planar cut hold at all elevations, unless
    /// `vertical_width_deg` is given.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub outside_gain_dbi: Option<f64>,
    /// Greatest gain of any sector (dBi). If absent, that of the measurement. All measured gains change by the same
    /// decibels: for measurements in relative units. `outside_gain_dbi` stays as it is.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub boresight_gain_dbi: Option<f64>,
    /// Gain of the quasi-omnidirectional pattern in all directions (dBi), 0 if absent; if the pattern was measured (rows of
    /// `quasi_omni` in the file, or `quasi_omni_dbi`), its greatest gain, that of the measurement if absent.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub quasi_omni_gain_dbi: Option<f64>,
    /// Standard deviation of the gain over the sectors and stations (dB), beside what was measured.
    #[cfg_attr(feature = "config", serde(default))]
    pub gain_ripple_db: f64,
}

/// Measured gains of one sector, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SectorGainsConfig {
    /// Identity of the sector on air, 0 to 63.
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 63)))]
    pub sector: u8,
    /// Gains (dBi): a list for each elevation, with a value for each azimuth.
    pub gain_dbi: Vec<Vec<f64>>,
}

/// Measured gains on a regular grid, interpolated linearly in decibels.
#[derive(Clone, Debug)]
pub(super) struct CodeBook {
    azimuths: Steps,
    elevations: Steps,
    identities: Vec<u8>,
    /// By sector, elevation, azimuth.
    gains_dbi: Vec<f64>,
    /// By elevation, azimuth, if the quasi-omnidirectional pattern was measured.
    quasi_omni_dbi: Option<Vec<f64>>,
    outside_dbi: Option<f64>,
    /// How far above and below a planar cut holds (degrees).
    cut_half_deg: f64,
}

/// Where a direction falls on the steps of an angle: the steps before and after it, and the share of the second.
type Between = (usize, usize, f64);

/// The gain in directions outside the grid where none is allowed.
const NOTHING_DBI: f64 = f64::NEG_INFINITY;

impl CodeBook {
    /// The code book that `config` describes; a file path is among `files`.
    ///
    /// # Errors
    /// If a value is invalid, or the file cannot be read or has a flaw.
    pub(super) fn read(config: &CodeBookConfig, files: &Files) -> Result<Self, SettingError> {
        let (measured, needs_boresight) =
            match (&config.file, &config.azimuths_deg, &config.elevations_deg, &config.sectors) {
                (Some(file), None, None, None) if config.quasi_omni_dbi.is_none() => {
                    rows::read(file, config.gaps, files)?
                }
                (Some(_), ..) => {
                    let with = "`azimuths_deg`, `elevations_deg`, `sectors` or `quasi_omni_dbi`";
                    return Err(SettingError::conflict("file", with, "set either the file or the grid"));
                }
                (None, Some(azimuths), Some(elevations), Some(sectors)) => {
                    (inline::read(azimuths, elevations, sectors, config)?, false)
                }
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
        if needs_boresight && config.boresight_gain_dbi.is_none() {
            let needed = "the greatest gain in dBi, because the column `gain_db` has relative units";
            return Err(SettingError::missing("boresight_gain_dbi", needed));
        }
        let Measured { azimuths, elevations, sectors, quasi_omni } = measured;
        let identities = sectors.iter().map(|&(identity, _)| identity).collect();
        let gains_dbi = sectors.into_iter().flat_map(|(_, gains)| gains).collect();
        let (outside_dbi, cut_half_deg) = (outside(config, &azimuths)?, cut_half_deg(config, &elevations)?);
        let book = Self {
            azimuths,
            elevations,
            identities,
            gains_dbi,
            quasi_omni_dbi: quasi_omni,
            outside_dbi,
            cut_half_deg,
        };
        book.with_levels(config)
    }

    /// The same with the greatest gains that `config` gives.
    fn with_levels(self, config: &CodeBookConfig) -> Result<Self, SettingError> {
        let mut book = self;
        if let Some(dbi) = config.boresight_gain_dbi {
            let dbi = SettingError::in_range("boresight_gain_dbi", dbi, -100.0, 100.0)?;
            let shift = dbi - greatest(&book.gains_dbi);
            let patterns = book.gains_dbi.iter_mut().chain(book.quasi_omni_dbi.iter_mut().flatten());
            patterns.for_each(|gain| *gain += shift);
        }
        if let (Some(dbi), Some(gains)) = (config.quasi_omni_gain_dbi, &mut book.quasi_omni_dbi) {
            let shift = dbi - greatest(gains);
            gains.iter_mut().for_each(|gain| *gain += shift);
        }
        Ok(book)
    }

    #[expect(clippy::cast_possible_truncation, reason = "a code book has at most 64 sectors")]
    pub(super) fn sector_count(&self) -> u8 {
        self.identities.len() as u8
    }

    /// Identity on air of the sector with this number.
    pub(super) fn identity(&self, sector: u8) -> u8 {
        self.identities[usize::from(sector)]
    }

    /// Greatest gain of any sector in any direction (dBi).
    pub(super) fn greatest_dbi(&self) -> f64 {
        greatest(&self.gains_dbi).max(self.outside_dbi.unwrap_or(NOTHING_DBI))
    }

    /// Whether the quasi-omnidirectional pattern was measured.
    #[inline]
    pub(super) fn has_quasi_omni(&self) -> bool {
        self.quasi_omni_dbi.is_some()
    }

    /// Greatest measured gain of the quasi-omnidirectional pattern (dBi); `None` if it was not measured.
    pub(super) fn greatest_quasi_omni_dbi(&self) -> Option<f64> {
        let measured = greatest(self.quasi_omni_dbi.as_ref()?);
        Some(measured.max(self.outside_dbi.unwrap_or(NOTHING_DBI)))
    }

    /// Elevation of the only cut (degrees) if it holds at all elevations because no width is given.
    pub(super) fn endless_cut_deg(&self) -> Option<f64> {
        (self.elevations.count == 1 && self.cut_half_deg.is_infinite()).then_some(self.elevations.first_deg)
    }

    /// Gain of a sector in the unit direction `d` (dBi).
    #[inline]
    pub(super) fn gain_dbi(&self, sector: u8, d: Position) -> f64 {
        let count = self.azimuths.count * self.elevations.count;
        self.between(&self.gains_dbi[usize::from(sector) * count..], d)
    }

    /// Measured gain of the quasi-omnidirectional pattern in the unit direction `d` (dBi); `None` if it was not measured.
    #[inline]
    pub(super) fn quasi_omni_dbi(&self, d: Position) -> Option<f64> {
        Some(self.between(self.quasi_omni_dbi.as_ref()?, d))
    }

    /// The gain between the places of the grid, of a pattern whose gains come first.
    #[inline]
    fn between(&self, gains_dbi: &[f64], d: Position) -> f64 {
        let cell = self.azimuth(libm::atan2(d.y_m, d.x_m)).zip(self.elevation(libm::asin(d.z_m.clamp(-1.0, 1.0))));
        let Some(((left, right, along), (below, above, up))) = cell else {
            return self.outside_dbi.unwrap_or(NOTHING_DBI);
        };
        let row = |elevation: usize| {
            let gains = &gains_dbi[elevation * self.azimuths.count..];
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

    /// Where an elevation falls; `None` outside the grid if there is a gain for that, and beyond the width of a planar
    /// cut.
    #[inline]
    fn elevation(&self, elevation_rad: f64) -> Option<Between> {
        let Steps { first_deg, step_deg, count } = self.elevations;
        let deg = elevation_rad * (180.0 / PI) - first_deg;
        if count == 1 {
            return (deg.abs() <= self.cut_half_deg + GRID_SLACK_DEG).then_some((0, 0, 0.0));
        }
        let deg = if self.outside_dbi.is_none() { deg.clamp(0.0, step_deg * (count - 1) as f64) } else { deg };
        inside(deg, step_deg, count)
    }
}

/// The gain outside the grid, checked.
fn outside(config: &CodeBookConfig, azimuths: &Steps) -> Result<Option<f64>, SettingError> {
    match config.outside_gain_dbi {
        Some(dbi) if dbi.is_nan() || dbi > 100.0 => {
            Err(SettingError::new("outside_gain_dbi", dbi, "at most 100; -inf for none"))
        }
        Some(dbi) => Ok(Some(dbi)),
        None if azimuths.is_circle() => Ok(None),
        None => {
            let found = format!("absent, and the azimuths of the grid go from {}", azimuths.text());
            Err(SettingError::new("outside_gain_dbi", found, "a gain in dBi, or a grid that goes all around"))
        }
    }
}

/// A planar cut holds at least so far (degrees): less is lost in the digits of its elevation.
const LEAST_CUT_DEG: f64 = 1e-6;

/// How far above and below a planar cut holds (degrees), checked: infinite if nothing is said.
fn cut_half_deg(config: &CodeBookConfig, elevations: &Steps) -> Result<f64, SettingError> {
    let Some(deg) = config.vertical_width_deg else { return Ok(f64::INFINITY) };
    if elevations.count > 1 {
        let with = format!("a grid of {} elevations", elevations.count);
        return Err(SettingError::conflict("vertical_width_deg", &with, "remove it, because it is for a planar cut"));
    }
    SettingError::in_range("vertical_width_deg", deg, LEAST_CUT_DEG, 180.0)?;
    if config.outside_gain_dbi.is_none() {
        let needed = "the gain in dBi beyond `vertical_width_deg`";
        return Err(SettingError::missing("outside_gain_dbi", needed));
    }
    Ok(deg / 2.0)
}

fn greatest(gains_dbi: &[f64]) -> f64 {
    gains_dbi.iter().copied().fold(NOTHING_DBI, f64::max)
}

/// How far outside the grid a direction still counts as on its border (degrees): rounding of angles.
const GRID_SLACK_DEG: f64 = 1e-9;

/// Where an angle above the first one falls on steps that do not wrap.
#[inline]
fn inside(deg: f64, step_deg: f64, count: usize) -> Option<Between> {
    let last = (count - 1) as f64;
    let steps = deg / step_deg;
    if steps < -GRID_SLACK_DEG / step_deg || steps > last + GRID_SLACK_DEG / step_deg {
        return None;
    }
    let steps = steps.clamp(0.0, last);
    let before = floor(steps).min(count - 2);
    Some((before, before + 1, steps - before as f64))
}

/// What is wrong with a code book.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Flaw {
    pub(super) found: String,
    pub(super) allowed: String,
}
