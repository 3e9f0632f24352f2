//! Silence that is written as a strength: one value below all others, in a large share of the cells.

use super::finding::Finding;
use super::levels::Levels;
use super::pile::Pile;

/// The lowest strength stands for silence if it is a pile of so large a share of all strengths. Near the threshold of a receiver
/// strengths become rarer towards the lowest, and of 29 logs of real robots the lowest is at most 16 % of all, and 1.2 times the next.
const LEAST_SHARE: f64 = 0.2;

/// So does a lowest strength that occurs at least so often, is at least one in so many, and has nothing within so many decibels
/// above it. In the same logs, the next strength is at most 4 dB higher.
const APART: [u64; 2] = [5, 100];
const APART_DB: f64 = 8.0;

/// What is odd of strengths that pile up at the lowest.
pub(super) fn finding(levels: &Levels) -> Option<Finding> {
    let apart = || Some((Pile::apart_at_lowest(levels, APART, APART_DB)?, true));
    let pile = Pile::at_lowest(levels, LEAST_SHARE).map(|pile| (pile, false));
    let (Pile { level_dbm, count, total, times }, is_apart) = pile.or_else(apart)?;
    let why = if is_apart {
        format!("and no other is within {APART_DB} dB above it")
    } else {
        format!("{times} times as many as any of the next above")
    };
    Some(Finding {
        check: "silence-as-strength",
        odd: format!(
            "{count} of {total} signal strengths are {level_dbm} dBm, the lowest there is, {why}: many tables write such a value \
             where nothing was heard"
        ),
        cost: "silence counts as packets that were heard, and pulls nodes to the middle of all stops".to_owned(),
        remedy: format!("`noise_floor={level_dbm}` counts strengths up to this one as not heard"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pile_at_the_lowest_strength_is_found() {
        let strength = |i: u16| -91.0 + f64::from((i * 7) % 31) + 0.5 * f64::from((i * 13) % 29);
        let levels = |silent: u16| {
            let mut levels = Levels::default();
            (0..400).for_each(|i| levels.take(if i < silent { -92.0 } else { strength(i) }));
            levels
        };
        assert_eq!(finding(&levels(0)), None);
        assert_eq!(finding(&levels(40)), None, "a tenth may be the threshold of the receiver");
        let far = |silent: u16| {
            let mut levels = levels(0);
            (0..silent).for_each(|_| levels.take(-128.0));
            levels
        };
        let found = finding(&far(60)).unwrap();
        assert!(
            found.odd.starts_with("60 of 460 signal strengths are -128 dBm, the lowest there is, and no other"),
            "{found}"
        );
        assert!(finding(&far(5)).is_some_and(|found| found.remedy.starts_with("`noise_floor=-128`")));
        assert_eq!(finding(&far(4)), None, "a few may be measured so");
        let found = finding(&levels(200)).unwrap();
        assert!(found.odd.starts_with("200 of 400 signal strengths are -92 dBm, the lowest there is"), "{found}");
        assert!(found.remedy.starts_with("`noise_floor=-92`"), "{found}");
    }
}
