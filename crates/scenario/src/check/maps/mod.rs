//! The maps of a scenario.

pub(crate) mod grids;

use sextant_apps::ControllerConfig;
use sextant_kernel::text::choices;
use sextant_kernel::{SettingError, SettingProblem};
use sextant_mapper::{
    AlgorithmConfig, KnowledgeKind, MapConfig, Mapper, OnEstimatedPath, PathError, PathUse, Stitched,
};
use sextant_sim::{RobotConfig, RoleConfig};

use super::errors::Errors;
use super::networks::Networks;
use crate::config::ScenarioConfig;

/// A map to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct MapJob {
    /// Its name in tables and recordings; unique in the scenario.
    pub name: String,
    /// The network whose log is mapped; the first surveyed one if absent. Joint maps name their networks themselves.
    pub network: Option<String>,
    /// The algorithm with its settings.
    pub mapper: Mapper,
    /// Names of the robots that write their logs in the frame of the world, as far as it is known.
    pub robots_in_world: Vec<String>,
}

/// The maps to compute of what robots hear; absent channel settings are taken from the `networks` of the maps, where they are
/// known.
pub(crate) fn check_maps(config: &ScenarioConfig, networks: &Networks<'_>, errors: &mut Errors) -> Vec<MapJob> {
    let in_world =
        |robot: &&RobotConfig<ControllerConfig>| robot.role == RoleConfig::Survey && robot.frame.is_world();
    let robots_in_world: Vec<String> =
        config.robots.iter().filter(in_world).map(|robot| robot.name.clone()).collect();
    let mut maps: Vec<MapJob> = Vec::new();
    for (i, written) in config.maps.iter().enumerate() {
        let table = format!("maps[{i}]");
        let mut map = written.clone();
        if errors.take(&table, networks.complete(&mut map)).is_none() {
            continue;
        }
        let mapper = Mapper::try_from(map.algorithm).map_err(|error| error.within("algorithm"));
        let mapper = mapper.and_then(|mapper| match (map.stitch, map.path) {
            (Some(_), PathUse::Estimated) => {
                let remedy = "leave out one of them: robots whose frames are joined have a path each";
                Err(SettingError::conflict("path", "`stitch`", remedy))
            }
            (Some(rules), PathUse::Believed) => Stitched::mapper(mapper, rules),
            (None, PathUse::Estimated) => {
                let error = PathError::try_from(map.path_error.unwrap_or_default());
                OnEstimatedPath::mapper(mapper, error.map_err(|error| error.within("path_error"))?)
            }
            (None, PathUse::Believed) if map.path_error.is_some() => {
                let remedy = "give `path = \"estimated\"` too, or leave `path_error` out";
                Err(SettingError::conflict("path_error", "the path as it is believed to be", remedy))
            }
            (None, PathUse::Believed) => Ok(mapper),
        });
        // A setting may only be absent because the network that should say it is invalid.
        let is_missing = |error: &SettingError| matches!(error.problem, SettingProblem::Missing { .. });
        if mapper.as_ref().is_err_and(is_missing) && !networks.are_known_to_maps() && !errors.found.is_empty() {
            continue;
        }
        let Some(mapper) = errors.take(&table, mapper) else {
            continue;
        };
        let name = map.name.unwrap_or_else(|| mapper.name().to_owned());
        check_name(&name, &table, &maps, errors);
        maps.push(MapJob { name, network: map.network, mapper, robots_in_world: robots_in_world.clone() });
    }
    maps
}

