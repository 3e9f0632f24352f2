//! What is recorded.

use sextant_channel::Bounds;
use sextant_kernel::SettingError;
use sextant_sim::World;

use super::errors::Errors;
use crate::config::ScenarioConfig;

/// What is recorded, but for the nodes that it names.
pub(super) fn check_recording(config: &ScenarioConfig, world: Option<&World>, errors: &mut Errors) {
    if let Some(snapshots) = &config.recording.fields {
        let places = world.iter().flat_map(|world| &world.nodes).map(|node| node.position);
        errors.take("recording.fields", snapshots.check(Bounds::of(places)));
    }
    errors.take("recording", config.recording.check());
    errors.take("recording.pcap", config.recording.pcap.check(&config.robots));
}

/// Refuses names in `recording.likelihood` that no node has.
pub(super) fn check_recorded_nodes(config: &ScenarioConfig, world: &World, errors: &mut Errors) {
    for (i, name) in config.recording.likelihood.iter().enumerate() {
        if !world.nodes.iter().any(|node| node.name == *name) {
            let key = format!("recording.likelihood[{i}]");
            errors.refuse(&SettingError::new(key, format!("`{name}`"), "the name of a node"));
        }
    }
}
