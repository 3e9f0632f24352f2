//! Settings of beams that follow, checked.

use std::sync::Arc;
use std::time::Duration;

use sextant_channel::{Db, Dbm, Position, SectorGains};
use sextant_kernel::SettingError;
use sextant_mac::dmg::interval::{self, MOST_SLOT_FRAMES, MOST_SLOTS};
use sextant_mac::dmg::retraining::{RetrainRule, Training};
use sextant_sim::{Antennas, Ieee80211ad};

use super::config::{BeamTrackingConfig, OnFallConfig, PredictedConfig, RetrainConfig};

/// What all robots of the mission have in common.
#[derive(Clone, Debug)]
pub(super) struct BeamTracking {
    pub(super) way: Vec<Position>,
    pub(super) interval: Duration,
    pub(super) rule: RetrainRule,
    /// Number of sectors of a sweep round the predicted one.
    pub(super) near: u8,
    pub(super) refines: bool,
    /// The gains of the sectors of a robot, in the world or, if its antenna turns with it, in its own frame.
    pub(super) gains: Arc<SectorGains>,
    pub(super) turns_with_robot: bool,
    /// Least power of frames of a training.
    pub(super) sensitivity: Dbm,
    pub(super) noise: Dbm,
    all_beacons: Duration,
    /// Sectors of a node: the frames of its answer.
    node_sectors: u8,
}

impl BeamTracking {
    /// The mission over these links.
    ///
    /// # Errors
    /// If a value is out of its range, an antenna does not fit, or a training with all sectors does not fit in half a
    /// beacon interval.
    pub(super) fn new(
        config: &BeamTrackingConfig,
        links: &Ieee80211ad,
        antennas: &Antennas,
    ) -> Result<Self, SettingError> {
        if config.way_m.is_empty() {
            return Err(SettingError::new("way_m", "an empty list", "at least one place"));
        }
        for (i, place) in config.way_m.iter().enumerate() {
            if !place.is_finite() {
                let found = format!("[{}, {}, {}]", place.x_m, place.y_m, place.z_m);
                return Err(SettingError::new(format!("way_m[{i}]"), found, "finite coordinates in metres"));
            }
        }
        let interval_ms = SettingError::in_range("beacon_interval_ms", config.beacon_interval_ms, 1.0, 1000.0)?;
        let sectors = antennas.robots().sector_count();
        let (rule, near) = rule(config.retrain, sectors)?;
        let gains = check_antennas(antennas)?;
        let mission = Self {
            way: config.way_m.clone(),
            interval: Duration::from_secs_f64(interval_ms * 1e-3),
            rule,
            near,
            refines: config.refine,
            gains,
            turns_with_robot: antennas.turn_with_robots(),
            sensitivity: links.radio.sensitivity(),
            noise: links.radio.noise_floor(),
            all_beacons: interval::all_beacons(&antennas.robot_layout()),
            node_sectors: antennas.nodes().sector_count(),
        };
        let longest = mission.training_time(Training::All);
        if longest * 2 > mission.interval {
            let least = longest.as_secs_f64() * 2e3;
            let allowed = format!("at least {least:.3}, twice the time of a training with all {sectors} sectors");
            return Err(SettingError::new("beacon_interval_ms", interval_ms, allowed));
        }
        Ok(mission)
    }

    /// What a beacon interval spends before its data.
    pub(super) fn training_time(&self, training: Training) -> Duration {
        let answers = |slots| interval::answers(slots, self.node_sectors);
        let refinement = if self.refines { interval::refinement() } else { Duration::ZERO };
        match training {
            Training::Keep => interval::beacons(1),
            Training::All => self.all_beacons + answers(MOST_SLOTS) + refinement,
            Training::Near(_) => interval::beacons(self.near.into()) + answers(1) + refinement,
        }
    }
}

/// The rule, and the number of sectors of a sweep round the predicted one.
fn rule(config: RetrainConfig, sectors: u8) -> Result<(RetrainRule, u8), SettingError> {
    let margin = |key: &str, margin_db| SettingError::in_range(key, margin_db, 0.0, 100.0).map(Db);
    match config {
        RetrainConfig::Every(0) => Err(SettingError::new("retrain.every", 0, "at least 1 beacon interval")),
        RetrainConfig::Every(intervals) => Ok((RetrainRule::Every(intervals), 0)),
        RetrainConfig::OnFall(OnFallConfig { margin_db }) => {
            Ok((RetrainRule::OnFall(margin("retrain.on_fall.margin_db", margin_db)?), 0))
        }
        RetrainConfig::Predicted(PredictedConfig { sectors: near, margin_db }) => {
            if near == 0 || near > sectors {
                let allowed = format!("1 to {sectors}, the sectors of a robot");
                return Err(SettingError::new("retrain.predicted.sectors", near, allowed));
            }
            Ok((RetrainRule::Predicted(margin("retrain.predicted.margin_db", margin_db)?), near))
        }
    }
}

/// The gains of the sectors of robots, if the antennas of both ends can be trained.
fn check_antennas(antennas: &Antennas) -> Result<Arc<SectorGains>, SettingError> {
    let refused = |what: String, allowed: &str| Err(SettingError::new("retrain", what, allowed));
    let nodes = antennas.nodes();
    if nodes.is_omnidirectional() {
        return refused("with nodes whose antenna has no sectors".to_owned(), "nodes with 1 to 16 sectors");
    }
    if nodes.sector_count() > MOST_SLOT_FRAMES {
        let found = format!("with nodes that have {} sectors", nodes.sector_count());
        return refused(found, "nodes with 1 to 16 sectors: a slot for answers has no more frames");
    }
    if antennas.robots().sweeps() > 1 {
        return refused("with robots that steer their antennas".to_owned(), "robots that sweep once");
    }
    match antennas.robot_sectors().gains() {
        Some(gains) => Ok(Arc::new(gains.clone())),
        None => refused("with omnidirectional robots".to_owned(), "robots whose antennas have sectors"),
    }
}
