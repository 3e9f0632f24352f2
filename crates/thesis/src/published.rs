//! Published values.

use super::better::Better;

/// A value of the thesis and its source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Published {
    /// A number as printed, or a conclusion in a few words.
    pub value: String,
    /// The table, figure or section.
    pub source: String,
}

impl Published {
    /// The `value` from `source`.
    pub fn new(value: impl Into<String>, source: impl Into<String>) -> Self {
        Self { value: value.into(), source: source.into() }
    }
}

/// What a published text allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PublishedRange {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Half a unit of the last decimal that is printed.
    pub(crate) ulp: f64,
}

impl PublishedRange {
    /// Of `5`, `128 ± 20`, `53 to 68`, `< 0.5` or `> 90`.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let (low, high) = if let Some(bound) = text.strip_prefix('<') {
            (f64::NEG_INFINITY, number(bound)?)
        } else if let Some(bound) = text.strip_prefix('>') {
            (number(bound)?, f64::INFINITY)
        } else if let Some((middle, half)) = text.split_once('±') {
            (number(middle)? - number(half)?, number(middle)? + number(half)?)
        } else if let Some((low, high)) = text.split_once(" to ") {
            (number(low)?, number(high)?)
        } else {
            (number(text)?, number(text)?)
        };
        let decimals =
            text.split_once('.').map_or(0, |(_, rest)| rest.bytes().take_while(u8::is_ascii_digit).count());
        Some(Self { low, high, ulp: 0.5 * 10_f64.powi(-i32::try_from(decimals).ok()?) })
    }

    pub(crate) fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// How far a value is from the nearer end, as a share of that; 0 within the range.
    pub(crate) fn distance(&self, value: f64) -> f64 {
        let nearest = value.clamp(self.low, self.high);
        let away = (value - nearest).abs();
        if away > 0.0 { away / nearest.abs() } else { 0.0 }
    }

    /// Whether a value is beyond the better end.
    pub(crate) fn is_beaten_by(&self, value: f64, better: Better) -> bool {
        match better {
            Better::Less => value < self.low,
            Better::More => value > self.high,
        }
    }
}
