//! Antennas: the gain of each sector in each direction.

mod code_book;
mod orientation;
mod pattern;
pub(crate) mod sector;
pub(crate) mod sector_gains;
pub(crate) mod sector_table;
mod sectors;
pub(crate) mod turned_sectors;

use std::ops::Range;
use std::path::PathBuf;

use sextant_kernel::{Files, Seed, SettingError, StationId};

pub use code_book::{CodeBookConfig, Gaps, SectorGainsConfig, look_like_factors};
pub use orientation::{Orientation, OrientationConfig};
pub use pattern::{
    EllipticalConfig, FlatBeam, FlatTopConfig, Ieee802153cConfig, LobeEdge, PatternConfig, SectorEdge, Tr38901Config,
};
pub use sectors::{AntennaSectorsConfig, Vertical};

use crate::antenna::sector::SectorDirections;
use crate::geometry::position::Position;
use crate::power::Db;
use crate::purpose;
use code_book::CodeBook;
use sectors::Sectors;

/// Most sectors of one DMG antenna: a sector identity has 6 bits (IEEE 802.11ad-2012, 8.4a.1).
const SECTORS_OF_ANTENNA: u8 = 64;
/// Most sectors of all DMG antennas of a station in one sweep (IEEE 802.11ad-2012, 9.35.2).
const SECTORS_OF_STATION: u8 = 128;
/// Most DMG antennas of a station: their identity has 2 bits.
const DMG_ANTENNAS: u8 = 4;
/// Most sectors of an antenna over all its tilts, so that a number from 0 names each.
const MOST_SECTORS: u8 = 255;
/// Draws of the gain ripple are cut at this many standard deviations, so that the greatest gain is known.
const RIPPLE_LIMIT: f64 = 4.0;

/// An antenna as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum AntennaConfig {
    /// The same gain in all directions.
    Omnidirectional(OmnidirectionalConfig),
    /// Sectors of equal width.
    Sectors(AntennaSectorsConfig),
    /// Measured sectors.
    CodeBook(CodeBookConfig),
}

impl Default for AntennaConfig {
    /// 0 dBi in all directions.
    fn default() -> Self {
        Self::Omnidirectional(OmnidirectionalConfig::default())
    }
}

/// An antenna with the same gain in all directions, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OmnidirectionalConfig {
    /// Gain (dBi).
    #[cfg_attr(feature = "config", serde(default))]
    pub gain_dbi: f64,
}

impl AntennaConfig {
    /// The file that it names, if it names one, and its key.
    pub fn file_mut(&mut self) -> Option<(&'static str, &mut PathBuf)> {
        match self {
            Self::CodeBook(config) => Some(("code_book.file", config.file.as_mut()?)),
            _ => None,
        }
    }
}

/// What a sector is called on air.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SectorAddress {
    /// DMG antenna identity, 0 to 3.
    pub dmg_antenna: u8,
    /// Sector identity within the antenna, 0 to 63.
    pub sector: u8,
}

/// An antenna with one or more sectors, numbered from 0, and a quasi-omnidirectional pattern.
///
/// Directions are unit vectors in the frame of the antenna (see [`Orientation`]), from the antenna to the other end.
/// All gains are equal, bit for bit, on all platforms.
#[derive(Clone, Debug)]
pub struct Antenna {
    beams: Beams,
    quasi_omni: Db,
    greatest: Db,
    ripple_db: f64,
    table: SectorDirections,
}

#[derive(Clone, Debug)]
enum Beams {
    Omnidirectional(Db),
    Sectors(Sectors),
    CodeBook(CodeBook),
}

impl Default for Antenna {
    /// 0 dBi in all directions.
    fn default() -> Self {
        Self::omnidirectional(Db(0.0))
    }
}

impl TryFrom<AntennaConfig> for Antenna {
    type Error = SettingError;

    /// File paths are relative to the working folder.
    fn try_from(config: AntennaConfig) -> Result<Self, SettingError> {
        Self::read(&config, &Files::default())
    }
}

impl Antenna {
    /// The antenna that `config` describes; its file paths are among `files`.
    ///
    /// # Errors
    /// If a value is invalid, or a file cannot be read or has a flaw.
    pub fn read(config: &AntennaConfig, files: &Files) -> Result<Self, SettingError> {
        match config {
            AntennaConfig::Omnidirectional(config) => {
                let gain = gain("gain_dbi", config.gain_dbi).map_err(|error| error.within("omnidirectional"))?;
                Ok(Self::omnidirectional(gain))
            }
            AntennaConfig::Sectors(config) => Sectors::try_from(config)
                .and_then(|sectors| {
                    let peaks = sectors.beams.iter().map(|beam| beam.peak_dbi);
                    let greatest = peaks.fold(f64::NEG_INFINITY, f64::max);
                    let ripple_db = config.gain_ripple_db;
                    Self::new(Beams::Sectors(sectors), greatest, config.quasi_omni_gain_dbi, ripple_db)
                })
                .map_err(|error| error.within("sectors")),
            AntennaConfig::CodeBook(config) => CodeBook::read(config, files)
                .and_then(|book| {
                    let greatest = book.greatest_dbi();
                    let equal_dbi = config.quasi_omni_gain_dbi.unwrap_or(0.0);
                    let quasi_omni_dbi = book.greatest_quasi_omni_dbi().unwrap_or(equal_dbi);
                    Self::new(Beams::CodeBook(book), greatest, quasi_omni_dbi, config.gain_ripple_db)
                })
                .map_err(|error| error.within("code_book")),
        }
    }

