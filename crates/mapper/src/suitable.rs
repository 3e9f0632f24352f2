//! Whether an estimator suits what is asked of it, and which others do.

use crate::algorithm::AlgorithmConfig;
use crate::error::MapError;
use crate::estimator::Mapper;
use crate::parts::PartEstimator;
use crate::posterior::PlacePrior;

impl Mapper {
    /// Checks that the estimator uses `prior`, if there is one.
    ///
    /// # Errors
    /// [`MapError::UnusedPrior`] if it does not.
    pub fn check_prior(&self, prior: Option<&PlacePrior>) -> Result<(), MapError> {
        if prior.is_none() || self.uses_prior() {
            return Ok(());
        }
        let mut known = AlgorithmConfig::names_with_prior();
        known.sort();
        Err(MapError::UnusedPrior { algorithm: self.name(), known: listed(&known) })
    }

    /// Checks that the estimator can map a log part by part.
    ///
    /// # Errors
    /// [`MapError::NotByParts`] if it cannot.
    pub fn check_parts(&self) -> Result<(), MapError> {
        self.parts_estimator().map(|_| ())
    }

    pub(crate) fn parts_estimator(&self) -> Result<&dyn PartEstimator, MapError> {
        let known = || listed(&AlgorithmConfig::names_by_parts());
        self.by_parts().ok_or_else(|| MapError::NotByParts { algorithm: self.name(), known: known() })
    }
}

/// Names as messages list them.
fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(all(test, feature = "config"))]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_estimators_that_suit() {
        let mapper = |text: &str| Mapper::try_from(toml::from_str::<AlgorithmConfig>(text).unwrap()).unwrap();
        let rssi_centroid = mapper("rssi_centroid = {}");
        let prior = PlacePrior::new(None, Some(1.0)).unwrap();
        let unused = rssi_centroid.check_prior(Some(&prior)).unwrap_err().to_string();
        assert!(unused.contains("`auto`, `link-model`"), "{unused}");
        let whole = rssi_centroid.check_parts().unwrap_err().to_string();
        assert!(whole.contains("`ml-tm`, `mmtm`, `link-model`, `packet-centroid`"), "{whole}");
    }

    #[test]
    fn settings_and_estimators_agree_on_what_they_can_do() {
        for any_log in AlgorithmConfig::of_any_log() {
            let text = format!("{} = {}", any_log.key(), any_log.settings);
            let mapper = Mapper::try_from(toml::from_str::<AlgorithmConfig>(&text).unwrap()).unwrap();
            let is_among = |names: Vec<String>| names.iter().any(|name| name == any_log.name);
            assert_eq!(mapper.uses_prior(), is_among(AlgorithmConfig::names_with_prior()), "{text}");
            assert_eq!(mapper.by_parts().is_some(), is_among(AlgorithmConfig::names_by_parts()), "{text}");
        }
    }
}
