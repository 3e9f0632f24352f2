//! The direction of a neighbour in the frame of an antenna, from the strengths of all sectors that were heard.

use std::f64::consts::TAU;

use sextant_channel::{Antenna, Position};

use crate::grid_ml::directions::wrapped;
use crate::pattern::of_report;

/// Directions are tried in steps of half a degree.
const STEPS: u16 = 720;
/// The strengths of fewer sectors tell no more than the best one does.
const LEAST_SECTORS: usize = 2;
/// A direction that is uniform in a sector has a standard deviation of its width over √12. One that is not surer than this
/// share of it tells no more than the sector.
const SURER: f64 = 0.75;

/// The direction of a neighbour in the frame of an antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectorBearing {
    /// Azimuth from the middle of sector 0, counterclockwise (rad), in (−π, π].
    pub azimuth_rad: f64,
    /// Its standard deviation (rad).
    pub sigma_rad: f64,
}

/// The gains of an antenna with rings of equal sectors over the azimuth, by which strengths tell a direction.
#[derive(Clone, Debug, PartialEq)]
pub struct BearingTable {
    /// Sectors in a ring.
    per_ring: u8,
    /// Gains of all sectors (dBi), each at the middle of its elevations, by azimuth.
    gains_dbi: Vec<Vec<f64>>,
    /// Standard deviation of a strength (dB).
    error_db: f64,
}

impl BearingTable {
    /// That of `antenna`, with rings of `per_ring` equal sectors, of which strengths have the standard deviation `error_db`:
    /// what the sectors of one antenna differ by from the pattern, and noise.
    #[must_use]
    pub fn new(antenna: &Antenna, per_ring: u8, error_db: f64) -> Self {
        let middle = |[from_deg, to_deg]: [f64; 2]| 0.5 * (from_deg + to_deg).to_radians();
        let sectors = || antenna.sectors().iter();
        let elevations: Vec<f64> =
            sectors().map(|sector| middle([sector.elevation_from_deg, sector.elevation_to_deg])).collect();
        let of_first = sectors().next().map_or(0.0, |first| middle([first.azimuth_from_deg, first.azimuth_to_deg]));
        let gains_at = |azimuth_rad: f64| {
            let azimuth_rad = of_first + azimuth_rad;
            let gain = |(number, &elevation_rad): (u8, &f64)| {
                let (level, up) = (libm::cos(elevation_rad), libm::sin(elevation_rad));
                let direction = Position::new(level * libm::cos(azimuth_rad), level * libm::sin(azimuth_rad), up);
                antenna.gain(number, direction).0
            };
            (0..).zip(&elevations).map(gain).collect()
        };
        Self { per_ring: per_ring.max(1), gains_dbi: azimuths().map(gains_at).collect(), error_db }
    }

    /// The direction from which the sectors were heard with these strengths (dB, above any level); only those of the ring of the
    /// strongest count. `None` if they tell no more than the strongest sector alone.
    #[must_use]
    pub fn bearing(&self, strengths: &[(u8, f64)]) -> Option<SectorBearing> {
        let strongest = strengths.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let ring = |sector: u8| sector / self.per_ring;
        let heard: Vec<(usize, f64)> = strengths
            .iter()
            .filter(|(sector, _)| ring(*sector) == ring(strongest.0))
            .map(|&(sector, strength_db)| (usize::from(sector), strength_db))
            .collect();
        let is_known = heard.iter().all(|&(sector, _)| sector < self.gains_dbi[0].len());
        if heard.len() < LEAST_SECTORS || !is_known {
            return None;
        }
        // Side lobes of two sectors may be as equal as their main lobes, but are not the strongest.
        let width = TAU / f64::from(self.per_ring);
        let aimed = width * f64::from(strongest.0 % self.per_ring);
        let is_near = |azimuth: f64| wrapped(azimuth - aimed).abs() <= width;
        let value = |(azimuth, gains): (f64, &Vec<f64>)| {
            is_near(azimuth).then(|| (azimuth, of_report(&heard, |sector| gains[sector], self.error_db)))
        };
        let values: Vec<(f64, f64)> = azimuths().zip(&self.gains_dbi).filter_map(value).collect();
        let highest = values.iter().map(|value| value.1).fold(f64::NEG_INFINITY, f64::max);
        let weighed = || values.iter().map(|&(azimuth, value)| (azimuth, libm::exp(value - highest)));
        let [x, y] = weighed().fold([0.0, 0.0], |[x, y], (azimuth, weight)| {
            [x + weight * libm::cos(azimuth), y + weight * libm::sin(azimuth)]
        });
        let middle = libm::atan2(y, x);
        let (total, square) = weighed().fold((0.0, 0.0), |(total, square), (azimuth, weight)| {
            let off = wrapped(azimuth - middle);
            (total + weight, square + weight * off * off)
        });
        let step = TAU / f64::from(STEPS);
        let sigma_rad = (square / total + step * step / 12.0).sqrt();
        (sigma_rad <= SURER * width / 12.0_f64.sqrt()).then_some(SectorBearing { azimuth_rad: middle, sigma_rad })
    }
}

