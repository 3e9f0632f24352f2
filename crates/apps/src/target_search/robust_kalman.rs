//! A robust Kalman filter for a target whose speed is uncertain.
//!
//! The model is x(k+1) = (A + B Δ K) x(k) + w(k), y(k) = C x(k) + v(k): the target moves at constant velocity, but the
//! steps of its place are longer or shorter than its velocity says by a factor in [1-ζ, 1+ζ] (Gunathillake 2018,
//! section 6.3.2). The filter is that of Petersen and Savkin (1999, "Robust Kalman Filtering for Signals and Systems
//! with Large Uncertainties"): it works out the set of all states that agree with the measurements and with a sum
//! quadratic constraint on w, v and Δ, and the middle of the set is the estimate.
//!
//! Three things differ in form, not in numbers. The recursion runs on P = S⁻¹, so that A needs no inverse. All matrices
//! of the model are blocks of one number per pair of axes, so one axis is computed for all. And K has rank one on an
//! axis, so that S > 0 exactly if τζ² times the variance of the velocity is below 1 (determinant lemma).
//!
//! The constraint holds for each multiplier τ > 0 of its uncertain part (S-procedure). The book has τ = 1, with which
//! the set need not be bounded. The book's constraint leaves out the uncertainty of the first step; here its sum starts
//! with that step.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SettingError;

use super::target_state::{AxisCovariance, Fix, TargetState};

/// Settings of a [`RobustKalman`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RobustKalmanSettings {
    /// ζ: largest relative error of the speed along an axis, 0 or more and below 1. 0 gives the usual Kalman filter.
    pub zeta: f64,
    /// Standard deviation of the target's acceleration along an axis (m/s²), constant during a step.
    pub acceleration_sigma_m_per_s2: f64,
    /// Standard deviation of the first place along an axis (m).
    pub position_sigma_m: f64,
    /// Standard deviation of the first velocity along an axis (m/s): the largest speed of the target.
    pub max_speed_m_per_s: f64,
}

impl Default for RobustKalmanSettings {
    fn default() -> Self {
        Self { zeta: 0.3, acceleration_sigma_m_per_s2: 0.5, position_sigma_m: 1.0, max_speed_m_per_s: 1.5 }
    }
}

impl RobustKalmanSettings {
    /// These settings, if they are valid.
    ///
    /// # Errors
    /// If a value is invalid. The keys are those of the fields.
    pub(crate) fn validated(self) -> Result<Self, SettingError> {
        if !(0.0..1.0).contains(&self.zeta) {
            return Err(SettingError::new("zeta", self.zeta, "0 or more, and below 1"));
        }
        SettingError::not_negative("acceleration_sigma_m_per_s2", self.acceleration_sigma_m_per_s2)?;
        SettingError::positive("position_sigma_m", self.position_sigma_m)?;
        SettingError::positive("max_speed_m_per_s", self.max_speed_m_per_s)?;
        Ok(self)
    }
}

/// The filter, after a step.
#[derive(Clone, Debug)]
pub(crate) struct RobustKalman {
    settings: RobustKalmanSettings,
    /// x̂ and S⁻¹.
    state: TargetState,
    /// The multiplier τ of the uncertainty of the next step; `None` if there is no uncertainty (ζ = 0): the usual Kalman filter.
    tau: Option<f64>,
    /// ρ: the states with (x - x̂)ᵀ S (x - x̂) ≤ ρ + d are possible.
    rho: f64,
}

impl RobustKalman {
    /// The filter after the first place of the target; its velocity is unknown.
    #[must_use]
    pub(crate) fn new(settings: RobustKalmanSettings, first: Position) -> Self {
        let covariance = AxisCovariance {
            place_m2: settings.position_sigma_m * settings.position_sigma_m,
            cross_m2_per_s: 0.0,
            velocity_m2_per_s2: settings.max_speed_m_per_s * settings.max_speed_m_per_s,
        };
        let state = TargetState { place: first, velocity_m_per_s: Position::ORIGIN, covariance };
        let mut filter = Self { settings, state, tau: None, rho: 0.0 };
        filter.admit_uncertainty();
        filter
    }

