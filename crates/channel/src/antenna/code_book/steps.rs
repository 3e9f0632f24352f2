//! Equal steps of an angle: an axis of a grid of directions.

use std::f64::consts::TAU;

/// Equal steps of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    pub(super) first_deg: f64,
    /// 0 for a single angle.
    pub(super) step_deg: f64,
    pub(super) count: usize,
}

/// How far an angle may be from its step (degrees): rounded angles of a file.
const TOLERANCE_DEG: f64 = 0.011;
/// Smaller steps (degrees) are lost in the digits of angles.
const LEAST_STEP_DEG: f64 = 1e-6;
/// Most steps of an axis: a tenth of a degree all around.
const MOST_STEPS: f64 = 3600.0;

impl Steps {
    /// The steps of these angles (degrees).
    pub(super) fn of(angles_deg: &[f64]) -> Result<Self, String> {
        let (steps, places) = Self::with_gaps(angles_deg)?;
        match places.windows(2).position(|pair| pair[1] != pair[0] + 1) {
            Some(at) => {
                let (before, after, step) = (angles_deg[at], angles_deg[at + 1], steps.step_deg);
                Err(format!("a gap: {after} after {before}, with steps of {step}"))
            }
            None => Ok(steps),
        }
    }

    /// The steps of these ascending angles (degrees), of which some may be missing, and the step of each angle.
    pub(super) fn with_gaps(angles_deg: &[f64]) -> Result<(Self, Vec<usize>), String> {
        let (Some(&first_deg), Some(&last_deg)) = (angles_deg.first(), angles_deg.last()) else {
            return Err("an empty list".into());
        };
        if let Some(bad) = angles_deg.iter().find(|deg| !deg.is_finite()) {
            return Err(format!("a list with {bad}"));
        }
        if angles_deg.len() == 1 {
            return Ok((Self { first_deg, step_deg: 0.0, count: 1 }, vec![0]));
        }
        if let Some(pair) = angles_deg.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(format!("{} after {}", pair[1], pair[0]));
        }
        let smallest_deg = angles_deg.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let steps = ((last_deg - first_deg) / smallest_deg).round();
        if steps > MOST_STEPS || smallest_deg < LEAST_STEP_DEG {
            return Err(format!("angles from {first_deg} to {last_deg} of which two differ by {smallest_deg}"));
        }
        let step_deg = (last_deg - first_deg) / steps;
        let mut places = Vec::with_capacity(angles_deg.len());
        for &deg in angles_deg {
            let place = ((deg - first_deg) / step_deg).round();
            if (first_deg + place * step_deg - deg).abs() > TOLERANCE_DEG {
                return Err(format!("{deg}, which is not on steps of {step_deg} from {first_deg} on"));
            }
            places.push(floor(place));
        }
        Ok((Self { first_deg, step_deg, count: floor(steps) + 1 }, places))
    }

    /// The angle of a step (degrees).
    pub(super) fn angle_deg(&self, step: usize) -> f64 {
        self.first_deg + self.step_deg * step as f64
    }

    pub(super) fn last_deg(&self) -> f64 {
        self.angle_deg(self.count - 1)
    }

    /// Whether a step after the last angle is the first one again.
    pub(super) fn is_circle(&self) -> bool {
        self.count > 1 && (self.step_deg * self.count as f64 - 360.0).abs() < 0.5 * self.step_deg
    }

    /// Whether the angles go once around if they are radians, to a hundredth: of degrees that is no chance.
    pub(super) fn is_turn_of_radians(&self) -> bool {
        let is_near = |span: f64| (span - TAU).abs() <= 0.01 * TAU;
        let span = self.last_deg() - self.first_deg;
        self.count >= 8 && (is_near(span) || is_near(span + self.step_deg))
    }

    /// The axis in words: `-60 to 60 in steps of 5`.
    pub(super) fn text(&self) -> String {
        match self.count {
            1 => format!("{}", self.first_deg),
            _ => {
                let angles = [self.first_deg, self.last_deg(), self.step_deg].map(rounded);
                format!("{} to {} in steps of {}", angles[0], angles[1], angles[2])
            }
        }
    }

    /// Steps in words, from the first to the last: `-5`, or `-5 to 10`.
    pub(super) fn span_text(&self, [first, last]: [usize; 2]) -> String {
        let [from, to] = [first, last].map(|step| rounded(self.angle_deg(step)));
        if first == last { format!("{from}") } else { format!("{from} to {to}") }
    }
}

/// Without what is left of rounding.
fn rounded(deg: f64) -> f64 {
    (deg * 1e6).round() / 1e6 + 0.0
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "steps are small and not negative")]
#[inline]
pub(super) fn floor(steps: f64) -> usize {
    steps as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_hardly_differ_are_no_steps() {
        assert!(Steps::of(&[170.0, 170.0 + 2e-6, 170.0 + 4e-6]).is_ok());
        let found = Steps::of(&[170.0, 170.0 + 1e-13]).unwrap_err();
        assert!(found.contains("of which two differ by"), "{found}");
    }

    #[test]
    fn missing_angles_are_steps_without_a_place() {
        let (steps, places) = Steps::with_gaps(&[-30.0, -20.0, 10.0, 20.0]).unwrap();
        assert_eq!((steps.count, places), (6, vec![0, 1, 4, 5]));
        assert_eq!(steps.text(), "-30 to 20 in steps of 10");
        assert!((steps.angle_deg(3) - 0.0).abs() < 1e-12);
        assert_eq!(Steps::of(&[0.0, 90.0, 270.0]).unwrap_err(), "a gap: 270 after 90, with steps of 90");
        // Thirds of a degree, rounded to hundredths.
        let (steps, places) = Steps::with_gaps(&[0.0, 0.33, 0.67, 1.0, 1.67]).unwrap();
        assert_eq!((steps.count, places), (6, vec![0, 1, 2, 3, 5]));
    }

    #[test]
    fn angles_without_equal_steps_are_refused() {
        for (angles, words) in [
            (&[0.0, 10.0, 25.0][..], "10, which is not on steps of"),
            (&[0.0, 10.0, 10.0], "10 after 10"),
            (&[0.0, 0.01, 90.0], "two differ by 0.01"),
            (&[0.0, f64::NAN], "a list with NaN"),
            (&[], "an empty list"),
        ] {
            let error = Steps::with_gaps(angles).unwrap_err();
            assert!(error.contains(words), "{error}\nshould say: {words}");
        }
    }
}
