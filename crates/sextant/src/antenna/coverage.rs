//! What the sectors of an antenna cover: their peaks, their widths, and the directions in which each is the best.

use std::f64::consts::FRAC_PI_2;
use std::fmt;

use serde::Serialize;
use sextant_channel::{Antenna, Db, Position, SectorConfig};

use crate::columns::{Align, columns};

/// Gains that differ by less are equal (dB).
const EQUAL_DB: f64 = 1e-9;
/// How far below its peak the half-power width ends (dB).
const HALF_POWER_DB: f64 = 3.010_299_956_639_812;

/// A sector that radiates more than this share of its power has gains that no antenna has: steps of one degree and the formulas of
/// reference antennas are not that wrong.
const MOST_RADIATED: f64 = 1.25;

/// One sector of an antenna in numbers. Angles are in the frame of the antenna.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternSummary {
    /// Identity of the sector in logs.
    pub sector: u8,
    /// Greatest gain (dBi).
    pub peak_gain_dbi: f64,
    /// Azimuth of the greatest gain (degrees).
    pub peak_azimuth_deg: f64,
    /// Elevation of the greatest gain (degrees).
    pub peak_elevation_deg: f64,
    /// Half-power width in azimuth through the peak (degrees).
    pub azimuth_width_deg: f64,
    /// Half-power width in elevation through the peak (degrees).
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
    /// What the sectors of `antenna` cover: directions are looked at in steps of one degree.
    #[must_use]
    pub fn of(antenna: &Antenna) -> Self {
        let mut shares = vec![0.0; usize::from(antenna.sector_count())];
        let mut powers = vec![0.0; shares.len()];
        let mut peaks = vec![(f64::NEG_INFINITY, 0, 0); shares.len()];
        let (mut all, mut undecided) = (0.0, 0.0);
        for elevation in -90..=90 {
            // Directions of a ring stand for its area.
            let weight = ring_weight(elevation);
            for azimuth in -180..180 {
                let direction = towards(azimuth.into(), elevation.into());
                let (mut best, mut is_equal) = ((0, f64::NEG_INFINITY), false);
                for sector in 0..antenna.sector_count() {
                    let gain_dbi = antenna.gain(sector, direction).0;
                    powers[usize::from(sector)] += weight * Db(gain_dbi).to_factor();
                    let peak = &mut peaks[usize::from(sector)];
                    // Of equal ones, as those of a planar cut are, the first.
                    if gain_dbi > peak.0 + EQUAL_DB {
                        *peak = (gain_dbi, azimuth, elevation);
                    }
                    if gain_dbi > best.1 + EQUAL_DB {
                        (best, is_equal) = ((sector, gain_dbi), false);
                    } else if gain_dbi > best.1 - EQUAL_DB {
                        is_equal = true;
                    }
                }
                let won = if is_equal { &mut undecided } else { &mut shares[usize::from(best.0)] };
                *won += weight;
                all += weight;
            }
        }
        let summary = |number: u8| {
            let (peak_gain_dbi, azimuth, elevation) = peaks[usize::from(number)];
            let sector = antenna.identity(number);
            let wedge = antenna.sectors().iter().find(|wedge| wedge.sector == sector);
            let full = [-180.0, 180.0];
            let azimuths = |wedge: &SectorConfig| [wedge.azimuth_from_deg, wedge.azimuth_to_deg];
            let elevations = |wedge: &SectorConfig| [wedge.elevation_from_deg, wedge.elevation_to_deg];
            let (azimuth, elevation) = (f64::from(azimuth), f64::from(elevation));
            PatternSummary {
                sector,
                peak_gain_dbi,
                peak_azimuth_deg: azimuth,
                peak_elevation_deg: elevation,
                azimuth_width_deg: width_deg(360.0, |aside| {
                    antenna.gain(number, towards(azimuth + aside, elevation)).0
                }),
                elevation_width_deg: width_deg(180.0, |aside| {
                    antenna.gain(number, towards(azimuth, elevation + aside)).0
                }),
                wedge_azimuth_deg: wedge.map_or(full, azimuths),
                wedge_elevation_deg: wedge.map_or([-90.0, 90.0], elevations),
                share_won: shares[usize::from(number)] / all,
                share_radiated: powers[usize::from(number)] / all,
            }
        };
        Self {
            sectors: (0..antenna.sector_count()).map(summary).collect(),
            share_undecided: undecided / all,
            quasi_omni_gain_dbi: antenna.quasi_omni().0,
            quasi_omni_measured: antenna.has_measured_quasi_omni(),
        }
    }
}

/// The unit vector of a direction; an elevation beyond the vertical comes down on the other side.
fn towards(azimuth_deg: f64, elevation_deg: f64) -> Position {
    let (sa, ca) = libm::sincos(azimuth_deg.to_radians());
    let (se, ce) = libm::sincos(elevation_deg.to_radians());
    Position::new(ca * ce, sa * ce, se)
}

/// The area of a ring of one degree round an elevation, without a constant factor.
fn ring_weight(elevation_deg: i32) -> f64 {
    let edge = |deg: f64| libm::sin(deg.to_radians().clamp(-FRAC_PI_2, FRAC_PI_2));
    let middle = f64::from(elevation_deg);
    edge(middle + 0.5) - edge(middle - 0.5)
}

/// Width of the lobe round 0 (degrees): between the first angles on both sides where the gain is half that of 0, found in
/// steps and then by halving. At most `whole_deg`.
fn width_deg(whole_deg: f64, gain_dbi: impl Fn(f64) -> f64) -> f64 {
    let level = gain_dbi(0.0) - HALF_POWER_DB;
    let half = |side: f64| {
        let mut inside = 0.0;
        while inside < whole_deg / 2.0 {
            let next = inside + 0.5;
            if gain_dbi(side * next) < level {
                let mut ends = [inside, next];
                for _ in 0..30 {
                    let middle = f64::midpoint(ends[0], ends[1]);
                    ends[usize::from(gain_dbi(side * middle) < level)] = middle;
                }
                return ends[0];
            }
            inside = next;
        }
        whole_deg / 2.0
    };
    half(-1.0) + half(1.0)
}

impl fmt::Display for AntennaCoverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = ["sector", "peak", "azimuth", "elevation", "width", "height", "wedge", "", "wins", "radiates"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        let degrees = |deg: f64| format!("{:.0}\u{b0}", deg + 0.0);
        let span = |[from, to]: [f64; 2]| format!("{:.0} to {:.0}\u{b0}", from + 0.0, to + 0.0);
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
            assert!((sector.share_won - 0.125).abs() < 0.03, "{sector:?}");
        }
        let won = found.sectors.iter().map(|sector| sector.share_won).sum::<f64>();
        assert!((won + found.share_undecided - 1.0).abs() < 1e-9 && won > 0.8, "{won}");
    }

    #[test]
    fn the_power_that_a_sector_radiates_is_the_integral_of_its_gain() {
        let share = |text: &str| coverage(text).sectors[0].share_radiated;
        // Two gains that radiate all power, whatever their widths, and all directions with the same gain.
        for beam in ["wedge", "cone"] {
            let text = format!("sectors = {{ azimuth_sectors = 6, pattern.flat_top = {{ beam = \"{beam}\" }} }}");
            assert!((share(&text) - 1.0).abs() < 0.02, "{beam}: {}", share(&text));
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
