//! Strengths that end at the highest value that the receiver can measure.

use super::finding::Finding;
use super::levels::Levels;

/// The highest strength is where a receiver saturates if it occurs at least so often, in so large a share of all strengths,
/// and so many times as often as each of the next strengths below it. Otherwise strong ones become rarer towards the highest.
const LEAST: u64 = 10;
const LEAST_SHARE: f64 = 0.03;
const TIMES: u64 = 3;
/// How many strengths below it are compared.
const BELOW: usize = 4;

/// What is odd of strengths that pile up at the highest.
pub(super) fn finding(levels: &Levels) -> Option<Finding> {
    let possible = levels.possible();
    let (&(highest_dbm, count), below) = possible.split_last()?;
    let next = &below[below.len().saturating_sub(BELOW)..];
    let most = next.iter().map(|(_, count)| *count).max()?;
    let total = levels.total();
    let is_pile = count >= LEAST && count as f64 >= LEAST_SHARE * total as f64 && count >= TIMES * most;
    (is_pile && next.len() == BELOW).then(|| Finding {
        check: "saturated-strengths",
        odd: format!(
            "{count} of {total} signal strengths are {highest_dbm} dBm, the highest there is, {} times as many as any of the \
             next below: the receiver saturates there",
            count / most.max(1)
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
