//! Means over a few runs, with confidence intervals.

use serde_json::{Map, Value};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A mean over independent runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// The mean.
    pub mean: f64,
    /// Half the width of the 95 % confidence interval (Student, 1908); `None` for a single run.
    pub half_width_95: Option<f64>,
    /// Number of runs.
    pub runs: usize,
}

impl Mean {
    /// The mean of `values`; `None` if there are none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sums = Sums::default();
        values.iter().for_each(|value| sums.add(*value));
        values.iter().for_each(|value| sums.add_deviation(*value));
        sums.mean()
    }

    /// The ends of the 95 % confidence interval; `None` for a single run.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        self.half_width_95.map(|half_width| [self.mean - half_width, self.mean + half_width])
    }

    /// The mean with its interval as a text: `6.01 ± 0.28 %`.
    #[must_use]
    pub fn text(&self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match self.half_width_95 {
            Some(half_width) => format!("{:.2} ± {half_width:.2}{unit}", self.mean),
            None => format!("{:.2}{unit}", self.mean),
        }
    }

    /// The mean with its interval as a text, with as many decimals as three digits of the mean need, and two of the
    /// interval: `12.3 ± 1.4 ms`, `0.0123 ± 0.0002`. A narrow interval adds at most three decimals.
    #[must_use]
    pub fn rounded(&self, unit: &str) -> String {
        let of_mean = decimals(self.mean, 3);
        // What is narrower than the rounding of the sums is no width.
        let half_width_95 = self.half_width_95.map(|half| if half < 1e-9 * self.mean.abs() { 0.0 } else { half });
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        match half_width_95 {
            Some(half_width) => {
                let most = if self.mean.abs() > 0.0 { of_mean + 3 } else { MOST_DECIMALS };
                let decimals = of_mean.max(decimals(half_width, 2)).min(most);
                format!("{:.decimals$} ± {half_width:.decimals$}{unit}", self.mean)
            }
            None => format!("{:.of_mean$}{unit}", self.mean),
        }
    }

    /// The keys `mean`, `runs` and, if there is an interval, `half_width_95`.
    #[must_use]
    pub fn json(&self) -> Map<String, Value> {
        let mut json = Map::new();
        json.insert("mean".to_owned(), self.mean.into());
        json.insert("runs".to_owned(), self.runs.into());
        if let Some(half_width_95) = self.half_width_95 {
            json.insert("half_width_95".to_owned(), half_width_95.into());
        }
        json
    }

    /// The mean multiplied by `factor`, to change its unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let half_width_95 = self.half_width_95.map(|half_width| factor * half_width);
        Self { mean: factor * self.mean, half_width_95, ..self }
    }
}

/// A mean that is worked out in two passes over its values: the second one adds how far each is from the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    runs: usize,
    sum: f64,
    squares: f64,
    /// How many values are outcomes that happened.
    happened: usize,
}

impl Default for Sums {
    /// The sum begins with the zero that changes nothing: 0 plus -0 is 0.
    fn default() -> Self {
        Self { runs: 0, sum: -0.0, squares: 0.0, happened: 0 }
    }
}

impl Sums {
    /// Adds a value in the first pass.
    pub(super) fn add(&mut self, value: f64) {
        self.runs += 1;
        self.sum += value;
        self.happened += usize::from(happened(value));
    }

    /// Adds the square of the deviation of a value in the second pass.
    pub(super) fn add_deviation(&mut self, value: f64) {
        self.squares += (value - self.sum / self.runs as f64).powi(2);
    }

    /// Of values that are outcomes: how many happened, and how many there are.
    pub(super) fn outcomes(&self) -> (usize, usize) {
        (self.happened, self.runs)
    }

    /// The mean; `None` without values.
    pub(super) fn mean(&self) -> Option<Mean> {
        let (runs, n) = (self.runs, self.runs as f64);
        let variance = self.squares / (n - 1.0);
        let half_width_95 = (runs > 1).then(|| students_t_975(runs - 1) * (variance / n).sqrt());
        (runs > 0).then(|| Mean { mean: self.sum / n, half_width_95, runs })
    }
}

/// Whether an outcome that is 1 or 0 happened.
pub(super) fn happened(outcome: f64) -> bool {
    outcome > 0.5
}

/// More decimals are never printed.
const MOST_DECIMALS: usize = 9;

/// How many decimals show so many digits of a number; none of 0.
fn decimals(number: f64, digits: i32) -> usize {
    let mut shown = number.abs();
    if shown > 0.0 {
        let mut decimals = 0;
        while shown < 10_f64.powi(digits - 1) - 0.5 && decimals < MOST_DECIMALS {
            shown *= 10.0;
            decimals += 1;
        }
        decimals
    } else {
        0
    }
}

/// The 97.5 % quantile of Student's t distribution with this many degrees of freedom: half the width of a 95 % interval in
/// standard errors (Student, 1908). NaN for 0.
#[must_use]
pub fn students_t_975(degrees_of_freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).map_or(f64::NAN, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_follows_students_t_distribution() {
        // t(0.975; 4) = 2.776445 (tables); standard deviation of 1, 2, 3, 4, 5 is sqrt(2.5).
        let mean = Mean::of(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
        assert!((mean.mean - 3.0).abs() < 1e-12);
        assert!((mean.half_width_95.unwrap() - 2.776_445 * (2.5_f64 / 5.0).sqrt()).abs() < 1e-5);
        // t(0.975; 1) = 12.7062.
        assert!((Mean::of(&[0.0, 2.0]).unwrap().half_width_95.unwrap() - 12.7062).abs() < 1e-3);
    }

    #[test]
    fn three_digits_of_a_mean_and_two_of_its_interval_are_printed() {
        let text = |mean, half_width_95| Mean { mean, half_width_95, runs: 3 }.rounded("m");
        for (mean, half_width, expected) in [
            (12.345, 1.0, "12.3 ± 1.0 m"),
            (0.001_234, 0.000_5, "0.00123 ± 0.00050 m"),
            (1234.5, 2.0, "1234.5 ± 2.0 m"),
            (1234.5, 20.0, "1234 ± 20 m"),
            (146.2, 0.0, "146 ± 0 m"),
            (0.0, 0.0, "0 ± 0 m"),
            (0.0, 0.3, "0.00 ± 0.30 m"),
            (-5.0, 0.07, "-5.000 ± 0.070 m"),
            (99.96, 1.0, "100.0 ± 1.0 m"),
            (10.0, 1e-12, "10.0 ± 0.0 m"),
        ] {
            assert_eq!(text(mean, Some(half_width)), expected, "{mean} {half_width}");
        }
        assert_eq!((text(2.0, None), text(250.0, None)), ("2.00 m".to_owned(), "250 m".to_owned()));
    }

    #[test]
    fn one_run_has_no_interval() {
        assert_eq!(Mean::of(&[7.0]).unwrap(), Mean { mean: 7.0, half_width_95: None, runs: 1 });
        assert_eq!(Mean::of(&[]), None);
    }
}
