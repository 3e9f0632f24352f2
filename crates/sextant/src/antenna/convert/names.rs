//! What a measurement calls its columns or variables.

use std::str::FromStr;

/// What a measurement calls its columns or variables, where the usual names do not fit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceNames {
    /// The identities of sectors.
    pub sector: Option<String>,
    /// The azimuths (degrees).
    pub azimuth: Option<String>,
    /// The elevations (degrees).
    pub elevation: Option<String>,
    /// The gains.
    pub gain: Option<String>,
    /// The identity whose rows are the quasi-omnidirectional pattern.
    pub quasi_omni: Option<u8>,
    /// Whether the elevations are angles from the zenith (degrees).
    pub from_zenith: bool,
    /// The axes of an array of gains, where their lengths do not tell them.
    pub order: Option<ArrayOrder>,
}

/// An axis of an array of gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Sector,
    Azimuth,
    Elevation,
}

/// The order of the axes of an array of gains, written as `sector,elevation,azimuth`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArrayOrder(pub(super) [Axis; 3]);

impl FromStr for ArrayOrder {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let axis = |word: &str| match word.trim() {
            "sector" => Some(Axis::Sector),
            "azimuth" => Some(Axis::Azimuth),
            "elevation" => Some(Axis::Elevation),
            _ => None,
        };
        let axes: Vec<Axis> = text.split(',').filter_map(axis).collect();
        match axes[..] {
            [a, b, c] if a != b && b != c && a != c && text.split(',').count() == 3 => Ok(Self([a, b, c])),
            _ => Err(format!("`{text}`; allowed: `sector`, `azimuth` and `elevation`, each once, with commas")),
        }
    }
}

/// What a column or a variable is, by its usual names.
pub(super) const SECTOR: [&str; 7] = ["sector", "sectors", "sectorid", "sectorids", "beam", "beamid", "sid"];
pub(super) const AZIMUTH: [&str; 6] = ["azimuth", "azimuths", "azimut", "az", "phi", "azimuthangle"];
pub(super) const ELEVATION: [&str; 6] = ["elevation", "elevations", "el", "elev", "theta", "elevationangle"];
pub(super) const GAIN: [&str; 8] = ["gain", "gains", "gainlinear", "snr", "rssi", "power", "pattern", "patterns"];

/// A name without case, signs and unit: `Azimuth (deg)` is `azimuth`.
pub(super) fn plain(name: &str) -> String {
    let last = name.rsplit('.').next().unwrap_or(name);
    let letters: String = last.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
    for unit in ["degrees", "degree", "deg", "dbi", "dbm", "db"] {
        if let Some(rest) = letters.strip_suffix(unit)
            && !rest.is_empty()
        {
            return rest.to_owned();
        }
    }
    letters
}

/// The place of the column or variable called `given`, or else of the first with a usual name.
pub(super) fn find(names: &[&str], given: Option<&str>, usual: &[&str]) -> Option<usize> {
    match given {
        Some(given) => names.iter().position(|name| *name == given),
        None => usual.iter().find_map(|usual| names.iter().position(|name| plain(name) == *usual)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_without_case_signs_and_units() {
        let names = ["Sector ID", "azimuth_deg", "Elevation (degrees)", "SNR [dB]"];
        let found = [&SECTOR[..], &AZIMUTH, &ELEVATION, &GAIN].map(|usual| find(&names, None, usual));
        assert_eq!(found, [Some(0), Some(1), Some(2), Some(3)]);
        assert_eq!(find(&names, Some("azimuth"), &AZIMUTH), None, "a given name is exact");
        assert_eq!((plain("book.phi_deg"), plain("dB")), ("phi".into(), "db".into()));
    }

    #[test]
    fn an_order_has_each_axis_once() {
        assert_eq!(
            "sector,elevation,azimuth".parse(),
            Ok(ArrayOrder([Axis::Sector, Axis::Elevation, Axis::Azimuth]))
        );
        for bad in ["sector,azimuth", "sector,sector,azimuth", "a,b,c", "sector,azimuth,elevation,gain"] {
            assert!(bad.parse::<ArrayOrder>().is_err(), "{bad}");
        }
    }
}
