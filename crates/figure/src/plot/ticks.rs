//! Ticks of an axis at round numbers.

/// Numbers at equal steps of 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) values: Vec<f64>,
    decimals: usize,
}

impl Ticks {
    /// At most `most` round numbers from `low` to `high`, at least `finest` apart. A range of zero width has none.
    pub(crate) fn new(low: f64, high: f64, most: f64, finest: f64) -> Self {
        if high - low <= 1e-9 * low.abs().max(high.abs()) {
            return Self { values: Vec::new(), decimals: 0 };
        }
        let coarse = ((high - low) / most.max(1.0)).max(finest).max(f64::MIN_POSITIVE);
        let power = libm::log10(coarse).floor();
        let factor =
            [1.0, 2.0, 5.0].into_iter().find(|factor| factor * libm::pow(10.0, power) >= coarse * (1.0 - 1e-9));
        let (factor, power) = factor.map_or((1.0, power + 1.0), |factor| (factor, power));
        let step = factor * libm::pow(10.0, power);
        let first = (low / step - 1e-9).ceil();
        let values = (0..1000_u16).map(|i| (first + f64::from(i)) * step);
        let values = values.take_while(|value| *value <= high + 1e-9 * step).collect();
        let decimals =
            (1..=9_u8).find(|&decimals| power >= 1.0 - f64::from(decimals)).map_or(9, |d| usize::from(d) - 1);
        Self { values, decimals }
    }

    /// The label of a tick.
    pub(crate) fn label(&self, value: f64) -> String {
        number(value, self.decimals)
    }
}

/// A number with a typographic minus sign, and without a minus before zero.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if value < 0.0 && !is_zero { format!("\u{2212}{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, most: f64, finest: f64) -> Vec<String> {
        let ticks = Ticks::new(low, high, most, finest);
        ticks.values.iter().map(|&value| ticks.label(value)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_within_the_range() {
        assert_eq!(labels(-14.2, 13.9, 7.0, 0.0), ["−10", "−5", "0", "5", "10"]);
        assert_eq!(labels(0.0, 1.0, 5.0, 0.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(0.0, 0.03, 3.0, 0.0), ["0.00", "0.01", "0.02", "0.03"]);
        assert_eq!(labels(995.0, 3020.0, 5.0, 0.0), ["1000", "1500", "2000", "2500", "3000"]);
    }

    #[test]
    fn ticks_of_counts_are_integers() {
        assert_eq!(labels(0.0, 3.0, 8.0, 1.0), ["0", "1", "2", "3"]);
    }

    #[test]
    fn a_range_of_zero_width_has_no_ticks() {
        for value in [0.0, 2.0, -1e9] {
            assert!(labels(value, value, 8.0, 0.0).is_empty());
        }
    }
}
