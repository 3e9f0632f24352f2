//! Strengths that end at the highest value that the receiver can measure.

use super::finding::Finding;
use super::levels::Levels;
use super::pile::Pile;

/// The highest strength is where a receiver saturates if it is a pile of so large a share of all strengths. Otherwise strong ones
/// become rarer towards the highest.
const LEAST_SHARE: f64 = 0.03;

/// What is odd of strengths that pile up at the highest.
pub(super) fn finding(levels: &Levels) -> Option<Finding> {
    let Pile { level_dbm, count, total, times } = Pile::at_highest(levels, LEAST_SHARE)?;
    Some(Finding {
        check: "saturated-strengths",
        odd: format!(
            "{count} of {total} signal strengths are {level_dbm} dBm, the highest there is, {times} times as many as any of the \
             next below: the receiver saturates there"
        ),
        cost: "all nearer distances look alike, so nodes beside the path are placed less exactly".to_owned(),
        remedy: "an attenuator or less transmit power at the next survey; these strengths mean `at least`".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pile_at_the_highest_strength_is_found() {
        let strength = |i: u16| -85.0 + f64::from((i * 7) % 31) + 0.5 * f64::from((i * 13) % 29);
        let levels = |most: f64| {
            let mut levels = Levels::default();
            (0..400).for_each(|i| levels.take(strength(i).min(most)));
            levels
        };
        assert_eq!(finding(&levels(0.0)), None);
        let found = finding(&levels(-60.0)).unwrap();
        assert!(found.odd.contains(" of 400 signal strengths are -60 dBm, the highest there is"), "{found}");
    }
}
