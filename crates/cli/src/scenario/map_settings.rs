//! Which maps to make of a log that came without a running scenario.

use std::path::PathBuf;
use std::sync::Arc;

use serde::Deserialize;
use sextant_mapper::MapConfig;

use super::build::{Errors, NamedMap, check_maps};
use super::config::MetricsConfig;
use super::deserialize::deserialize;
use super::document::{self, Document, Source, Value};
use super::error::{ScenarioError, ScenarioErrors};
use super::layers;

/// What `sextant map` computes if nothing says otherwise; the profile comes from the flag.
const DEFAULT: &str = "[[maps]]\nalgorithm.ml_tm.grid_step_m = 0.25\n";

/// Which maps to make of a log, and how to compare them with the truth.
#[derive(Clone, Debug)]
pub struct MapSettings {
    /// The maps to compute.
    pub maps: Vec<NamedMap>,
    /// How they are compared with the truth.
    pub metrics: MetricsConfig,
}

/// The part of a scenario that concerns maps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    maps: Vec<MapConfig>,
    #[serde(default)]
    metrics: MetricsConfig,
}

impl MapSettings {
    /// The maps of the scenario `text` (called `name` in messages), or one `ml-tm` map if there is no scenario or it
    /// has no maps. `profile` (`p0=0.9,plateau_m=2,range_m=10`, the keys of `maps.N.algorithm.ml_tm.profile.trapezoid`,
    /// after the name of another profile and a colon if wanted) replaces the profile of every map; `set` are flags
    /// as of `run`.
    ///
    /// # Errors
    /// If anything is wrong: everything that was found.
    pub fn new(
        scenario: Option<(&str, &str)>,
        profile: Option<&str>,
        set: &[String],
    ) -> Result<Self, ScenarioErrors> {
        let source =
            |name: &str, text: &str| Source { name: name.to_owned(), text: Arc::from(text), folder: PathBuf::new() };
        let (name, text) = scenario.unwrap_or(("the defaults", DEFAULT));
        let mut sources = vec![source(name, text)];
        let mut root = document::parse(&sources, 0)?;
        let mut map_count = keep_maps(&mut root.value);
        if map_count == 0 {
            sources[0] = source("the defaults", DEFAULT);
            root = document::parse(&sources, 0)?;
            map_count = 1;
        }
        if let Some(profile) = profile {
            let (name, settings) = profile.split_once(':').unwrap_or(("trapezoid", profile));
            for map in 0..map_count {
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
        let written: Written = deserialize(&document).map_err(|error| with_help(error, profile))?;
        let mut errors = Errors { document: &document, found: Vec::new() };
        let maps = check_maps(&written.maps, &mut errors);
        errors.take("metrics", written.metrics.check());
        ScenarioErrors::check(errors.found)?;
        Ok(Self { maps, metrics: written.metrics })
    }
}

fn with_help(error: ScenarioError, profile: Option<&str>) -> ScenarioError {
    if profile.is_none() && error.to_string().starts_with("`profile` is missing") {
        return ScenarioError::new("nothing says how far the radio reaches")
            .help("for example: --profile p0=0.95,plateau_m=2,range_m=10");
    }
    error
}

/// Drops all but the part of a scenario that concerns maps; the number of maps.
fn keep_maps(value: &mut Value) -> usize {
    let Value::Table(table) = value else { return 0 };
    table.retain(|key, _| key == "maps" || key == "metrics");
    match table.get("maps").map(|maps| &maps.value) {
        Some(Value::Array(maps)) => maps.len(),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROFILE: &str = "p0=0.9,plateau_m=2,range_m=10";

    #[test]
    fn a_profile_makes_a_map_of_a_log_without_a_scenario() {
        let settings = MapSettings::new(None, Some(PROFILE), &[]).unwrap();
        assert_eq!(settings.maps.len(), 1);
        assert_eq!(settings.maps[0].name, "ml-tm");
        let same = MapSettings::new(None, Some(&format!("trapezoid:{PROFILE}")), &[]).unwrap();
        assert_eq!(same.maps, settings.maps);
        let set = ["maps.0.algorithm.ml_tm.grid_step_m=1".to_owned(), "maps.0.name=coarse".to_owned()];
        let coarse = MapSettings::new(None, Some(PROFILE), &set).unwrap();
        assert_eq!(coarse.maps[0].name, "coarse");
        assert_ne!(coarse.maps[0].mapper, settings.maps[0].mapper);
    }

    #[test]
    fn the_maps_of_a_scenario_are_kept_and_its_other_parts_ignored() {
        let text = "name = \"x\"\n[[maps]]\nname = \"a\"\n[maps.algorithm.ml_tm]\ngrid_step_m = 1\n\
                    profile.trapezoid = { p0 = 1, plateau_m = 1, range_m = 5 }\n";
        let kept = MapSettings::new(Some(("x", text)), None, &[]).unwrap();
        assert_eq!(kept.maps[0].name, "a");
        let changed = MapSettings::new(Some(("x", text)), Some(PROFILE), &[]).unwrap();
        assert_ne!(changed.maps[0].mapper, kept.maps[0].mapper);
    }

    #[test]
    fn a_wrong_profile_is_refused_at_the_flag() {
        let refused = |profile: Option<&str>| MapSettings::new(None, profile, &[]).unwrap_err().to_string();
        assert_eq!(refused(None), "nothing says how far the radio reaches");
        assert!(refused(Some("p0=2,plateau_m=2,range_m=10")).contains("p0` is 2; allowed: above 0, at most 1"));
        assert!(refused(Some("p=2")).contains("unknown key `p`"));
        assert!(refused(Some("p0 2")).contains("is no TOML value"));
        assert!(refused(Some("square:p0=1")).contains("unknown choice `square`"));
    }
}
