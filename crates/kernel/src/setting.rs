//! Errors in settings, worded so that a front end can point at the key.

use std::fmt;

use crate::text::shortened_to;

/// The longest description of what was found (characters): that of the gaps of a code book, for example.
const MOST_FOUND: usize = 4000;

/// A setting that is missing, conflicts with another one, or is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct SettingError {
    /// Path of the key below the table that was checked, for example `log_distance.exponent` or
    /// `obstacles[2].size_m`.
    pub key: String,
    /// What is wrong with it.
    pub problem: SettingProblem,
}

/// What is wrong with a setting.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingProblem {
    /// The table is not there.
    MissingTable,
    /// The value is not there.
    Missing {
        /// What is needed, in words.
        needed: String,
    },
    /// It cannot be together with something else.
    Conflict {
        /// What it conflicts with.
        with: String,
        /// What to do.
        remedy: String,
    },
    /// Its value is not allowed.
    Invalid {
        /// The value found, as a person would write it.
        found: String,
        /// The values allowed, in words.
        allowed: String,
    },
}

impl fmt::Display for SettingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let key = &self.key;
        match &self.problem {
            SettingProblem::MissingTable => write!(f, "the table `[{key}]` is missing"),
            SettingProblem::Missing { needed } => write!(f, "`{key}` is missing; needed: {needed}"),
            SettingProblem::Conflict { with, remedy } => write!(f, "`{key}` conflicts with {with}; {remedy}"),
            SettingProblem::Invalid { found, allowed } => write!(f, "`{key}` is {found}; allowed: {allowed}"),
        }
    }
}

impl SettingError {
    /// The value `found` under `key` is not one of those `allowed`.
    pub fn new(key: impl Into<String>, found: impl fmt::Display, allowed: impl Into<String>) -> Self {
        let found = shortened_to(MOST_FOUND, &found.to_string()).into_owned();
        let problem = SettingProblem::Invalid { found, allowed: allowed.into() };
        Self { key: key.into(), problem }
    }

    /// There is no table `key`, which is needed.
    pub fn missing_table(key: impl Into<String>) -> Self {
        Self { key: key.into(), problem: SettingProblem::MissingTable }
    }

    /// There is nothing under `key`, where this is `needed`.
    pub fn missing(key: impl Into<String>, needed: impl Into<String>) -> Self {
        Self { key: key.into(), problem: SettingProblem::Missing { needed: needed.into() } }
    }

    /// What is under `key` cannot be together `with` this; the `remedy` is a command: "set one of them".
    pub fn conflict(key: impl Into<String>, with: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { key: key.into(), problem: SettingProblem::Conflict { with: with.into(), remedy: remedy.into() } }
    }

    /// What was found: the value, or what it conflicts with.
    #[must_use]
    pub fn found(&self) -> &str {
        match &self.problem {
            SettingProblem::MissingTable | SettingProblem::Missing { .. } => "absent",
            SettingProblem::Conflict { with: found, .. } | SettingProblem::Invalid { found, .. } => found,
        }
    }

    /// What would be right: what is needed, what to do, or the values allowed.
    #[must_use]
    pub fn allowed(&self) -> &str {
        match &self.problem {
            SettingProblem::MissingTable => "a table",
            SettingProblem::Missing { needed: allowed }
            | SettingProblem::Conflict { remedy: allowed, .. }
            | SettingProblem::Invalid { allowed, .. } => allowed,
        }
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
        let missing = SettingError::missing("carrier_ghz", "0.1 to 1000").within("close_in");
        assert_eq!(missing.to_string(), "`close_in.carrier_ghz` is missing; needed: 0.1 to 1000");
        let table = SettingError::missing_table("radio").within("networks.a");
        assert_eq!(table.to_string(), "the table `[networks.a.radio]` is missing");
        let conflict = SettingError::conflict("order", "`spacing_m`", "set one of them").within("hilbert");
        assert_eq!(conflict.to_string(), "`hilbert.order` conflicts with `spacing_m`; set one of them");
        assert_eq!((conflict.found(), conflict.allowed()), ("`spacing_m`", "set one of them"));
    }

    #[test]
    fn numbers_are_checked_at_their_bounds() {
        let tiny = f64::MIN_POSITIVE;
        let accepted = |check: &dyn Fn(f64) -> Result<f64, SettingError>| {
            [f64::NAN, f64::NEG_INFINITY, -1.0, -tiny, 0.0, tiny, 1.0, 2.0, f64::INFINITY]
                .into_iter()
                .filter(|&value| check(value).inspect(|found| assert_eq!(found.to_bits(), value.to_bits())).is_ok())
                .collect::<Vec<_>>()
        };
        assert_eq!(accepted(&|value| SettingError::positive("x", value)), [tiny, 1.0, 2.0]);
        assert_eq!(accepted(&|value| SettingError::not_negative("x", value)), [0.0, tiny, 1.0, 2.0]);
        assert_eq!(accepted(&|value| SettingError::finite("x", value)), [-1.0, -tiny, 0.0, tiny, 1.0, 2.0]);
        assert_eq!(accepted(&|value| SettingError::in_range("x", value, 0.0, 1.0)), [0.0, tiny, 1.0]);
    }
}
