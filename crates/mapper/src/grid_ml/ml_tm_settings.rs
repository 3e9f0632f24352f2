//! Which estimator the settings of `ml_tm` mean: one under a given profile, a fitted one, or one among known obstacles.

use sextant_kernel::SettingError;

use super::fitted_ml_tm::FittedMlTm;
use super::ml_tm::{MlTm, MlTmConfig};
#[cfg(feature = "obstacles")]
use super::obstacle_ml_tm::ObstacleMlTm;
use crate::estimator::{AnyLog, EstimatorSettings, Mapper, ProfileSetting};
use crate::log_facts::SectorsConfig;
use crate::profile::ProfileConfig;

impl EstimatorSettings for MlTmConfig {
    const ANY_LOG: Option<AnyLog> = Some(AnyLog {
        name: "ml-tm",
        rank: 3,
        description: "Maximum likelihood on a grid, with a reception profile that is fitted first",
        settings: "{ grid_step_m = 0.25, estimate = \"posterior_mean\", profile.fitted = {} }",
    });

    const BY_PARTS: bool = true;

    fn mapper(self) -> Result<Mapper, SettingError> {
        match self.profile.clone() {
            ProfileConfig::Fitted(fitted) => FittedMlTm::new(self, fitted).map(Mapper::new),
            #[cfg(feature = "obstacles")]
            ProfileConfig::Channel(channel) if channel.obstacles == crate::profile::ObstacleUse::Known => {
                ObstacleMlTm::new(self, &channel).map(Mapper::new)
            }
            ProfileConfig::Trapezoid(_) | ProfileConfig::Channel(_) => MlTm::try_from(self).map(Mapper::new),
        }
    }

    fn sectors_mut(&mut self) -> Option<&mut SectorsConfig> {
        self.sectors.as_mut()
    }

    fn profiles_mut(&mut self) -> Vec<ProfileSetting<'_>> {
        vec![ProfileSetting { key: "profile".to_owned(), network: None, profile: &mut self.profile }]
    }
}
