//! The sectors of a listener: their directions, and their gains if they are known.

use std::sync::Arc;

use sextant_kernel::SettingError;

use crate::antenna::sector::{EvenSectorsConfig, SectorConfig, SectorDirections, runs};
use crate::antenna::sector_gains::SectorGains;

/// The sectors of a listener, by their identities, with the gains of its antenna if they are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SectorTable {
    directions: SectorDirections,
    gains: Option<Arc<SectorGains>>,
}

impl SectorTable {
    /// A table of these sectors. They may overlap.
    ///
    /// # Errors
    /// `[i].KEY` if a value of sector i of the list is invalid or its identity is already used.
    pub fn new(sectors: impl IntoIterator<Item = SectorConfig>) -> Result<Self, SettingError> {
        SectorDirections::new(sectors).map(Self::from)
    }

    /// The same sectors with the gains of their antenna.
    ///
    /// # Errors
    /// If the antenna has other sectors.
    pub fn with_gains(self, gains: SectorGains) -> Result<Self, SettingError> {
        if !gains.identities().iter().eq(self.iter().map(|sector| &sector.sector)) {
            let of_antenna = runs(gains.identities().iter().copied());
            return Err(SettingError::new("antenna", format!("sectors {of_antenna}"), self.identities()));
        }
        Ok(Self { gains: Some(Arc::new(gains)), ..self })
    }

    /// The gains of the antenna, if they are known.
    #[must_use]
    pub fn gains(&self) -> Option<&SectorGains> {
        self.gains.as_deref()
    }

    /// Number of sectors.
    #[must_use]
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Whether there are no sectors.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    /// The sectors, by ascending identity.
    pub fn iter(&self) -> impl Iterator<Item = &SectorConfig> {
        self.directions.iter()
    }

    /// Whether the table has the sector `id`.
    #[must_use]
    pub fn contains(&self, id: u8) -> bool {
        self.directions.contains(id)
    }

    /// The identities, as a person would write them: `0 to 7, 9`.
    #[must_use]
    pub fn identities(&self) -> String {
        self.directions.identities()
    }
}

impl From<SectorDirections> for SectorTable {
    /// Sectors whose gains are unknown.
    fn from(directions: SectorDirections) -> Self {
        Self { directions, gains: None }
    }
}

impl From<SectorGains> for SectorTable {
    /// The directions of the sectors in the frame of the stops, where each is the best one, with these gains.
    fn from(gains: SectorGains) -> Self {
        Self { directions: gains.directions(), gains: Some(Arc::new(gains)) }
    }
}

impl TryFrom<EvenSectorsConfig> for SectorTable {
    type Error = SettingError;

    fn try_from(config: EvenSectorsConfig) -> Result<Self, SettingError> {
        SectorDirections::try_from(config).map(Self::from)
    }
}
