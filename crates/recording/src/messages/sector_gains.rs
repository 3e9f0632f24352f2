//! The message of the gains of the robots' antenna.

use std::sync::Arc;

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;
use sextant_channel::{Antenna, ListenerAntennaConfig, Orientation, OrientationConfig, SectorGains};
use sextant_kernel::Files;

use super::super::antenna_text;
use super::descriptor::{self, Declaration};

/// The antenna of the robots whose sectors the log has, and how it is turned in the frame of the stops.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SectorGainsMessage {
    /// The settings of the antenna as a text of TOML: the table `sectors` or `code_book`, with the grid and the gains of a
    /// code book in it.
    #[prost(string, tag = "1")]
    pub(crate) antenna: String,
    /// Rotation about the vertical axis, counterclockwise seen from above (rad).
    #[prost(double, tag = "2")]
    pub(crate) yaw_rad: f64,
    /// Tilt of the forward axis above the horizontal plane (rad).
    #[prost(double, tag = "3")]
    pub(crate) pitch_rad: f64,
    /// Rotation about the forward axis, the left side up (rad).
    #[prost(double, tag = "4")]
    pub(crate) roll_rad: f64,
}

impl SectorGainsMessage {
    /// These gains; `None` of an antenna without sectors.
    pub(crate) fn new(gains: &SectorGains) -> Option<Self> {
        let level = SectorGains::new(Arc::clone(gains.antenna()), Orientation::LEVEL);
        let [yaw_rad, pitch_rad, roll_rad] = gains.orientation().angles_rad();
        Some(Self { antenna: antenna_text::write(&level)?, yaw_rad, pitch_rad, roll_rad })
    }

    /// The gains; an error message if they are invalid.
    pub(crate) fn gains(&self) -> Result<SectorGains, String> {
        let angles_rad = [self.yaw_rad, self.pitch_rad, self.roll_rad];
        if let Some(angle) = angles_rad.iter().find(|angle| !angle.is_finite()) {
            return Err(format!("an antenna turned by {angle} rad; allowed: finite angles"));
        }
        let config: ListenerAntennaConfig = toml::from_str(&self.antenna).map_err(|why| why.to_string())?;
        if config.orientation != OrientationConfig::default() {
            return Err("the settings of the antenna turn it; allowed: the fields of the message do".to_owned());
        }
        if config.code_book.as_ref().is_some_and(|book| book.file.is_some()) {
            return Err("the settings of the antenna name a file; allowed: the grid and its gains".to_owned());
        }
        let level = SectorGains::read(&config, &Files::default()).map_err(|why| why.to_string())?;
        let antenna: &Arc<Antenna> = level.antenna();
        Ok(SectorGains::new(Arc::clone(antenna), Orientation::new(self.yaw_rad, self.pitch_rad, self.roll_rad)))
    }
}

recorded! {
    "sextant_sector_gains.proto";
    SectorGainsMessage = "SectorGains": [
        "antenna" = 1 String, "yaw_rad" = 2 Double, "pitch_rad" = 3 Double, "roll_rad" = 4 Double,
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(antenna: &str, yaw_rad: f64) -> SectorGainsMessage {
        SectorGainsMessage { antenna: antenna.to_owned(), yaw_rad, ..SectorGainsMessage::default() }
    }

    #[test]
    fn gains_are_read_back_equal() {
        let book = "[code_book]\nazimuths_deg = [-120, 0, 120]\nelevations_deg = [0]\noutside_gain_dbi = -inf\n\
            sectors = [{ sector = 3, gain_dbi = [[1.1, 2.2, 3.3]] }, { sector = 61, gain_dbi = [[4, 0.1, -7e-3]] }]";
        for antenna in ["sectors = { azimuth_sectors = 6, first_azimuth_deg = 0.3 }", book] {
            let gains = message(antenna, 0.1).gains().unwrap();
            let written = SectorGainsMessage::new(&gains).unwrap();
            assert_eq!(written.gains().unwrap(), gains);
            assert_eq!(SectorGainsMessage::new(&written.gains().unwrap()).unwrap(), written);
        }
    }

    #[test]
    fn invalid_antennas_are_rejected() {
        let problem = |antenna: &str, yaw_rad: f64| message(antenna, yaw_rad).gains().unwrap_err();
        assert!(problem("sectors.azimuth_sectors = 6", f64::NAN).contains("finite"));
        assert!(problem("", 0.0).contains("code_book"));
        assert!(problem("sectors.azimuth_sectors = 0", 0.0).contains("1 to 64"));
        assert!(problem("code_book.file = '/etc/passwd'", 0.0).contains("file"));
        assert!(problem("sectors.azimuth_sectors = 6\norientation.yaw_deg = 3", 0.0).contains("fields"));
        assert!(problem("beams = 3", 0.0).contains("beams"));
    }
}
