//! The sinks of a scenario.

use sextant_channel::ObstacleField;
use sextant_kernel::SettingError;
use sextant_sim::{Sink, World};

use super::errors::Errors;
use super::networks::Networks;
use crate::config::ScenarioConfig;

/// The sinks, with unique names.
pub(crate) fn check_sinks(
    config: &ScenarioConfig,
    world: Option<&World>,
    networks: &Networks<'_>,
    errors: &mut Errors,
) -> Vec<Sink> {
    let none = ObstacleField::default();
    let obstacles = world.map_or(&none, |world| &world.obstacles);
    let mut sinks: Vec<Sink> = Vec::new();
    for (i, sink) in config.sinks.iter().enumerate() {
        let placed = sink.place(obstacles).and_then(|placed| {
            let numbers = sink.networks.as_ref().map(|names| {
                let numbered = names.iter().enumerate();
                let number = |(j, name): (usize, &String)| networks.number(&format!("networks[{j}]"), Some(name));
                numbered.map(number).collect::<Result<Vec<_>, _>>()
            });
            Ok(Sink { networks: numbers.transpose()?, ..placed })
        });
        let table = format!("sinks[{i}]");
        let Some(placed) = errors.take(&table, placed) else { continue };
        let is_taken = sinks.iter().any(|other| other.name == placed.name)
            || config.robots.iter().any(|robot| robot.name == placed.name)
            || is_name_of_node(world, &placed.name);
        if is_taken {
            let found = format!("`{}`, as of a node, a robot or another sink", placed.name);
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        sinks.push(placed);
    }
    sinks
}

/// Whether a node has this name: rows of tables and commands name stations, of whatever kind.
pub(crate) fn is_name_of_node(world: Option<&World>, name: &str) -> bool {
    world.is_some_and(|world| world.nodes.iter().any(|node| node.name == name))
}
