//! The maps that `sextant map` computes from a log.

use std::borrow::Cow;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use sextant_channel::ObstacleField;
use sextant_kernel::Files;
use sextant_kernel::text::{choices, listed, shortened};
use sextant_mapper::{AlgorithmConfig, AnyLog, KnowledgeKind, MapConfig};

use super::check::errors::Errors;
use super::check::maps::{MapJob, check_maps};
use super::check::networks::Networks;
use super::check::robots::team;
use super::config::team::TeamConfig;
use super::config::{MetricsConfig, ScenarioConfig};
use super::deserialize::deserialize;
use super::document::Document;
use super::error::{ScenarioError, ScenarioErrors};

/// The key of the algorithm that has reception profiles, and of the one that chooses by the log.
const WITH_PROFILE: &str = "ml_tm";
const AUTO: &str = "auto";

/// An algorithm whose default settings suit any log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AlgorithmName(AnyLog);

impl AlgorithmName {
    /// All of them, those that are tried first before the others.
    #[must_use]
    pub fn all() -> Vec<Self> {
        AlgorithmConfig::of_any_log().into_iter().map(Self).collect()
    }

    /// The one with this key, which is registered.
    fn of_key(key: &str) -> Self {
        Self::all().into_iter().find(|name| name.0.key() == key).expect("it is registered")
    }

    /// Its name, as in `[[maps]]` of a scenario but with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// What it computes, in a sentence without a full stop.
    #[must_use]
    pub fn description(self) -> &'static str {
        self.0.description
    }

    /// The algorithm of a log without a scenario, if none is named: the one whose settings are given, otherwise the usual one.
    fn meant(has_scenario: bool, profile: Option<&str>, set: &[String]) -> Option<Self> {
        let is_set = |name: &Self| {
            let key = format!("algorithm.{}", name.0.key());
            set.iter().any(|setting| setting.contains(&key))
        };
        let set_up = Self::all().into_iter().find(is_set);
        (!has_scenario).then(|| set_up.unwrap_or_else(|| Self::usual(profile)))
    }

    /// The usual one of a log: `ml-tm` for a `profile`, otherwise the choice of the log.
    #[must_use]
    pub fn usual(profile: Option<&str>) -> Self {
        Self::of_key(if profile.is_some() { WITH_PROFILE } else { AUTO })
    }

    /// One map by the algorithm, as written in a scenario.
    fn text(self) -> String {
        format!("[[maps]]\nalgorithm.{} = {}\n", self.0.key(), self.0.settings)
    }
}

/// The name is that of no algorithm.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{found}` is not an algorithm; allowed: {}", AlgorithmName::all().into_iter().map(AlgorithmName::name).collect::<Vec<_>>().join(", "))]
pub struct UnknownAlgorithm {
    /// The name.
    pub found: String,
}

impl FromStr for AlgorithmName {
    type Err = UnknownAlgorithm;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::all().into_iter().find(|algorithm| algorithm.name() == text);
        named.ok_or_else(|| UnknownAlgorithm { found: text.to_owned() })
    }
}

/// The scenario of a recording.
#[derive(Clone, Copy, Debug)]
pub struct RecordedScenario<'a> {
    /// Its name in messages.
    pub name: &'a str,
    /// Its text.
    pub text: &'a str,
    /// The files that it names.
    pub files: &'a Files,
}

/// The maps to compute from a log, and how to compare them with the truth.
#[derive(Clone, Debug)]
pub struct MapSettings {
    /// The maps to compute.
    pub maps: Vec<MapJob>,
    /// The obstacles, if the scenario has them and a map may know them.
    pub obstacles: Option<ObstacleField>,
    /// How they are compared with the truth.
    pub metrics: MetricsConfig,
}

/// The tables on which maps depend.
const TABLES: [&str; 11] =
    ["world", "radio", "channel", "mac", "antenna", "networks", "traffic", "robots", "team", "maps", "metrics"];

/// The scenario of a log that has none, without its maps.
const OF_LOG: &str = "name = \"log\"\nworld.nodes.explicit.positions_m = []\n";