    /// Goes on by `step`, and uses what was measured at its end, if anything was. A step of zero length without a
    /// measurement changes nothing.
    pub(crate) fn advance(&mut self, step: Duration, fix: Option<Fix>) {
        if step.is_zero() && fix.is_none() {
            return;
        }
        self.state = self.predict(step);
        if let Some(fix) = fix {
            self.correct(fix);
        }
        self.admit_uncertainty();
    }

    /// The estimate x̂ and its covariance S⁻¹.
    #[must_use]
    pub(crate) fn state(&self) -> TargetState {
        self.state
    }

    /// The state after another `span` at constant velocity, for the middle of the uncertainty (Δ = 0). The covariance
    /// holds for all of it.
    #[must_use]
    pub(crate) fn predict(&self, span: Duration) -> TargetState {
        let t_s = span.as_secs_f64();
        let mut covariance = self.state.covariance.after(t_s);
        if let Some(tau) = self.tau {
            covariance.place_m2 += t_s * t_s / tau;
        }
        let sigma = self.settings.acceleration_sigma_m_per_s2 * t_s;
        let velocity_m2_per_s2 = sigma * sigma;
        covariance.place_m2 += 0.25 * t_s * t_s * velocity_m2_per_s2;
        covariance.cross_m2_per_s += 0.5 * t_s * velocity_m2_per_s2;
        covariance.velocity_m2_per_s2 += velocity_m2_per_s2;
        let place = self.state.place + self.state.velocity_m_per_s * t_s;
        TargetState { place, covariance, ..self.state }
    }

    /// Squared radius of the set of possible states in the norm of S = P⁻¹, summed over the axes, if the squares of all
    /// noises, divided by their variances, sum up to `budget` at most (d of the book); `None` if no state is possible:
    /// the measurements contradict the model.
    #[cfg(test)]
    fn possible_within(&self, budget: f64) -> Option<f64> {
        let square = self.rho + budget;
        (square >= 0.0).then_some(square)
    }

    /// Kalman's correction by a measured place: adds CᵀRC to the information.
    fn correct(&mut self, fix: Fix) {
        let AxisCovariance { place_m2, cross_m2_per_s, velocity_m2_per_s2 } = self.state.covariance;
        let total_m2 = place_m2 + fix.variance_m2;
        let innovation = fix.place - self.state.place;
        self.state.place = self.state.place + innovation * (place_m2 / total_m2);
        self.state.velocity_m_per_s = self.state.velocity_m_per_s + innovation * (cross_m2_per_s / total_m2);
        self.rho -= innovation.dot(innovation) / total_m2;
        let kept = fix.variance_m2 / total_m2;
        let determinant = (place_m2 * velocity_m2_per_s2 - cross_m2_per_s * cross_m2_per_s).max(0.0);
        self.state.covariance = AxisCovariance {
            place_m2: place_m2 * kept,
            cross_m2_per_s: cross_m2_per_s * kept,
            velocity_m2_per_s2: determinant / total_m2 + velocity_m2_per_s2 * kept,
        };
    }

