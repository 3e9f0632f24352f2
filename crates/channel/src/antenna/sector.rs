//! Antenna sectors of a listener: the directions of each sector.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use sextant_kernel::SettingError;

/// The directions of one sector, in the frame of the stops and not of the robot: azimuth counterclockwise from x,
/// elevation up from the horizontal plane. A robot whose antenna turns with it logs the sector in the frame of the
/// stops.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SectorConfig {
    /// Identity of the sector in the log, 0 to 255.
    pub sector: u8,
    /// Azimuth at which the sector begins (degrees).
    pub azimuth_from_deg: f64,
    /// Azimuth at which it ends, counterclockwise from its beginning (degrees); 360 more than the beginning is a full
    /// circle.
    pub azimuth_to_deg: f64,
    /// Lowest elevation (degrees), −90 (straight down) if absent.
    #[cfg_attr(feature = "config", serde(default = "nadir"))]
    pub elevation_from_deg: f64,
    /// Highest elevation (degrees), 90 (straight up) if absent.
    #[cfg_attr(feature = "config", serde(default = "zenith"))]
    pub elevation_to_deg: f64,
}

/// Sectors of equal width that fill the circle, in one or more rings: sector `i` of ring `j` is number
/// `j · azimuth_sectors + i`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvenSectorsConfig {
    /// Number of sectors in a ring, 1 or more.
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 255)))]
    pub azimuth_sectors: u8,
    /// Azimuth of the middle of sector 0 (degrees), 0 (along x) if absent. The other sectors follow counterclockwise.
    #[cfg_attr(feature = "config", serde(default))]
    pub first_azimuth_deg: f64,
    /// Lowest and highest elevation of each ring (degrees); one ring from −90 to 90 if absent.
    #[cfg_attr(feature = "config", serde(default = "one_ring"))]
    pub elevations_deg: Vec<[f64; 2]>,
}

#[cfg(feature = "config")]
fn nadir() -> f64 {
    -90.0
}

#[cfg(feature = "config")]
fn zenith() -> f64 {
    90.0
}

#[cfg(feature = "config")]
fn one_ring() -> Vec<[f64; 2]> {
    vec![[nadir(), zenith()]]
}

/// The directions of one sector, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wedge {
    /// Azimuth at which it begins (rad).
    pub azimuth_from_rad: f64,
    /// Its width counterclockwise (rad), above 0, at most 2π.
    pub azimuth_width_rad: f64,
    /// Lowest and highest elevation (rad), in [−π/2, π/2].
    pub elevation_rad: [f64; 2],
}

impl SectorConfig {
    /// The directions of the sector, checked.
    ///
    /// # Errors
    /// If an angle is not finite, the azimuths are equal, or the elevations are not ascending within [−90, 90].
    pub fn wedge(&self) -> Result<Wedge, SettingError> {
        let &Self { azimuth_from_deg: from, azimuth_to_deg: to, .. } = self;
        SettingError::finite("azimuth_from_deg", from)?;
        SettingError::finite("azimuth_to_deg", to)?;
        let width_deg = if to - from >= 360.0 { 360.0 } else { (to - from).rem_euclid(360.0) };
        if width_deg <= 0.0 {
            let allowed =
                format!("an azimuth other than azimuth_from_deg ({from}); {} is a full circle", from + 360.0);
            return Err(SettingError::new("azimuth_to_deg", to, allowed));
        }
        let (low, high) = (self.elevation_from_deg, self.elevation_to_deg);
        SettingError::in_range("elevation_from_deg", low, -90.0, 90.0)?;
        if !(high > low && high <= 90.0) {
            let allowed = format!("above elevation_from_deg ({low}), at most 90");
            return Err(SettingError::new("elevation_to_deg", high, allowed));
        }
        Ok(Wedge {
            azimuth_from_rad: from.to_radians(),
            azimuth_width_rad: width_deg.to_radians().min(TAU),
            elevation_rad: [low, high].map(|deg| deg.to_radians().clamp(-FRAC_PI_2, FRAC_PI_2)),
        })
    }
}

/// The directions of the sectors of an antenna, by their identities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SectorDirections(BTreeMap<u8, SectorConfig>);

impl SectorDirections {
    /// These sectors. They may overlap.
    ///
    /// # Errors
    /// `[i].KEY` if a value of sector i of the list is invalid or its identity is already used.
    pub fn new(sectors: impl IntoIterator<Item = SectorConfig>) -> Result<Self, SettingError> {
        let mut table = BTreeMap::new();
        for (i, sector) in sectors.into_iter().enumerate() {
            let within = |error: SettingError| error.within(format!("[{i}]"));
            sector.wedge().map_err(within)?;
            let id = sector.sector;
            if table.insert(id, sector).is_some() {
                return Err(within(SettingError::new("sector", id, "an identity that no other sector has")));
            }
        }
        Ok(Self(table))
    }

    /// Number of sectors.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no sectors.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The sectors, by ascending identity.
    pub fn iter(&self) -> impl Iterator<Item = &SectorConfig> {
        self.0.values()
    }

    /// Whether there is the sector `id`.
    #[must_use]
    pub fn contains(&self, id: u8) -> bool {
        self.0.contains_key(&id)
    }