/// Refuses maps of what robots heard, if no robot surveys, those that join the logs of robots, if there are not two, and those
/// by the sectors of a network without any.
pub(crate) fn check_log_of_maps(
    config: &ScenarioConfig,
    maps: &[MapJob],
    networks: &Networks<'_>,
    errors: &mut Errors,
) {
    for (i, map) in config.maps.iter().enumerate() {
        let by_sectors = matches!(map.algorithm, AlgorithmConfig::Mmtm(_) | AlgorithmConfig::AngleOfArrival(_));
        if by_sectors && !networks.log_has_sectors(map.network.as_deref()) {
            let key = format!("maps[{i}].algorithm.{}", map.algorithm.key());
            let with = "a network without `mac.sector_sweep`, because its receptions have no sectors";
            errors.refuse(&SettingError::conflict(key, with, "use `ml_tm`, which maps without sectors"));
        }
    }
    let surveying: Vec<&str> =
        config.robots.iter().filter(|robot| robot.role == RoleConfig::Survey).map(|robot| &*robot.name).collect();
    for (i, stitch) in config.maps.iter().enumerate().filter_map(|(i, map)| Some((i, map.stitch.as_ref()?))) {
        for name in stitch.known.iter().flatten().filter(|name| !surveying.contains(&name.as_str())) {
            let allowed = format!("names of robots that survey: {}", choices(&surveying));
            errors.refuse(&SettingError::new(format!("maps[{i}].stitch.known"), format!("`{name}`"), allowed));
        }
    }
    for i in (0..config.maps.len()).filter(|&i| surveying.len() == 1 && config.maps[i].stitch.is_some()) {
        let remedy = "leave out `stitch`, which joins the logs of two or more robots";
        errors.refuse(&SettingError::conflict(format!("maps[{i}].stitch"), "one robot that surveys", remedy));
    }
    let by_ranges = |map: &MapConfig| {
        use AlgorithmConfig::{RangeMl, TimeDifference, TimeOfArrival};
        matches!(map.algorithm, RangeMl(_) | TimeOfArrival(_) | TimeDifference(_))
            && !networks.log_has_ranges(map.network.as_deref())
    };
    for (i, map) in config.maps.iter().enumerate().filter(|(_, map)| by_ranges(map)) {
        let with = "a network without `ranging`, whose robots measure no ranges";
        let key = map.algorithm.key();
        let remedy = format!(
            "add a table `[ranging]`, or map a log that has `ranges.csv` by `sextant map LOG --algorithm {}`",
            key.replace('_', "-")
        );
        errors.refuse(&SettingError::conflict(format!("maps[{i}].algorithm.{key}"), with, remedy));
    }
    let discovers = |map: &&MapJob| {
        let uses = map.mapper.uses();
        uses.iter().any(|kind| kind.needs_neighbours() || kind.needs_beacons())
    };
    if let Some((map, key)) = maps.iter().find(discovers).zip(networks.first_without_hellos()) {
        let with = format!("the map `{}`, for which nodes send hellos by a channel access", map.name);
        errors.refuse(&SettingError::conflict(key, with, "leave one of them out"));
    }
    if config.robots.iter().any(|robot| robot.role == RoleConfig::Survey) {
        return;
    }
    let of_log = |map: &&MapJob| {
        let uses = map.mapper.uses();
        uses.contains(&KnowledgeKind::RobotReceptions) || uses.contains(&KnowledgeKind::RobotRanges)
    };
    if let Some(map) = maps.iter().find(of_log) {
        let allowed = format!("a robot that surveys: the map `{}` is made from what robots hear", map.name);
        errors.refuse(&SettingError::new("robots", "no surveying robot", allowed));
    }
}

/// Refuses the name of a map that is not plain, or that one of the `others` has. The name is in `table`.
pub(crate) fn check_name(name: &str, table: &str, others: &[MapJob], errors: &mut Errors) {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if name.is_empty() || !name.chars().all(is_plain) {
        let allowed = "at least one character; only letters, digits, `-`, `_` and `.`";
        errors.refuse(&SettingError::new("name", format!("`{name}`"), allowed).within(table));
    }
    if others.iter().any(|map| map.name == name) {
        let found = format!("`{name}`, the name of an earlier map");
        errors.refuse(&SettingError::new("name", found, "a unique name").within(table));
    }
}
