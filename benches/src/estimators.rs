//! The estimators that tables compare, by name.

use sextant_kernel::SettingError;
use sextant_mapper::{
    AlgorithmConfig, AutoConfig, EstimateKind, FittedConfig, GaussianProcessConfig, LinkModelConfig,
    LogDistanceConfig, Mapper, MlTmConfig, PacketCentroidConfig, ProfileConfig, RssGridConfig, RssiCentroidConfig,
    SelfCalibratedConfig, StrongestStopConfig,
};

/// What an estimator is in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It chooses among others.
    Chooser,
    /// It has a model of radio.
    Model,
    /// A simple method: places follow from what was heard of each node by itself.
    Simple,
}

/// An estimator.
#[derive(Clone, Debug)]
pub struct Estimator {
    /// Its name in tables.
    pub name: &'static str,
    /// What it is compared as.
    pub role: Role,
    /// The algorithm.
    pub mapper: Mapper,
}

/// All estimators for logs of one network without sectors, in the order of the tables.
///
/// # Errors
/// If a setting is invalid.
pub fn all() -> Result<Vec<Estimator>, SettingError> {
    let fitted = MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        ..MlTmConfig::new(0.25, ProfileConfig::Fitted(FittedConfig::default()))
    };
    let rss_grid = RssGridConfig {
        grid_step_m: None,
        ranging: sextant_mapper::RangingConfig::default(),
        sensitivity_dbm: None,
        max_range_m: None,
        estimate: EstimateKind::PosteriorMean,
        z_range_m: None,
    };
    let usual = LogDistanceConfig { exponents: [2.5; 2], z_range_m: None };
    let packets = |power| AlgorithmConfig::PacketCentroid(PacketCentroidConfig { power });
    let strengths = |g| AlgorithmConfig::RssiCentroid(RssiCentroidConfig { g });
    let (chooser, model, simple) = (Role::Chooser, Role::Model, Role::Simple);
    let named = [
        ("auto", chooser, AlgorithmConfig::Auto(AutoConfig::default())),
        ("link-model", model, AlgorithmConfig::LinkModel(LinkModelConfig::default())),
        ("self-calibrated", model, AlgorithmConfig::SelfCalibrated(SelfCalibratedConfig::default())),
        ("fitted", model, AlgorithmConfig::MlTm(fitted)),
        ("rss-grid", model, AlgorithmConfig::RssGrid(rss_grid)),
        ("packet-centroid-1", simple, packets(1.0)),
        ("packet-centroid-3", simple, packets(3.0)),
        ("packet-centroid-6", simple, packets(6.0)),
        ("strongest-stop", simple, AlgorithmConfig::StrongestStop(StrongestStopConfig {})),
        ("rssi-centroid-0.25", simple, strengths(0.25)),
        ("rssi-centroid-0.5", simple, strengths(0.5)),
        ("rssi-centroid-1", simple, strengths(1.0)),
        ("rssi-centroid-2", simple, strengths(2.0)),
        ("least-squares", simple, AlgorithmConfig::LeastSquares(LogDistanceConfig::default())),
        ("least-squares-2.5", simple, AlgorithmConfig::LeastSquares(usual)),
        ("gaussian-process", simple, AlgorithmConfig::GaussianProcess(GaussianProcessConfig {})),
    ];
    named.into_iter().map(|(name, role, config)| Ok(Estimator { name, role, mapper: config.try_into()? })).collect()
}

/// The estimators whose names are in the list, separated by commas, in the order of the tables.
///
/// # Errors
/// If a name is not known.
pub fn named(all: &[Estimator], list: &str) -> Result<Vec<Estimator>, String> {
    let names: Vec<&str> = list.split(',').collect();
    if let Some(unknown) = names.iter().find(|name| all.iter().all(|estimator| estimator.name != **name)) {
        let known: Vec<&str> = all.iter().map(|estimator| estimator.name).collect();
        return Err(format!("`{unknown}` is no estimator; allowed: {}", known.join(", ")));
    }
    Ok(all.iter().filter(|estimator| names.contains(&estimator.name)).cloned().collect())
}
