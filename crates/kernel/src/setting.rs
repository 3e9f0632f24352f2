//! Errors in settings, worded so that a front end can point at the key.

use std::fmt;

/// An invalid setting: the key, the value found and the values allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` is {found}; allowed: {allowed}")]
pub struct SettingError {
    /// Path of the key below the table that was checked, for example `log_distance.exponent` or
    /// `obstacles[2].size_m`.
    pub key: String,
    /// The value found, as a person would write it.
    pub found: String,
    /// The values allowed, in words.
    pub allowed: String,
}

impl SettingError {
    /// The value `found` under `key` is not one of those `allowed`.
    pub fn new(key: impl Into<String>, found: impl fmt::Display, allowed: impl Into<String>) -> Self {
        Self { key: key.into(), found: found.to_string(), allowed: allowed.into() }
    }

    /// The same error seen from the table that holds this one under `parent` (a key path,
    /// or `name[index]`).
    #[must_use]
    pub fn within(mut self, parent: impl fmt::Display) -> Self {
        self.key = if self.key.is_empty() { parent.to_string() } else { format!("{parent}.{}", self.key) };
        self
    }

    /// `value` if it is finite and more than zero.
    ///
    /// # Errors
    /// Otherwise, naming `key`.
    pub fn positive(key: &str, value: f64) -> Result<f64, Self> {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(Self::new(key, value, "a finite number above 0"))
        }
    }

    /// `value` if it is finite and not negative.
    ///
    /// # Errors
    /// Otherwise, naming `key`.
    pub fn not_negative(key: &str, value: f64) -> Result<f64, Self> {
        if value.is_finite() && value >= 0.0 {
            Ok(value)
        } else {
            Err(Self::new(key, value, "a finite number, 0 or above"))
        }
    }

    /// `value` if it is finite.
    ///
    /// # Errors
    /// Otherwise, naming `key`.
    pub fn finite(key: &str, value: f64) -> Result<f64, Self> {
        if value.is_finite() { Ok(value) } else { Err(Self::new(key, value, "a finite number")) }
    }

    /// `value` if it lies in `[low, high]`.
    ///
    /// # Errors
    /// Otherwise, naming `key`.
    pub fn in_range(key: &str, value: f64, low: f64, high: f64) -> Result<f64, Self> {
        if value >= low && value <= high { Ok(value) } else { Err(Self::new(key, value, format!("{low} to {high}"))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_its_key_from_the_outermost_table() {
        let error = SettingError::positive("exponent", -2.0).unwrap_err().within("log_distance").within("path_loss");
        assert_eq!(error.to_string(), "`path_loss.log_distance.exponent` is -2; allowed: a finite number above 0");
        assert!(SettingError::not_negative("x", f64::NAN).is_err());
        assert!(SettingError::in_range("x", f64::NAN, 0.0, 1.0).is_err());
    }
}
