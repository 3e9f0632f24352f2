//! What the sectors of an antenna cover: their peaks, their widths, and the directions in which each is the best.

use std::f64::consts::PI;
use std::fmt;

use serde::Serialize;
use sextant_channel::{Antenna, Db, Position, SectorConfig};

use super::boresight::{EQUAL_DB, Lobe};
use crate::columns::{Align, columns};

/// Number of directions in which the gains of all sectors are compared and summed up.
const DIRECTIONS: u32 = 200_000;

/// A sector that radiates more than this share of its power has gains that no antenna has: the formulas of reference antennas are not
/// that wrong.
const MOST_RADIATED: f64 = 1.25;

/// One sector of an antenna in numbers. Angles are in the frame of the antenna.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternSummary {
    /// Identity of the sector in logs.
    pub sector: u8,
    /// Greatest gain (dBi).
    pub peak_gain_dbi: f64,
    /// Azimuth of the boresight (degrees): the direction of the greatest gain, and the middle of all such directions if there are several.
    pub peak_azimuth_deg: f64,
    /// Elevation of the boresight (degrees).
    pub peak_elevation_deg: f64,
    /// Half-power width in azimuth through the boresight (degrees).
    pub azimuth_width_deg: f64,
    /// Half-power width in elevation through the boresight (degrees).
    pub elevation_width_deg: f64,
    /// The azimuths where the sector stands in a log, first and last, counterclockwise (degrees).
    pub wedge_azimuth_deg: [f64; 2],
    /// The elevations where the sector stands in a log, lowest and highest (degrees).
    pub wedge_elevation_deg: [f64; 2],
    /// Share of all directions in which it alone is the best.
    pub share_won: f64,
    /// Share of the power that it radiates into all directions: the efficiency of the antenna. No antenna has more than 1.
    pub share_radiated: f64,
}

/// What the sectors of an antenna cover.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AntennaCoverage {
    /// The sectors, by their identities.
    pub sectors: Vec<PatternSummary>,
    /// Share of all directions in which several sectors are equally good: outside a measurement.
    pub share_undecided: f64,
    /// Greatest gain of the quasi-omnidirectional pattern (dBi).
    pub quasi_omni_gain_dbi: f64,
    /// Whether the quasi-omnidirectional pattern was measured, so that its gain is not the same in all directions.
    pub quasi_omni_measured: bool,
}

impl AntennaCoverage {
    /// What the sectors of `antenna` cover: many directions stand for equal parts of the sphere.
    #[must_use]
    pub fn of(antenna: &Antenna) -> Self {
        let mut won = vec![0_u32; usize::from(antenna.sector_count())];
        let mut powers = vec![0.0; won.len()];
        let mut undecided = 0_u32;
        for direction in (0..DIRECTIONS).map(direction) {
            let (mut best, mut is_equal) = ((0, f64::NEG_INFINITY), false);
            for sector in 0..antenna.sector_count() {
                let gain_dbi = antenna.gain(sector, direction).0;
                powers[usize::from(sector)] += Db(gain_dbi).to_factor();
                if gain_dbi > best.1 + EQUAL_DB {
                    (best, is_equal) = ((sector, gain_dbi), false);
                } else if gain_dbi > best.1 - EQUAL_DB {
                    is_equal = true;
                }
            }
            let won = if is_equal { &mut undecided } else { &mut won[usize::from(best.0)] };
            *won += 1;
        }
        let all = f64::from(DIRECTIONS);
        let summary = |number: u8| {
            let sector = antenna.identity(number);
            let wedge = antenna.sectors().iter().find(|wedge| wedge.sector == sector);
            let full = [-180.0, 180.0];
            let azimuths = |wedge: &SectorConfig| [wedge.azimuth_from_deg, wedge.azimuth_to_deg];
            let elevations = |wedge: &SectorConfig| [wedge.elevation_from_deg, wedge.elevation_to_deg];
            let lobe = Lobe::of(antenna, number);
            PatternSummary {
                sector,
                peak_gain_dbi: lobe.peak_dbi,
                peak_azimuth_deg: lobe.azimuth_deg,
                peak_elevation_deg: lobe.elevation_deg,
                azimuth_width_deg: lobe.azimuth_width_deg(antenna),
                elevation_width_deg: lobe.elevation_width_deg(antenna),
                wedge_azimuth_deg: wedge.map_or(full, azimuths),
                wedge_elevation_deg: wedge.map_or([-90.0, 90.0], elevations),
                share_won: f64::from(won[usize::from(number)]) / all,
                share_radiated: powers[usize::from(number)] / all,
            }
        };
        Self {
            sectors: (0..antenna.sector_count()).map(summary).collect(),
            share_undecided: f64::from(undecided) / all,
            quasi_omni_gain_dbi: antenna.quasi_omni().0,
            quasi_omni_measured: antenna.has_measured_quasi_omni(),
        }
    }
}

