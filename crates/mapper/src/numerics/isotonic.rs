//! The best fit by a curve that never rises.

/// The values that never rise with the index and minimise `Σ weight (value − mean)²`: the pool-adjacent-violators
/// algorithm (Ayer and others 1955, "An empirical distribution function for sampling with incomplete information").
/// For shares of successes weighed by their trials they are also the binomial maximum likelihood (Barlow and others
/// 1972, "Statistical inference under order restrictions", section 1.5). An entry of weight 0 gets the value of the
/// entry before it; entries of weight 0 at the start get the value of the first entry with a weight. Linear in the
/// number of entries.
///
/// # Panics
/// If the numbers of weights and means differ.
#[must_use]
pub fn never_rising(means: &[f64], weights: &[f64]) -> Vec<f64> {
    assert_eq!(means.len(), weights.len(), "each mean has a weight");
    struct Pool {
        sum: f64,
        weight: f64,
        entries: usize,
    }
    let mut pools: Vec<Pool> = Vec::new();
    let mut leading = 0;
    for (&mean, &weight) in means.iter().zip(weights) {
        if weight <= 0.0 {
            match pools.last_mut() {
                Some(pool) => pool.entries += 1,
                None => leading += 1,
            }
            continue;
        }
        let mut pool = Pool { sum: mean * weight, weight, entries: 1 };
        while let Some(before) = pools.pop_if(|before| before.sum * pool.weight <= pool.sum * before.weight) {
            pool.sum += before.sum;
            pool.weight += before.weight;
            pool.entries += before.entries;
        }
        pools.push(pool);
    }
    match pools.first_mut() {
        Some(first) => first.entries += leading,
        None => return vec![0.0; means.len()],
    }
    pools.iter().flat_map(|pool| std::iter::repeat_n(pool.sum / pool.weight, pool.entries)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The value at `i` is the least over starts up to `i` of the greatest over ends from `i` on of the weighted mean
    /// (the min-max formula, Barlow and others 1972, eq. 1.9), reversed for falling curves.
    fn oracle(means: &[f64], weights: &[f64]) -> Vec<f64> {
        let mean = |from: usize, to: usize| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for j in from..=to {
                sum += means[j] * weights[j];
                weight += weights[j];
            }
            sum / weight
        };
        let last = means.len() - 1;
        let value = |i: usize| {
            let highest = |from: usize| (i..=last).map(|to| mean(from, to)).fold(f64::NEG_INFINITY, f64::max);
            (0..=i).map(highest).fold(f64::INFINITY, f64::min)
        };
        (0..means.len()).map(value).collect()
    }

    proptest! {
        #[test]
        fn pooling_agrees_with_the_min_max_formula(
            entries in prop::collection::vec((0.0..1.0_f64, 0.01..10.0_f64), 1..40)
        ) {
            let (means, weights): (Vec<f64>, Vec<f64>) = entries.into_iter().unzip();
            for (found, expected) in never_rising(&means, &weights).iter().zip(oracle(&means, &weights)) {
                prop_assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
            }
        }
    }

    #[test]
    fn entries_without_weight_follow_their_neighbours() {
        let values = never_rising(&[9.0, 0.9, 9.0, 0.2, 0.4, 9.0], &[0.0, 1.0, 0.0, 1.0, 3.0, 0.0]);
        for (found, expected) in values.iter().zip([0.9, 0.9, 0.9, 0.35, 0.35, 0.35]) {
            assert!((found - expected).abs() < 1e-12, "{values:?}");
        }
        assert_eq!(never_rising(&[1.0], &[0.0]), [0.0]);
    }
}