    /// The same gain in all directions.
    fn omnidirectional(gain: Db) -> Self {
        let beams = Beams::Omnidirectional(gain);
        Self { beams, quasi_omni: gain, greatest: gain, ripple_db: 0.0, table: SectorDirections::default() }
    }

    fn new(beams: Beams, greatest_dbi: f64, quasi_omni_dbi: f64, ripple_db: f64) -> Result<Self, SettingError> {
        let quasi_omni = gain("quasi_omni_gain_dbi", quasi_omni_dbi)?;
        let ripple_db = SettingError::in_range("gain_ripple_db", ripple_db, 0.0, 20.0)?;
        let greatest = Db((greatest_dbi + RIPPLE_LIMIT * ripple_db).max(quasi_omni.0));
        let table = match &beams {
            Beams::Omnidirectional(_) => SectorDirections::default(),
            Beams::Sectors(sectors) => sectors.table()?,
            Beams::CodeBook(book) => book.table(),
        };
        Ok(Self { beams, quasi_omni, greatest, ripple_db, table })
    }

    /// The settings that it is read from again, gain by gain: those of a code book from a file have the grid and the gains
    /// of the file in them. The standard deviation of the ripple is among them, its draws are not.
    #[must_use]
    pub fn config(&self) -> AntennaConfig {
        match &self.beams {
            &Beams::Omnidirectional(Db(gain_dbi)) => {
                AntennaConfig::Omnidirectional(OmnidirectionalConfig { gain_dbi })
            }
            Beams::Sectors(sectors) => AntennaConfig::Sectors(sectors.config.clone()),
            Beams::CodeBook(book) => AntennaConfig::CodeBook(CodeBookConfig {
                quasi_omni_gain_dbi: (!book.has_quasi_omni()).then_some(self.quasi_omni.0),
                gain_ripple_db: self.ripple_db,
                ..book.config()
            }),
        }
    }

    /// Number of sectors over all rings, 1 to 255; an omnidirectional antenna has one.
    #[must_use]
    pub fn sector_count(&self) -> u8 {
        match &self.beams {
            Beams::Omnidirectional(_) => 1,
            Beams::Sectors(sectors) => sectors.per_ring * sectors.rings,
            Beams::CodeBook(book) => book.sector_count(),
        }
    }

    /// Whether it has the same gain in all directions.
    #[must_use]
    #[inline]
    pub fn is_omnidirectional(&self) -> bool {
        matches!(self.beams, Beams::Omnidirectional(_))
    }

