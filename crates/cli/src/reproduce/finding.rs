//! What runs say of a conclusion.

use crate::sweep::Mean;

/// Whether something is so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is so: the whole 95 % interval of each comparison says so.
    Holds,
    /// It is not so: the whole 95 % interval of a comparison says so.
    DoesNotHold,
    /// The runs do not tell: a comparison is within its interval.
    CannotBeTold,
}

/// What the runs say of a conclusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Whether it holds.
    pub verdict: Verdict,
    /// By how much, in the comparison that decides: above 0 on the side of the conclusion.
    pub margin: Mean,
    /// Unit of the margin.
    pub unit: &'static str,
}

impl Verdict {
    /// The verdict in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
            Self::CannotBeTold => "cannot be told",
        }
    }
}

impl Finding {
    /// The finding of several comparisons, all of which must be on the side of the conclusion; `None` of none.
    pub(super) fn of(margins: &[Mean], factor: f64, unit: &'static str) -> Option<Self> {
        let least = |end: fn(&Mean) -> f64| margins.iter().min_by(|a, b| end(a).total_cmp(&end(b)));
        let (by_low_end, by_high_end) = (least(|margin| interval(margin).0)?, least(|margin| interval(margin).1)?);
        let (verdict, margin) = if interval(by_high_end).1 <= 0.0 {
            (Verdict::DoesNotHold, by_high_end)
        } else if interval(by_low_end).0 > 0.0 {
            (Verdict::Holds, by_low_end)
        } else {
            (Verdict::CannotBeTold, by_low_end)
        };
        Some(Self { verdict, margin: margin.times(factor), unit })
    }
}

/// The ends of the 95 % interval; of a single run all numbers.
fn interval(mean: &Mean) -> (f64, f64) {
    let half_width = mean.half_width_95.unwrap_or(f64::INFINITY);
    (mean.mean - half_width, mean.mean + half_width)
}
