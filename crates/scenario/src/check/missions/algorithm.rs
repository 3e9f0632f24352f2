//! What an application does, checked.

use std::sync::Arc;

use sextant_apps::AlgorithmConfig;
use sextant_apps::source_seeking::SourceSeeking;
use sextant_apps::target_search::{Doubt, TargetSearch};
use sextant_channel::Dbm;
use sextant_kernel::SettingError;
use sextant_sim::{Field, Gaussian, Radio, World};

/// What an application does, checked.
#[derive(Clone, Debug)]
pub struct Algorithm {
    /// Its name in tables.
    pub name: &'static str,
    /// What robots and nodes do.
    pub task: Task,
}

/// What robots and nodes do.
#[derive(Clone, Debug)]
pub enum Task {
    /// They search targets.
    Search(Arc<TargetSearch>),
    /// They seek the source of a field.
    Seek(Arc<SourceSeeking>),
}

impl Algorithm {
    /// The checked form of `config` in a network of such radios, in this world.
    pub(crate) fn new(config: &AlgorithmConfig, radio: &Radio, world: &World) -> Result<Self, SettingError> {
        let fields = &world.fields;
        let places = world.nodes.iter().map(|node| node.position);
        let doubt = || world.sensors.targets.and_then(|sensor| Doubt::new(&sensor, places));
        let search = |search: TargetSearch| Task::Search(Arc::new(search));
        let seek = |seek: SourceSeeking| Task::Seek(Arc::new(seek));
        let task = match config {
            AlgorithmConfig::Detarsk(config) => {
                TargetSearch::detarsk(config).and_then(|search| search.among(doubt())).map(search)
            }
            AlgorithmConfig::PG(config) => TargetSearch::pseudo_gradient(config, radio).map(search),
            AlgorithmConfig::LevelSet(config) => SourceSeeking::level_set(config, fields).map(seek),
            AlgorithmConfig::Gradient(config) => SourceSeeking::gradient(config, fields).map(seek),
        };
        let task = task.and_then(|task| match &task {
            Task::Seek(seek) => {
                check_level(seek, fields).and_then(|()| check_weights(seek, radio.tx_power())).map(|()| task)
            }
            Task::Search(_) => Ok(task),
        });
        let task = task.map_err(|error| error.within(format!("algorithm.{}", config.key())))?;
        Ok(Self { name: config.name(), task })
    }

    /// Whether it searches targets; otherwise it seeks the source of a field.
    #[must_use]
    pub fn is_search(&self) -> bool {
        matches!(self.task, Task::Search(_))
    }

    /// Number of the field whose source it seeks, and the level that it wants to reach, in the unit of the field; no level
    /// if it is the source itself.
    #[must_use]
    pub fn sought(&self) -> Option<(usize, Option<f64>)> {
        match &self.task {
            Task::Search(_) => None,
            Task::Seek(seek) => Some((seek.field().index(), seek.level())),
        }
    }
}

/// Refuses levels that the field has nowhere: above the sum of all its peaks.
fn check_level(seek: &SourceSeeking, fields: &[Field]) -> Result<(), SettingError> {
    let field = &fields[seek.field().index()];
    let highest: f64 = field.gaussians().iter().map(Gaussian::peak).filter(|peak| *peak > 0.0).sum();
    if let (Some(level), Some(least)) = (seek.level(), seek.arrival_value())
        && least > highest
    {
        let found = format!("{level}, which the field `{}` has nowhere", field.name());
        return Err(SettingError::new("goal.level", found, format!("at most {highest}, the sum of its peaks")));
    }
    Ok(())
}

/// Refuses weights that have no value: a number of dBm divided by zero.
fn check_weights(seek: &SourceSeeking, tx_power: Dbm) -> Result<(), SettingError> {
    if seek.weighs_by_dbm() && tx_power.0.abs() <= 0.0 {
        let found = "`dbm_ratio`, which has no value for a transmit power of 0 dBm";
        return Err(SettingError::new("estimate.weights", found, "`equal` or `power`"));
    }
    Ok(())
}
