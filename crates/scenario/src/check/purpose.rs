//! What a scenario is for, and for how long it goes on.

use std::time::Duration;

use sextant_kernel::SettingError;
use sextant_sim::RoleConfig;

use super::errors::Errors;
use super::networks::Networks;
use crate::config::ScenarioConfig;

/// How long a simulation may be (s).
const DURATIONS_S: [f64; 2] = [1e-6, 1e7];

/// When the simulation ends, if not with the survey.
pub(super) fn check_duration(config: &ScenarioConfig, errors: &mut Errors) -> Option<Duration> {
    let duration = config.duration_s.and_then(|duration_s| {
        let [least, most] = DURATIONS_S;
        let checked = SettingError::in_range("duration_s", duration_s, least, most).map(Duration::from_secs_f64);
        errors.take("", checked)
    });
    // Without a survey, maps need no more than the names of the nodes.
    let nothing_happens = !config.has_traffic() && config.distributed_mapping.is_none();
    if nothing_happens { Some(Duration::ZERO) } else { duration }
}

/// What is left out of the counts at the start.
pub(super) fn check_warm_up(config: &ScenarioConfig, networks: &Networks<'_>, errors: &mut Errors) -> Duration {
    let Some(warm_up_s) = config.warm_up_s else { return Duration::ZERO };
    let checked = match config.duration_s {
        None => {
            let remedy = "set `duration_s` or remove it, because a survey counts from its start";
            Err(SettingError::conflict("warm_up_s", "a scenario without `duration_s`", remedy))
        }
        Some(_) if networks.sweep_sectors() => {
            Err(SettingError::conflict("warm_up_s", "`mac.sector_sweep`", "remove it, because all sweeps count"))
        }
        // The error is that of the duration.
        Some(duration_s) if !(DURATIONS_S[0]..=DURATIONS_S[1]).contains(&duration_s) => return Duration::ZERO,
        Some(duration_s) if !(warm_up_s >= 0.0 && warm_up_s < duration_s) => {
            Err(SettingError::new("warm_up_s", warm_up_s, format!("0 to less than `duration_s`, {duration_s}")))
        }
        Some(_) => Ok(Duration::from_secs_f64(warm_up_s)),
    };
    errors.take("", checked).unwrap_or_default()
}

/// Refuses scenarios in which nothing happens, or packets that are for nobody.
pub(super) fn check_purpose(config: &ScenarioConfig, networks: &Networks<'_>, errors: &mut Errors) {
    if !config.has_traffic() && config.distributed_mapping.is_none() && config.applications.is_empty() {
        let needed = "at least one robot, or `duration_s` to end a simulation without robots";
        errors.refuse(&SettingError::missing("robots", needed));
    }
    // Neither a map in the nodes nor what they sense needs a receiver, and nodes with programs receive themselves.
    let surveys = config.robots.iter().any(|robot| robot.role != RoleConfig::Agent);
    let senses = !config.world.targets.is_empty() || !config.world.fields.is_empty();
    let is_for_nobody =
        config.sinks.is_empty() && !surveys && config.distributed_mapping.is_none() && !networks.have_programs();
    if config.duration_s.is_some() && is_for_nobody && !senses && config.applications.is_empty() {
        let needed = "at least one sink in `[[sinks]]`, or a robot that surveys, to receive the packets";
        errors.refuse(&SettingError::missing("sinks", needed));
    }
}
