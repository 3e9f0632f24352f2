//! The messages of networks and of antennas with sectors.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;
use sextant_channel::SectorConfig;

use super::descriptor::{self, Declaration};

/// The networks that robots survey, if there are several.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct NetworksMessage {
    /// Their names. The log of the first one has the topics of a log of one network.
    #[prost(string, repeated, tag = "1")]
    pub(crate) names: Vec<String>,
}

/// The directions of one antenna sector of the robots, in the frame of the stops.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SectorMessage {
    /// Identity of the sector in the log, 0 to 255.
    #[prost(uint32, tag = "1")]
    pub(crate) sector: u32,
    /// Azimuth at which it begins, counterclockwise from x (degrees).
    #[prost(double, tag = "2")]
    pub(crate) azimuth_from_deg: f64,
    /// Azimuth at which it ends, counterclockwise from its beginning (degrees).
    #[prost(double, tag = "3")]
    pub(crate) azimuth_to_deg: f64,
    /// Lowest elevation, up from the horizontal plane (degrees).
    #[prost(double, tag = "4")]
    pub(crate) elevation_from_deg: f64,
    /// Highest elevation (degrees).
    #[prost(double, tag = "5")]
    pub(crate) elevation_to_deg: f64,
}

impl From<&SectorConfig> for SectorMessage {
    fn from(config: &SectorConfig) -> Self {
        let &SectorConfig { sector, azimuth_from_deg, azimuth_to_deg, elevation_from_deg, elevation_to_deg } = config;
        Self { sector: sector.into(), azimuth_from_deg, azimuth_to_deg, elevation_from_deg, elevation_to_deg }
    }
}

impl TryFrom<SectorMessage> for SectorConfig {
    type Error = String;

    fn try_from(message: SectorMessage) -> Result<Self, String> {
        let SectorMessage { sector, azimuth_from_deg, azimuth_to_deg, elevation_from_deg, elevation_to_deg } =
            message;
        let sector = u8::try_from(sector).map_err(|_| format!("sector {sector}; allowed: 0 to 255"))?;
        Ok(Self { sector, azimuth_from_deg, azimuth_to_deg, elevation_from_deg, elevation_to_deg })
    }
}

recorded! {
    "sextant_networks.proto";
    NetworksMessage = "Networks": ["names" = 1 Strings];
    SectorMessage = "Sector": [
        "sector" = 1 Uint32, "azimuth_from_deg" = 2 Double, "azimuth_to_deg" = 3 Double,
        "elevation_from_deg" = 4 Double, "elevation_to_deg" = 5 Double,
    ];
}