impl MapSettings {
    /// The maps of `scenario`. If `algorithm` is given, it is one map by that
    /// algorithm instead. If the scenario has no maps, it is one `ml-tm` map with a fitted profile. Without a scenario, it is
    /// the map that the log chooses (`auto`), or one by the algorithm that `profile` or `set` are for.
    ///
    /// `profile` replaces the profile of every map that has one. It is the name of a profile (`fitted`), or a name, a
    /// colon and settings (`trapezoid:p0=0.9,plateau_m=2,range_m=10`); settings without a name are those of a trapezoid.
    /// `set` are settings `path.to.key=value`. If `network` is given, its log is mapped instead of those of the networks that the maps
    /// name; joint maps keep theirs.
    ///
    /// # Errors
    /// All errors found.
    pub fn new(
        scenario: Option<RecordedScenario<'_>>,
        algorithm: Option<AlgorithmName>,
        profile: Option<&str>,
        network: Option<&str>,
        set: &[String],
    ) -> Result<Self, ScenarioErrors> {
        let algorithm = algorithm.or_else(|| AlgorithmName::meant(scenario.is_some(), profile, set));
        let mut document = document(scenario, algorithm)?;
        if let Some(profile) = profile {
            replace_profiles(&mut document, profile)?;
        }
        for setting in set {
            document.lay_setting("setting", &whole_setting(setting, &document)?, Path::new(""))?;
        }
        let mut config: ScenarioConfig = deserialize(&document)?;
        let is_joint = |map: &MapConfig| map.algorithm.networks().is_some();
        if let Some(network) = network.filter(|_| !config.networks.is_empty()) {
            let alone = config.maps.iter_mut().filter(|map| !is_joint(map));
            alone.for_each(|map| map.network = Some(network.to_owned()));
        }
        let mut errors = Errors::default();
        team::stitch_no_lone_robot(config.team.as_ref(), 1 + config.robots.len(), &mut config.maps);
        config.robots.extend(config.team.iter().flat_map(TeamConfig::robots_in_world));
        let none = Files::Attached(Arc::default());
        let files = scenario.map_or(&none, |scenario| scenario.files);
        let networks = Networks::of_log(&config, files, &mut errors);
        let maps = check_maps(&config, &networks, &mut errors);
        errors.take("metrics", config.metrics.check());
        let knows = |map: &MapJob| map.mapper.uses().contains(&KnowledgeKind::Obstacles);
        let obstacles = if scenario.is_some() && maps.iter().any(knows) {
            errors.take("world", config.world.set_up_obstacles(files)).map(|world| world.obstacles)
        } else {
            None
        };
        errors.placed(&document)?;
        Ok(Self { maps, obstacles, metrics: config.metrics })
    }
}

/// The settings before any flag: those of the scenario. If `algorithm` is given or the scenario has no maps, its maps are
/// replaced by the default map.
fn document(
    scenario: Option<RecordedScenario<'_>>,
    algorithm: Option<AlgorithmName>,
) -> Result<Document, ScenarioError> {
    let mut document = Document::default();
    let (name, text) = scenario.map_or(("the log", OF_LOG), |scenario| (scenario.name, scenario.text));
    document.lay_text(name, text)?;
    let has_maps = || deserialize(&document).map(|config: ScenarioConfig| !config.maps.is_empty());
    if algorithm.is_some() || !has_maps()? {
        let algorithm = algorithm.unwrap_or_else(|| AlgorithmName::of_key(WITH_PROFILE));
        document.lay_text("the defaults", &algorithm.text())?;
    }
    Ok(document)
}

/// The setting with its whole key: if there is one map, what its estimator has may be named alone, or from `algorithm` on.
fn whole_setting<'a>(setting: &'a str, document: &Document) -> Result<Cow<'a, str>, ScenarioError> {
    let table = setting.split(['.', '=']).next().unwrap_or_default().trim();
    if TABLES.contains(&table) {
        return Ok(Cow::Borrowed(setting));
    }
    let config: ScenarioConfig = deserialize(document)?;
    let of_map = |(number, map): (usize, &MapConfig)| match table {
        "algorithm" => format!("maps.{number}.{}", setting.trim_start()),
        _ => format!("maps.{number}.algorithm.{}.{}", map.algorithm.key(), setting.trim_start()),
    };
    let whole: Vec<String> = config.maps.iter().enumerate().map(of_map).collect();
    let is_known = |whole: &str| {
        let mut tried = document.clone();
        let is_read = tried.lay_setting("setting", whole, Path::new("")).is_ok();
        is_read && deserialize::<ScenarioConfig>(&tried).is_ok()
    };
    match &whole[..] {
        [alone] if is_known(alone) => return Ok(Cow::Owned(alone.clone())),
        _ => {}
    }
    let key = |whole: &String| format!("`{}`", shortened(whole.split('=').next().unwrap_or_default().trim_end()));
    let whole: Vec<String> = whole.iter().map(key).collect();
    let message = format!("setting `{}`: no map depends on `{}`", shortened(setting), shortened(table));
    let help =
        format!("maps depend on {}; if an estimator has it, its whole key is {}", choices(&TABLES), listed(&whole));
    Err(ScenarioError::new(message).help(help))
}