    /// Whether its gains were measured, each in its own way.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        matches!(self.beams, Beams::CodeBook(_))
    }

    /// Number of rings of sectors; one for a code book.
    #[must_use]
    pub fn rings(&self) -> u8 {
        match &self.beams {
            Beams::Sectors(sectors) => sectors.rings,
            Beams::Omnidirectional(_) | Beams::CodeBook(_) => 1,
        }
    }

    /// Number of sweeps that cover all sectors: one for each tilt of a steered antenna, else one.
    #[must_use]
    pub fn sweeps(&self) -> u8 {
        match &self.beams {
            Beams::Sectors(sectors) if sectors.vertical == Vertical::Steered => sectors.rings,
            _ => 1,
        }
    }

    /// The sectors of one sweep, in the order in which they are swept.
    ///
    /// # Panics
    /// If `sweep` is not less than [`sweeps`](Self::sweeps).
    #[must_use]
    pub fn sectors_of_sweep(&self, sweep: u8) -> Range<u8> {
        assert!(sweep < self.sweeps(), "sweep {sweep} of {}", self.sweeps());
        let count = self.sector_count() / self.sweeps();
        sweep * count..(sweep + 1) * count
    }

    /// The identity of a sector in logs, tables and recordings: that of a code book on air, else its number.
    ///
    /// # Panics
    /// If there is no such sector.
    #[must_use]
    pub fn identity(&self, sector: u8) -> u8 {
        match &self.beams {
            Beams::Omnidirectional(_) | Beams::Sectors(_) => sector,
            Beams::CodeBook(book) => book.identity(sector),
        }
    }

    /// What the sector is called on air. Each ring of an array is a DMG antenna; if there are more than four, an equal
    /// number of consecutive rings is one. The sectors of a steered antenna have the same names at each tilt.
    #[must_use]
    pub fn address(&self, sector: u8) -> SectorAddress {
        match &self.beams {
            Beams::Omnidirectional(_) => SectorAddress { dmg_antenna: 0, sector },
            Beams::Sectors(sectors) => {
                let of_antenna = sectors.per_ring
                    * match sectors.vertical {
                        Vertical::Array => sectors.rings.div_ceil(DMG_ANTENNAS),
                        Vertical::Steered => 1,
                    };
                let dmg_antenna = match sectors.vertical {
                    Vertical::Array => sector / of_antenna,
                    Vertical::Steered => 0,
                };
                SectorAddress { dmg_antenna, sector: sector % of_antenna }
            }
            Beams::CodeBook(book) => SectorAddress { dmg_antenna: 0, sector: book.identity(sector) },
        }
    }

    /// Gain of `sector` in `direction`, without the ripple.
    ///
    /// # Panics
    /// If there is no such sector.
    #[must_use]
    #[inline]
    pub fn gain(&self, sector: u8, direction: Position) -> Db {
        match &self.beams {
            Beams::Omnidirectional(gain) => *gain,
            Beams::Sectors(sectors) => Db(sectors.beams[usize::from(sector)].gain_dbi(&sectors.pattern, direction)),
            Beams::CodeBook(book) => Db(book.gain_dbi(sector, direction)),
        }
    }

    /// Greatest gain of the quasi-omnidirectional pattern, with which the antenna listens: its gain in all directions,
    /// unless it was measured.
    #[must_use]
    #[inline]
    pub fn quasi_omni(&self) -> Db {
        self.quasi_omni
    }

    /// Whether the quasi-omnidirectional pattern was measured.
    #[must_use]
    #[inline]
    pub fn has_measured_quasi_omni(&self) -> bool {
        matches!(&self.beams, Beams::CodeBook(book) if book.has_quasi_omni())
    }

    /// Gain of the quasi-omnidirectional pattern in `direction`, if it was measured; `None` if it is
    /// [`quasi_omni`](Self::quasi_omni) in all directions.
    #[must_use]
    #[inline]
    pub fn measured_quasi_omni(&self, direction: Position) -> Option<Db> {
        match &self.beams {
            Beams::Omnidirectional(_) | Beams::Sectors(_) => None,
            Beams::CodeBook(book) => book.quasi_omni_dbi(direction).map(Db),
        }
    }

    /// Elevation of a planar cut whose gains are taken for all elevations (degrees), because nothing else is known;
    /// `None` of other antennas.
    #[must_use]
    pub fn endless_cut_deg(&self) -> Option<f64> {
        match &self.beams {
            Beams::Omnidirectional(_) | Beams::Sectors(_) => None,
            Beams::CodeBook(book) => book.endless_cut_deg(),
        }
    }

    /// A bound of the gain of all sectors with their ripple, and of the quasi-omnidirectional pattern.
    #[must_use]
    #[inline]
    pub fn greatest_gain(&self) -> Db {
        self.greatest
    }

    /// The sector with the greatest gain in `direction`, the first if several have the same.
    #[must_use]
    pub fn best_sector(&self, direction: Position) -> u8 {
        let mut best = (0, self.gain(0, direction));
        for sector in 1..self.sector_count() {
            let gain = self.gain(sector, direction);
            if gain > best.1 {
                best = (sector, gain);
            }
        }
        best.0
    }

    /// By how much the gain of each sector of `station` differs from the pattern: drawn from `seed`, normal, zero on
    /// average, never more than four standard deviations. Empty if the antenna has no ripple.
    #[must_use]
    pub fn ripple(&self, seed: Seed, station: StationId) -> Vec<Db> {
        if self.ripple_db <= 0.0 {
            return Vec::new();
        }
        let draw = |sector| seed.normal(purpose::GAIN_RIPPLE, [u64::from(station.0), u64::from(sector), 0]);
        let limited = |sector| draw(sector).clamp(-RIPPLE_LIMIT, RIPPLE_LIMIT);
        (0..self.sector_count()).map(|sector| Db(self.ripple_db * limited(sector))).collect()
    }

    /// The directions of each sector in the frame of the antenna, by its [identity](Self::identity): those where it is the best. For a code
    /// book, each is the smallest interval of azimuth and elevation that has them all. None without sectors.
    #[must_use]
    pub fn sectors(&self) -> &SectorDirections {
        &self.table
    }
}

/// The gain under `key`, checked.
fn gain(key: &str, dbi: f64) -> Result<Db, SettingError> {
    SettingError::in_range(key, dbi, -100.0, 100.0).map(Db)
}
