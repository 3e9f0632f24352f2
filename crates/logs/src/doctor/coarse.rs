//! Strengths that take few values.

use super::finding::Finding;
use super::levels::Levels;

/// Steps of at least this are coarse (dB): a step of 1 dB is usual.
const COARSE_DB: f64 = 2.9;
/// Fewer strengths say nothing of their steps.
const LEAST: u64 = 40;

/// What is odd of strengths with coarse steps.
pub(super) fn finding(levels: &Levels) -> Option<Finding> {
    let possible = levels.possible();
    let total = levels.total();
    if total < LEAST {
        return None;
    }
    let check = "coarse-strengths";
    if let [(only_dbm, _)] = possible[..] {
        return Some(Finding {
            check,
            odd: format!("all {total} signal strengths are {only_dbm} dBm"),
            cost: "they tell nothing about distances".to_owned(),
            remedy: "leave the column `rssi_dbm` out, or record what the receiver measures of each packet".to_owned(),
        });
    }
    let step_db = possible.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(f64::INFINITY, f64::min);
    (step_db.is_finite() && step_db >= COARSE_DB).then(|| Finding {
        check,
        odd: format!(
            "the {total} signal strengths take {} values only, {step_db:.1} dB or more from each other",
            possible.len()
        ),
        cost: format!(
            "each is uncertain by {:.1} dB more, that is {:.0} % of the distance",
            step_db / 12.0_f64.sqrt(),
            100.0 * (libm::exp10(step_db / 12.0_f64.sqrt() / 25.0) - 1.0)
        ),
        remedy: "record the finest values that the receiver gives (bars and percentages are coarse)".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_three_decibels_are_coarse_and_of_one_are_not() {
        let levels = |step: f64| {
            let mut levels = Levels::default();
            (0..300_u16).for_each(|i| levels.take((f64::from(i % 40) / step).round() * step - 90.0));
            levels
        };
        assert_eq!(finding(&levels(1.0)), None);
        assert_eq!(finding(&levels(2.0)), None);
        let found = finding(&levels(5.0)).unwrap();
        assert_eq!(found.odd, "the 300 signal strengths take 9 values only, 5.0 dB or more from each other");
        let mut same = Levels::default();
        (0..50).for_each(|_| same.take(-70.0));
        assert_eq!(finding(&same).unwrap().odd, "all 50 signal strengths are -70 dBm");
    }
}