/// Replaces the reception profile of every map that has one by `profile`.
fn replace_profiles(document: &mut Document, profile: &str) -> Result<(), ScenarioError> {
    let (name, settings) = profile.split_once(':').unwrap_or(if profile.contains(['=', ' ']) {
        ("trapezoid", profile)
    } else {
        (profile, "")
    });
    let mut config: ScenarioConfig = deserialize(document)?;
    let mut keys: Vec<String> = Vec::new();
    for (i, map) in config.maps.iter_mut().enumerate() {
        keys.extend(
            map.algorithm.profiles_mut().iter().map(|profile| format!("maps[{i}].algorithm.{}", profile.key)),
        );
    }
    if keys.is_empty() {
        return Err(ScenarioError::new(format!("profile `{profile}`: no map has a reception profile")));
    }
    let flag = |key| format!("{key}.{name}={{ {settings} }}");
    keys.iter().try_for_each(|key| document.lay_setting("profile", &flag(key), Path::new("")))
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use sextant_channel::{ChannelConfig, ChannelLaw, CloseInConfig, PathLossConfig};

    use super::*;
    use crate::schema::schema;

    /// The start of each recorded scenario: tables of TOML follow.
    const START: &str = "name = \"x\"\nworld.nodes.explicit.positions_m = [[0, 0]]\n";

    /// A recorded scenario that names no files.
    fn recorded(text: &str) -> Option<RecordedScenario<'_>> {
        static NONE: LazyLock<Files> = LazyLock::new(|| Files::Attached(Arc::default()));
        Some(RecordedScenario { name: "x", text, files: &NONE })
    }

    /// A recorded scenario with one map, which has a profile.
    fn with_a_map() -> String {
        format!(
            "{START}[[maps]]\nname = \"a\"\n[maps.algorithm.ml_tm]\ngrid_step_m = 1\n\
             profile.trapezoid = {{ p0 = 1, plateau_m = 1, range_m = 5 }}\n"
        )
    }

    const PROFILE: &str = "p0=0.9,plateau_m=2,range_m=10";

    #[test]
    fn a_log_without_a_scenario_is_mapped_with_the_given_profile() {
        let settings = MapSettings::new(None, None, Some(PROFILE), None, &[]).unwrap();
        assert_eq!(settings.maps.len(), 1);
        assert_eq!(settings.maps[0].name, "ml-tm");
        let same = MapSettings::new(None, None, Some(&format!("trapezoid:{PROFILE}")), None, &[]).unwrap();
        assert_eq!(same.maps, settings.maps);
        let set = ["maps.0.algorithm.ml_tm.grid_step_m=1".to_owned(), "maps.0.name=coarse".to_owned()];
        let coarse = MapSettings::new(None, None, Some(PROFILE), None, &set).unwrap();
        assert_eq!(coarse.maps[0].name, "coarse");
        assert_ne!(coarse.maps[0].mapper, settings.maps[0].mapper);
    }

    #[test]
    fn the_maps_of_a_scenario_are_used_and_its_other_parts_ignored() {
        let text = with_a_map();
        let kept = MapSettings::new(recorded(&text), None, None, None, &[]).unwrap();
        assert_eq!(kept.maps[0].name, "a");
        let changed = MapSettings::new(recorded(&text), None, Some(PROFILE), None, &[]).unwrap();
        assert_ne!(changed.maps[0].mapper, kept.maps[0].mapper);
    }

    #[test]
    fn an_algorithm_replaces_the_maps_of_a_scenario_and_a_profile_is_rejected_if_it_has_none() {
        let text = with_a_map();
        let algorithm = Some(AlgorithmName::of_key("self_calibrated"));
        for scenario in [None, recorded(&text), recorded(START)] {
            let settings = MapSettings::new(scenario, algorithm, None, None, &[]).unwrap();
            assert_eq!((settings.maps.len(), settings.maps[0].name.as_str()), (1, "self-calibrated"));
            let set = ["maps.0.algorithm.self_calibrated.grid_step_m=0.5".to_owned()];
            let finer = MapSettings::new(scenario, algorithm, None, None, &set).unwrap();
            assert_ne!(finer.maps[0].mapper, settings.maps[0].mapper);
            let refused = MapSettings::new(scenario, algorithm, Some(PROFILE), None, &[]).unwrap_err().to_string();
            assert!(refused.contains("no map has a reception profile"), "{refused}");
        }
        let refused = ["maps.0.algorithm.self_calibrated.grid_step_m=0".to_owned()];
        let refused = MapSettings::new(None, algorithm, None, None, &refused).unwrap_err().to_string();
        assert!(
            refused.contains("maps[0].algorithm.self_calibrated.grid_step_m") && refused.contains("is 0"),
            "{refused}"
        );
    }

    #[test]
    fn absent_settings_of_a_channel_profile_come_from_the_scenario() {
        let map = |channel: &str, profile: &str| {
            let text = format!(
                "{START}radio = {{ tx_power_dbm = -50, sensitivity_dbm = -90 }}\n{channel}\n\
                 traffic.beacon = {{ interval_s = 2.0 }}\n[[maps]]\nalgorithm.ml_tm.grid_step_m = 0.25\n\
                 algorithm.ml_tm.profile.channel = {{ {profile} }}\n"
            );
            let settings = MapSettings::new(recorded(&text), None, None, None, &[]).unwrap();
            settings.maps[0].mapper.clone()
        };
        let channel = "channel = { environment = \"light-tree\", max_range_m = 10, path_loss.log_distance.reference_loss_db = 0.0 }";
        let known = map(channel, "");
        let written = "exponent = 3.6, sigma_db = 8.2, tx_power_dbm = -50, sensitivity_dbm = -90, max_range_m = 10";
        assert_eq!(known, map("", written));
        assert_ne!(known, map(channel, "max_range_m = 9"));
        let suburban = "channel = { environment = \"suburban\", max_range_m = 10, path_loss.log_distance.reference_loss_db = 0.0 }";
        assert_ne!(known, map(suburban, ""));
    }

    #[test]
    fn a_channel_profile_of_sector_sweeps_has_the_gains_of_the_weaker_direction() {
        let map = |gains: [f64; 2], profile: &str| {
            let [nodes, robots] = gains.map(|dbi| format!("{{ azimuth_sectors = 8, boresight_gain_dbi = {dbi} }}"));
            let text = format!(
                "{START}radio = {{ tx_power_dbm = 20, sensitivity_dbm = -60 }}\nmac.sector_sweep = {{}}\n\
                 channel.path_loss.close_in = {{ carrier_ghz = 73, exponent = 1.7 }}\nchannel.max_range_m = 7\n\
                 channel.shadowing = {{ sigma_db = 3.2, correlation = \"per_link\" }}\n\
                 antenna.nodes.sectors = {nodes}\nantenna.robots.sectors = {robots}\n\
                 [[maps]]\nalgorithm.mmtm = {{ grid_step_m = 0.5, profile.channel = {{ {profile} }} }}\n"
            );
            let settings = MapSettings::new(recorded(&text), None, None, None, &[]).unwrap();
            settings.maps[0].mapper.clone()
        };
        let law = CloseInConfig { carrier_ghz: Some(73.0), exponent: Some(1.7), ..CloseInConfig::default() };
        let channel = ChannelConfig { path_loss: Some(PathLossConfig::CloseIn(law)), ..ChannelConfig::default() };
        let loss_db = ChannelLaw::try_from(channel).unwrap().path_loss().reference_loss().0;
        // Free space over a metre at 73 GHz: 20 log10(4 pi f / c).
        assert!((loss_db - 69.71).abs() < 0.01, "{loss_db} dB");
        let written = map([0.0, 0.0], &format!("tx_power_dbm = {:?}", 20.0 + 10.0 - loss_db));
        assert_eq!(map([10.0, 14.0], ""), written, "the answer of a node is the weaker direction");
        assert_eq!(map([14.0, 10.0], ""), written, "the sweep of a robot is the weaker direction");
        assert_ne!(map([14.0, 11.0], ""), written);
    }

    #[test]
    fn maps_name_networks_that_robots_survey() {
        let new = |network: &str, flag: Option<&str>| {
            let text = format!(
                "{START}channel = {{ environment = \"suburban\", max_range_m = 9, path_loss.log_distance.reference_loss_db = 0.0 }}\n[networks.a]\nradio = {{ tx_power_dbm = -50, sensitivity_dbm = -90 }}\n\
                 [networks.b]\nradio = {{ tx_power_dbm = -60, sensitivity_dbm = -90 }}\n\
                 [networks.c]\nradio = {{ tx_power_dbm = -60, sensitivity_dbm = -90 }}\n\
                 [[robots]]\nname = \"r\"\nstart_m = [0, 0]\nlisten_s = 1\nnetworks = [\"b\", \"a\"]\n\
                 controller.waypoints.places_m = [[0, 0]]\n\
                 [[maps]]\n{network}algorithm.ml_tm = {{ grid_step_m = 0.5, profile.channel = {{}} }}\n"
            );
            MapSettings::new(recorded(&text), None, None, flag, &[])
        };
        let mapper = |network, flag| new(network, flag).unwrap().maps[0].mapper.clone();
        let (first, second) = (mapper("", None), mapper("network = \"b\"\n", None));
        assert_ne!(first, second, "each has the channel of its network");
        assert_eq!(mapper("network = \"a\"\n", None), first);
        assert_eq!(mapper("network = \"a\"\n", Some("b")), second, "a flag overrides the map");
        for refused in [new("network = \"c\"\n", None), new("", Some("c"))] {
            let refused = refused.unwrap_err().to_string();
            assert!(refused.contains("`maps[0].network` is `c`"), "{refused}");
            assert!(refused.contains("`a`, `b`, the networks that robots survey"), "{refused}");
        }
    }

    #[test]
    fn an_invalid_profile_is_rejected() {
        let refused =
            |profile: Option<&str>| MapSettings::new(None, None, profile, None, &[]).unwrap_err().to_string();
        assert!(refused(Some("channel:sigma_db=8")).contains("`"), "{}", refused(Some("channel:sigma_db=8")));
        assert!(refused(Some("p0=2,plateau_m=2,range_m=10")).contains("p0` is 2; allowed: above 0, at most 1"));
        assert!(refused(Some("p=2")).contains("unknown key `p`"));
        assert!(refused(Some("p0 2")).contains("is not a TOML value"));
        assert!(refused(Some("square:p0=1")).contains("unknown choice `square`"));
    }

    #[test]
    fn a_setting_on_which_no_map_depends_is_refused() {
        for (setting, table) in [("seed=3", "seed"), ("duration_s = 4", "duration_s"), ("x", "x")] {
            let refused = MapSettings::new(None, None, None, None, &[setting.to_owned()]).unwrap_err().to_string();
            assert!(refused.contains(&format!("no map depends on `{table}`")), "{refused}");
        }
        let refused = MapSettings::new(None, None, None, None, &["seed=3".to_owned()]).unwrap_err();
        assert!(format!("{refused:?}").contains("its whole key is `maps.0.algorithm.auto.seed`"), "{refused:?}");
        let keys = schema();
        assert!(TABLES.iter().all(|table| keys["properties"].get(table).is_some()));
    }

    #[test]
    fn what_the_estimator_of_one_map_has_may_be_set_alone() {
        let mapper = |set: &str| {
            let set = [set.to_owned()];
            MapSettings::new(None, None, None, None, &set).unwrap().maps[0].mapper.clone()
        };
        let whole = mapper("maps.0.algorithm.auto.z_range_m=[0,3]");
        assert_ne!(mapper("maps.0.algorithm.auto={}"), whole);
        for short in ["z_range_m=[0,3]", " z_range_m = [0, 3]", "algorithm.auto.z_range_m=[0,3]"] {
            assert_eq!(mapper(short), whole, "{short}");
        }
        // A value that is not allowed is told with the whole key.
        let refused = MapSettings::new(None, None, None, None, &["z_range_m=3".to_owned()]).unwrap_err();
        assert!(format!("{refused:?}").contains("`maps.0.algorithm.auto.z_range_m`"), "{refused:?}");
    }
}
