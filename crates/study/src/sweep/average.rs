//! What several runs say of a measure: a mean, or the share of the runs in which something happened.

use serde_json::{Map, Value};
use sextant::summary::Unit;

use super::share::Share;
use super::statistics::{Mean, Sums};

/// The average of a measure over independent runs, whose interval is that of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Average {
    /// The mean of numbers.
    Mean(Mean),
    /// The share of outcomes that happened.
    Share(Share),
}

impl Average {
    /// Of the values of a measure with this unit; `None` if there are none.
    #[must_use]
    pub fn of(unit: Unit, values: &[f64]) -> Option<Self> {
        match unit {
            Unit::Outcome => Share::of(values).map(Self::Share),
            _ => Mean::of(values).map(Self::Mean),
        }
    }

    /// The same of values that are summed up.
    pub(super) fn of_sums(unit: Unit, sums: &Sums) -> Option<Self> {
        match unit {
            Unit::Outcome => {
                let (happened, runs) = sums.outcomes();
                Share::counted(happened, runs).map(Self::Share)
            }
            _ => sums.mean().map(Self::Mean),
        }
    }

    /// The mean or the share.
    #[must_use]
    pub fn value(&self) -> f64 {
        match self {
            Self::Mean(mean) => mean.mean,
            Self::Share(share) => share.share(),
        }
    }

    /// Number of runs.
    #[must_use]
    pub fn runs(&self) -> usize {
        match self {
            Self::Mean(mean) => mean.runs,
            Self::Share(share) => share.runs,
        }
    }

    /// The 95 % confidence interval, from its low to its high end: of a mean Student's, of a share that of Clopper and
    /// Pearson. `None` for a single run.
    #[must_use]
    pub fn interval_95(&self) -> Option<[f64; 2]> {
        match self {
            Self::Mean(mean) => mean.interval_95(),
            Self::Share(share) => (share.runs > 1).then_some(share.interval_95),
        }
    }

    /// The average as a text in another unit, of which one has `factor`: `12.3 ± 1.4 ms`, `80 % (28 to 99 %)`.
    #[must_use]
    pub fn rounded(&self, factor: f64, unit: &str) -> String {
        match self {
            Self::Mean(mean) => mean.times(factor).rounded(unit),
            Self::Share(share) => {
                let percent = |share: f64| format!("{:.0}", 100.0 * share);
                let interval = self.interval_95().map(|ends| ends.map(percent));
                let interval = interval.map_or_else(String::new, |[low, high]| format!(" ({low} to {high} %)"));
                percent(share.share()) + " %" + &interval
            }
        }
    }

    /// The keys `mean`, `runs` and, if there is an interval, `half_width_95` of a mean and `interval_95` of a share: its low
    /// and high end.
    #[must_use]
    pub fn json(&self) -> Map<String, Value> {
        match self {
            Self::Mean(mean) => mean.json(),
            Self::Share(share) => {
                let mut json = Map::new();
                json.insert("mean".to_owned(), share.share().into());
                json.insert("runs".to_owned(), share.runs.into());
                if let Some(interval_95) = self.interval_95() {
                    json.insert("interval_95".to_owned(), interval_95.to_vec().into());
                }
                json
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_has_the_interval_of_a_share_and_other_measures_that_of_a_mean() {
        let values = [1.0, 1.0, 0.0, 1.0, 1.0];
        let (share, mean) =
            (Average::of(Unit::Outcome, &values).unwrap(), Average::of(Unit::Share, &values).unwrap());
        assert_eq!((share.value(), share.runs()), (mean.value(), mean.runs()));
        // Clopper and Pearson for 4 of 5, and Student with t(0.975; 4) = 2.7764 times 0.4472 / sqrt(5).
        let [low, high] = share.interval_95().unwrap();
        assert!((low - 0.2836).abs() < 1e-4 && (high - 0.9949).abs() < 1e-4, "{share:?}");
        assert!((mean.interval_95().unwrap()[1] - 0.8 - 0.5553).abs() < 1e-4, "{mean:?}");
        assert_eq!(share.rounded(100.0, "%"), "80 % (28 to 99 %)");
        assert_eq!(mean.rounded(100.0, "%"), "80.0 ± 55.5 %");
        assert_eq!(share.json()["interval_95"], serde_json::json!([low, high]));
        assert!(share.json().get("half_width_95").is_none());
        // All runs alike are not the end of doubt.
        assert_eq!(Average::of(Unit::Outcome, &[1.0; 5]).unwrap().rounded(100.0, "%"), "100 % (48 to 100 %)");
        let one = Average::of(Unit::Outcome, &[1.0]).unwrap();
        assert_eq!((one.interval_95(), one.rounded(100.0, "%")), (None, "100 %".to_owned()));
        assert_eq!(Average::of(Unit::Outcome, &[]), None);
    }
}
