//! What was measured: the gains of each sector on a grid of directions, with gaps.

use super::steps::Steps;
use super::{Flaw, SECTORS_OF_ANTENNA};

/// The word for the quasi-omnidirectional pattern in place of a sector.
pub(super) const QUASI_OMNI: &str = "quasi_omni";

/// Measured gains in decibels on a grid of directions; not a number where there is a gap.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) azimuths: Steps,
    pub(super) elevations: Steps,
    /// By identity: the gains by elevation, then azimuth.
    pub(super) sectors: Vec<(u8, Vec<f64>)>,
    /// The gains of the quasi-omnidirectional pattern, if it was measured.
    pub(super) quasi_omni: Option<Vec<f64>>,
}

/// One measured pattern.
pub(super) struct MeasuredPattern<'a> {
    /// Identity of the sector; `None` for the quasi-omnidirectional pattern.
    pub(super) sector: Option<u8>,
    pub(super) gains: &'a [f64],
}

impl MeasuredPattern<'_> {
    /// Its name: `sector 5`, or `quasi_omni`.
    pub(super) fn name(&self) -> String {
        self.sector.map_or_else(|| QUASI_OMNI.to_owned(), |sector| format!("sector {sector}"))
    }
}

impl Measured {
    /// All patterns: the sectors, then the quasi-omnidirectional one.
    pub(super) fn patterns(&self) -> impl Iterator<Item = MeasuredPattern<'_>> {
        let sectors = self.sectors.iter().map(|(sector, gains)| MeasuredPattern { sector: Some(*sector), gains });
        sectors.chain(self.quasi_omni.iter().map(|gains| MeasuredPattern { sector: None, gains }))
    }

    /// The same, with the sectors in ascending order.
    ///
    /// # Errors
    /// If there are no sectors or too many, or the grid is none of directions.
    pub(super) fn checked(mut self) -> Result<Self, Flaw> {
        let flaw = |found: String, allowed: String| Err(Flaw { found, allowed });
        if self.sectors.is_empty() || self.sectors.len() > usize::from(SECTORS_OF_ANTENNA) {
            let found = format!("{} sectors", self.sectors.len());
            return flaw(found, format!("1 to {SECTORS_OF_ANTENNA} sectors"));
        }
        self.sectors.sort_by_key(|&(identity, _)| identity);
        if let Some((bad, _)) = self.sectors.iter().find(|(identity, _)| *identity >= SECTORS_OF_ANTENNA) {
            return flaw(format!("sector {bad}"), format!("sectors 0 to {}", SECTORS_OF_ANTENNA - 1));
        }
        let Self { azimuths, elevations, .. } = &self;
        if azimuths.count == 1 {
            return flaw(format!("one azimuth, {}", azimuths.first_deg), "two or more azimuths".into());
        }
        if azimuths.is_turn_of_radians() {
            let found = format!(
                "azimuths from {} to {}, which is once around in radians",
                azimuths.first_deg,
                azimuths.last_deg()
            );
            return flaw(found, "degrees".into());
        }
        if azimuths.last_deg() - azimuths.first_deg > 360.0 - 0.5 * azimuths.step_deg {
            let found = format!("azimuths from {} to {}", azimuths.first_deg, azimuths.last_deg());
            return flaw(found, "each direction once: less than a full circle from the first to the last".into());
        }
        if elevations.first_deg < -90.0 || elevations.last_deg() > 90.0 + 1e-9 {
            let found = format!("elevations from {} to {}", elevations.first_deg, elevations.last_deg());
            return flaw(found, "-90 to 90".into());
        }
        Ok(self)
    }

    /// The gains of all patterns, one after the other.
    pub(super) fn all_gains(&self) -> impl Iterator<Item = f64> + Clone {
        let sectors = self.sectors.iter().flat_map(|(_, gains)| gains);
        sectors.chain(self.quasi_omni.iter().flatten()).copied()
    }

    /// The gains of all patterns.
    pub(super) fn gains_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.sectors.iter_mut().map(|(_, gains)| gains).chain(&mut self.quasi_omni)
    }
}
