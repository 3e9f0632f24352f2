//! The gains of a listener's sectors, where its antenna is known.

use std::sync::Arc;

use sextant_kernel::{Files, SettingError};

use crate::antenna::sector::SectorDirections;
use crate::antenna::turned_sectors::turned;
use crate::antenna::{Antenna, AntennaConfig, AntennaSectorsConfig, CodeBookConfig, Orientation, OrientationConfig};
use crate::geometry::position::Position;

/// The gains of the sectors of a listener in all directions, in the frame of the stops: its antenna and how it is turned
/// there. What single antennas differ by from the pattern is not known to a mapper, so that it is not in here.
#[derive(Clone, Debug)]
pub struct SectorGains {
    antenna: Arc<Antenna>,
    orientation: Orientation,
    identities: Vec<u8>,
}

/// The antenna of a listener and how it is turned in the frame of the stops, as a file has it: one of `sectors` and
/// `code_book`.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ListenerAntennaConfig {
    /// How the antenna is turned in the frame of the stops; level if absent, with azimuth 0 along x.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "is_level"))]
    pub orientation: OrientationConfig,
    /// Sectors of equal width.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub sectors: Option<AntennaSectorsConfig>,
    /// Measured sectors.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub code_book: Option<CodeBookConfig>,
}

#[cfg(feature = "config")]
fn is_level(orientation: &OrientationConfig) -> bool {
    *orientation == OrientationConfig::default()
}

impl SectorGains {
    /// The gains of `antenna`, turned by `orientation`.
    #[must_use]
    pub fn new(antenna: Arc<Antenna>, orientation: Orientation) -> Self {
        let identities = antenna.sectors().iter().map(|sector| sector.sector).collect();
        Self { antenna, orientation, identities }
    }

    /// The gains of the antenna that `config` describes; its file paths are among `files`.
    ///
    /// # Errors
    /// If there is no antenna or more than one, a value is invalid, or a file cannot be read or has a flaw.
    pub fn read(config: &ListenerAntennaConfig, files: &Files) -> Result<Self, SettingError> {
        let antenna = match (&config.sectors, &config.code_book) {
            (Some(sectors), None) => AntennaConfig::Sectors(sectors.clone()),
            (None, Some(book)) => AntennaConfig::CodeBook(book.clone()),
            (None, None) => return Err(SettingError::missing("sectors", "`sectors` or `code_book`")),
            (Some(_), Some(_)) => {
                return Err(SettingError::conflict("code_book", "`sectors`", "set one of them"));
            }
        };
        let orientation = config.orientation.try_into().map_err(|why: SettingError| why.within("orientation"))?;
        Ok(Self::new(Arc::new(Antenna::read(&antenna, files)?), orientation))
    }

    /// The settings from which they are read again, without a file; `None` of an antenna without sectors.
    #[must_use]
    pub fn config(&self) -> Option<ListenerAntennaConfig> {
        let turned = ListenerAntennaConfig { orientation: self.orientation.config(), ..Default::default() };
        match self.antenna.config() {
            AntennaConfig::Omnidirectional(_) => None,
            AntennaConfig::Sectors(sectors) => Some(ListenerAntennaConfig { sectors: Some(sectors), ..turned }),
            AntennaConfig::CodeBook(book) => Some(ListenerAntennaConfig { code_book: Some(book), ..turned }),
        }
    }

    /// The directions of the sectors in the frame of the stops: those where each is the best one.
    #[must_use]
    pub fn directions(&self) -> SectorDirections {
        turned(&self.antenna, self.orientation)
    }

    /// The identities of the sectors in the log, ascending.
    #[must_use]
    pub fn identities(&self) -> &[u8] {
        &self.identities
    }

    /// The antenna.
    #[must_use]
    pub fn antenna(&self) -> &Arc<Antenna> {
        &self.antenna
    }

    /// How the antenna is turned in the frame of the stops.
    #[must_use]
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// The gains in a direction (dBi), in the order of [`identities`](Self::identities). `direction` is a unit vector in
    /// the frame of the stops, from the listener to the node.
    pub fn all_dbi(&self, direction: Position, gains: &mut Vec<f64>) {
        let direction = self.orientation.to_antenna_frame(direction);
        gains.clear();
        gains.extend((0..self.antenna.sector_count()).map(|sector| self.antenna.gain(sector, direction).0));
    }
}

impl PartialEq for SectorGains {
    /// Whether they are of antennas with the same settings and measured gains, turned alike.
    fn eq(&self, other: &Self) -> bool {
        let is_same = Arc::ptr_eq(&self.antenna, &other.antenna);
        self.orientation == other.orientation && (is_same || self.antenna.config() == other.antenna.config())
    }
}
