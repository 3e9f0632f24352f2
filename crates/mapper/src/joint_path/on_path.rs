//! A map on the path that the log tells: a stage in front of any estimator.

use sextant_channel::Stop;
use sextant_kernel::{SettingError, Watch};

use super::{PathError, PathFit, estimate_path};
use crate::error::MapError;
use crate::estimator::{Estimator, Mapper, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::learned::{EstimatorFindings, Finding, Line, Section};
use crate::profile::ReceptionProfile;
use crate::topology_map::TopologyMap;

/// On which path a map is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum PathUse {
    /// The path as the robots believe it to be.
    #[default]
    Believed,
    /// The path that is estimated with the places of nodes, from what was heard.
    Estimated,
}

/// How wrong odometry is, as written in a scenario: standard deviations, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PathErrorConfig {
    /// Of the share by which all of the path is too long.
    pub scale: f64,
    /// Of how much the heading drifts to one side (rad/m).
    pub heading_drift_rad_per_m: f64,
    /// Of how much the heading wanders over a metre; it grows with the root of the length.
    pub heading_noise_rad_per_sqrt_m: f64,
    /// Of how much the place wanders over a metre (m); it grows with the root of the length.
    pub position_noise_m_per_sqrt_m: f64,
}

impl Default for PathErrorConfig {
    fn default() -> Self {
        let PathError { scale, drift_rad_per_m, heading_rad_per_root_m, position_m_per_root_m } =
            PathError::default();
        Self {
            scale,
            heading_drift_rad_per_m: drift_rad_per_m,
            heading_noise_rad_per_sqrt_m: heading_rad_per_root_m,
            position_noise_m_per_sqrt_m: position_m_per_root_m,
        }
    }
}

impl TryFrom<PathErrorConfig> for PathError {
    type Error = SettingError;

    fn try_from(config: PathErrorConfig) -> Result<Self, SettingError> {
        let checked = |key, value: f64| {
            let is_allowed = (0.0..=1.0).contains(&value);
            if is_allowed { Ok(value) } else { Err(SettingError::new(key, value, "a number from 0 to 1")) }
        };
        Ok(Self {
            scale: checked("scale", config.scale)?,
            drift_rad_per_m: checked("heading_drift_rad_per_m", config.heading_drift_rad_per_m)?,
            heading_rad_per_root_m: checked("heading_noise_rad_per_sqrt_m", config.heading_noise_rad_per_sqrt_m)?,
            position_m_per_root_m: checked("position_noise_m_per_sqrt_m", config.position_noise_m_per_sqrt_m)?,
        })
    }
}

/// An estimator that maps the log on the path that was estimated from it.
#[derive(Clone, Debug, PartialEq)]
pub struct OnEstimatedPath {
    inner: Mapper,
    odometry: PathError,
}

impl OnEstimatedPath {
    /// The version of `inner` on an estimated path, where odometry is wrong by `odometry`.
    ///
    /// # Errors
    /// If `inner` maps several networks.
    pub fn mapper(inner: Mapper, odometry: PathError) -> Result<Mapper, SettingError> {
        if !inner.networks().is_empty() {
            let with = format!("`{}`, a map of several networks", inner.name());
            return Err(SettingError::conflict("path", with, "leave out `path`, or map one network"));
        }
        Ok(Mapper::new(Self { inner, odometry }))
    }
}

impl Estimator for OnEstimatedPath {
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn uses(&self) -> &'static [KnowledgeKind] {
        self.inner.uses()
    }

    fn check_grid(&self, stops: &[Stop]) -> Result<(), MapError> {
        self.inner.check_grid(stops)
    }

    fn counts_packets(&self) -> bool {
        self.inner.counts_packets()
    }

    fn uses_prior(&self) -> bool {
        self.inner.uses_prior()
    }

    fn profile(&self) -> Option<&ReceptionProfile> {
        self.inner.profile()
    }

    fn messages(&self) -> Messages {
        self.inner.messages()
    }

    fn estimate(
        &self,
        knowledge: &Knowledge<'_>,
        watch: &dyn Watch,
    ) -> Result<(TopologyMap, Option<EstimatorFindings>), MapError> {
        let path = estimate_path(knowledge.log, self.odometry, &[], watch)?;
        let log = path.log(knowledge.log);
        let (mut map, learned) = self.inner.map_and_learn(Knowledge { log: &log, ..*knowledge }, watch)?;
        path.widen(&mut map);
        let of_path = EstimatorFindings::new(path.fit);
        let learned = match learned {
            Some(learned) => learned.and(of_path),
            None => of_path,
        };
        Ok((map, Some(learned)))
    }
}

impl Finding for PathFit {
    #[cfg(feature = "config")]
    fn keys(&self, _: &TopologyMap) -> serde_json::Map<String, serde_json::Value> {
        std::iter::once(("path".to_owned(), self.value())).collect()
    }

    fn lines(&self, name: &str, _: &TopologyMap) -> Vec<Line> {
        vec![Line { section: Section::Laws, text: format!("{name}: {self}") }]
    }
}
