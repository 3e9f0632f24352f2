//! A reception profile given by a table of values, for curves that are estimated or computed from a channel.

use sextant_kernel::SettingError;

use super::limits::ProfileLimits;

/// Values below this count as 0. Products of many factors then stay within the range of f64.
const NOTHING: f64 = 1e-30;

/// S(d) by linear interpolation of values at equal distances, 0 from the last value on, then clamped to
/// `[floor, ceiling]`. The values need not fall with distance.
#[derive(Clone, Debug, PartialEq)]
pub struct TableProfile {
    step_m: f64,
    /// At 0, `step_m`, 2 `step_m`, ...
    probabilities: Vec<f64>,
    range_m: f64,
    limits: ProfileLimits,
}

impl TableProfile {
    /// The profile with `probabilities` at the distances 0, `step_m`, 2 `step_m`, ...; the last distance is the
    /// range. Values below 10⁻³⁰ count as 0.
    ///
    /// # Errors
    /// `step_m` if it is not above 0; `probabilities` if there are fewer than two, one is not in `[0, 1]`, or none
    /// before the last is above the floor; `ceiling` and `floor` if they are not `0 <= floor < ceiling <= 1`.
    pub fn new(step_m: f64, probabilities: Vec<f64>, floor: f64, ceiling: f64) -> Result<Self, SettingError> {
        SettingError::positive("step_m", step_m)?;
        if probabilities.len() < 2 {
            let allowed = "two or more values, from distance 0 to the range";
            return Err(SettingError::new("probabilities", format!("{} values", probabilities.len()), allowed));
        }
        if let Some(&wrong) = probabilities.iter().find(|&&p| !(0.0..=1.0).contains(&p)) {
            return Err(SettingError::new("probabilities", wrong, "0 to 1"));
        }
        let limits = ProfileLimits::new(floor, ceiling)?;
        let before_range = &probabilities[..probabilities.len() - 1];
        if before_range.iter().all(|&p| p <= floor) {
            let highest = before_range.iter().fold(0.0, |highest: f64, &p| highest.max(p));
            let allowed = format!("at least one above the floor ({floor}) before the range");
            return Err(SettingError::new("probabilities", highest, allowed));
        }
        let range_m = step_m * (probabilities.len() - 1) as f64;
        let probabilities = probabilities.into_iter().map(|p| if p < NOTHING { 0.0 } else { p }).collect();
        Ok(Self { step_m, probabilities, range_m, limits })
    }

    /// Probability that a packet is received over `distance_m`.
    #[must_use]
    pub fn probability(&self, distance_m: f64) -> f64 {
        let s = if distance_m < self.range_m {
            let along = distance_m / self.step_m;
            let below = crate::numerics::whole(along).min(self.probabilities.len() - 2);
            let (near, far) = (self.probabilities[below], self.probabilities[below + 1]);
            near + (far - near) * (along - below as f64)
        } else {
            0.0
        };
        self.limits.clamp(s)
    }

    /// Distance of neighbouring values (m).
    #[must_use]
    pub fn step_m(&self) -> f64 {
        self.step_m
    }

    /// The values, before floor and ceiling.
    #[must_use]
    pub fn probabilities(&self) -> &[f64] {
        &self.probabilities
    }

    /// At this distance and beyond, a reception is impossible, or has the probability of the floor (m).
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.range_m
    }

    /// Lowest probability of a reception.
    #[must_use]
    pub fn floor(&self) -> f64 {
        self.limits.floor()
    }

    /// Highest probability of a reception.
    #[must_use]
    pub fn ceiling(&self) -> f64 {
        self.limits.ceiling()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_interpolated_up_to_the_range_and_clamped() {
        let table = TableProfile::new(2.0, vec![1.0, 0.6, 0.2], 0.01, 0.9).unwrap();
        assert!((table.range_m() - 4.0).abs() < 1e-15);
        for (d, expected) in [(0.0, 0.9), (1.0, 0.8), (2.0, 0.6), (3.5, 0.3), (4.0, 0.01), (90.0, 0.01)] {
            assert!((table.probability(d) - expected).abs() < 1e-15, "S({d}) = {}", table.probability(d));
        }
    }

    #[test]
    fn invalid_values_are_rejected_with_their_key() {
        let key = |step, values: &[f64], floor, ceiling| {
            TableProfile::new(step, values.to_vec(), floor, ceiling).map_err(|error| error.key)
        };
        let good = [0.9, 0.0];
        assert!(key(1.0, &good, 0.0, 1.0).is_ok());
        for (result, expected) in [
            (key(0.0, &good, 0.0, 1.0), "step_m"),
            (key(f64::NAN, &good, 0.0, 1.0), "step_m"),
            (key(1.0, &[0.9], 0.0, 1.0), "probabilities"),
            (key(1.0, &[0.9, -0.1], 0.0, 1.0), "probabilities"),
            (key(1.0, &[f64::NAN, 0.0], 0.0, 1.0), "probabilities"),
            (key(1.0, &[0.1, 0.3], 0.1, 1.0), "probabilities"),
            (key(1.0, &good, 0.5, 0.5), "floor"),
            (key(1.0, &good, -0.5, 0.5), "floor"),
            (key(1.0, &good, 0.0, 1.5), "ceiling"),
        ] {
            assert_eq!(result.unwrap_err(), expected);
        }
    }
}
