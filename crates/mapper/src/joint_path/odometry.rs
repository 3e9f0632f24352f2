//! Odometry as a prior of a path: each leg is what odometry says, but for scale, drift and noise.

use nalgebra::{DVector, Vector4};

use super::PathError;
use super::chain::ChainSystem;

/// Shares of the drift and the wander of odometry that are tried: the evidence chooses.
pub(super) const FACTORS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];

/// A step of the path as odometry has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// How far and where to (m), in the frame of odometry.
    pub(super) by: [f64; 2],
    pub(super) length_m: f64,
    /// How much the path turns at its beginning (rad).
    pub(super) turn_rad: f64,
    /// Whether it leads from one robot's last pose to the next one's first, so that it says nothing.
    pub(super) is_jump: bool,
}

/// The legs between poses, each given by its place (m) and whether it is of another robot than the one before.
pub(super) fn legs(poses: impl Iterator<Item = ([f64; 2], bool)>) -> Vec<Leg> {
    let mut found = Vec::new();
    let mut last: Option<[f64; 2]> = None;
    let mut before: Option<[f64; 2]> = None;
    for (place, is_first) in poses {
        if let Some(last) = last {
            let by = [place[0] - last[0], place[1] - last[1]];
            let turn_rad = before.filter(|_| !is_first).map_or(0.0, |before| {
                libm::atan2(before[0] * by[1] - before[1] * by[0], before[0] * by[0] + before[1] * by[1])
            });
            found.push(Leg { by, length_m: libm::hypot(by[0], by[1]), turn_rad, is_jump: is_first });
            before = (!is_first).then_some(by);
        }
        last = Some(place);
    }
    found
}

/// Odometry: the legs, how wrong it is, and what is known of the first pose of each robot. A state is x, y (m), the turn of
/// odometry's frame (rad), and nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Odometry<'a> {
    pub(super) legs: &'a [Leg],
    pub(super) error: PathError,
    /// The first pose of each robot with its place (m).
    pub(super) firsts: &'a [(usize, [f64; 2])],
    /// How well these are known (m, rad).
    pub(super) first_deviation: [f64; 2],
    /// Where scale and drift stand in the border.
    pub(super) scale: usize,
    pub(super) drift: usize,
}

/// How far the frame of odometry is turned in the middle of a leg (rad): on the leg it turns steadily.
fn middle_turn(from: &Vector4<f64>, to: &Vector4<f64>) -> f64 {
    0.5 * (from[2] + to[2])
}

