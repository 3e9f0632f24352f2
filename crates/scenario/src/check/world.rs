//! What is in the world besides what stands in it: noise, nodes that move, batteries, and nodes that know their position.

use sextant_channel::Anchor;
use sextant_kernel::text::counted;
use sextant_kernel::{Seed, SettingError};
use sextant_sim::{Batteries, Interferer, RoleConfig, World};

use super::errors::Errors;
use super::maps::MapJob;
use crate::config::ScenarioConfig;

/// The sources of noise, with unique names.
pub(super) fn check_interferers(config: &ScenarioConfig, errors: &mut Errors) -> Vec<Interferer> {
    let mut interferers: Vec<Interferer> = Vec::new();
    for (i, interferer) in config.interferers.iter().enumerate() {
        let table = format!("interferers[{i}]");
        let Some(interferer) = errors.take(&table, interferer.build(i, Seed(config.seed))) else { continue };
        if interferers.iter().any(|other| other.name() == interferer.name()) {
            let found = format!("`{}`, as of another interferer", interferer.name());
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        interferers.push(interferer);
    }
    interferers
}

/// Refuses nodes that move beside what takes all nodes to stand.
pub(super) fn check_motions(config: &ScenarioConfig, errors: &mut Errors) {
    if config.world.motions.is_empty() {
        return;
    }
    let surveys = config.robots.iter().any(|robot| robot.role != RoleConfig::Agent);
    for (is_there, with) in [
        (surveys, "a robot that surveys"),
        (!config.maps.is_empty(), "`maps`"),
        (config.distributed_mapping.is_some(), "`distributed_mapping`"),
        (!config.applications.is_empty(), "`applications`"),
        (!config.world.targets.is_empty(), "`world.targets`"),
        (!config.world.fields.is_empty(), "`world.fields`"),
    ] {
        if is_there {
            let remedy = "remove one of the two: nodes that move send to sinks, and all else takes nodes to stand";
            errors.refuse(&SettingError::conflict("world.motions", with, remedy));
        }
    }
}

/// The batteries of the nodes, if there are any.
pub(super) fn check_battery(config: &ScenarioConfig, world: &World, errors: &mut Errors) -> Option<Batteries> {
    let battery = config.battery.as_ref()?;
    for (is_there, with) in [
        (!config.applications.is_empty(), "`applications`"),
        (config.distributed_mapping.is_some(), "`distributed_mapping`"),
    ] {
        if is_there {
            let remedy = "remove one of the two: batteries are those of nodes that send their traffic";
            errors.refuse(&SettingError::conflict("battery", with, remedy));
        }
    }
    errors.take("battery", battery.build(&world.nodes, Seed(config.seed)))
}

/// The nodes that know their position; checks that there are enough for each of `maps`.
pub(super) fn check_anchors(
    config: &ScenarioConfig,
    world: &World,
    maps: &[MapJob],
    errors: &mut Errors,
) -> Option<Vec<Anchor>> {
    let anchors = errors.take("anchors", config.anchors.choose(&world.nodes, &world.obstacles, Seed(config.seed)))?;
    let first = anchors.first().map_or(0.0, |anchor| anchor.position.z_m);
    let is_planar = anchors.iter().all(|anchor| (anchor.position.z_m - first).abs() <= 1e-9);
    let needed = |map: &MapJob| map.mapper.least_anchors(if is_planar { 2 } else { 3 });
    let lacking: Vec<&MapJob> = maps.iter().filter(|map| anchors.len() < needed(map)).collect();
    if let Some(most) = lacking.iter().map(|map| needed(map)).max() {
        let found = format!("{} of the {}", anchors.len(), counted(world.nodes.len(), "node"));
        let names: Vec<String> = lacking.iter().map(|map| format!("`{}`", map.name)).collect();
        let maps = if names.len() == 1 { "map" } else { "maps" };
        let allowed = format!("at least {most}, for the {maps} {}", names.join(", "));
        errors.refuse(&SettingError::new("anchors", found, allowed));
    }
    errors.take("faults", config.faults.believed(&anchors, &world.nodes, Seed(config.seed)))
}
