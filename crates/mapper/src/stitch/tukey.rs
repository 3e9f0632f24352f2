//! Tukey's biweight: residuals far beyond the usual ones do not count (Beaton and Tukey 1974).

/// Residuals beyond this many standard deviations do not count; 95 % efficient for normal errors.
const CUT: f64 = 4.685;
/// The median length of a plane vector of independent normal errors, in standard deviations of one of them: √(2 ln 2).
const MEDIAN_OF_PLANE: f64 = 1.177_410_022_515_474_7;
/// What one residual adds to twice the loss at most.
pub(super) const MOST_EVIDENCE: f64 = CUT * CUT / 3.0;

/// How much a residual of so many standard deviations counts, 0 to 1.
pub(super) fn weight(deviations: f64) -> f64 {
    let share = deviations / CUT;
    if share.abs() >= 1.0 { 0.0 } else { (1.0 - share * share).powi(2) }
}

/// Twice the loss of a residual: its square for small ones, at most [`MOST_EVIDENCE`].
pub(super) fn evidence(deviations: f64) -> f64 {
    let share = (deviations / CUT).abs().min(1.0);
    MOST_EVIDENCE * (1.0 - (1.0 - share * share).powi(3))
}

/// The standard deviation along one axis of residuals of which fewer than half are outliers, from their lengths; `degrees`
/// of them were used up by the fit (Rousseeuw and Leroy 1987, section 5.1).
pub(super) fn standard_deviation(mut lengths: Vec<f64>, degrees: usize) -> f64 {
    if lengths.is_empty() {
        return 0.0;
    }
    let correction = 1.0 + 5.0 / lengths.len().saturating_sub(degrees).max(1) as f64;
    let middle = lengths.len() / 2;
    let (_, median, _) = lengths.select_nth_unstable_by(middle, f64::total_cmp);
    correction * *median / MEDIAN_OF_PLANE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_residuals_count_as_squares_and_large_ones_not_at_all() {
        assert!((evidence(0.01) - 1e-4).abs() < 1e-8);
        assert!((evidence(50.0) - MOST_EVIDENCE).abs() < 1e-12);
        assert!((weight(0.0) - 1.0).abs() < 1e-12 && weight(5.0) <= 0.0 && weight(-5.0) <= 0.0);
    }

    #[test]
    fn outliers_do_not_widen_the_standard_deviation() {
        let lengths: Vec<f64> = (0..100).map(|i| if i < 60 { 1.177_41 } else { 1e6 }).collect();
        let found = standard_deviation(lengths, 2);
        assert!((found - 1.0).abs() < 0.06, "{found}");
    }
}
