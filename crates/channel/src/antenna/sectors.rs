//! Antennas with equal sectors in rings.

use sextant_kernel::SettingError;

use super::pattern::{Aim, Beam, Ieee802153cConfig, Pattern, SectorEdge};
use super::{MOST_SECTORS, PatternConfig, SECTORS_OF_ANTENNA, SECTORS_OF_STATION};
use crate::antenna::sector::{EvenSectorsConfig, SectorDirections};

/// An antenna with sectors of equal width in azimuth, in one or more rings, as written in a scenario. Sector `i` of
/// ring `j` is number `j · azimuth_sectors + i`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AntennaSectorsConfig {
    /// Number of sectors in a ring, 1 to 64.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 64)))]
    pub azimuth_sectors: u8,
    /// Azimuth of the boresight of sector 0 in the frame of the antenna (degrees). The other sectors follow
    /// counterclockwise.
    #[cfg_attr(feature = "config", serde(default))]
    pub first_azimuth_deg: f64,
    /// Elevation of the boresights of each ring (degrees), ascending; one horizontal ring if absent.
    #[cfg_attr(feature = "config", serde(default = "one_ring"))]
    pub elevations_deg: Vec<f64>,
    /// Whether all rings are swept at once, or one after the other.
    #[cfg_attr(feature = "config", serde(default))]
    pub vertical: Vertical,
    /// Half-power width of a beam in azimuth (degrees), at most 180; if absent, the width of a sector.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub beam_width_deg: Option<f64>,
    /// Width of a beam in elevation (degrees), of patterns that need one; that in azimuth if absent.
    /// It also limits the elevations for which a ring stands on a map. If absent, rings meet half way between their
    /// boresights, and the outermost reach straight up and down.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub vertical_width_deg: Option<f64>,
    /// Radiation pattern of a sector.
    #[cfg_attr(feature = "config", serde(default))]
    pub pattern: PatternConfig,
    /// Gain at the boresight of each sector (dBi). If absent, that of the pattern. The shape stays: all gains of the
    /// pattern change by the same decibels.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub boresight_gain_dbi: Option<f64>,
    /// Gain of the quasi-omnidirectional pattern in all directions (dBi).
    #[cfg_attr(feature = "config", serde(default))]
    pub quasi_omni_gain_dbi: f64,
    /// Standard deviation of the gain over the sectors (dB): real arrays are not equally good in all directions.
    #[cfg_attr(feature = "config", serde(default))]
    pub gain_ripple_db: f64,
}

#[cfg(feature = "config")]
fn one_ring() -> Vec<f64> {
    vec![0.0]
}

/// How an antenna covers several rings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Vertical {
    /// Each ring is a separate antenna (vertical antenna array); one sweep covers all, at most 128 sectors.
    #[default]
    Array,
    /// One antenna is tilted to one ring after the other (vertical beam steering), with a sweep for each.
    Steered,
}

/// The beams of an antenna with equal sectors.
#[derive(Clone, Debug)]
pub(super) struct Sectors {
    pub(super) pattern: Pattern,
    pub(super) beams: Vec<Beam>,
    pub(super) per_ring: u8,
    pub(super) rings: u8,
    pub(super) vertical: Vertical,
    directions: EvenSectorsConfig,
    /// What it was made of.
    pub(super) config: AntennaSectorsConfig,
}

impl TryFrom<&AntennaSectorsConfig> for Sectors {
    type Error = SettingError;

