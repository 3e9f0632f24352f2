//! Units of lengths.

use std::str::FromStr;

/// A unit of lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Decimetres.
    Decimetre,
    /// Metres.
    Metre,
    /// Kilometres.
    Kilometre,
    /// Inches.
    Inch,
    /// Feet.
    Foot,
    /// Yards.
    Yard,
    /// Miles.
    Mile,
    /// Thousandths of an inch.
    Mil,
    /// Micrometres.
    Micrometre,
    /// Decametres.
    Decametre,
    /// Hectometres.
    Hectometre,
    /// Feet of surveys in the United States, 1200/3937 m.
    UsSurveyFoot,
    /// Inches of such feet.
    UsSurveyInch,
    /// Yards of such feet.
    UsSurveyYard,
    /// Miles of such feet.
    UsSurveyMile,
}

/// A unit, the code of `$INSUNITS`, its name and its sign, and its length (m).
type UnitRow = (LengthUnit, i64, [&'static str; 2], f64);

/// The foot of surveys in the United States (m): Mendenhall Order of 1893.
const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// All units, with the code of `$INSUNITS` ("DXF Reference", AutoCAD 2018, section HEADER), the name and the length (m).
const UNITS: [UnitRow; 17] = [
    (LengthUnit::Millimetre, 4, ["millimetres", "mm"], 1e-3),
    (LengthUnit::Centimetre, 5, ["centimetres", "cm"], 1e-2),
    (LengthUnit::Decimetre, 14, ["decimetres", "dm"], 1e-1),
    (LengthUnit::Metre, 6, ["metres", "m"], 1.0),
    (LengthUnit::Kilometre, 7, ["kilometres", "km"], 1e3),
    (LengthUnit::Inch, 1, ["inches", "in"], 0.0254),
    (LengthUnit::Foot, 2, ["feet", "ft"], 0.3048),
    (LengthUnit::Yard, 10, ["yards", "yd"], 0.9144),
    (LengthUnit::Mile, 3, ["miles", "mi"], 1609.344),
    (LengthUnit::Mil, 9, ["mils", "mil"], 25.4e-6),
    (LengthUnit::Micrometre, 13, ["micrometres", "um"], 1e-6),
    (LengthUnit::Decametre, 15, ["decametres", "dam"], 10.0),
    (LengthUnit::Hectometre, 16, ["hectometres", "hm"], 100.0),
    (LengthUnit::UsSurveyFoot, 21, ["US survey feet", "us-ft"], US_SURVEY_FOOT_M),
    (LengthUnit::UsSurveyInch, 22, ["US survey inches", "us-in"], US_SURVEY_FOOT_M / 12.0),
    (LengthUnit::UsSurveyYard, 23, ["US survey yards", "us-yd"], US_SURVEY_FOOT_M * 3.0),
    (LengthUnit::UsSurveyMile, 24, ["US survey miles", "us-mi"], US_SURVEY_FOOT_M * 5280.0),
];

impl FromStr for LengthUnit {
    type Err = String;

    /// The unit with this sign, such as `m`, `mm` or `ft`.
    fn from_str(text: &str) -> Result<Self, String> {
        let known = UNITS.iter().find(|(_, _, [_, sign], _)| *sign == text);
        known.map(|(unit, ..)| *unit).ok_or_else(|| {
            let signs = UNITS.map(|(_, _, [_, sign], _)| sign);
            format!("found the unit `{text}`; allowed: {}", signs.join(", "))
        })
    }
}

/// Codes of units in which no building is drawn.
const UNUSUAL: [(i64, &str); 7] = [
    (8, "microinches"),
    (11, "angstroms"),
    (12, "nanometres"),
    (17, "gigametres"),
    (18, "astronomical units"),
    (19, "light years"),
    (20, "parsecs"),
];

/// What a drawing says whose code is neither 0 nor that of a unit of buildings.
pub(super) fn unusual(code: i64) -> String {
    let named = UNUSUAL.iter().find(|(of, _)| *of == code);
    let said = named.map_or_else(
        || format!("$INSUNITS is {code}, which is the code of no unit"),
        |(_, name)| format!("its lengths are in {name} ($INSUNITS is {code}), in which no building is drawn"),
    );
    format!("{said}: option `unit` says the right unit")
}

impl LengthUnit {
    /// The unit with this code of `$INSUNITS`; `None` for 0, which says none, and for units of no building.
    pub(super) fn of_code(code: i64) -> Option<Self> {
        UNITS.iter().find(|(_, of, ..)| *of == code).map(|(unit, ..)| *unit)
    }

    fn row(self) -> &'static UnitRow {
        UNITS.iter().find(|(unit, ..)| *unit == self).expect("each unit has its row")
    }

    /// Its name in the plural.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().2[0]
    }

    /// Its length (m).
    #[must_use]
    pub fn metres(self) -> f64 {
        self.row().3
    }
}
