//! Polynomials on [-1, 1] as sums of Legendre polynomials. Powers of time would lose all digits: the normal equations
//! of degree 6 at t up to 80 have a condition number of 1e22.

use nalgebra::{DMatrix, DVector};

/// Σ c_k P_k(u). There is at least one coefficient.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegendreSeries {
    coefficients: Vec<f64>,
}

impl LegendreSeries {
    /// The constant 1.
    pub(super) fn one() -> Self {
        Self { coefficients: vec![1.0] }
    }

    /// The series of `degree` with the least squares of its distances from `points` (u, value), by QR; `None` if the
    /// points do not determine it.
    pub(super) fn fit(points: &[(f64, f64)], degree: usize) -> Option<Self> {
        let terms = degree + 1;
        if points.len() < terms {
            return None;
        }
        let mut basis = DMatrix::zeros(points.len(), terms);
        for (row, &(u, _)) in points.iter().enumerate() {
            for (column, value) in legendre(u).take(terms).enumerate() {
                basis[(row, column)] = value;
            }
        }
        let mut values = DVector::from_iterator(points.len(), points.iter().map(|&(_, value)| value));
        let qr = basis.qr();
        qr.q_tr_mul(&mut values);
        let r = qr.unpack_r();
        let diagonal = r.diagonal().abs();
        if diagonal.min() <= 1e-10 * diagonal.max() {
            return None;
        }
        let coefficients = r.solve_upper_triangular(&values.rows(0, terms))?;
        Some(Self { coefficients: coefficients.iter().copied().collect() })
    }

    /// The value at `u`.
    pub(super) fn at(&self, u: f64) -> f64 {
        self.coefficients.iter().zip(legendre(u)).map(|(c, p)| c * p).sum()
    }

    /// The derivative, from P'_k = P'_{k-2} + (2k-1) P_{k-1}.
    pub(super) fn derivative(&self) -> Self {
        let mut left = self.coefficients.clone();
        let mut coefficients = vec![0.0; (left.len() - 1).max(1)];
        for k in (1..left.len()).rev() {
            coefficients[k - 1] = (2 * k - 1) as f64 * left[k];
            if k >= 2 {
                left[k - 2] += left[k];
            }
        }
        Self { coefficients }
    }

    /// An integral: ∫P_k = (P_{k+1} - P_{k-1}) / (2k+1), with P_{-1} left out.
    pub(super) fn integral(&self) -> Self {
        let mut coefficients = vec![0.0; self.coefficients.len() + 1];
        for (k, c) in self.coefficients.iter().enumerate() {
            let part = c / (2 * k + 1) as f64;
            coefficients[k + 1] += part;
            if k >= 1 {
                coefficients[k - 1] -= part;
            }
        }
        Self { coefficients }
    }

    /// The product with (u - `root`), from u P_k = ((k+1) P_{k+1} + k P_{k-1}) / (2k+1).
    pub(super) fn times_root(&self, root: f64) -> Self {
        let mut coefficients: Vec<f64> = self.coefficients.iter().map(|c| -root * c).collect();
        coefficients.push(0.0);
        for (k, c) in self.coefficients.iter().enumerate() {
            let part = c / (2 * k + 1) as f64;
            coefficients[k + 1] += part * (k + 1) as f64;
            if k >= 1 {
                coefficients[k - 1] += part * k as f64;
            }
        }
        Self { coefficients }
    }

    /// Where the sign changes within (-1, 1), in ascending order. Between two changes of sign of its derivative the
    /// series is monotone, so that bisection misses no change.
    pub(super) fn sign_changes(&self) -> Vec<f64> {
        if self.coefficients.len() < 2 {
            return Vec::new();
        }
        let mut knots = self.derivative().sign_changes();
        knots.push(1.0);
        let mut changes = Vec::new();
        let (mut low, mut at_low) = (-1.0, self.at(-1.0));
        for knot in knots {
            let at_knot = self.at(knot);
            if at_low * at_knot < 0.0 {
                changes.push(self.bisect(low, knot, at_low));
            }
            // A knot at which the series is zero is passed over, with the sign before it.
            if at_knot != 0.0 {
                (low, at_low) = (knot, at_knot);
            }
        }
        changes
    }

