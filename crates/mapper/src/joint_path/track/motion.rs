//! How a tag moves: freely, or as odometry says.

use nalgebra::{DVector, Vector4};

use crate::joint_path::chain::ChainSystem;
use crate::joint_path::odometry::Odometry;

/// Usual speeds are up to a few metres a second.
const SPEED_M_PER_S: f64 = 20.0;

/// The prior of a track.
#[derive(Clone, Copy, Debug)]
pub(super) enum Motion<'a> {
    /// A state is x, y (m), and the velocity along them (m/s).
    Free(FreeMotion<'a>),
    /// A state is x, y (m), the turn of odometry's frame (rad), and nothing.
    Driven(Odometry<'a>),
}

/// The acceleration is white noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeMotion<'a> {
    /// Times from each epoch to the next (s).
    pub(super) steps_s: &'a [f64],
    /// Power spectral density of the acceleration (m²/s³).
    pub(super) acceleration: f64,
}

impl Motion<'_> {
    /// The antenna that is `offset` from the state (m), and is read so much later than it (s); and what the state's third and fourth
    /// entry add to it along x and y.
    pub(super) fn antenna(&self, state: &Vector4<f64>, after_s: f64, offset: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        match self {
            Self::Free(_) => {
                ([state[0] + after_s * state[2], state[1] + after_s * state[3]], [[after_s, 0.0], [0.0, after_s]])
            }
            Self::Driven(_) => {
                let (sin, cos) = libm::sincos(state[2]);
                let [x, y] = [cos * offset[0] - sin * offset[1], sin * offset[0] + cos * offset[1]];
                ([state[0] + x, state[1] + y], [[-y, 0.0], [x, 0.0]])
            }
        }
    }

    /// The logarithm of the prior, but for a constant.
    pub(super) fn value(&self, states: &[Vector4<f64>], border: &DVector<f64>) -> f64 {
        match self {
            Self::Free(motion) => motion.value(states),
            Self::Driven(odometry) => odometry.value(states, border),
        }
    }

    /// Adds the slope and the curvature of the prior.
    pub(super) fn add(&self, system: &mut ChainSystem, states: &[Vector4<f64>], border: &DVector<f64>) {
        match self {
            Self::Free(motion) => motion.add(system, states),
            Self::Driven(odometry) => odometry.add(system, states, border),
        }
    }

    /// What the widths of the prior add to the logarithm of the marginal likelihood.
    pub(super) fn log_widths(&self) -> f64 {
        match self {
            Self::Free(motion) => -2.0 * motion.steps_s.len() as f64 * libm::log(motion.acceleration),
            Self::Driven(odometry) => odometry.log_widths(),
        }
    }
}

impl FreeMotion<'_> {
    /// The residuals of a step along x (0) or y (1): of the velocity, and of the place that two velocities do not explain; with
    /// their variances. They are independent.
    fn of_step(&self, step_s: f64, axis: usize, from: &Vector4<f64>, to: &Vector4<f64>) -> [(f64, f64); 2] {
        let velocity = to[2 + axis] - from[2 + axis];
        let place = to[axis] - from[axis] - 0.5 * step_s * (to[2 + axis] + from[2 + axis]);
        [(velocity, self.acceleration * step_s), (place, self.acceleration * step_s.powi(3) / 12.0)]
    }

    fn value(&self, states: &[Vector4<f64>]) -> f64 {
        let mut value = 0.0;
        for (pair, &step_s) in states.windows(2).zip(self.steps_s) {
            for axis in 0..2 {
                let residuals = self.of_step(step_s, axis, &pair[0], &pair[1]);
                value -=
                    residuals.iter().map(|(residual, variance)| 0.5 * residual * residual / variance).sum::<f64>();
            }
        }
        for state in states {
            value -= 0.5 * (state[2].powi(2) + state[3].powi(2)) / SPEED_M_PER_S.powi(2);
        }
        value
    }

    fn add(&self, system: &mut ChainSystem, states: &[Vector4<f64>]) {
        let unit = |entry: usize, value: f64| {
            let mut vector = Vector4::zeros();
            vector[entry] = value;
            vector
        };
        for (number, (pair, &step_s)) in states.windows(2).zip(self.steps_s).enumerate() {
            for axis in 0..2 {
                let rows = [
                    (unit(2 + axis, -1.0), unit(2 + axis, 1.0)),
                    (
                        unit(axis, -1.0) + unit(2 + axis, -0.5 * step_s),
                        unit(axis, 1.0) + unit(2 + axis, -0.5 * step_s),
                    ),
                ];
                for ((by_from, by_to), (residual, variance)) in
                    rows.into_iter().zip(self.of_step(step_s, axis, &pair[0], &pair[1]))
                {
                    system.add(number, by_from, Some(by_to), &[], 1.0 / variance, -residual / variance);
                }
            }
        }
        let slowness = SPEED_M_PER_S.powi(-2);
        for ((curvature, slope), state) in system.states.iter_mut().zip(&mut system.slopes).zip(states) {
            for entry in [2, 3] {
                curvature[(entry, entry)] += slowness;
                slope[entry] -= slowness * state[entry];
            }
        }
    }
}
