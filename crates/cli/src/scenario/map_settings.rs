//! Which maps to make of a log that came without a running scenario.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use sextant_apps::ControllerConfig;
use sextant_channel::{ChannelConfig, ChannelLaw, ObstacleConfig, ObstacleField};
use sextant_mapper::{KnowledgeKind, MapConfig};
use sextant_sim::{RadioConfig, RobotConfig, TrafficConfig, WorldConfig};

use super::build::{Errors, NamedMap, check_maps};
use super::config::MetricsConfig;
use super::deserialize::deserialize;
use super::document::{self, Document, Value};
use super::error::{ScenarioError, ScenarioErrors};
use super::known_channel::KnownChannel;
use super::layers;
use super::source::Source;

/// What `sextant map` computes if nothing says otherwise.
const DEFAULT: &str = "[[maps]]\nalgorithm.ml_tm = { grid_step_m = 0.25, estimate = \"posterior_mean\", \
                       profile.fitted = {} }\n";

/// The same for another algorithm.
const SELF_CALIBRATED: &str = "[[maps]]\nalgorithm.self_calibrated = {}\n";

/// An algorithm with settings that fit any log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum AlgorithmName {
    /// Maximum likelihood on a grid, under a reception profile that is fitted first.
    MlTm,
    /// Positions, reception curve, stops and obstacles estimated together.
    SelfCalibrated,
}

impl AlgorithmName {
    /// One map by the algorithm, as in a scenario.
    fn text(self) -> &'static str {
        match self {
            Self::MlTm => DEFAULT,
            Self::SelfCalibrated => SELF_CALIBRATED,
        }
    }
}

/// Which maps to make of a log, and how to compare them with the truth.
#[derive(Clone, Debug)]
pub struct MapSettings {
    /// The maps to compute.
    pub maps: Vec<NamedMap>,
    /// What stands in the way, if the scenario tells and a map may know it.
    pub obstacles: Option<ObstacleField>,
    /// How they are compared with the truth.
    pub metrics: MetricsConfig,
}

/// The part of a scenario that concerns maps, and what they may take from the other parts.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(default)]
    world: WrittenWorld,
    #[serde(default)]
    radio: Option<RadioConfig>,
    #[serde(default)]
    channel: ChannelConfig,
    #[serde(default)]
    traffic: Option<TrafficConfig>,
    #[serde(default)]
    robots: Vec<RobotConfig<ControllerConfig>>,
    maps: Vec<MapConfig>,
    #[serde(default)]
    metrics: MetricsConfig,
}

/// The part of a world that a map may know: not the nodes.
#[derive(Debug, Default, Deserialize)]
struct WrittenWorld {
    #[serde(default)]
    obstacles: Vec<ObstacleConfig>,
}

