//! How near our value is to a published number.

use super::ours::Ours;
use super::published::PublishedRange;
use sextant_study::sweep::Share;

/// How near our value is to a published number or range. The interval is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// The published number is in our 95 % interval. Of a published range or bound, a part is in it. For a value that needs no
    /// run, the two are equal with as many decimals as are published.
    WithinInterval,
    /// Ours differs from the published number, or from the nearer end of a published range, by at most a fifth of that.
    WithinFifth,
    /// Neither, but ours is near in one of these ways under a named reading of what the thesis leaves open.
    ForReading,
    /// None of these, and ours is better than what is published.
    Better,
    /// Ours is at least half and at most twice the published number, or the nearer end of a published range.
    WithinFactorTwo,
    /// None of these. Also if what is measured happened in none of our runs.
    Other,
}

impl Agreement {
    /// All, from near to far.
    pub const ALL: [Self; 6] =
        [Self::WithinInterval, Self::WithinFifth, Self::ForReading, Self::Better, Self::WithinFactorTwo, Self::Other];

    /// The verdict in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::WithinInterval => "within interval",
            Self::WithinFifth => "within 20 %",
            Self::ForReading => "within 20 % for a reading",
            Self::Better => "better than published",
            Self::WithinFactorTwo => "within a factor 2",
            Self::Other => "other",
        }
    }

    /// Whether ours is in the interval or within a fifth.
    #[must_use]
    pub fn is_near(self) -> bool {
        matches!(self, Self::WithinInterval | Self::WithinFifth)
    }

    /// That of our value and a published text in the same unit; `None` if the text is no number, or there is no value.
    pub(crate) fn of(published: &str, ours: &Ours) -> Option<Self> {
        let range = PublishedRange::read(published)?;
        let (value, interval) = match ours {
            Ours::Mean(mean) => (mean.mean, mean.interval_95()),
            Ours::Share(share) => (100.0 * share.share(), Some(ends(share))),
            Ours::Exact(value) => {
                return Some(agreement(&range, *value, Some([value - range.ulp, value + range.ulp])));
            }
            Ours::Choice { best, as_good } => {
                let value = |text: &String| text.parse::<f64>().ok();
                let is_published = |text: &String| value(text).is_some_and(|value| range.has(value));
                if as_good.iter().chain([best]).any(is_published) {
                    return Some(Self::WithinInterval);
                }
                (value(best)?, None)
            }
            Ours::Never => return Some(Self::Other),
            Ours::Finding(_) | Ours::Missing => return None,
        };
        Some(agreement(&range, value, interval))
    }
}

fn ends(share: &Share) -> [f64; 2] {
    share.interval_95.map(|end| 100.0 * end)
}

fn agreement(range: &PublishedRange, value: f64, interval: Option<[f64; 2]>) -> Agreement {
    if interval.is_some_and(|[low, high]| low <= range.high && range.low <= high) {
        return Agreement::WithinInterval;
    }
    let nearest = value.clamp(range.low, range.high);
    if (value - nearest).abs() <= 0.2 * nearest.abs() {
        Agreement::WithinFifth
    } else if (0.5 * nearest..=2.0 * nearest).contains(&value) {
        Agreement::WithinFactorTwo
    } else {
        Agreement::Other
    }
}

#[cfg(test)]
mod tests {
    use sextant_study::sweep::Mean;

    use super::*;

    #[test]
    fn a_number_has_the_nearest_verdict_that_fits() {
        use Agreement::{Other, WithinFactorTwo, WithinFifth, WithinInterval};
        let mean = |mean: f64, half_width: f64| Ours::Mean(Mean { mean, half_width_95: Some(half_width), runs: 3 });
        let once = |mean: f64| Ours::Mean(Mean { mean, half_width_95: None, runs: 1 });
        let never = Ours::Share(Share::of(&[0.0; 20]).unwrap());
        let choice = |best: &str, as_good: &str| Ours::Choice { best: best.into(), as_good: vec![as_good.into()] };
        for (published, ours, verdict) in [
            ("5", mean(5.5, 0.5), WithinInterval),
            ("5", mean(5.5, 0.4), WithinFifth),
            ("5", mean(6.0, 0.1), WithinFifth),
            ("5", mean(6.1, 0.1), WithinFactorTwo),
            ("5", mean(2.5, 0.1), WithinFactorTwo),
            ("5", mean(2.4, 0.1), Other),
            ("5", once(5.0), WithinFifth),
            ("128 ± 20", mean(150.0, 3.0), WithinInterval),
            ("128 ± 20", mean(155.0, 3.0), WithinFifth),
            ("53 to 68", mean(50.0, 1.0), WithinFifth),
            ("53 to 68", once(60.0), WithinFifth),
            ("< 0.5", mean(0.01, 0.001), WithinInterval),
            ("< 0.5", mean(0.9, 0.1), WithinFactorTwo),
            ("> 90", mean(80.0, 1.0), WithinFifth),
            ("0", never.clone(), WithinInterval),
            ("20", never, Other),
            ("0", mean(0.1, 0.05), Other),
            ("0.0325", Ours::Exact(0.032_523), WithinInterval),
            ("0.0325", Ours::Exact(0.0326), WithinFifth),
            ("0.95", choice("0.9", "0.95"), WithinInterval),
            ("0.95", choice("0.9", "0.85"), WithinFifth),
            ("70", Ours::Never, Other),
        ] {
            assert_eq!(Agreement::of(published, &ours), Some(verdict), "{published}: {ours:?}");
        }
        assert_eq!(Agreement::of("both sources", &once(1.0)), None);
        assert_eq!(Agreement::of("5", &Ours::Missing), None);
    }
}
