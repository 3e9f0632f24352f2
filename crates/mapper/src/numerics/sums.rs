//! Sums over slices, in four parts side by side.

/// The sum of the products of two slices.
pub(crate) fn dot(first: &[f64], second: &[f64]) -> f64 {
    let (first, second) = (first.chunks_exact(4), second.chunks_exact(4));
    let rest: f64 = first.remainder().iter().zip(second.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 4];
    for (first, second) in first.zip(second) {
        for ((sum, a), b) in sums.iter_mut().zip(first).zip(second) {
            *sum += a * b;
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// The sum of a slice.
pub(crate) fn sum(values: &[f64]) -> f64 {
    let chunks = values.chunks_exact(4);
    let rest: f64 = chunks.remainder().iter().sum();
    let mut sums = [0.0; 4];
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, value)| *sum += value);
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_lengths_are_summed() {
        for count in 0..11_u32 {
            let values: Vec<f64> = (1..=count).map(f64::from).collect();
            let expected = f64::from(count * (count + 1) / 2);
            assert!((sum(&values) - expected).abs() < 1e-12, "{count}");
            let squares: f64 = values.iter().map(|value| value * value).sum();
            assert!((dot(&values, &values) - squares).abs() < 1e-12, "{count}");
        }
    }
}