    /// The change of sign between `low` and `high`.
    fn bisect(&self, mut low: f64, mut high: f64, at_low: f64) -> f64 {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if self.at(middle) * at_low > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
}

/// P_0(u), P_1(u), ..: (k+1) P_{k+1} = (2k+1) u P_k - k P_{k-1}.
fn legendre(u: f64) -> impl Iterator<Item = f64> {
    let (mut before, mut now, mut k) = (0.0, 1.0, 0.0);
    std::iter::from_fn(move || {
        let value = now;
        (before, now) = (now, ((2.0 * k + 1.0) * u * now - k * before) / (k + 1.0));
        k += 1.0;
        Some(value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-13 * b.abs().max(1.0), "{a} for {b}");
    }

    #[test]
    fn the_polynomials_are_those_of_the_tables() {
        for u in [-1.0, -0.4, 0.0, 0.7, 1.2_f64] {
            let p: Vec<_> = legendre(u).take(5).collect();
            close(p[2], 0.5 * (3.0 * u * u - 1.0));
            close(p[3], 0.5 * (5.0 * u.powi(3) - 3.0 * u));
            close(p[4], (35.0 * u.powi(4) - 30.0 * u * u + 3.0) / 8.0);
        }
    }

    #[test]
    fn products_integrals_and_derivatives_are_those_of_powers() {
        // (u - 0.5) (u + 0.25) (u - 2) = u³ - 2.25 u² + 0.375 u + 0.25
        let cubic = [0.5, -0.25, 2.0].iter().fold(LegendreSeries::one(), |series, &root| series.times_root(root));
        let (derivative, integral) = (cubic.derivative(), cubic.integral());
        let primitive = |u: f64| u.powi(4) / 4.0 - 0.75 * u.powi(3) + 0.1875 * u * u + 0.25 * u;
        for u in [-1.0, -0.3, 0.1, 0.9_f64] {
            close(cubic.at(u), u.powi(3) - 2.25 * u * u + 0.375 * u + 0.25);
            close(derivative.at(u), 3.0 * u * u - 4.5 * u + 0.375);
            close(integral.at(u) - integral.at(0.0), primitive(u));
            close(integral.derivative().at(u), cubic.at(u));
        }
        assert_eq!(LegendreSeries::one().derivative(), LegendreSeries { coefficients: vec![0.0] });
    }

    #[test]
    fn only_changes_of_sign_inside_are_found() {
        let with_roots =
            |roots: &[f64]| roots.iter().fold(LegendreSeries::one(), |series, &root| series.times_root(root));
        let found = |roots: &[f64]| with_roots(roots).sign_changes();
        for roots in [&[-0.7, 0.2, 0.201, 0.9][..], &[-0.999, 0.0, 0.999], &[0.3], &[]] {
            let changes = found(roots);
            assert_eq!(changes.len(), roots.len(), "{roots:?}: {changes:?}");
            for (change, root) in changes.iter().zip(roots) {
                assert!((change - root).abs() < 1e-12, "{change} for {root}");
            }
        }
        assert_eq!(found(&[1.5, -3.0]), [0.0; 0], "outside");
        assert_eq!(found(&[0.0, 0.0]), [0.0; 0], "touches without a change");
        assert_eq!(found(&[0.0, 0.0, 0.0]).len(), 1, "three times, with a change");
    }

    #[test]
    fn a_polynomial_of_degree_6_is_recovered_from_times_up_to_80() {
        // Wilkinson-like: (t - 10) (t - 22) (t - 34) (t - 47) (t - 60) (t - 71) / 1e6, in exact integers at whole t.
        let roots = [10_i64, 22, 34, 47, 60, 71];
        let exact = |t: i64| roots.iter().map(|root| t - root).product::<i64>() as f64 / 1e6;
        let u = |t: f64| t / 40.0 - 1.0;
        let points: Vec<_> = (0..=80).map(|t| (u(t as f64), exact(t))).collect();
        let series = LegendreSeries::fit(&points, 6).expect("determined");
        let largest = points.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
        for &(u, value) in &points {
            assert!((series.at(u) - value).abs() <= 1e-14 * largest, "{} for {value}", series.at(u));
        }
        for (change, root) in series.sign_changes().into_iter().zip(roots) {
            assert!((40.0 * (change + 1.0) - root as f64).abs() < 1e-10, "{change} for {root}");
        }
        // The same by normal equations of powers of t, as printed in the thesis, is far off.
        let power = |t: i64, k: usize| (0..k).map(|_| t as f64).product::<f64>();
        let normal = DMatrix::from_fn(7, 7, |i, j| (0..=80).map(|t| power(t, i + j)).sum::<f64>());
        let right = DVector::from_fn(7, |i, _| (0..=80).map(|t| power(t, i) * exact(t)).sum::<f64>());
        let powers = normal.try_inverse().map(|inverse| inverse * right);
        let error = |powers: &DVector<f64>| {
            let value = |t: i64| powers.iter().enumerate().map(|(k, c)| c * power(t, k)).sum::<f64>();
            (0..=80).map(|t| (value(t) - exact(t)).abs()).fold(0.0, f64::max)
        };
        assert!(powers.is_none_or(|powers| error(&powers) > 1e-9 * largest));
    }

    #[test]
    fn points_that_do_not_determine_a_series_are_refused() {
        assert_eq!(LegendreSeries::fit(&[(0.0, 1.0), (0.5, 2.0)], 2), None);
        assert_eq!(LegendreSeries::fit(&[(0.5, 1.0), (0.5, 2.0), (0.5, 3.0)], 1), None);
    }
}
