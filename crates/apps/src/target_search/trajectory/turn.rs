//! When a target turned, along one axis.

use super::legendre::LegendreSeries;

/// How the times are found at which a target turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TurnTimes {
    /// The extremes from which the place has come back by more than this (m), each at the top of the parabola through
    /// the three samples round it.
    Extremes(f64),
    /// The zeros of the derivative of a polynomial of least squares through all places, as in the thesis. Its degree
    /// is one more than the number of turns that are counted.
    Polynomial {
        /// A turn counts if the increment between two samples changes its sign, and the new one is more than this (m), as
        /// printed in the thesis. A target that slows down before it turns is not seen to turn.
        least_m: f64,
        /// Largest degree.
        most_degree: usize,
    },
}

impl TurnTimes {
    /// Times at which the values of `points` (s, m) turn, in ascending order of time.
    pub(super) fn of(self, points: &[(f64, f64)]) -> Vec<f64> {
        match self {
            Self::Extremes(least_m) => {
                extremes(points, least_m).into_iter().map(|index| top_s(points, index)).collect()
            }
            Self::Polynomial { least_m, most_degree } => {
                zeros_s(points, changed_increments(points, least_m) + 1, most_degree)
            }
        }
    }
}

/// Zeros of the derivative of the polynomial of least squares of `degree`, or `most_degree`, or the degree for which
/// there are two points per coefficient, if that is less. None if the points do not determine it.
fn zeros_s(points: &[(f64, f64)], degree: usize, most_degree: usize) -> Vec<f64> {
    let (Some(&(first_s, _)), Some(&(last_s, _))) = (points.first(), points.last()) else { return Vec::new() };
    let half_s = 0.5 * (last_s - first_s);
    let degree = degree.min(most_degree).min((points.len() - 1) / 2);
    if half_s <= 0.0 || degree < 2 {
        return Vec::new();
    }
    let scaled: Vec<_> = points.iter().map(|&(t_s, value)| ((t_s - first_s) / half_s - 1.0, value)).collect();
    let Some(curve) = LegendreSeries::fit(&scaled, degree) else { return Vec::new() };
    curve.derivative().sign_changes().into_iter().map(|u| first_s + (u + 1.0) * half_s).collect()
}

/// Indices of the extremes from which the values come back by more than `least_m`.
fn extremes(points: &[(f64, f64)], least_m: f64) -> Vec<usize> {
    let (mut low, mut high, mut is_rising, mut extremes) = (0, 0, None, Vec::new());
    for (index, &(_, value)) in points.iter().enumerate() {
        if value < points[low].1 {
            low = index;
        }
        if value > points[high].1 {
            high = index;
        }
        if is_rising != Some(true) && value - points[low].1 > least_m {
            extremes.extend(is_rising.map(|_| low));
            (is_rising, high) = (Some(true), index);
        } else if is_rising != Some(false) && points[high].1 - value > least_m {
            extremes.extend(is_rising.map(|_| high));
            (is_rising, low) = (Some(false), index);
        }
    }
    extremes
}

/// Time of the top of the parabola through the points round the extreme at `index`.
fn top_s(points: &[(f64, f64)], index: usize) -> f64 {
    let (t_s, value) = points[index];
    let neighbours = index.checked_sub(1).and_then(|before| Some((points[before], *points.get(index + 1)?)));
    let Some(((before_s, before), (after_s, after))) = neighbours else { return t_s };
    let (back_s, on_s) = (t_s - before_s, after_s - t_s);
    let (fall, climb) = ((value - before) / back_s, (after - value) / on_s);
    if fall - climb == 0.0 {
        return t_s;
    }
    // The slopes are those in the middles of the two intervals, and the slope is linear in time.
    (t_s - 0.5 * back_s) + 0.5 * (back_s + on_s) * fall / (fall - climb)
}

fn changed_increments(points: &[(f64, f64)], least_m: f64) -> usize {
    let (mut sign, mut count) = (0.0, 0);
    for pair in points.windows(2) {
        let increment = pair[1].1 - pair[0].1;
        // An increment of zero goes on with the sign before it.
        if increment == 0.0 {
            continue;
        }
        count += usize::from(increment.signum() * sign < 0.0 && increment.abs() > least_m);
        sign = increment.signum();
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLYNOMIAL: TurnTimes = TurnTimes::Polynomial { least_m: 1.0, most_degree: 8 };

    /// `values` at 0, 1, 2, .. seconds.
    fn each_second(values: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
        values.into_iter().enumerate().map(|(t_s, value)| (t_s as f64, value)).collect()
    }

    #[test]
    fn increments_of_another_sign_are_turns() {
        let count = |values: &[f64]| changed_increments(&each_second(values.iter().copied()), 1.0);
        assert_eq!(count(&[0.0, 2.0, 4.0, 2.0, 0.0, 0.0, -2.0, 0.0, 2.0]), 2);
        assert_eq!(count(&[0.0, 2.0, 1.5, 3.5, 3.0, 5.0]), 2, "the way back is short, but the way on is long");
        assert_eq!(count(&[0.0, 2.0, 2.0, 2.0, 0.0]), 1, "an increment of zero is no turn");
        assert_eq!(count(&[]), 0);
        let smooth: Vec<_> = (0..=20).map(|t| 4.0 * (0.3 * f64::from(t)).sin()).collect();
        assert_eq!(count(&smooth), 0, "a smooth turn is not seen");
    }

    #[test]
    fn the_turns_of_a_polynomial_are_found_exactly() {
        // x' = (t - 12) (t - 30) (t - 55) / 1000
        let x = |t: f64| 1e-3 * (t.powi(4) / 4.0 - 97.0 * t.powi(3) / 3.0 + 2670.0 * t * t / 2.0 - 19800.0 * t);
        let points = each_second((0..=70).map(|t| x(f64::from(t))));
        let found = zeros_s(&points, 4, 8);
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, expected) in found.into_iter().zip([12.0, 30.0, 55.0]) {
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }

    #[test]
    fn the_extremes_of_parabolas_are_found_exactly() {
        // Uneven times; a top at 2.3 s, a bottom at 7.6 s.
        let x = |t: f64| if t < 5.0 { 10.0 - (t - 2.3).powi(2) } else { -4.58 + (t - 7.6).powi(2) };
        let points = [0.0, 1.0, 2.0, 3.5, 4.5, 5.5, 7.0, 8.0, 9.0, 10.0].map(|t| (t, x(t)));
        let found = TurnTimes::Extremes(1.0).of(&points);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!((found[0] - 2.3).abs() < 1e-12 && (found[1] - 7.6).abs() < 1e-12, "{found:?}");
        assert_eq!(TurnTimes::Extremes(1.0).of(&each_second([0.0, 3.0, 0.0])), [1.0]);
        assert_eq!(TurnTimes::Extremes(1.0).of(&each_second([0.0, 3.0, 3.0, 0.0])), [1.5]);
    }

    #[test]
    fn the_degree_is_limited_by_the_number_of_points() {
        let zigzag = |count: u32| each_second((0..count).map(|t| f64::from(3 * (t % 2))));
        assert!(POLYNOMIAL.of(&zigzag(4)).is_empty(), "degree 1");
        assert!(POLYNOMIAL.of(&zigzag(9)).len() <= 3, "degree 4");
        assert!(POLYNOMIAL.of(&zigzag(60)).len() <= 7, "degree 8");
        assert!(POLYNOMIAL.of(&[]).is_empty());
        assert!(POLYNOMIAL.of(&[(1.0, 0.0); 7]).is_empty());
    }
}
