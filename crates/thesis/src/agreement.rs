//! How near our value is to a published number.

use super::ours::Ours;
use sextant_study::sweep::{Mean, Share};

/// How near our value is to a published number or range. The interval is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Agreement {
    /// The published number is in our 95 % interval. Of a published range or bound, a part is in it. For a value that needs no
    /// run, the two are equal with as many decimals as are published.
    WithinInterval,
    /// Ours differs from the published number, or from the nearer end of a published range, by at most a fifth of that.
    WithinFifth,
    /// Ours is at least half and at most twice the published number, or the nearer end of a published range.
    WithinFactorTwo,
    /// None of these. Also if what is measured happened in none of our runs.
    Other,
}

impl Agreement {
    /// All, from near to far.
    pub const ALL: [Self; 4] = [Self::WithinInterval, Self::WithinFifth, Self::WithinFactorTwo, Self::Other];

    /// The verdict in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::WithinInterval => "within interval",
            Self::WithinFifth => "within 20 %",
            Self::WithinFactorTwo => "within a factor 2",
            Self::Other => "other",
        }
    }

    /// That of our value and a published text in the same unit; `None` if the text is no number, or there is no value.
    pub(crate) fn of(published: &str, ours: &Ours) -> Option<Self> {
        let range = Range::read(published)?;
        let (value, interval) = match ours {
            Ours::Mean(mean) => (mean.mean, interval(mean)),
            Ours::Share(share) => (100.0 * share.share(), Some(ends(share))),
            Ours::Exact(value) => return Some(range.agreement(*value, Some([value - range.ulp, value + range.ulp]))),
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
        Some(range.agreement(value, interval))
    }
}

fn interval(mean: &Mean) -> Option<[f64; 2]> {
    mean.half_width_95.map(|half_width| [mean.mean - half_width, mean.mean + half_width])
}

fn ends(share: &Share) -> [f64; 2] {
    share.interval_95.map(|end| 100.0 * end)
}

/// What a published text allows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    low: f64,
    high: f64,
    /// Half a unit of the last decimal that is printed.
    ulp: f64,
}

impl Range {
    /// Of `5`, `128 ± 20`, `53 to 68`, `< 0.5` or `> 90`.
    fn read(text: &str) -> Option<Self> {
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

    fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn agreement(&self, value: f64, interval: Option<[f64; 2]>) -> Agreement {
        if interval.is_some_and(|[low, high]| low <= self.high && self.low <= high) {
            return Agreement::WithinInterval;
        }
        let nearest = value.clamp(self.low, self.high);
        if (value - nearest).abs() <= 0.2 * nearest.abs() {
            Agreement::WithinFifth
        } else if (0.5 * nearest..=2.0 * nearest).contains(&value) {
            Agreement::WithinFactorTwo
        } else {
            Agreement::Other
        }
    }
}

#[cfg(test)]
mod tests {
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