    /// The identities, as a person would write them: `0 to 7, 9`.
    #[must_use]
    pub fn identities(&self) -> String {
        if self.is_empty() { "none".into() } else { runs(self.0.keys().copied()) }
    }
}

/// Ascending identities, as a person would write them: `0 to 7, 9`.
pub(crate) fn runs(identities: impl Iterator<Item = u8>) -> String {
    let mut runs: Vec<[u8; 2]> = Vec::new();
    for id in identities {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 == id => *last = id,
            _ => runs.push([id, id]),
        }
    }
    let run = |[first, last]: &[u8; 2]| if first == last { first.to_string() } else { format!("{first} to {last}") };
    runs.iter().map(run).collect::<Vec<_>>().join(", ")
}

impl TryFrom<EvenSectorsConfig> for SectorDirections {
    type Error = SettingError;

    fn try_from(config: EvenSectorsConfig) -> Result<Self, SettingError> {
        let EvenSectorsConfig { azimuth_sectors, first_azimuth_deg, elevations_deg } = config;
        SettingError::finite("first_azimuth_deg", first_azimuth_deg)?;
        let most = 256 / usize::from(azimuth_sectors.max(1));
        if azimuth_sectors == 0 {
            return Err(SettingError::new("azimuth_sectors", 0, "1 to 255"));
        }
        if elevations_deg.is_empty() || elevations_deg.len() > most {
            let allowed = format!("1 to {most} rings of {azimuth_sectors} sectors");
            return Err(SettingError::new("elevations_deg", format!("{} rings", elevations_deg.len()), allowed));
        }
        let width_deg = 360.0 / f64::from(azimuth_sectors);
        let rings = elevations_deg.iter().flat_map(|ring| (0..azimuth_sectors).map(move |i| (i, ring)));
        let sectors = (0..=u8::MAX).zip(rings).map(|(sector, (i, &[low, high]))| {
            let from = first_azimuth_deg + width_deg * (f64::from(i) - 0.5);
            SectorConfig {
                sector,
                azimuth_from_deg: from,
                azimuth_to_deg: from + width_deg,
                elevation_from_deg: low,
                elevation_to_deg: high,
            }
        });
        Self::new(sectors).map_err(|error| {
            SettingError::new(
                "elevations_deg",
                error.found(),
                "pairs of elevations from -90 to 90, the lower one first",
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sector(azimuth: [f64; 2], elevation: [f64; 2]) -> SectorConfig {
        SectorConfig {
            sector: 3,
            azimuth_from_deg: azimuth[0],
            azimuth_to_deg: azimuth[1],
            elevation_from_deg: elevation[0],
            elevation_to_deg: elevation[1],
        }
    }

    #[test]
    fn azimuths_run_counterclockwise_from_first_to_last() {
        for (azimuth, width_deg) in
            [([-20.0, 20.0], 40.0), ([340.0, 20.0], 40.0), ([20.0, -20.0], 320.0), ([0.0, 360.0], 360.0)]
        {
            let wedge = sector(azimuth, [-90.0, 90.0]).wedge().unwrap();
            assert!((wedge.azimuth_width_rad.to_degrees() - width_deg).abs() < 1e-9, "{wedge:?}");
        }
    }

    #[test]
    fn invalid_angles_are_rejected_with_their_key() {
        for (azimuth, elevation, key) in [
            ([f64::NAN, 0.0], [0.0, 1.0], "azimuth_from_deg"),
            ([0.0, f64::INFINITY], [0.0, 1.0], "azimuth_to_deg"),
            ([5.0, 5.0], [0.0, 1.0], "azimuth_to_deg"),
            ([0.0, 5.0], [-91.0, 1.0], "elevation_from_deg"),
            ([0.0, 5.0], [2.0, 1.0], "elevation_to_deg"),
            ([0.0, 5.0], [2.0, 100.0], "elevation_to_deg"),
        ] {
            assert_eq!(sector(azimuth, elevation).wedge().unwrap_err().key, key);
        }
        let twice = SectorDirections::new([sector([0.0, 5.0], [0.0, 1.0]), sector([5.0, 9.0], [0.0, 1.0])]);
        assert_eq!(twice.unwrap_err().key, "[1].sector");
    }

    #[test]
    fn even_sectors_are_numbered_ring_by_ring() {
        let config = EvenSectorsConfig {
            azimuth_sectors: 8,
            first_azimuth_deg: 0.0,
            elevations_deg: vec![[-90.0, 0.0], [0.0, 90.0]],
        };
        let table = SectorDirections::try_from(config.clone()).unwrap();
        assert_eq!((table.len(), table.identities().as_str()), (16, "0 to 15"));
        let tenth = table.iter().nth(10).unwrap();
        assert_eq!(tenth.sector, 10);
        assert!((tenth.azimuth_from_deg - 67.5).abs() < 1e-9);
        assert!(tenth.elevation_from_deg.abs() < 1e-12);
        let key = |config: EvenSectorsConfig| SectorDirections::try_from(config).unwrap_err().key;
        assert_eq!(key(EvenSectorsConfig { azimuth_sectors: 0, ..config.clone() }), "azimuth_sectors");
        assert_eq!(key(EvenSectorsConfig { azimuth_sectors: 200, ..config.clone() }), "elevations_deg");
        assert_eq!(key(EvenSectorsConfig { elevations_deg: vec![[9.0, 3.0]], ..config }), "elevations_deg");
    }
}