/// The azimuths that are tried (rad).
fn azimuths() -> impl Iterator<Item = f64> {
    (0..STEPS).map(|step| TAU * f64::from(step) / f64::from(STEPS))
}

#[cfg(test)]
mod tests {
    use sextant_channel::{AntennaConfig, AntennaSectorsConfig, FlatTopConfig, PatternConfig, Vertical};
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    fn table(pattern: PatternConfig, error_db: f64) -> (Antenna, BearingTable) {
        let antenna = AntennaConfig::Sectors(AntennaSectorsConfig {
            azimuth_sectors: 8,
            first_azimuth_deg: 30.0,
            elevations_deg: vec![0.0],
            vertical: Vertical::Array,
            beam_width_deg: None,
            vertical_width_deg: None,
            pattern,
            boresight_gain_dbi: None,
            quasi_omni_gain_dbi: 0.0,
            gain_ripple_db: 0.0,
        });
        let antenna = Antenna::try_from(antenna).unwrap();
        let table = BearingTable::new(&antenna, 8, error_db);
        (antenna, table)
    }

    #[test]
    fn strengths_with_an_error_tell_a_direction_as_well_as_they_claim() {
        let (antenna, table) = table(PatternConfig::default(), 1.0);
        let (mut squares, mut scaled, mut count) = (0.0, 0.0, 0.0);
        for of in 0..400_u64 {
            let azimuth = TAU * Seed(5).uniform(Purpose::new(1), [of, 0, 0]);
            let direction = Position::new(libm::cos(azimuth), libm::sin(azimuth), 0.0);
            let error = |sector: u8| Seed(5).normal(Purpose::new(2), [of, sector.into(), 0]);
            // Main lobes are heard, side lobes are not.
            let strengths: Vec<(u8, f64)> = (0..8)
                .map(|sector| (sector, antenna.gain(sector, direction).0 + error(sector) - 70.0))
                .filter(|strength| strength.1 > -77.0)
                .collect();
            let Some(found) = table.bearing(&strengths) else { continue };
            let off = wrapped(found.azimuth_rad + 30.0_f64.to_radians() - azimuth);
            squares += off * off;
            scaled += (off / found.sigma_rad).powi(2);
            count += 1.0;
        }
        let deg = (squares / count).sqrt().to_degrees();
        // The best sector alone leaves 45 / sqrt(12) = 13 degrees.
        assert!(count > 350.0 && deg < 4.0, "{deg} degrees of {count}");
        assert!((0.6..1.6).contains(&(scaled / count)), "{}", scaled / count);
    }

    #[test]
    fn equal_gains_within_a_sector_tell_no_more_than_the_sector() {
        let (antenna, table) = table(PatternConfig::FlatTop(FlatTopConfig::default()), 1.0);
        let direction = Position::new(1.0, 0.1, 0.0);
        let strengths: Vec<(u8, f64)> = (0..8).map(|sector| (sector, antenna.gain(sector, direction).0)).collect();
        assert_eq!(table.bearing(&strengths), None);
        assert_eq!(table.bearing(&strengths[..1]), None);
        assert_eq!(table.bearing(&[]), None);
        assert_eq!(table.bearing(&[(200, 1.0), (201, 2.0)]), None);
    }
}
