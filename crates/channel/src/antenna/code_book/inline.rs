//! Code books whose grid and gains stand in the settings themselves.

use sextant_kernel::SettingError;

use super::measured::Measured;
use super::steps::Steps;
use super::{CodeBook, CodeBookConfig, Flaw, Gaps, SectorGainsConfig, greatest, unit};

/// Angles of a grid are written with so many parts of a degree, so that the steps of what is read back are the same.
const PARTS_OF_DEGREE: f64 = 1e9;

/// The measurement that `config` has: these azimuths, elevations and sectors.
///
/// # Errors
/// If the angles are not in steps, or gains are missing, not finite or look like factors.
pub(super) fn read(
    azimuths_deg: &[f64],
    elevations_deg: &[f64],
    sectors: &[SectorGainsConfig],
    config: &CodeBookConfig,
) -> Result<Measured, SettingError> {
    let steps = |key, angles| {
        Steps::of(angles).map_err(|found| SettingError::new(key, found, "angles ascending in equal steps"))
    };
    let azimuths = steps("azimuths_deg", azimuths_deg)?;
    let elevations = steps("elevations_deg", elevations_deg)?;
    let of_grid = |key: &str, gains: &[Vec<f64>]| {
        if gains.len() != elevations.count || gains.iter().any(|row| row.len() != azimuths.count) {
            let lengths: Vec<_> = gains.iter().map(Vec::len).collect();
            let found = format!("{} lists of {lengths:?} gains", gains.len());
            let allowed = format!("{} lists (elevations) of {} gains (azimuths)", elevations.count, azimuths.count);
            return Err(SettingError::new(key, found, allowed));
        }
        match gains.iter().flatten().find(|gain| !gain.is_finite()) {
            Some(bad) => Err(SettingError::new(key, format!("a list with {bad}"), "finite numbers")),
            None => Ok(gains.concat()),
        }
    };
    let mut rows: Vec<(u8, Vec<f64>)> = Vec::new();
    for (i, SectorGainsConfig { sector, gain_dbi }) in sectors.iter().enumerate() {
        let within = |error: SettingError| error.within(format!("sectors[{i}]"));
        if rows.iter().any(|(other, _)| other == sector) {
            return Err(within(SettingError::new("sector", sector, "an identity that no other sector has")));
        }
        rows.push((*sector, of_grid("gain_dbi", gain_dbi).map_err(within)?));
    }
    let quasi_omni = config.quasi_omni_dbi.as_deref().map(|gains| of_grid("quasi_omni_dbi", gains)).transpose()?;
    let measured = Measured { azimuths, elevations, sectors: rows, quasi_omni };
    let flawed = |Flaw { found, allowed }: Flaw| SettingError::new("sectors", found, allowed);
    // With a greatest gain beside them, the gains are decibels in any units.
    if config.boresight_gain_dbi.is_none() {
        unit::suspect_factors(measured.all_gains()).map_err(flawed)?;
    }
    measured.checked().map_err(flawed)
}

impl CodeBook {
    /// The settings of a code book with the same gains, without a file.
    pub(in crate::antenna) fn config(&self) -> CodeBookConfig {
        let angles = |steps: &Steps| {
            let rounded = |step| (steps.angle_deg(step) * PARTS_OF_DEGREE).round() / PARTS_OF_DEGREE;
            (0..steps.count).map(rounded).collect()
        };
        let columns = self.azimuths.count;
        let of_grid = |gains: &[f64]| gains.chunks_exact(columns).map(<[f64]>::to_vec).collect();
        let of_sectors = self.gains_dbi.chunks_exact(columns * self.elevations.count);
        let sectors = self.identities.iter().zip(of_sectors);
        CodeBookConfig {
            file: None,
            azimuths_deg: Some(angles(&self.azimuths)),
            elevations_deg: Some(angles(&self.elevations)),
            sectors: Some(
                sectors.map(|(&sector, gains)| SectorGainsConfig { sector, gain_dbi: of_grid(gains) }).collect(),
            ),
            quasi_omni_dbi: self.quasi_omni_dbi.as_deref().map(of_grid),
            gaps: Gaps::Refuse,
            vertical_width_deg: self.cut_half_deg.is_finite().then_some(2.0 * self.cut_half_deg),
            outside_gain_dbi: self.outside_dbi,
            boresight_gain_dbi: Some(greatest(&self.gains_dbi)).filter(|dbi| dbi.abs() <= 100.0),
            quasi_omni_gain_dbi: None,
            gain_ripple_db: 0.0,
        }
    }
}