    /// Subtracts τζ²KᵀK from the information S, for the uncertainty of the step that follows.
    fn admit_uncertainty(&mut self) {
        let zeta2 = self.settings.zeta * self.settings.zeta;
        let AxisCovariance { place_m2, cross_m2_per_s, velocity_m2_per_s2 } = self.state.covariance;
        // ζ²·λmax(K Pu Kᵀ): the filter exists for τ below its inverse.
        let limit = zeta2 * velocity_m2_per_s2;
        if limit <= 0.0 {
            self.tau = None;
            return;
        }
        // Half of the largest τ with which it exists, but at most 1, the value of the book.
        let tau = 1_f64.min(0.5 / limit);
        let left = 1.0 - tau * limit;
        let gain = tau * zeta2 / left;
        let velocity = self.state.velocity_m_per_s;
        self.rho += gain * velocity.dot(velocity);
        self.state.place = self.state.place + velocity * (gain * cross_m2_per_s);
        self.state.velocity_m_per_s = velocity * (1.0 / left);
        self.state.covariance = AxisCovariance {
            place_m2: place_m2 + gain * cross_m2_per_s * cross_m2_per_s,
            cross_m2_per_s: cross_m2_per_s / left,
            velocity_m2_per_s2: velocity_m2_per_s2 / left,
        };
        self.tau = Some(tau);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use sextant_kernel::{Purpose, Seed};

    use super::*;

    /// The recursion of Petersen and Savkin on S, η and g, in the plane, with the inverse of A.
    struct Book {
        zeta: f64,
        t_s: f64,
        sigma: f64,
        s: DMatrix<f64>,
        eta: DVector<f64>,
        g: f64,
        /// B₁ and Q of the next step, which the multiplier changes.
        b1: DMatrix<f64>,
        q: DMatrix<f64>,
    }

    fn c() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 4, &[1., 0., 0., 0., 0., 1., 0., 0.])
    }

    fn k() -> DMatrix<f64> {
        DMatrix::from_row_slice(2, 4, &[0., 0., 1., 0., 0., 0., 0., 1.])
    }

    impl Book {
        fn new(settings: &RobustKalmanSettings, t_s: f64, first: Position) -> Self {
            let position = settings.position_sigma_m.powi(-2);
            let velocity = settings.max_speed_m_per_s.powi(-2);
            let n = DMatrix::from_diagonal(&DVector::from_vec(vec![position, position, velocity, velocity]));
            let start = DVector::from_vec(vec![first.x_m, first.y_m, 0.0, 0.0]);
            let sigma = settings.acceleration_sigma_m_per_s2;
            let g = (start.transpose() * &n * &start)[0];
            let (b1, q) = (DMatrix::zeros(4, 0), DMatrix::zeros(0, 0));
            let mut book = Self { zeta: settings.zeta, t_s, sigma, eta: &n * start, s: n, g, b1, q };
            book.subtract_k();
            book
        }

        /// Chooses τ for the step that follows: S - τζ²KᵀK, with B₁ = [B G] and Q = diag(τ, 1/σ²).
        fn subtract_k(&mut self) {
            let t = self.t_s;
            let g_columns = [0.5 * t * t, 0., t, 0., 0., 0.5 * t * t, 0., t];
            self.b1 = DMatrix::from_column_slice(4, 2, &g_columns);
            self.q = DMatrix::identity(2, 2) * self.sigma.powi(-2);
            if self.zeta > 0.0 {
                let covariance = self.s.clone().try_inverse().unwrap();
                let largest = (k() * covariance * k().transpose()).symmetric_eigenvalues().max();
                let tau = 1_f64.min(0.5 / (self.zeta * self.zeta * largest));
                self.s -= k().transpose() * k() * (tau * self.zeta * self.zeta);
                let b_columns = [t, 0., 0., 0., 0., t, 0., 0.];
                let g_columns = self.b1.clone();
                self.b1 = DMatrix::from_column_slice(4, 2, &b_columns).resize_horizontally(4, 0.0);
                self.b1.columns_mut(2, 2).copy_from(&g_columns);
                let weights = vec![tau, tau, self.sigma.powi(-2), self.sigma.powi(-2)];
                self.q = DMatrix::from_diagonal(&DVector::from_vec(weights));
            }
            assert!(self.s.clone().cholesky().is_some());
        }

        fn advance(&mut self, fix: Option<Fix>) {
            let t = self.t_s;
            let a = [1., 0., t, 0., 0., 1., 0., t, 0., 0., 1., 0., 0., 0., 0., 1.];
            let a_inverse = DMatrix::from_row_slice(4, 4, &a).try_inverse().unwrap();
            let b = &a_inverse * &self.b1;
            let inner = (b.transpose() * &self.s * &b + &self.q).try_inverse().unwrap();
            let f = &inner * b.transpose() * &self.s * &a_inverse;
            let closed = &a_inverse - &b * f;
            self.g -= (self.eta.transpose() * &b * inner * b.transpose() * &self.eta)[0];
            self.s = a_inverse.transpose() * &self.s * &closed;
            self.eta = closed.transpose() * &self.eta;
            if let Some(fix) = fix {
                let y = DVector::from_vec(vec![fix.place.x_m, fix.place.y_m]);
                self.s += c().transpose() * c() / fix.variance_m2;
                self.eta += c().transpose() * &y / fix.variance_m2;
                self.g += y.dot(&y) / fix.variance_m2;
            }
            self.subtract_k();
        }

        fn estimate(&self) -> DVector<f64> {
            self.s.clone().try_inverse().unwrap() * &self.eta
        }
    }

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{a} for {b}");
    }

    /// A fix that moves and scatters, with a gap of five steps and changing variance.
    fn fix(step: u64) -> Option<Fix> {
        let noise = |axis| Seed(3).normal(Purpose::new(8), [step, axis, 1]);
        let place = Position::new(1.2 * step as f64 + noise(0), 5.0 - 0.4 * step as f64 + noise(1), 0.0);
        let variance_m2 = 0.3 + 0.1 * (step % 4) as f64;
        (!(12..17).contains(&step)).then_some(Fix { place, variance_m2 })
    }

    #[test]
    fn the_estimate_and_its_set_are_those_of_the_book() {
        for zeta in [0.0, 0.1, 0.3, 0.9] {
            let settings = RobustKalmanSettings { zeta, ..RobustKalmanSettings::default() };
            let first = Position::new(0.3, 4.0, 0.0);
            let mut filter = RobustKalman::new(settings, first);
            let mut book = Book::new(&settings, 0.5, first);
            for step in 1..=30 {
                filter.advance(Duration::from_millis(500), fix(step));
                book.advance(fix(step));
                let state = filter.state();
                let expected = book.estimate();
                let found =
                    [state.place.x_m, state.place.y_m, state.velocity_m_per_s.x_m, state.velocity_m_per_s.y_m];
                for (found, expected) in found.into_iter().zip(expected.iter()) {
                    close(found, *expected, 1e-12);
                }
                let covariance = book.s.clone().try_inverse().unwrap();
                close(state.covariance.place_m2, covariance[(0, 0)], 1e-12);
                close(state.covariance.cross_m2_per_s, covariance[(1, 3)], 1e-12);
                close(state.covariance.velocity_m2_per_s2, covariance[(2, 2)], 1e-12);
                // ρ of the book is a difference of numbers that grow with the places.
                let rho = book.eta.dot(&expected) - book.g;
                let found = filter.possible_within(1e3).expect("a generous budget") - 1e3;
                assert!((found - rho).abs() <= 1e-11 * book.g, "{found} for {rho}");
            }
        }
    }

    #[test]
    fn without_uncertainty_it_is_the_usual_kalman_filter() {
        let settings = RobustKalmanSettings { zeta: 0.0, ..RobustKalmanSettings::default() };
        let mut filter = RobustKalman::new(settings, Position::ORIGIN);
        let (t, sigma2) = (1.0, 0.25);
        let a = DMatrix::from_row_slice(2, 2, &[1.0, t, 0.0, 1.0]);
        let noise = DMatrix::from_row_slice(2, 2, &[0.25 * t, 0.5 * t, 0.5 * t, t]) * sigma2;
        let mut p = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 2.25]));
        let mut x = DVector::from_vec(vec![0.0, 0.0]);
        for step in 1..=30 {
            filter.advance(Duration::from_secs(1), fix(step));
            (x, p) = (&a * x, &a * p * a.transpose() + &noise);
            if let Some(fix) = fix(step) {
                let gain = p.column(0) / (p[(0, 0)] + fix.variance_m2);
                x += &gain * (fix.place.x_m - x[0]);
                p = (DMatrix::identity(2, 2) - gain * DMatrix::from_row_slice(1, 2, &[1.0, 0.0])) * p;
            }
            let state = filter.state();
            close(state.place.x_m, x[0], 1e-10);
            close(state.velocity_m_per_s.x_m, x[1], 1e-10);
            close(state.covariance.place_m2, p[(0, 0)], 1e-10);
            close(state.covariance.velocity_m2_per_s2, p[(1, 1)], 1e-10);
            assert_eq!(filter.tau, None);
        }
    }

    /// The largest (x - x̂)ᵀ S (x - x̂) / (ρ + d) over all steps of a target whose step factors are the worst.
    fn worst_share(zeta: f64, factor: impl Fn(u64) -> f64) -> f64 {
        let settings = RobustKalmanSettings { zeta, ..RobustKalmanSettings::default() };
        let (r, sigma) = (0.4, settings.acceleration_sigma_m_per_s2);
        let (mut place, mut velocity) = (Position::new(0.5, -0.5, 0.0), Position::new(1.2, -0.7, 0.0));
        let first = Position::ORIGIN;
        let mut budget = (place - first).dot(place - first) / settings.position_sigma_m.powi(2)
            + velocity.dot(velocity) / settings.max_speed_m_per_s.powi(2);
        let mut filter = RobustKalman::new(settings, first);
        let mut worst: f64 = 0.0;
        for step in 1..=40 {
            let draw = |what| {
                Position::new(
                    Seed(9).normal(Purpose::new(8), [step, what, 0]),
                    Seed(9).normal(Purpose::new(8), [step, what, 1]),
                    0.0,
                )
            };
            let (acceleration, noise) = (draw(0) * (0.3 * sigma), draw(1) * (0.3 * r));
            budget += acceleration.dot(acceleration) / (sigma * sigma) + noise.dot(noise) / (r * r);
            place = place + velocity * factor(step) + acceleration * 0.5;
            velocity = velocity + acceleration;
            filter.advance(Duration::from_secs(1), Some(Fix { place: place + noise, variance_m2: r * r }));
            let AxisCovariance { place_m2, cross_m2_per_s, velocity_m2_per_s2 } = filter.state().covariance;
            let determinant = place_m2 * velocity_m2_per_s2 - cross_m2_per_s * cross_m2_per_s;
            let (p, v) = (place - filter.state().place, velocity - filter.state().velocity_m_per_s);
            let square = velocity_m2_per_s2 * p.dot(p) - 2.0 * cross_m2_per_s * p.dot(v) + place_m2 * v.dot(v);
            let Some(allowed) = filter.possible_within(budget) else { return f64::INFINITY };
            worst = worst.max(square / determinant / allowed);
        }
        worst
    }

    #[test]
    fn a_target_within_the_constraint_is_in_the_set_of_possible_states() {
        for zeta in [0.1, 0.3, 0.6] {
            let patterns: [&dyn Fn(u64) -> f64; 4] = [
                &|_| 1.0 + zeta,
                &|_| 1.0 - zeta,
                &|step| if step % 2 == 0 { 1.0 + zeta } else { 1.0 - zeta },
                &|step| 1.0 + zeta * (2.0 * Seed(4).uniform(Purpose::new(8), [step, 0, 0]) - 1.0),
            ];
            for pattern in patterns {
                let share = worst_share(zeta, pattern);
                assert!(share <= 1.0 + 1e-9, "{share} of the set at zeta {zeta}");
            }
        }
        // A target that the constraint does not allow is found out: the test can fail.
        assert!(worst_share(0.0, |_| 1.5) > 1.0);
    }

    #[test]
    fn the_multiplier_is_that_of_the_book_unless_a_velocity_is_too_uncertain_for_it() {
        let tau = |zeta: f64| {
            let settings = RobustKalmanSettings { zeta, max_speed_m_per_s: 1.2, ..RobustKalmanSettings::default() };
            RobustKalman::new(settings, Position::ORIGIN).tau
        };
        assert_eq!(tau(0.3), Some(1.0));
        // 0.9² · 1.2² = 1.1664 > 1: S = N - ζ²KᵀK would be indefinite.
        assert_eq!(tau(0.9), Some(0.5 / 1.1664));
    }

    #[test]
    fn the_height_of_a_planar_map_stays_what_it_is() {
        let mut filter = RobustKalman::new(RobustKalmanSettings::default(), Position::new(0.0, 0.0, 1.7));
        for step in 1..=20 {
            let measured = fix(step).map(|fix| Fix { place: Position { z_m: 1.7, ..fix.place }, ..fix });
            filter.advance(Duration::from_millis(700), measured);
            assert_eq!(filter.state().place.z_m.to_bits(), 1.7_f64.to_bits());
        }
    }

    #[test]
    fn invalid_settings_are_rejected() {
        let settings = RobustKalmanSettings::default();
        assert!(settings.validated().is_ok());
        for invalid in [
            RobustKalmanSettings { zeta: 1.0, ..settings },
            RobustKalmanSettings { zeta: f64::NAN, ..settings },
            RobustKalmanSettings { position_sigma_m: 0.0, ..settings },
            RobustKalmanSettings { acceleration_sigma_m_per_s2: -1.0, ..settings },
        ] {
            assert!(invalid.validated().is_err(), "{invalid:?}");
        }
    }
}