/// Direction `number` of all: they stand for equal areas, each turned from the one before by the golden angle, so that neither edges of
/// sectors nor rows of a grid coincide with them (R. Swinbank, R. J. Purser: Fibonacci grids. Q. J. R. Meteorol. Soc., 2006).
fn direction(number: u32) -> Position {
    let golden_rad = PI * (3.0 - 5.0_f64.sqrt());
    let number = f64::from(number);
    let z = (2.0 * number + 1.0) / f64::from(DIRECTIONS) - 1.0;
    let across = (1.0 - z * z).sqrt();
    let (sin, cos) = libm::sincos(number * golden_rad);
    Position::new(across * cos, across * sin, z)
}

impl fmt::Display for AntennaCoverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = ["sector", "peak", "azimuth", "elevation", "width", "height", "wedge", "", "wins", "radiates"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let degrees = |deg: f64| format!("{:.0}\u{b0}", deg.round() + 0.0);
        let span = |[from, to]: [f64; 2]| format!("{:.0} to {:.0}\u{b0}", from.round() + 0.0, to.round() + 0.0);
        rows.extend(self.sectors.iter().map(|sector| {
            vec![
                sector.sector.to_string(),
                format!("{:.1} dBi", sector.peak_gain_dbi),
                degrees(sector.peak_azimuth_deg),
                degrees(sector.peak_elevation_deg),
                degrees(sector.azimuth_width_deg),
                degrees(sector.elevation_width_deg),
                span(sector.wedge_azimuth_deg),
                span(sector.wedge_elevation_deg),
                format!("{:.1} %", 100.0 * sector.share_won),
                format!("{:.0} %", 100.0 * sector.share_radiated),
            ]
        }));
        let mut align = [Align::Right; 10];
        align[6] = Align::Left;
        align[7] = Align::Left;
        let mut table = Vec::new();
        columns(&rows, &align, &mut table).map_err(|_| fmt::Error)?;
        f.write_str(&String::from_utf8_lossy(&table))?;
        if self.share_undecided > 0.0 {
            writeln!(
                f,
                "in {:.1} % of all directions several sectors are equally good",
                100.0 * self.share_undecided
            )?;
        }
        if self.sectors.iter().any(|sector| sector.share_radiated > MOST_RADIATED) {
            writeln!(f, "some gains are too large for their widths: no antenna radiates more power than it gets")?;
        }
        let (gain, measured) = (self.quasi_omni_gain_dbi, if self.quasi_omni_measured { "measured" } else { "even" });
        writeln!(f, "listens with {gain:.1} dBi at most ({measured})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::AntennaConfig;

    fn coverage(text: &str) -> AntennaCoverage {
        #[derive(serde::Deserialize)]
        struct Holder {
            antenna: AntennaConfig,
        }
        let holder: Holder = toml::from_str(&format!("antenna.{text}")).expect("an antenna");
        AntennaCoverage::of(&Antenna::try_from(holder.antenna).expect("a good antenna"))
    }

    #[test]
    fn equal_sectors_win_equal_shares_and_have_their_half_power_widths() {
        let found = coverage("sectors = { azimuth_sectors = 8, boresight_gain_dbi = 9.0 }");
        assert_eq!(found.sectors.iter().map(|sector| sector.sector).collect::<Vec<_>>(), (0..8).collect::<Vec<_>>());
        for (number, sector) in (0..).zip(&found.sectors) {
            let azimuth = (45.0 * f64::from(number) + 180.0) % 360.0 - 180.0;
            assert!((sector.peak_azimuth_deg - azimuth).abs() < 1.0 && sector.peak_elevation_deg.abs() < 1.0);
            assert!((sector.peak_gain_dbi - 9.0).abs() < 1e-6, "{sector:?}");
            // Beams of the reference antenna are as wide as a sector between their half-power angles.
            for width_deg in [sector.azimuth_width_deg, sector.elevation_width_deg] {
                assert!((width_deg - 45.0).abs() < 0.05, "{sector:?}");
            }
            // Between the beams they are equally good.
            assert!((sector.share_won - found.sectors[0].share_won).abs() < 5e-4, "{sector:?}");
        }
        let won = found.sectors.iter().map(|sector| sector.share_won).sum::<f64>();
        assert!((won + found.share_undecided - 1.0).abs() < 1e-9 && won > 0.8, "{won}");
    }

    #[test]
    fn a_flat_top_has_its_boresight_in_the_middle_and_its_own_widths() {
        for (beam, count, height_deg) in
            [("cone", 8_u8, 45.0), ("cone", 16, 22.5), ("wedge", 8, 180.0), ("wedge", 7, 180.0), ("wedge", 32, 180.0)]
        {
            let text =
                format!("sectors = {{ azimuth_sectors = {count}, pattern.flat_top = {{ beam = \"{beam}\" }} }}");
            let found = coverage(&text);
            let width_deg = 360.0 / f64::from(count);
            for sector in &found.sectors {
                let azimuth = (width_deg * f64::from(sector.sector) + 180.0) % 360.0 - 180.0;
                let off = (sector.peak_azimuth_deg - azimuth + 540.0) % 360.0 - 180.0;
                assert!(off.abs() < 0.01 && sector.peak_elevation_deg.abs() < 0.01, "{text}: {sector:?}");
                assert!((sector.azimuth_width_deg - width_deg).abs() < 0.01, "{text}: {sector:?}");
                assert!((sector.elevation_width_deg - height_deg).abs() < 0.01, "{text}: {sector:?}");
                assert!((sector.share_radiated - 1.0).abs() < 0.01, "{text}: {sector:?}");
            }
        }
        // A tilted ring with edges in elevation: the middle is at the tilt.
        let tilted = "sectors = { azimuth_sectors = 4, elevations_deg = [30], vertical_width_deg = 20, pattern.flat_top = {} }";
        let sector = &coverage(tilted).sectors[1];
        assert!((sector.peak_elevation_deg - 30.0).abs() < 0.01, "{sector:?}");
        assert!((sector.elevation_width_deg - 20.0).abs() < 0.01, "{sector:?}");
    }

    #[test]
    fn a_peak_between_degrees_is_found() {
        let found = coverage("sectors = { azimuth_sectors = 16, boresight_gain_dbi = 14.0 }");
        assert!((found.sectors[1].peak_azimuth_deg - 22.5).abs() < 0.01, "{:?}", found.sectors[1]);
        assert!((found.sectors[1].peak_gain_dbi - 14.0).abs() < 1e-4, "{:?}", found.sectors[1]);
        let book = "code_book = { azimuths_deg = [0, 0.7, 1.4], elevations_deg = [-0.6, 0.3, 1.2], outside_gain_dbi = -20, \
                    sectors = [{ sector = 0, gain_dbi = [[0, 0, 0], [0, 9, 0], [0, 0, 0]] }] }";
        let sector = &coverage(book).sectors[0];
        assert!(
            (sector.peak_azimuth_deg - 0.7).abs() < 0.01 && (sector.peak_elevation_deg - 0.3).abs() < 0.01,
            "{sector:?}"
        );
        assert!((sector.peak_gain_dbi - 9.0).abs() < 0.01, "{sector:?}");
    }

    #[test]
    fn the_power_that_a_sector_radiates_is_the_integral_of_its_gain() {
        let share = |text: &str| coverage(text).sectors[0].share_radiated;
        // Two gains that radiate all power, whatever their widths, and all directions with the same gain.
        for beam in ["wedge", "cone"] {
            let text = format!("sectors = {{ azimuth_sectors = 6, pattern.flat_top = {{ beam = \"{beam}\" }} }}");
            assert!((share(&text) - 1.0).abs() < 0.003, "{beam}: {}", share(&text));
        }
        // 3 dBi in all directions.
        let half = "code_book = { azimuths_deg = [-180, 0], elevations_deg = [0], sectors = [{ sector = 0, gain_dbi = [[3, 3]] }] }";
        assert!((share(half) - 10_f64.powf(0.3)).abs() < 1e-9);
        assert!(coverage(half).to_string().contains("too large for their widths"));
        // The formulas of reference antennas are near.
        for pattern in ["ieee802153c = {}", "elliptical = {}", "tr38901 = {}"] {
            let found = share(&format!("sectors = {{ azimuth_sectors = 8, pattern.{pattern} }}"));
            assert!((0.6..1.25).contains(&found), "{pattern}: {found}");
        }
    }

    #[test]
    fn shares_are_shares_of_the_area_of_the_sphere() {
        // Round beams along x and up: the plane between them halves the sphere.
        let text = "sectors = { azimuth_sectors = 1, elevations_deg = [0, 90], beam_width_deg = 180, \
                    pattern.ieee802153c = {} }";
        let found = coverage(text);
        assert!(found.sectors.iter().all(|sector| (sector.share_won - 0.5).abs() < 1e-3), "{found:?}");
        let planar = coverage(
            "code_book = { azimuths_deg = [0, 90, 180, 270], elevations_deg = [0], \
             sectors = [{ sector = 3, gain_dbi = [[9, 3, -3, 3]] }, { sector = 60, gain_dbi = [[-3, 3, 9, 3]] }] }",
        );
        let identities: Vec<u8> = planar.sectors.iter().map(|sector| sector.sector).collect();
        assert_eq!(identities, [3, 60]);
        assert!((planar.sectors[0].share_won - 0.5).abs() < 0.01, "{planar:?}");
        // From 9 dBi the gain falls by 6 dB in 90 degrees: half the power is lost after 45.15 on both sides.
        assert!((planar.sectors[0].azimuth_width_deg - 90.31).abs() < 0.01, "{planar:?}");
        assert!(planar.to_string().contains("60  9.0 dBi"), "{planar}");
    }
}
