//! Units of lengths.

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

/// All units, with the code of `$INSUNITS`, the name and the length (m).
const UNITS: [(LengthUnit, i64, &str, f64); 8] = [
    (LengthUnit::Millimetre, 4, "millimetres", 1e-3),
    (LengthUnit::Centimetre, 5, "centimetres", 1e-2),
    (LengthUnit::Decimetre, 14, "decimetres", 1e-1),
    (LengthUnit::Metre, 6, "metres", 1.0),
    (LengthUnit::Kilometre, 7, "kilometres", 1e3),
    (LengthUnit::Inch, 1, "inches", 0.0254),
    (LengthUnit::Foot, 2, "feet", 0.3048),
    (LengthUnit::Yard, 10, "yards", 0.9144),
];

impl LengthUnit {
    /// The unit with this code of `$INSUNITS`; `None` for 0, which says none, and for units of no building.
    pub(super) fn of_code(code: i64) -> Option<Self> {
        UNITS.iter().find(|(_, of, ..)| *of == code).map(|(unit, ..)| *unit)
    }

    fn row(self) -> &'static (Self, i64, &'static str, f64) {
        UNITS.iter().find(|(unit, ..)| *unit == self).expect("each unit has its row")
    }

    /// Its name in the plural.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().2
    }

    /// Its length (m).
    #[must_use]
    pub fn metres(self) -> f64 {
        self.row().3
    }
}