impl Odometry<'_> {
    /// The variance of a leg's length error along each axis (m²), and of its turn (rad²). What a robot turns on the spot is less
    /// certain.
    fn variances(&self, leg: &Leg) -> [f64; 2] {
        let length_m = leg.length_m.max(0.01);
        let along = self.error.position_m_per_root_m.powi(2) * length_m + 1e-6;
        let turn = self.error.heading_rad_per_root_m.powi(2) * (length_m + 4.0 * leg.turn_rad * leg.turn_rad) + 1e-9;
        [along, turn]
    }

    /// The residuals of a leg: along x and y of odometry's frame (m), and of the turn (rad).
    fn of_leg(&self, leg: &Leg, from: &Vector4<f64>, to: &Vector4<f64>, border: &DVector<f64>) -> [f64; 3] {
        let (sin, cos) = libm::sincos(middle_turn(from, to));
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let longer = 1.0 + border[self.scale];
        [
            cos * x + sin * y - longer * leg.by[0],
            -sin * x + cos * y - longer * leg.by[1],
            to[2] - from[2] - border[self.drift] * leg.length_m,
        ]
    }

    /// Length of the path (m).
    pub(super) fn length_m(&self) -> f64 {
        self.legs.iter().filter(|leg| !leg.is_jump).map(|leg| leg.length_m).sum()
    }

    /// What is known of first poses: pose, entry, mean, standard deviation.
    fn of_firsts(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> {
        let [place, turn] = self.first_deviation;
        self.firsts
            .iter()
            .flat_map(move |&(pose, [x, y])| [(pose, 0, x, place), (pose, 1, y, place), (pose, 2, 0.0, turn)])
    }

    /// What is known of scale and drift: entry and standard deviation.
    fn of_border(&self) -> [(usize, f64); 2] {
        [(self.scale, self.error.scale.max(1e-9)), (self.drift, self.error.drift_rad_per_m.max(1e-9))]
    }

    /// The logarithm of the prior of a path.
    pub(super) fn value(&self, poses: &[Vector4<f64>], border: &DVector<f64>) -> f64 {
        let mut value = 0.0;
        for (number, leg) in self.legs.iter().enumerate().filter(|(_, leg)| !leg.is_jump) {
            let [x, y, turn] = self.of_leg(leg, &poses[number], &poses[number + 1], border);
            let [along, turning] = self.variances(leg);
            value -= 0.5 * ((x * x + y * y) / along + turn * turn / turning);
        }
        for (pose, entry, mean, deviation) in self.of_firsts() {
            value -= 0.5 * ((poses[pose][entry] - mean) / deviation).powi(2);
        }
        value
            - self
                .of_border()
                .iter()
                .map(|&(entry, deviation)| 0.5 * (border[entry] / deviation).powi(2))
                .sum::<f64>()
    }

    /// Adds the slope and the curvature of the prior.
    pub(super) fn add(&self, system: &mut ChainSystem, poses: &[Vector4<f64>], border: &DVector<f64>) {
        for (number, leg) in self.legs.iter().enumerate().filter(|(_, leg)| !leg.is_jump) {
            let (from, to) = (&poses[number], &poses[number + 1]);
            let [x, y, turn] = self.of_leg(leg, from, to, border);
            let [along, turning] = self.variances(leg);
            let longer = 1.0 + border[self.scale];
            let (sin, cos) = libm::sincos(middle_turn(from, to));
            // Half of what the leg is in the frame of odometry: each end has half of the turn in its middle.
            let (turned_x, turned_y) = (0.5 * (x + longer * leg.by[0]), 0.5 * (y + longer * leg.by[1]));
            let rows = [
                (
                    Vector4::new(-cos, -sin, turned_y, 0.0),
                    Vector4::new(cos, sin, turned_y, 0.0),
                    (self.scale, -leg.by[0]),
                    x,
                    along,
                ),
                (
                    Vector4::new(sin, -cos, -turned_x, 0.0),
                    Vector4::new(-sin, cos, -turned_x, 0.0),
                    (self.scale, -leg.by[1]),
                    y,
                    along,
                ),
                (
                    Vector4::new(0.0, 0.0, -1.0, 0.0),
                    Vector4::new(0.0, 0.0, 1.0, 0.0),
                    (self.drift, -leg.length_m),
                    turn,
                    turning,
                ),
            ];
            for (by_from, by_to, by_border, residual, variance) in rows {
                system.add(number, by_from, Some(by_to), &[by_border], 1.0 / variance, -residual / variance);
            }
        }
        for (entry, deviation) in self.of_border() {
            system.add_to_border(entry, entry, deviation.powi(-2));
            system.border_slope[entry] -= border[entry] / deviation.powi(2);
        }
        for (pose, entry, mean, deviation) in self.of_firsts() {
            system.states[pose][(entry, entry)] += deviation.powi(-2);
            system.slopes[pose][entry] -= (poses[pose][entry] - mean) / deviation.powi(2);
        }
        for state in &mut system.states {
            state[(3, 3)] += 1.0;
        }
    }

    /// What the widths of the prior add to the logarithm of the marginal likelihood.
    pub(super) fn log_widths(&self) -> f64 {
        let of_legs = self.legs.iter().filter(|leg| !leg.is_jump).map(|leg| {
            let [along, turning] = self.variances(leg);
            -libm::log(along) - 0.5 * libm::log(turning)
        });
        of_legs.sum::<f64>() - self.of_border().iter().map(|&(_, deviation)| libm::log(deviation)).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_that_turns_steadily_is_its_chord() {
        let legs = [Leg { by: [1.0, 0.0], length_m: 1.0, turn_rad: 0.0, is_jump: false }];
        let error = PathError { drift_rad_per_m: 1.0, ..PathError::default() };
        let odometry = Odometry { legs: &legs, error, firsts: &[], first_deviation: [1.0, 1.0], scale: 0, drift: 1 };
        let (sin, cos) = libm::sincos(0.1);
        let poses = [Vector4::zeros(), Vector4::new(cos, sin, 0.2, 0.0)];
        // What is left is the prior of the drift.
        let value = odometry.value(&poses, &DVector::from_vec(vec![0.0, 0.2]));
        assert!((value + 0.5 * 0.2 * 0.2).abs() < 1e-9, "{value}");
    }
}