impl MapSettings {
    /// The maps of the scenario `text` (called `name` in messages), or one by `algorithm` if that is given, or one `ml-tm`
    /// map with a fitted profile if there is no scenario or it has no maps. `profile` replaces the profile of every map
    /// that has one: the name of a profile, alone
    /// (`fitted`) or with a colon and its keys (`trapezoid:p0=0.9,plateau_m=2,range_m=10`); keys without a name are those
    /// of a trapezoid. `set` are flags as of `run`.
    ///
    /// # Errors
    /// If anything is wrong: everything that was found.
    pub fn new(
        scenario: Option<(&str, &str)>,
        algorithm: Option<AlgorithmName>,
        profile: Option<&str>,
        set: &[String],
    ) -> Result<Self, ScenarioErrors> {
        let source =
            |name: &str, text: &str| Source { name: name.to_owned(), text: Arc::from(text), folder: PathBuf::new() };
        let defaults = algorithm.unwrap_or(AlgorithmName::MlTm).text();
        let (name, text) = scenario.unwrap_or(("the defaults", defaults));
        let mut sources = vec![source(name, text)];
        let mut root = document::parse(&sources, 0)?;
        let map_count = keep_maps(&mut root.value);
        if scenario.is_some() && (map_count == 0 || algorithm.is_some()) {
            sources.push(source("the defaults", defaults));
            root.overlay(document::parse(&sources, 1)?);
        }
        if let Some(profile) = profile {
            let (name, settings) = profile.split_once(':').unwrap_or(if profile.contains(['=', ' ']) {
                ("trapezoid", profile)
            } else {
                (profile, "")
            });
            let with_profile = maps_with_profile(&root.value);
            if with_profile.is_empty() {
                let message = format!("--profile {profile}: none of the maps has a reception profile");
                return Err(ScenarioErrors::from(ScenarioError::new(message)));
            }
            for map in with_profile {
                let flag = format!("maps[{map}].algorithm.ml_tm.profile.{name}={{ {settings} }}");
                sources.push(source("--profile", &flag));
                layers::lay_flag(&mut root, &sources)?;
            }
        }
        for flag in set {
            sources.push(source("--set", flag));
            layers::lay_flag(&mut root, &sources)?;
        }
        let document = Document { root, sources, text: String::new() };
        let written: Written = deserialize(&document)?;
        let mut errors = Errors { document: &document, found: Vec::new() };
        let channel = match (written.radio, written.traffic) {
            (Some(radio), Some(traffic)) => errors
                .take("channel", ChannelLaw::try_from(written.channel))
                .map(|channel| KnownChannel::new(radio, channel, traffic, &written.robots)),
            _ => None,
        };
        let maps = check_maps(&written.maps, channel, &mut errors);
        errors.take("metrics", written.metrics.check());
        let knows = |map: &NamedMap| map.mapper.uses().contains(&KnowledgeKind::Obstacles);
        let obstacles = if scenario.is_some() && maps.iter().any(knows) {
            errors.take("world", WorldConfig::set_up_obstacles(&written.world.obstacles, Path::new("")))
        } else {
            None
        };
        ScenarioErrors::check(errors.found)?;
        Ok(Self { maps, obstacles, metrics: written.metrics })
    }
}

/// Drops all but the parts of a scenario that concern maps; the number of maps.
fn keep_maps(value: &mut Value) -> usize {
    let Value::Table(table) = value else { return 0 };
    table.retain(|key, _| {
        ["world", "radio", "channel", "traffic", "robots", "maps", "metrics"].contains(&key.as_str())
    });
    match table.get("maps").map(|maps| &maps.value) {
        Some(Value::Array(maps)) => maps.len(),
        _ => 0,
    }
}

