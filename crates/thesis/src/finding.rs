//! The result of a check of a conclusion.

use sextant_study::sweep::Mean;

/// Whether a conclusion holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It holds: the 95 % interval of each comparison supports it completely.
    Holds,
    /// It does not hold or cannot be told, but holds under a named reading of what the thesis leaves open.
    HoldsForReading,
    /// It does not hold: the 95 % interval of a comparison contradicts it completely.
    DoesNotHold,
    /// The runs do not decide: the interval of a comparison contains 0.
    CannotBeTold,
}

/// The result of a check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Whether it holds.
    pub verdict: Verdict,
    /// Margin of the comparison that decides; above 0 if it supports the conclusion.
    pub margin: Mean,
    /// Unit of the margin.
    pub unit: &'static str,
}

impl Verdict {
    /// All verdicts.
    pub const ALL: [Self; 4] = [Self::Holds, Self::HoldsForReading, Self::DoesNotHold, Self::CannotBeTold];

    /// The verdict in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::HoldsForReading => "holds for a reading",
            Self::DoesNotHold => "does not hold",
            Self::CannotBeTold => "cannot be told",
        }
    }
}

impl Finding {
    /// The finding of several comparisons, all of which must support the conclusion; `None` if there are none.
    pub(super) fn of(margins: &[Mean], factor: f64, unit: &'static str) -> Option<Self> {
        let least = |end: fn(&Mean) -> f64| margins.iter().min_by(|a, b| end(a).total_cmp(&end(b)));
        let (by_low_end, by_high_end) = (least(|margin| interval(margin)[0])?, least(|margin| interval(margin)[1])?);
        let (verdict, margin) = if interval(by_high_end)[1] <= 0.0 {
            (Verdict::DoesNotHold, by_high_end)
        } else if interval(by_low_end)[0] > 0.0 {
            (Verdict::Holds, by_low_end)
        } else {
            (Verdict::CannotBeTold, by_low_end)
        };
        Some(Self { verdict, margin: margin.times(factor), unit })
    }
}

/// The ends of the 95 % interval; for a single run it contains all numbers.
fn interval(mean: &Mean) -> [f64; 2] {
    mean.interval_95().unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
}
