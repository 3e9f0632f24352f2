//! Shares of runs in which something happened, with exact confidence intervals.

use statrs::distribution::{Beta, ContinuousCDF};

use super::statistics::{Mean, happened};

/// The share of independent runs in which something happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Number of runs in which it happened.
    pub happened: usize,
    /// Number of runs.
    pub runs: usize,
    /// The 95 % confidence interval (Clopper and Pearson, 1934): lower and upper end.
    pub interval_95: [f64; 2],
}

impl Share {
    /// Of outcomes that are 1 if it happened and 0 if not; `None` if there are none.
    #[must_use]
    pub fn of(outcomes: &[f64]) -> Option<Self> {
        Self::counted(outcomes.iter().filter(|outcome| happened(**outcome)).count(), outcomes.len())
    }

    /// If it happened in so many of the `runs`; `None` if there are none.
    pub(super) fn counted(happened: usize, runs: usize) -> Option<Self> {
        let (yes, no) = (happened as f64, (runs - happened) as f64);
        let quantile = |a: f64, b: f64, p: f64| Beta::new(a, b).ok().map(|beta| beta.inverse_cdf(p));
        let low = if happened == 0 { 0.0 } else { quantile(yes, no + 1.0, 0.025)? };
        let high = if happened == runs { 1.0 } else { quantile(yes + 1.0, no, 0.975)? };
        (runs > 0).then_some(Self { happened, runs, interval_95: [low, high] })
    }

    /// The share.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.happened as f64 / self.runs as f64
    }

    /// The share with its interval as a text: `90 % (18 of 20 runs, 68 to 99 %)`.
    #[must_use]
    pub fn text(&self) -> String {
        let [low, high] = self.interval_95.map(|end| 100.0 * end);
        format!("{:.0} % ({} of {} runs, {low:.0} to {high:.0} %)", 100.0 * self.share(), self.happened, self.runs)
    }

    /// The middle of the interval with half its width. It is not the share itself: the interval is not symmetric.
    #[must_use]
    pub fn interval(&self) -> Mean {
        let [low, high] = self.interval_95;
        Mean { mean: f64::midpoint(low, high), half_width_95: Some((high - low) / 2.0), runs: self.runs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_exact() {
        // If it always happened in n runs, the lower end is the n-th root of 0.025.
        let all = Share::of(&[1.0; 20]).unwrap();
        assert!((all.interval_95[0] - 0.025_f64.powf(1.0 / 20.0)).abs() < 1e-6, "{all:?}");
        assert_eq!((all.share(), all.interval_95[1]), (1.0, 1.0));
        let none = Share::of(&[0.0; 20]).unwrap();
        assert!((none.interval_95[1] - (1.0 - 0.025_f64.powf(1.0 / 20.0))).abs() < 1e-6, "{none:?}");
        assert_eq!((none.share(), none.interval_95[0]), (0.0, 0.0));
        // The ends for 3 of 10 solve P(X >= 3) = 0.025 and P(X <= 3) = 0.025 of a binomial X.
        let few = Share::of(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        let choose = [1.0, 10.0, 45.0, 120.0];
        let at_most = |most: usize, p: f64| -> f64 {
            (0_i32..).zip(&choose[..=most]).map(|(k, ways)| ways * p.powi(k) * (1.0 - p).powi(10 - k)).sum()
        };
        let [low, high] = few.interval_95;
        assert!((1.0 - at_most(2, low) - 0.025).abs() < 1e-6, "{few:?}");
        assert!((at_most(3, high) - 0.025).abs() < 1e-6, "{few:?}");
        assert_eq!(few.text(), "30 % (3 of 10 runs, 7 to 65 %)");
        assert_eq!(Share::of(&[]), None);
    }
}
