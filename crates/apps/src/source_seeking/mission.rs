//! Source seeking as a mission.

use std::sync::Arc;

use sextant_channel::Dbm;
use sextant_kernel::SettingError;
use sextant_sim::{Applications, Field, Gaussian, ReadySimulation, Setup, Simulation};

use super::config::{GradientConfig, LevelSetConfig};
use super::record::SeekRecord;
use super::settings::SourceSeeking;
use super::station::SeekStation;
use crate::mission::{
    Mission, MissionArrival, MissionGoal, MissionOutcome, MissionPlace, MissionSettings, MissionTeam, SoughtField,
};
use crate::navigation::NavigationMap;

impl MissionSettings for LevelSetConfig {
    fn key(&self) -> &'static str {
        "level_set"
    }

    fn name(&self) -> &'static str {
        "level-set"
    }

    fn check_world(&self, place: &MissionPlace<'_>) -> Result<(), SettingError> {
        check_sensed(self.key(), place)
    }

    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
        checked(SourceSeeking::level_set(self, &place.world.fields)?, place)
    }
}

impl MissionSettings for GradientConfig {
    fn key(&self) -> &'static str {
        "gradient"
    }

    fn name(&self) -> &'static str {
        "gradient"
    }

    fn check_world(&self, place: &MissionPlace<'_>) -> Result<(), SettingError> {
        check_sensed(self.key(), place)
    }

    fn check(&self, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
        checked(SourceSeeking::gradient(self, &place.world.fields)?, place)
    }
}

impl Mission for SourceSeeking {
    fn goal(&self) -> MissionGoal {
        MissionGoal::Field(SoughtField {
            field: self.field(),
            level: self.level(),
            arrival_value: self.arrival_value(),
            climb_rate: self.climb_rate(),
        })
    }

    fn prepare(
        self: Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
        setup: Setup,
    ) -> Result<ReadySimulation<'static, MissionOutcome>, SettingError> {
        let simulation = Simulation::with(setup, self.stations(map, team))?;
        Ok(simulation.ready(|own| outcome(&own.each(SeekStation::into_record))))
    }
}

/// Refuses a world without fields, and nodes that do not sample them.
fn check_sensed(algorithm: &str, place: &MissionPlace<'_>) -> Result<(), SettingError> {
    if place.world.fields.is_empty() {
        let allowed = format!("another algorithm, or a field in `[[world.fields]]`: `{algorithm}` seeks its source");
        return Err(SettingError::new("algorithm", format!("`{algorithm}`, without fields"), allowed));
    }
    if place.sensors.fields.is_none() {
        let allowed = format!("a table `[sensors.fields]`: with `{algorithm}` nodes sample the field");
        return Err(SettingError::new("algorithm", format!("`{algorithm}`, without sensors of fields"), allowed));
    }
    Ok(())
}

/// The mission, if its field and the radios allow it.
fn checked(seek: SourceSeeking, place: &MissionPlace<'_>) -> Result<Arc<dyn Mission>, SettingError> {
    check_level(&seek, &place.world.fields)?;
    check_weights(&seek, place.radio().tx_power())?;
    Ok(Arc::new(seek))
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

/// What all stations together did.
fn outcome(records: &Applications<SeekRecord>) -> MissionOutcome {
    let mut outcome = MissionOutcome::default();
    let mut refused = 0;
    for (robot, record) in records.robots.iter().enumerate() {
        let SeekRecord::Robot(record) = record else { continue };
        *outcome.messages.entry("requests").or_default() += record.polls;
        *outcome.steps.entry("blocked").or_default() += record.blocked;
        *outcome.steps.entry("sources_removed").or_default() += record.removed as u64;
        refused += record.refused;
        outcome.octets += record.octets;
        let arrival = |arrival: &super::Arrival| MissionArrival { robot, time: arrival.time, value: arrival.value };
        outcome.arrivals.extend(record.arrivals.iter().map(arrival));
    }
    for record in &records.nodes {
        let SeekRecord::Node(node) = record else { continue };
        *outcome.messages.entry("answers").or_default() += node.answers;
        refused += node.refused;
        outcome.octets += node.octets;
    }
    outcome.messages.insert("refused", refused);
    outcome.without_zeros()
}