/// Indices of the maps that have a reception profile.
fn maps_with_profile(value: &Value) -> Vec<usize> {
    let Value::Table(table) = value else { return Vec::new() };
    let Some(Value::Array(maps)) = table.get("maps").map(|maps| &maps.value) else { return Vec::new() };
    let has_profile = |value: &Value| {
        let Value::Table(map) = value else { return false };
        matches!(map.get("algorithm").map(|entry| &entry.value), Some(Value::Table(table)) if table.contains_key("ml_tm"))
    };
    (0..).zip(maps).filter(|(_, map)| has_profile(&map.value)).map(|(index, _)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: &str = "p0=0.9,plateau_m=2,range_m=10";

    #[test]
    fn a_profile_makes_a_map_of_a_log_without_a_scenario() {
        let settings = MapSettings::new(None, None, Some(PROFILE), &[]).unwrap();
        assert_eq!(settings.maps.len(), 1);
        assert_eq!(settings.maps[0].name, "ml-tm");
        let same = MapSettings::new(None, None, Some(&format!("trapezoid:{PROFILE}")), &[]).unwrap();
        assert_eq!(same.maps, settings.maps);
        let set = ["maps.0.algorithm.ml_tm.grid_step_m=1".to_owned(), "maps.0.name=coarse".to_owned()];
        let coarse = MapSettings::new(None, None, Some(PROFILE), &set).unwrap();
        assert_eq!(coarse.maps[0].name, "coarse");
        assert_ne!(coarse.maps[0].mapper, settings.maps[0].mapper);
    }

    #[test]
    fn the_maps_of_a_scenario_are_kept_and_its_other_parts_ignored() {
        let text = "name = \"x\"\n[[maps]]\nname = \"a\"\n[maps.algorithm.ml_tm]\ngrid_step_m = 1\n\
                    profile.trapezoid = { p0 = 1, plateau_m = 1, range_m = 5 }\n";
        let kept = MapSettings::new(Some(("x", text)), None, None, &[]).unwrap();
        assert_eq!(kept.maps[0].name, "a");
        let changed = MapSettings::new(Some(("x", text)), None, Some(PROFILE), &[]).unwrap();
        assert_ne!(changed.maps[0].mapper, kept.maps[0].mapper);
    }

    #[test]
    fn an_algorithm_replaces_the_maps_of_a_scenario_and_takes_no_profile_if_it_has_none() {
        let text = "name = \"x\"\n[[maps]]\nname = \"a\"\n[maps.algorithm.ml_tm]\ngrid_step_m = 1\n\
                    profile.trapezoid = { p0 = 1, plateau_m = 1, range_m = 5 }\n";
        let algorithm = Some(AlgorithmName::SelfCalibrated);
        for scenario in [None, Some(("x", text)), Some(("x", "name = \"x\"\n"))] {
            let settings = MapSettings::new(scenario, algorithm, None, &[]).unwrap();
            assert_eq!((settings.maps.len(), settings.maps[0].name.as_str()), (1, "self-calibrated"));
            let set = ["maps.0.algorithm.self_calibrated.grid_step_m=0.5".to_owned()];
            let finer = MapSettings::new(scenario, algorithm, None, &set).unwrap();
            assert_ne!(finer.maps[0].mapper, settings.maps[0].mapper);
            let refused = MapSettings::new(scenario, algorithm, Some(PROFILE), &[]).unwrap_err().to_string();
            assert!(refused.contains("none of the maps has a reception profile"), "{refused}");
        }
        let refused = ["maps.0.algorithm.self_calibrated.grid_step_m=0".to_owned()];
        let refused = MapSettings::new(None, algorithm, None, &refused).unwrap_err().to_string();
        assert!(
            refused.contains("maps[0].algorithm.self_calibrated.grid_step_m") && refused.contains("is 0"),
            "{refused}"
        );
    }

    #[test]
    fn a_channel_profile_takes_what_it_leaves_open_from_the_scenario() {
        let map = |channel: &str, profile: &str| {
            let text = format!(
                "radio = {{ tx_power_dbm = -50, sensitivity_dbm = -90 }}\n{channel}\n\
                 traffic.beacon = {{ interval_s = 2.0 }}\n[[maps]]\nalgorithm.ml_tm.grid_step_m = 0.25\n\
                 algorithm.ml_tm.profile.channel = {{ {profile} }}\n"
            );
            let settings = MapSettings::new(Some(("x", &text)), None, None, &[]).unwrap();
            settings.maps[0].mapper.clone()
        };
        let channel = "channel = { environment = \"light-tree\", max_range_m = 10 }";
        let known = map(channel, "");
        let written = "exponent = 3.6, sigma_db = 8.2, tx_power_dbm = -50, sensitivity_dbm = -90, max_range_m = 10";
        assert_eq!(known, map("", written));
        assert_ne!(known, map(channel, "max_range_m = 9"));
        let suburban = "channel = { environment = \"suburban\", max_range_m = 10 }";
        assert_ne!(known, map(suburban, ""));
    }

    #[test]
    fn a_wrong_profile_is_refused_at_the_flag() {
        let refused = |profile: Option<&str>| MapSettings::new(None, None, profile, &[]).unwrap_err().to_string();
        assert!(refused(Some("channel:sigma_db=8")).contains("`"), "{}", refused(Some("channel:sigma_db=8")));
        assert!(refused(Some("p0=2,plateau_m=2,range_m=10")).contains("p0` is 2; allowed: above 0, at most 1"));
        assert!(refused(Some("p=2")).contains("unknown key `p`"));
        assert!(refused(Some("p0 2")).contains("is no TOML value"));
        assert!(refused(Some("square:p0=1")).contains("unknown choice `square`"));
    }
}
