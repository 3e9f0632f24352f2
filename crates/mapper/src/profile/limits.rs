//! The lowest and the highest probability that a profile gives to a reception.

use sextant_kernel::SettingError;

/// `0 <= floor < ceiling <= 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ProfileLimits {
    floor: f64,
    ceiling: f64,
}

impl ProfileLimits {
    /// # Errors
    /// `ceiling` or `floor` if they are not `0 <= floor < ceiling <= 1`.
    pub(super) fn new(floor: f64, ceiling: f64) -> Result<Self, SettingError> {
        let ceiling = above_0_to_1("ceiling", ceiling)?;
        if !(floor >= 0.0 && floor < ceiling) {
            return Err(SettingError::new("floor", floor, format!("0 to below ceiling = {ceiling}")));
        }
        Ok(Self { floor, ceiling })
    }

    pub(super) fn floor(self) -> f64 {
        self.floor
    }

    pub(super) fn ceiling(self) -> f64 {
        self.ceiling
    }

    /// The allowed probability nearest to `probability`.
    pub(super) fn clamp(self, probability: f64) -> f64 {
        probability.clamp(self.floor, self.ceiling)
    }
}

/// `value` if it is above 0 and at most 1.
///
/// # Errors
/// Otherwise, naming `key`.
pub(super) fn above_0_to_1(key: &str, value: f64) -> Result<f64, SettingError> {
    if value > 0.0 && value <= 1.0 { Ok(value) } else { Err(SettingError::new(key, value, "above 0, at most 1")) }
}