    fn try_from(config: &AntennaSectorsConfig) -> Result<Self, SettingError> {
        let per_ring = config.azimuth_sectors;
        if !(1..=SECTORS_OF_ANTENNA).contains(&per_ring) {
            return Err(SettingError::new("azimuth_sectors", per_ring, format!("1 to {SECTORS_OF_ANTENNA}")));
        }
        SettingError::finite("first_azimuth_deg", config.first_azimuth_deg)?;
        let rings = rings(config)?;
        let width_deg = beam_width_deg(config)?;
        let vertical_width_deg = match config.vertical_width_deg {
            Some(deg) if deg > 0.0 && deg <= 180.0 => Some(deg),
            Some(deg) => return Err(SettingError::new("vertical_width_deg", deg, "above 0, at most 180")),
            None => None,
        };
        let aims = config.elevations_deg.iter().flat_map(|elevation_deg| {
            (0..per_ring).map(move |i| Aim {
                azimuth_rad: (config.first_azimuth_deg + 360.0 * f64::from(i) / f64::from(per_ring)).to_radians(),
                elevation_rad: elevation_deg.to_radians(),
                width_rad: width_deg.to_radians(),
                vertical_width_rad: vertical_width_deg.map(f64::to_radians),
            })
        });
        let within = |error: SettingError| error.within("pattern");
        let built = aims.map(|aim| config.pattern.build(aim)).collect::<Result<Vec<_>, _>>().map_err(within)?;
        let pattern = built[0].0;
        let peak = match config.boresight_gain_dbi {
            Some(dbi) => Some(SettingError::in_range("boresight_gain_dbi", dbi, -100.0, 100.0)?),
            None => None,
        };
        let beams = built.into_iter().map(|(_, beam)| peak.map_or(beam, |dbi| beam.with_peak(dbi))).collect();
        let directions = EvenSectorsConfig {
            azimuth_sectors: per_ring,
            first_azimuth_deg: config.first_azimuth_deg,
            elevations_deg: elevation_intervals(&config.elevations_deg, vertical_width_deg),
        };
        Ok(Self { pattern, beams, per_ring, rings, vertical: config.vertical, directions, config: config.clone() })
    }
}

impl Sectors {
    /// The directions of each sector.
    pub(super) fn table(&self) -> Result<SectorDirections, SettingError> {
        SectorDirections::try_from(self.directions.clone())
    }
}

/// The number of rings, checked.
fn rings(config: &AntennaSectorsConfig) -> Result<u8, SettingError> {
    let elevations = &config.elevations_deg;
    let per_ring = config.azimuth_sectors;
    let most = match config.vertical {
        Vertical::Array => SECTORS_OF_STATION / per_ring,
        Vertical::Steered => MOST_SECTORS / per_ring,
    };
    let rings = u8::try_from(elevations.len()).unwrap_or(u8::MAX);
    if rings == 0 || rings > most {
        let allowed = match config.vertical {
            Vertical::Array => format!("1 to {most} rings of {per_ring} sectors, {SECTORS_OF_STATION} in all"),
            Vertical::Steered => format!("1 to {most} rings of {per_ring} sectors, {MOST_SECTORS} in all"),
        };
        return Err(SettingError::new("elevations_deg", format!("{} rings", elevations.len()), allowed));
    }
    let valid = elevations.iter().all(|deg| (-90.0..=90.0).contains(deg));
    if !valid || !elevations.is_sorted_by(|low, high| low < high) {
        return Err(SettingError::new("elevations_deg", format!("{elevations:?}"), "-90 to 90, ascending"));
    }
    Ok(rings)
}

/// Half-power width of the beams in azimuth (degrees), checked.
fn beam_width_deg(config: &AntennaSectorsConfig) -> Result<f64, SettingError> {
    let Some(deg) = config.beam_width_deg else {
        return Ok((360.0 / f64::from(config.azimuth_sectors)).min(180.0));
    };
    if matches!(
        config.pattern,
        PatternConfig::Ieee802153c(Ieee802153cConfig { sector_edge: SectorEdge::MainLobe, .. })
    ) {
        let with = "`pattern.ieee802153c.sector_edge = \"main_lobe\"`";
        return Err(SettingError::conflict("beam_width_deg", with, "set one of them"));
    }
    if deg > 0.0 && deg <= 180.0 {
        Ok(deg)
    } else {
        Err(SettingError::new("beam_width_deg", deg, "above 0, at most 180"))
    }
}

/// The elevations that each ring covers (degrees).
fn elevation_intervals(centers: &[f64], width_deg: Option<f64>) -> Vec<[f64; 2]> {
    let interval = |j: usize| {
        let center = centers[j];
        if let Some(width) = width_deg {
            return [(center - width / 2.0).max(-90.0), (center + width / 2.0).min(90.0)];
        }
        let low = if j == 0 { -90.0 } else { f64::midpoint(centers[j - 1], center) };
        let high = centers.get(j + 1).map_or(90.0, |&next| f64::midpoint(center, next));
        [low, high]
    };
    (0..centers.len()).map(interval).collect()
}
