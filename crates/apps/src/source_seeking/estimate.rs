//! How the field at the robot is worked out from readings, as written in a scenario and checked.

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// How the value of the field at the robot is worked out from readings of nodes, as written in a scenario: a weighted mean,
/// or a local fit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct EstimateConfig {
    /// The mean of the readings, with these weights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weights: Option<Weights>,
    /// Nodes farther than this from the place of the robot on the map do not count in the mean, in the unit of the map
    /// (m). If no node is so near, the nearest one counts. All count if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach_m: Option<f64>,
    /// Instead of a mean: a polynomial through the readings around the place of the robot on the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub local_fit: Option<LocalFitConfig>,
}

/// The weights of readings in their mean (thesis, chapter 7, equation of d(t): w = P_rx / P_tx).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Weights {
    /// All the same.
    Equal,
    /// The ratio of the two powers as numbers in dBm. The weights are nearly equal. If both numbers are negative, a weight
    /// grows with the distance.
    DbmRatio,
    /// The ratio of the two powers in watts: near nodes count most, and shadowing makes the mean jump.
    Power,
}

/// Settings of local fits, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct LocalFitConfig {
    /// Smallest bandwidth of the Gaussian weights, as a multiple of the spacing of the nodes on the map.
    pub bandwidth_spacings: f64,
    /// The bandwidth grows until the gradient of the field is so many standard deviations (after Lepski 1991: the smallest
    /// bandwidth at which the signal stands out of the noise), or all nodes that answer are used.
    pub significance: f64,
}

impl Default for LocalFitConfig {
    fn default() -> Self {
        Self { bandwidth_spacings: 1.25, significance: 3.0 }
    }
}

/// How the value of the field at the robot is worked out, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Estimate {
    /// The mean of the readings within a distance on the map (m); of all readings if it is absent.
    Mean(Weights, Option<f64>),
    /// A local fit.
    LocalFit(LocalFitConfig),
}

impl Default for Estimate {
    fn default() -> Self {
        Self::LocalFit(LocalFitConfig::default())
    }
}

impl EstimateConfig {
    /// The checked form. What is absent is as in `preset`.
    pub(super) fn checked(self, preset: Estimate) -> Result<Estimate, SettingError> {
        let Self { weights, reach_m, local_fit } = self;
        let remedy = "set one of them: a local fit has weights and a reach of its own";
        match (local_fit, weights, reach_m) {
            (Some(_), Some(_), _) => Err(SettingError::conflict("local_fit", "`weights`", remedy)),
            (Some(_), None, Some(_)) => Err(SettingError::conflict("local_fit", "`reach_m`", remedy)),
            (Some(fit), None, None) => {
                fit.checked().map(Estimate::LocalFit).map_err(|error| error.within("local_fit"))
            }
            (None, None, None) => Ok(preset),
            (None, weights, reach_m) => {
                let (preset_weights, preset_reach_m) = match preset {
                    Estimate::Mean(weights, reach_m) => (Some(weights), reach_m),
                    Estimate::LocalFit(_) => (None, None),
                };
                let needed = "\"equal\", \"dbm_ratio\" or \"power\", because `reach_m` limits a mean";
                let weights = weights.or(preset_weights).ok_or_else(|| SettingError::missing("weights", needed))?;
                let reach_m = reach_m.map(|reach_m| SettingError::positive("reach_m", reach_m)).transpose()?;
                Ok(Estimate::Mean(weights, reach_m.or(preset_reach_m)))
            }
        }
    }
}

impl LocalFitConfig {
    fn checked(self) -> Result<Self, SettingError> {
        SettingError::in_range("bandwidth_spacings", self.bandwidth_spacings, 0.1, 100.0)?;
        SettingError::not_negative("significance", self.significance)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THESIS: Estimate = Estimate::Mean(Weights::DbmRatio, Some(4.0));

    fn checked(settings: &str, preset: Estimate) -> Result<Estimate, String> {
        let config: EstimateConfig = toml::from_str(settings).expect("settings");
        config.checked(preset).map_err(|error| error.to_string())
    }

    #[test]
    fn only_what_is_written_overrides_the_preset() {
        let fit = Estimate::LocalFit(LocalFitConfig::default());
        for (settings, with_thesis, with_fit) in [
            ("", THESIS, fit),
            ("weights = \"power\"", Estimate::Mean(Weights::Power, Some(4.0)), Estimate::Mean(Weights::Power, None)),
            (
                "weights = \"equal\"\nreach_m = 3.0",
                Estimate::Mean(Weights::Equal, Some(3.0)),
                Estimate::Mean(Weights::Equal, Some(3.0)),
            ),
            ("local_fit = {}", fit, fit),
        ] {
            assert_eq!(checked(settings, THESIS), Ok(with_thesis), "{settings}");
            assert_eq!(checked(settings, fit), Ok(with_fit), "{settings}");
        }
        assert_eq!(checked("reach_m = 5.0", THESIS), Ok(Estimate::Mean(Weights::DbmRatio, Some(5.0))));
    }

    #[test]
    fn a_mean_and_a_fit_exclude_each_other() {
        let refused = |settings: &str| checked(settings, Estimate::default()).expect_err("no valid settings");
        let remedy = "set one of them: a local fit has weights and a reach of its own";
        assert_eq!(
            refused("local_fit = {}\nweights = \"equal\""),
            format!("`local_fit` conflicts with `weights`; {remedy}")
        );
        assert_eq!(
            refused("local_fit = {}\nreach_m = 4.0"),
            format!("`local_fit` conflicts with `reach_m`; {remedy}")
        );
        assert_eq!(
            refused("reach_m = 4.0"),
            "`weights` is missing; needed: \"equal\", \"dbm_ratio\" or \"power\", because `reach_m` limits a mean"
        );
        assert!(refused("weights = \"equal\"\nreach_m = 0.0").starts_with("`reach_m` is 0"));
    }
}
