//! What a measurement calls its columns or variables.

use std::str::FromStr;

use super::ConvertError;
use super::gain_unit::GainUnit;

/// What a measurement calls its columns or variables, where the usual names do not fit, and what its names do not say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceNames {
    /// The identities of sectors.
    pub sector: Option<String>,
    /// The azimuths.
    pub azimuth: Option<String>,
    /// The elevations: angles from the horizontal plane, whatever their name.
    pub elevation: Option<String>,
    /// The gains.
    pub gain: Option<String>,
    /// The identity whose rows are the quasi-omnidirectional pattern.
    pub quasi_omni: Option<u8>,
    /// Whether the elevations are angles from the zenith.
    pub from_zenith: bool,
    /// The unit of all angles.
    pub angles: Option<AngleUnit>,
    /// The axes of an array of gains, where their lengths do not tell them.
    pub order: Option<ArrayOrder>,
    /// Which way azimuths turn in a format that does not say.
    pub turning: Option<Turning>,
}

impl SourceNames {
    /// Refuses options that have no effect on a format.
    ///
    /// # Errors
    /// If one of them is given.
    pub(super) fn check(&self, format: Format) -> Result<(), ConvertError> {
        let (tables, arrays) = ("only with a table or a MATLAB file", "only with a MATLAB file");
        let has_names = matches!(format, Format::Matlab | Format::Table);
        let given = [
            ("sector", self.sector.is_some(), has_names, tables),
            ("azimuth", self.azimuth.is_some(), has_names, tables),
            ("elevation", self.elevation.is_some(), has_names, tables),
            ("gain", self.gain.is_some(), has_names, tables),
            ("zenith", self.from_zenith, has_names, tables),
            (self.angles.map_or("degrees", AngleUnit::word), self.angles.is_some(), has_names, tables),
            ("order", self.order.is_some(), format == Format::Matlab, arrays),
            ("azimuths", self.turning.is_some(), format == Format::Planet, "only with a pattern of MSI and Planet"),
        ];
        match given.into_iter().find(|&(_, is_given, has_effect, _)| is_given && !has_effect) {
            Some((option, .., allowed)) => Err(ConvertError::Option { option, found: "given", allowed }),
            None => Ok(()),
        }
    }
}

/// The format of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// Variables and arrays of a MATLAB file.
    Matlab,
    /// A table with named columns.
    Table,
    /// A code book of ns-3 in numbers.
    Ns3,
    /// A pattern of MSI and Planet.
    Planet,
}

/// Which way azimuths turn, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// To the right, as on a compass.
    Clockwise,
    /// To the left, as in code books.
    Counterclockwise,
}

/// A unit of angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleUnit {
    /// 360 are once around.
    Degrees,
    /// 2π are once around.
    Radians,
}

impl AngleUnit {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Self::Degrees => "degrees",
            Self::Radians => "radians",
        }
    }
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
pub(super) const AZIMUTH: [&str; 7] = ["azimuth", "azimuths", "azimut", "az", "phi", "phis", "azimuthangle"];
pub(super) const ELEVATION: [&str; 15] = [
    "elevation",
    "elevations",
    "el",
    "elev",
    "elevationangle",
    "theta",
    "thetas",
    "thetaangle",
    "zenith",
    "zenithangle",
    "zenithangles",
    "polar",
    "polarangle",
    "inclination",
    "colatitude",
];
/// The total gain as measurements and the programs CST, HFSS and FEKO call it: not that of one polarisation.
pub(super) const GAIN: [&str; 24] = [
    "gain",
    "gains",
    "gainlinear",
    "snr",
    "rssi",
    "power",
    "pattern",
    "patterns",
    "absgain",
    "absrealizedgain",
    "absrealisedgain",
    "absieeegain",
    "absdir",
    "absdirectivity",
    "realizedgain",
    "realisedgain",
    "directivity",
    "gaintotal",
    "realizedgaintotal",
    "realisedgaintotal",
    "directivitytotal",
    "dirtotal",
    "totalgain",
    "total",
];

/// The name of a column or a variable in its parts: `Abs(Realized Gain)[dBi  ]` is `absrealizedgain` in `dbi`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ColumnName {
    /// Without case, signs and unit.
    pub(super) plain: String,
    /// In small letters without signs; empty if there is none, or nothing in its brackets.
    unit: String,
    /// Whether the name has brackets for a unit.
    has_brackets: bool,
    /// Whether HFSS wrote the name: `dB(GainTotal) []`.
    is_decibels: bool,
}

/// Units at the end of names.
const UNITS: [&str; 8] = ["degrees", "degree", "deg", "radians", "radian", "rad", "dbi", "dbm"];

