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
}

/// A unit, the code of `$INSUNITS`, its name and its sign, and its length (m).
type UnitRow = (LengthUnit, i64, [&'static str; 2], f64);

/// All units.
const UNITS: [UnitRow; 8] = [
    (LengthUnit::Millimetre, 4, ["millimetres", "mm"], 1e-3),
    (LengthUnit::Centimetre, 5, ["centimetres", "cm"], 1e-2),
    (LengthUnit::Decimetre, 14, ["decimetres", "dm"], 1e-1),
    (LengthUnit::Metre, 6, ["metres", "m"], 1.0),
    (LengthUnit::Kilometre, 7, ["kilometres", "km"], 1e3),
    (LengthUnit::Inch, 1, ["inches", "in"], 0.0254),
    (LengthUnit::Foot, 2, ["feet", "ft"], 0.3048),
    (LengthUnit::Yard, 10, ["yards", "yd"], 0.9144),
];

impl FromStr for LengthUnit {
    type Err = String;

    /// The unit with this sign: `mm`, `cm`, `dm`, `m`, `km`, `in`, `ft` or `yd`.
    fn from_str(text: &str) -> Result<Self, String> {
        let known = UNITS.iter().find(|(_, _, [_, sign], _)| *sign == text);
        known.map(|(unit, ..)| *unit).ok_or_else(|| {
            let signs = UNITS.map(|(_, _, [_, sign], _)| sign);
            format!("found the unit `{text}`; allowed: {}", signs.join(", "))
        })
    }
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
