//! Strengths that no radio measures: 127, 0, positive ones, far below all noise.

use super::finding::Finding;
use super::levels::Levels;

/// What is odd of strengths that no radio measures.
pub(super) fn finding(levels: &Levels) -> Option<Finding> {
    let odd = levels.impossible();
    let total = levels.total();
    if levels.are_linear() {
        return Some(Finding {
            check: "impossible-strengths",
            odd: format!(
                "all {total} signal strengths are 0 or more, and some are nearly 0: they seem to be powers, not dBm"
            ),
            cost: "distances from strengths are wrong".to_owned(),
            remedy: "convert `rssi_dbm` to dBm: ten times the decimal logarithm of the power in milliwatts"
                .to_owned(),
        });
    }
    let count: u64 = odd.iter().map(|(_, count)| count).sum();
    let &(usual_dbm, usual) = odd.iter().max_by_key(|(_, count)| *count)?;
    if 2 * count > total && odd.len() > 1 {
        let [low, high] = [odd[0].0, odd[odd.len() - 1].0];
        return Some(Finding {
            check: "impossible-strengths",
            odd: format!("{count} of {total} signal strengths are 0 dBm or more, or below -150 dBm ({low} to {high})"),
            cost: "distances from strengths are wrong, if these are not dBm but raw values of a chip, or have lost their sign"
                .to_owned(),
            remedy: "convert `rssi_dbm` to dBm (-20 to -120 as a rule), or leave the column out".to_owned(),
        });
    }
    let others = count - usual;
    let others = if others > 0 {
        format!(", and {others} others are 0 dBm or more, or below -150 dBm")
    } else {
        String::new()
    };
    Some(Finding {
        check: "impossible-strengths",
        odd: format!(
            "{usual} of {total} signal strengths are {usual_dbm} dBm{others}: many receivers write such a value where they \
             measured none"
        ),
        cost: "these packets count as if they were heard with that strength, and pull nodes to their stops"
            .to_owned(),
        remedy: if levels.are_cells() {
            format!("`missing={usual_dbm}` counts these cells as nodes that were not heard")
        } else {
            format!("`rssi_missing={usual_dbm}` counts them as packets without a strength")
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(all: impl IntoIterator<Item = f64>) -> Levels {
        let mut levels = Levels::default();
        all.into_iter().for_each(|level| levels.take(level));
        levels
    }

    #[test]
    fn values_that_stand_for_no_measurement_are_named_with_their_flag() {
        let good = || (0..200_u8).map(|i| -90.0 + f64::from(i % 40));
        assert_eq!(finding(&levels(good())), None);
        for value in [127.0, 0.0, -200.0] {
            let found = finding(&levels(good().chain([value; 7]))).unwrap();
            assert!(found.odd.starts_with(&format!("7 of 207 signal strengths are {value} dBm:")), "{found}");
            assert!(found.remedy.starts_with(&format!("`rssi_missing={value}`")), "{found}");
        }
        let found = finding(&levels(good().chain([127.0, 127.0, 3.5]))).unwrap();
        assert!(found.odd.contains("2 of 203") && found.odd.contains("1 others are 0 dBm or more"), "{found}");
    }

    #[test]
    fn zeros_in_the_cells_of_a_wide_table_are_silence() {
        let mut cells = Levels::of_cells();
        (0..200_u8).for_each(|i| cells.take(if i < 60 { 0.0 } else { -90.0 + f64::from(i % 40) }));
        let found = finding(&cells).unwrap();
        assert!(found.remedy.starts_with("`missing=0` counts these cells"), "{found}");
    }

    #[test]
    fn linear_power_is_not_dbm() {
        let power = |i: u8| libm::pow(10.0, -4.0 - 0.1 * f64::from(i % 40));
        let found = finding(&levels((0..100).map(power))).unwrap();
        assert!(
            found.odd.starts_with("all 100 signal strengths are 0 or more") && found.remedy.contains("milliwatts"),
            "{found}"
        );
        let found = finding(&levels((0..100).map(power).chain([-50.0]))).unwrap();
        assert!(found.remedy.starts_with("`rssi_missing=0`"), "{found}");
    }

    #[test]
    fn raw_values_are_not_dbm() {
        let found = finding(&levels((0..100_u8).map(f64::from))).unwrap();
        assert!(found.odd.starts_with("100 of 100 signal strengths") && found.remedy.contains("convert"), "{found}");
    }
}