impl ColumnName {
    pub(super) fn of(name: &str) -> Self {
        // A field of a structure of MATLAB: `phi_deg` of `book.phi_deg`, but not what follows the point of `Phi [deg.]`.
        let is_path = name.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '.'));
        let last = if is_path { name.rsplit('.').next().unwrap_or(name) } else { name };
        // HFSS adds what else varies: `dB(GainTotal) [] - Freq='2.4GHz'`.
        let last = last.split(" - ").next().unwrap_or(last);
        let bracketed = last.rfind('[').and_then(|at| Some((&last[..at], last[at + 1..].split_once(']')?.0)));
        let (base, bracket) = bracketed.map_or((last, None), |(base, unit)| (base, Some(unit)));
        let mut plain = letters(base);
        let decibels = ["db", "db10", "db20"]
            .into_iter()
            .find(|word| base.trim().to_lowercase().starts_with(&format!("{word}(")));
        if let Some(word) = decibels {
            plain = plain.trim_start_matches(word).to_owned();
        }
        let mut unit = bracket.map(letters).unwrap_or_default();
        if unit.is_empty() {
            for known in UNITS.iter().copied().chain(["db"]) {
                if let Some(rest) = plain.strip_suffix(known).filter(|rest| !rest.is_empty()) {
                    (unit, plain) = (known.to_owned(), rest.to_owned());
                    break;
                }
            }
        }
        if bracket.is_some_and(|bracket| bracket.contains('°')) {
            unit = "deg".to_owned();
        }
        Self { plain, unit, has_brackets: bracket.is_some(), is_decibels: decibels.is_some() }
    }

    /// The unit of angles that the name says.
    pub(super) fn angle_unit(&self) -> Option<AngleUnit> {
        match self.unit.as_str() {
            "deg" | "degree" | "degrees" => Some(AngleUnit::Degrees),
            "rad" | "radian" | "radians" => Some(AngleUnit::Radians),
            _ => None,
        }
    }

    /// The unit of gains that the name says. What programs call gain and directivity is that over an isotropic antenna; a
    /// signal-to-noise ratio or a received strength is measured in decibels over something else.
    pub(super) fn gain_unit(&self) -> Option<GainUnit> {
        let is_total = ["gaintotal", "realizedgaintotal", "realisedgaintotal", "directivitytotal", "dirtotal"]
            .contains(&self.plain.as_str());
        match self.unit.as_str() {
            "dbi" => Some(GainUnit::Dbi),
            "db" | "dbm" => Some(GainUnit::Relative),
            "" if self.plain.contains("linear") => Some(GainUnit::Linear),
            "" if self.is_decibels && is_total => Some(GainUnit::Dbi),
            "" if self.is_decibels => Some(GainUnit::Relative),
            // CST and HFSS write factors with empty brackets.
            "" if self.has_brackets && (is_total || self.plain.starts_with("abs")) => Some(GainUnit::Linear),
            "" if ["snr", "rssi"].contains(&self.plain.as_str()) => Some(GainUnit::Relative),
            _ => None,
        }
    }

    /// The unit in the name if it is none of gains: field strengths, for example.
    pub(super) fn other_unit(&self) -> Option<&str> {
        let is_known = ["", "db", "dbi", "dbm", "linear"].contains(&self.unit.as_str());
        (!is_known).then_some(self.unit.as_str())
    }
}

/// Letters and digits of a name, in small ones. Greek letters of angles are their names.
fn letters(text: &str) -> String {
    let text = text.replace(['φ', 'ϕ', 'Φ'], "phi").replace(['θ', 'ϑ', 'Θ'], "theta");
    text.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase()
}

/// A name without case, signs and unit: `Azimuth (deg)` is `azimuth`.
pub(super) fn plain(name: &str) -> String {
    ColumnName::of(name).plain
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
    fn names_of_programs_have_their_units() {
        use AngleUnit::{Degrees, Radians};
        for (name, plain_name, angle) in [
            ("Phi   [deg.]", "phi", Some(Degrees)),
            ("Theta [deg.]", "theta", Some(Degrees)),
            ("phi_deg", "phi", Some(Degrees)),
            ("Phi[rad]", "phi", Some(Radians)),
            ("theta (rad.)", "theta", Some(Radians)),
            ("Azimuth [°]", "azimuth", Some(Degrees)),
            ("φ", "phi", None),
            ("theta", "theta", None),
        ] {
            let found = ColumnName::of(name);
            assert_eq!((found.plain.as_str(), found.angle_unit()), (plain_name, angle), "{name}");
        }
        use GainUnit::{Dbi, Linear, Relative};
        for (name, plain_name, unit) in [
            ("Abs(Gain)[dBi]", "absgain", Some(Dbi)),
            ("Abs(Realized Gain)[dBi  ]", "absrealizedgain", Some(Dbi)),
            ("Abs(Dir.)[dBi   ]", "absdir", Some(Dbi)),
            ("Abs(Gain)[      ]", "absgain", Some(Linear)),
            ("dB(GainTotal) [] - Freq='2.4GHz'", "gaintotal", Some(Dbi)),
            ("dB(RealizedGainTotal)", "realizedgaintotal", Some(Dbi)),
            ("GainTotal []", "gaintotal", Some(Linear)),
            ("Gain(Total)", "gaintotal", None),
            ("Directivity(Total)", "directivitytotal", None),
            ("book.SNR_dB", "snr", Some(Relative)),
            ("snr", "snr", Some(Relative)),
            ("gain", "gain", None),
            ("power", "power", None),
            ("gain_linear", "gainlinear", Some(Linear)),
            ("Abs(E)[V/m]", "abse", None),
        ] {
            let found = ColumnName::of(name);
            assert_eq!((found.plain.as_str(), found.gain_unit()), (plain_name, unit), "{name}");
        }
        assert_eq!(ColumnName::of("Abs(E)[V/m]").other_unit(), Some("vm"));
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
